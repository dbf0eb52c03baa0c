// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationCaseWriter_h
#define mammoray_RegistrationCaseWriter_h

#include "mammoray/Case/RegistrationCase.h"
#include "mammorayCaseModule.h"

#include "vtkSmartPointer.h"

#include <string>
#include <vector>

class vtkUnstructuredGrid;

namespace mammoray
{
/// The anatomy at rest, volume frame, with the point array "Displacement" (mm), those of the
/// sensitivities (SensitivityArrayPrefix), and the unit's "Placement".
MAMMORAYCASE_EXPORT vtkSmartPointer<vtkUnstructuredGrid> UncompressedGrid(
  const RegistrationCaseResult& result, const RegisteredView& view);

/// Where the views are written to within the result's folder: the views' names in small letters
/// ("cc", "mlo"), numbered where they repeat; "" for a single one.
MAMMORAYCASE_EXPORT std::vector<std::string> ViewFolders(const RegistrationCaseResult& result);

/**
 * Writes into an existing folder, for one mammogram: uncompressed.vtu and compressed.vtu (volume
 * frame, both with the point array "Displacement", mm, from the one to the other), synthetic.mha
 * (log attenuation on the mammogram's pixel grid, float), and what WriteRegistrationReport writes.
 * For several: a folder with that for each of them (ViewFolders), and what WriteJointReport writes.
 * Throws InputError when a file cannot be written.
 */
MAMMORAYCASE_EXPORT void WriteRegistrationCase(const RegistrationCase& input,
  const RegistrationCaseResult& result, const std::string& folder);
}

#endif
