// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_GridParcel_h
#define mammoray_Private_GridParcel_h

#include "mammoray/IO/GuardedRead.h"
#include "mammorayIOModule.h"

#include "vtkSmartPointer.h"

#include <vector>

class vtkUnstructuredGrid;

namespace mammoray
{
/// The values of a VTK array: numbers of a VTK type, or texts.
struct PackedArray
{
  std::string Name;
  int Type = 0;
  int NumberOfComponents = 1;
  std::vector<unsigned char> Bytes;
  std::vector<std::string> Texts;
};

/// A grid's points, cells and arrays of numbers and texts, as they are sent.
struct PackedGrid
{
  PackedArray Points;
  std::vector<std::int64_t> Offsets;
  std::vector<std::int64_t> Corners;
  std::vector<unsigned char> Types;
  std::vector<PackedArray> PointData, CellData, FieldData;
};

/// Throws InputError, which names `path` and the point, unless its coordinates are below 1e9 mm.
void CheckCoordinates(const std::string& path, std::size_t point, const double* at);

void Exchange(Parcel& parcel, PackedArray& array);
MAMMORAYIO_EXPORT void Exchange(Parcel& parcel, PackedGrid& grid);

/// Throws InputError, which names `path`, if cells are given by lists of faces.
PackedGrid PackGrid(vtkUnstructuredGrid* grid, const std::string& path);

/// Throws InputError, which names `path` and the place, if a cell has a point that does not exist,
/// or an array another length than it should; and as CheckCoordinates.
MAMMORAYIO_EXPORT vtkSmartPointer<vtkUnstructuredGrid> UnpackGrid(const PackedGrid& packed,
  const std::string& path);
}

#endif
