// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_GltfReader_h
#define mammoray_Private_GltfReader_h

#include "vtkSmartPointer.h"

#include <string>

class vtkPolyData;

namespace mammoray
{
/// The metre, in which glTF's coordinates are, in mm.
inline constexpr double GltfUnitMm = 1000;

/**
 * Reads all triangles of the default scene (the first without one) of a .glb or .gltf file of glTF
 * 2.0, placed by their nodes, in mm. Vertices at the same place become one; what a node mirrors is
 * turned so that fronts stay fronts. Buffers may lie in files beside it. Throws InputError where
 * the file cannot be shown as it is: required extensions other than those of looks, points and
 * lines, skins, morph targets, sparse accessors, and data beyond its buffer.
 */
vtkSmartPointer<vtkPolyData> ReadGltf(const std::string& path);
}

#endif
