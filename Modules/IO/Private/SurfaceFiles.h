// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_SurfaceFiles_h
#define mammoray_Private_SurfaceFiles_h

#include "mammorayIOModule.h"

#include "vtkSmartPointer.h"

#include <string>

class vtkPolyData;

namespace mammoray
{
/**
 * The polygons of a file, in whose points the type, float or double, is the file's own. Each of
 * these throws InputError, which names the line or the element, on what is not of its format, on
 * points that do not exist and on files that are cut off. Normals, colours, textures, materials,
 * groups, lines and free points are passed over.
 */
/// STL in text or binary; points at the same place are one. The number of triangles of a binary
/// file must be that which its size holds.
MAMMORAYIO_EXPORT vtkSmartPointer<vtkPolyData> ReadStl(const std::string& path);
/// PLY in text or binary of either byte order.
MAMMORAYIO_EXPORT vtkSmartPointer<vtkPolyData> ReadPly(const std::string& path);
/// Wavefront's OBJ.
MAMMORAYIO_EXPORT vtkSmartPointer<vtkPolyData> ReadObj(const std::string& path);
}

#endif
