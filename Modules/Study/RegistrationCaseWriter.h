// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationCaseWriter_h
#define mammoray_RegistrationCaseWriter_h

#include "mammoray/Study/RegistrationCase.h"
#include "mammorayStudyModule.h"

#include "vtkSmartPointer.h"

#include <string>
#include <vector>

class vtkUnstructuredGrid;

namespace mammoray
{
/// The uncompressed anatomy, volume frame, with the point array "Displacement" (mm), those of the
/// sensitivities (SensitivityArrayPrefix), and the unit's "Placement".
MAMMORAYSTUDY_EXPORT vtkSmartPointer<vtkUnstructuredGrid> UncompressedGrid(
  const RegistrationCaseResult& result, const RegisteredView& registered);

/// Folders of the mammograms within the result's folder: their views in small letters ("cc",
/// "mlo"), numbered if they repeat; "" for a single mammogram.
MAMMORAYSTUDY_EXPORT std::vector<std::string> MammogramFolders(
  const RegistrationCaseResult& result);

/// Whether a result's folder, or one of its mammograms', has a file of this name.
MAMMORAYSTUDY_EXPORT bool IsFileOfResult(const std::string& name);

/// The checkpoint of a search whose result goes to this folder, until the result is written.
MAMMORAYSTUDY_EXPORT std::string CheckpointPath(const std::string& folder);

/// Reserves the folder (ReserveFolder). Throws InputError unless the folder is new or empty or,
/// with `overwrite`, has an earlier result and nothing else.
MAMMORAYSTUDY_EXPORT void CheckResultFolder(const std::string& folder, bool overwrite);

/**
 * Writes a folder, complete or not at all, and removes the case's checkpoint.
 *
 * One mammogram: uncompressed.vtu and compressed.vtu (volume frame, both with the point array
 * "Displacement", mm, from the one to the other), synthetic.mha (log attenuation on the mammogram's
 * pixel grid, float), the result file, and the files of WriteRegistrationReport. Several: a folder
 * with these for each (MammogramFolders), the joint result file, and the files of WriteJointReport.
 * A study adds labels.nrrd and mri.nrrd (StudyTissue) and a section of the report. The case's Image
 * becomes mri.nrrd, too.
 *
 * Throws InputError as CheckResultFolder, and if a file cannot be written or an input cannot be
 * read.
 */
MAMMORAYSTUDY_EXPORT void WriteRegistrationCase(const RegistrationCase& input,
  const RegistrationCaseResult& result, const std::string& folder, bool overwrite = false);
}

#endif
