// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SurfaceConversion_h
#define mammoray_SurfaceConversion_h

#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/SurfaceMesh.h"
#include "mammorayIOModule.h"

#include "vtkSmartPointer.h"

#include <string>
#include <vector>

class vtkPolyData;

namespace mammoray
{
/// Names of the cell arrays that hold the material on a triangle's front and back.
inline constexpr const char* FrontMaterialArrayName = "FrontMaterial";
inline constexpr const char* BackMaterialArrayName = "BackMaterial";

/**
 * Triangles with the materials of "FrontMaterial" and "BackMaterial"; or with those of "Material",
 * which names the inside of closed surfaces in air, whichever way they are oriented as a whole; or
 * without arrays, closed surfaces of material 1. Throws InputError, which names the cell, on cells
 * other than triangles and on materials outside [0, 65535]. `materialNames` receives the field
 * array "MaterialNames".
 */
MAMMORAYIO_EXPORT SurfaceMesh FromPolyData(vtkPolyData* surface,
  std::vector<std::string>* materialNames = nullptr);

/// Triangles with the cell arrays "FrontMaterial" and "BackMaterial" (unsigned short) and the field
/// array "MaterialNames"; positions in single precision, 1e-5 mm of 100 mm.
MAMMORAYIO_EXPORT vtkSmartPointer<vtkPolyData> ToPolyData(const SurfaceMesh& surface,
  const std::vector<std::string>& materialNames);

/**
 * FindPoseAnchor for a mesh: the middle of its bounding box across and along the body, at the front
 * of the held tissue, or at the posterior end where no material is held. `held[m]` tells whether m
 * is held.
 */
MAMMORAYIO_EXPORT Vector3 FindPoseAnchor(const SurfaceMesh& surface, const std::vector<bool>& held,
  const AnatomicalAxes& axes);
}

#endif
