// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MeshConversion_h
#define mammoray_MeshConversion_h

#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Meshes.h"
#include "mammorayIOModule.h"

#include "vtkSmartPointer.h"

#include <optional>
#include <string>
#include <vector>

class vtkDataObject;
class vtkPolyData;
class vtkUnstructuredGrid;

namespace mammoray
{
/// Name of the cell array (int32) that holds material indices.
inline constexpr const char* MaterialArrayName = "Material";
/// Name of the field data array (strings) that names material 0, 1, 2, ...
inline constexpr const char* MaterialNamesArrayName = "MaterialNames";
/// Name of the field data array (4 x 3 doubles) with the unit's placement: the gantry's origin, mm,
/// and its x, y and z axes in the grid's frame.
inline constexpr const char* PlacementArrayName = "Placement";

/// Returns a grid of linear tetrahedra with the cell array "Material" and the field array
/// "MaterialNames".
MAMMORAYIO_EXPORT vtkSmartPointer<vtkUnstructuredGrid> ToGrid(const TetrahedralMesh& mesh,
  const std::vector<std::string>& materialNames);

/**
 * Converts a grid back. Throws InputError, which names the cell, on cells other than linear
 * tetrahedra, on materials that are no whole number in [0, 65535], and if the cell array "Material"
 * is missing. `materialNames` receives the field array
 * if there is one.
 */
MAMMORAYIO_EXPORT TetrahedralMesh FromGrid(vtkUnstructuredGrid* grid,
  std::vector<std::string>* materialNames = nullptr);

/// As FromGrid and MaterialTable::FitMesh; the grid gets the table's numbers and names, too, where
/// they differ from its own. Messages begin with `where`.
MAMMORAYIO_EXPORT TetrahedralMesh FitGrid(vtkUnstructuredGrid* grid, const MaterialTable& table,
  const std::string& where);

/// What a cell of VTK's type is: "quadratic hexahedron".
MAMMORAYIO_EXPORT std::string NameOfCellType(int type);

/// Adds the field array "Placement".
MAMMORAYIO_EXPORT void AddPlacement(vtkDataObject* data, const VolumeFromGantry& placed);
/// Returns the placement of the field array "Placement"; nothing without one of 4 x 3 values.
MAMMORAYIO_EXPORT std::optional<VolumeFromGantry> FindPlacement(vtkDataObject* data);

/// Names of the cell arrays that hold the material on a triangle's front and back.
inline constexpr const char* FrontMaterialArrayName = "FrontMaterial";
inline constexpr const char* BackMaterialArrayName = "BackMaterial";

/**
 * Converts polygons, which are cut into triangles; lines and vertices are left out. Their materials
 * are those of the cell arrays "FrontMaterial" and "BackMaterial"; without these, "Material" is
 * inside closed surfaces in air, whichever way they are oriented as a whole; without any array,
 * material 1 is. Throws InputError, which names the cell, on strips and on materials outside [0,
 * 65535]. `materialNames` receives the field array "MaterialNames".
 */
MAMMORAYIO_EXPORT SurfaceMesh FromPolyData(vtkPolyData* surface,
  std::vector<std::string>* materialNames = nullptr);

/// Returns triangles with the cell arrays "FrontMaterial" and "BackMaterial" (unsigned short) and
/// the field array "MaterialNames"; positions in single precision, 1e-5 mm of 100 mm.
MAMMORAYIO_EXPORT vtkSmartPointer<vtkPolyData> ToPolyData(const SurfaceMesh& surface,
  const std::vector<std::string>& materialNames);
}

#endif
