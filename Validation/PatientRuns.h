// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Validation_PatientRuns_h
#define mammoray_Validation_PatientRuns_h

#include "mammoray/Foundation/Progress.h"

#include <string>
#include <vector>

namespace mammoray
{
/// A patient whose MRI is segmented.
struct Patient
{
  std::string Name;
  /// Folder of the series.
  std::string Mri;
  /// Drawn slices (ReadDrawnSlices); the file may be absent.
  std::string Drawn;
};

/**
 * Segments each MRI as 'mammoray segment' does and prints a row: verdict, volumes, agreement with
 * the drawn slices, and time. A refused MRI is a row, too. `folder`, which does not exist or is
 * empty, receives the rows (patients.csv), the labels of each patient (NAME.nrrd) and slices of all
 * patients with the labels' outlines (patients.png). Throws InputError if a file of drawn slices is
 * unusable or the folder cannot be written, and Interrupted.
 */
void RunPatients(const std::vector<Patient>& patients, const std::string& folder,
  const ProgressCallback& progress = {});
}

#endif
