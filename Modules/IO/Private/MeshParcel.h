// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_MeshParcel_h
#define mammoray_Private_MeshParcel_h

#include "mammoray/IO/GuardedRead.h"
#include "mammorayIOModule.h"

#include <string>

class vtkPolyData;
class vtkUnstructuredGrid;

namespace mammoray
{
/// Sends a mesh with its points, cells and all arrays; throws InputError, which names `path`, on
/// cells with lists of faces.
void PackMesh(vtkUnstructuredGrid* mesh, const std::string& path, ParcelWriter& parcel);
void PackMesh(vtkPolyData* mesh, const std::string& path, ParcelWriter& parcel);

/// Takes it out. Throws InputError, which names `path` and the place, where a cell has a point that
/// is not there, a coordinate is not finite, or an array has another length than it should.
MAMMORAYIO_EXPORT void UnpackMesh(ParcelReader& parcel, const std::string& path,
  vtkUnstructuredGrid* mesh);
MAMMORAYIO_EXPORT void UnpackMesh(ParcelReader& parcel, const std::string& path, vtkPolyData* mesh);
}

#endif
