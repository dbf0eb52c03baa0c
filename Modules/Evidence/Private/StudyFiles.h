// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_StudyFiles_h
#define mammoray_Private_StudyFiles_h

#include "Private/ImitatedMammogram.h"
#include "Private/PatientTissue.h"
#include "mammoray/Evidence/VirtualStudy.h"
#include "mammoray/Foundation/Mammogram.h"

#include <string>
#include <vector>

namespace mammoray
{
/// What is in the scanner: the breast at rest, what is behind it, and how it hangs.
struct StudyPatient
{
  const LabelVolume& Rest;
  const MaterialTable& Table;
  ChestCurve Curve;
  double OffMm = 0;
  PointMotion Hang;
};

/**
 * Pictures the patient as MRI and writes it, the mammograms (those of truth.Views, in their order,
 * whose File is filled in) and what else lies in an export to FOLDER/export, and FOLDER/truth.json.
 * The folder appears when all is there. Throws InputError where it cannot be written, Interrupted.
 */
void WriteStudyFiles(const StudyPatient& patient, const std::vector<Mammogram>& mammograms,
  const VirtualStudyOptions& options, Draws& draws, const std::string& folder,
  VirtualStudyTruth& truth, const ProgressCallback& progress);
}

#endif
