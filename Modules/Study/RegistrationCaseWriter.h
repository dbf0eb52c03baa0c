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
/// The anatomy at rest, volume frame, with the point array "Displacement" (mm), those of the
/// sensitivities (SensitivityArrayPrefix), and the unit's "Placement".
MAMMORAYSTUDY_EXPORT vtkSmartPointer<vtkUnstructuredGrid> UncompressedGrid(
  const RegistrationCaseResult& result, const RegisteredView& registered);

/// Where the mammograms are written to within the result's folder: their views in small letters
/// ("cc", "mlo"), numbered where they repeat; "" for a single one.
MAMMORAYSTUDY_EXPORT std::vector<std::string> MammogramFolders(
  const RegistrationCaseResult& result);

/// Whether a result's folder, or one of its mammograms', has a file of this name.
MAMMORAYSTUDY_EXPORT bool IsFileOfResult(const std::string& name);

/// Where the search for a result of this folder keeps its last step, until the result is written.
MAMMORAYSTUDY_EXPORT std::string CheckpointPath(const std::string& folder);

/// Reserves the folder (ReserveFolder). Throws InputError unless a result can be written there:
/// into a folder that exists, under a name that is free or, with `overwrite`, that of an earlier
/// result and nothing else.
MAMMORAYSTUDY_EXPORT void CheckResultFolder(const std::string& folder, bool overwrite);

/**
 * Writes a folder, complete or not at all, for one mammogram: uncompressed.vtu and compressed.vtu
 * (volume frame, both with the point array "Displacement", mm, from the one to the other),
 * synthetic.mha (log attenuation on the mammogram's pixel grid, float), the result file, and what
 * WriteRegistrationReport writes. For several: a folder with that for each of them
 * (MammogramFolders), their joint result file, and what WriteJointReport writes. Of a study besides
 * labels.nrrd and mri.nrrd (StudyTissue), and a section of the report;
 * mri.nrrd is the case's Image, too. Throws InputError
 * as CheckResultFolder, and when a file cannot be written or an input no longer be read. Once all
 * is written the case's checkpoint is removed.
 */
MAMMORAYSTUDY_EXPORT void WriteRegistrationCase(const RegistrationCase& input,
  const RegistrationCaseResult& result, const std::string& folder, bool overwrite = false);
}

#endif
