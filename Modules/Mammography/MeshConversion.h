// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MeshConversion_h
#define mammoray_MeshConversion_h

#include "TetrahedralMesh.h"
#include "mammorayMammographyModule.h"

#include "vtkSmartPointer.h"

#include <string>
#include <vector>

class vtkUnstructuredGrid;

namespace mammoray
{
/// Name of the cell array (int32) that holds material indices.
inline constexpr const char* MaterialArrayName = "Material";
/// Name of the field data array (strings) that names material 0, 1, 2, ...
inline constexpr const char* MaterialNamesArrayName = "MaterialNames";

/// Grid of linear tetrahedra with the cell array "Material" and the field array "MaterialNames".
MAMMORAYMAMMOGRAPHY_EXPORT vtkSmartPointer<vtkUnstructuredGrid> ToGrid(
  const TetrahedralMesh& mesh, const std::vector<std::string>& materialNames);

/**
 * The reverse. Throws InputError, which names the cell, on cells other than linear tetrahedra, and when the
 * cell array "Material" is missing. `materialNames` receives the field array, if there is one.
 */
MAMMORAYMAMMOGRAPHY_EXPORT TetrahedralMesh FromGrid(
  vtkUnstructuredGrid* grid, std::vector<std::string>* materialNames = nullptr);
}

#endif
