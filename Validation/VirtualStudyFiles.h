// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Validation_VirtualStudyFiles_h
#define mammoray_Validation_VirtualStudyFiles_h

#include "PatientTissue.h"
#include "SimulatedMammogram.h"
#include "VirtualStudy.h"
#include "mammoray/Foundation/Mammogram.h"

#include <string>
#include <vector>

namespace mammoray
{
/// The patient in the scanner: the breast at rest, the chest behind it, and the motion to where it
/// hangs.
struct StudyPatient
{
  const LabelVolume& Rest;
  const MaterialTable& Table;
  ChestCurve Curve;
  double OffMm = 0;
  PointMotion Hang;
};

/**
 * Simulates the patient's MRI and writes it, the mammograms (those of truth.Views, in their order,
 * whose File is filled in) and the other files of an export to FOLDER/export, and
 * FOLDER/truth.json. The folder appears when it is complete. Throws InputError if it cannot be
 * written, Interrupted.
 */
void WriteStudyFiles(const StudyPatient& patient, const std::vector<Mammogram>& mammograms,
  const VirtualStudyOptions& options, Draws& draws, const std::string& folder, StudyTruth& truth,
  const ProgressCallback& progress);
}

#endif
