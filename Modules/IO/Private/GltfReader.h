// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_GltfReader_h
#define mammoray_Private_GltfReader_h

#include "mammorayIOModule.h"

#include "vtkSmartPointer.h"

#include <string>

class vtkPolyData;

namespace mammoray
{
/// glTF has metres.
inline constexpr double GltfUnitMm = 1000;

/**
 * The triangles of the default scene of a glTF 2.0 file, binary (.glb) or in JSON (.gltf, its
 * buffers in it or in files beside it), in one surface, mm: all meshes, placed by their nodes'
 * matrices or translations, rotations and scales, turned over where these mirror; points at the
 * same place are one. Materials, normals, cameras and animations are left out.
 *
 * Throws InputError, one line, on what it cannot show as it is: a required extension that changes
 * geometry (Draco, meshopt, quantisation), points and lines, sparse accessors, skins, morph targets
 * that are not at rest; and on anything damaged, such as accessors beyond their buffer.
 */
MAMMORAYIO_EXPORT vtkSmartPointer<vtkPolyData> ReadGltf(const std::string& path);
}

#endif
