// SPDX-License-Identifier: Apache-2.0
#include "Private/GridParcel.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkStringArray.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace mammoray
{
namespace
{
/// Arrays of bits, which have no bytes of their own, become arrays of characters.
PackedArray PackArray(vtkAbstractArray* array)
{
  PackedArray packed;
  packed.Name = array->GetName() ? array->GetName() : "";
  packed.NumberOfComponents = array->GetNumberOfComponents();
  packed.Type = array->GetDataType() == VTK_BIT ? VTK_UNSIGNED_CHAR : array->GetDataType();
  if (auto* const texts = vtkStringArray::SafeDownCast(array))
  {
    packed.Texts.assign(texts->GetPointer(0), texts->GetPointer(0) + texts->GetNumberOfValues());
    return packed;
  }
  const auto plain =
    vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(packed.Type));
  plain->DeepCopy(vtkDataArray::SafeDownCast(array));
  const auto* const bytes = static_cast<const unsigned char*>(plain->GetVoidPointer(0));
  packed.Bytes.assign(bytes,
    bytes + static_cast<std::size_t>(plain->GetNumberOfValues()) * plain->GetDataTypeSize());
  return packed;
}

vtkSmartPointer<vtkAbstractArray> UnpackArray(const PackedArray& packed, const std::string& path)
{
  vtkSmartPointer<vtkAbstractArray> array;
  if (packed.Type == VTK_STRING)
  {
    auto texts = vtkSmartPointer<vtkStringArray>::New();
    for (const std::string& text : packed.Texts)
    {
      texts->InsertNextValue(text);
    }
    array = texts;
  }
  else
  {
    // VTK makes doubles of a type that it does not know, and prints a line.
    const int type = packed.Type;
    const bool isKnown = (type >= VTK_CHAR && type <= VTK_ID_TYPE) || type == VTK_SIGNED_CHAR ||
      type == VTK_LONG_LONG || type == VTK_UNSIGNED_LONG_LONG;
    const int components = packed.NumberOfComponents;
    auto numbers = vtkSmartPointer<vtkDataArray>::Take(
      vtkDataArray::CreateDataArray(isKnown ? type : VTK_DOUBLE));
    const std::size_t size = static_cast<std::size_t>(std::clamp(components, 1, 1024)) *
      static_cast<std::size_t>(numbers->GetDataTypeSize());
    if (!isKnown || components < 1 || components > 1024 || packed.Bytes.size() % size != 0)
    {
      throw InputError(
        path + ": array '" + packed.Name + "': expected numbers of 1 to 1024 components");
    }
    numbers->SetNumberOfComponents(components);
    numbers->SetNumberOfTuples(static_cast<vtkIdType>(packed.Bytes.size() / size));
    if (!packed.Bytes.empty())
    {
      std::memcpy(numbers->GetVoidPointer(0), packed.Bytes.data(), packed.Bytes.size());
    }
    array = numbers;
  }
  array->SetName(packed.Name.empty() ? nullptr : packed.Name.c_str());
  return array;
}

/// Leaves out arrays that are neither numbers nor texts.
std::vector<PackedArray> PackFields(vtkFieldData* fields)
{
  std::vector<PackedArray> packed;
  for (int index = 0; index < fields->GetNumberOfArrays(); ++index)
  {
    vtkAbstractArray* const array = fields->GetAbstractArray(index);
    if (vtkDataArray::SafeDownCast(array) || vtkStringArray::SafeDownCast(array))
    {
      packed.push_back(PackArray(array));
    }
  }
  return packed;
}

/// `tuples`: how many an array of numbers must have; any if negative.
void UnpackFields(const std::vector<PackedArray>& packed, const std::string& path, vtkIdType tuples,
  vtkFieldData* fields)
{
  for (const PackedArray& each : packed)
  {
    const auto array = UnpackArray(each, path);
    if (tuples >= 0 && each.Type != VTK_STRING && array->GetNumberOfTuples() != tuples)
    {
      throw InputError(path + ": array '" + each.Name + "': expected " + std::to_string(tuples) +
        " values, found " + std::to_string(array->GetNumberOfTuples()));
    }
    fields->AddArray(array);
  }
}

void UnpackPoints(const PackedGrid& packed, const std::string& path, vtkUnstructuredGrid* grid)
{
  const auto array = UnpackArray(packed.Points, path);
  auto* const coordinates = vtkDataArray::SafeDownCast(array);
  if (!coordinates || coordinates->GetNumberOfComponents() != 3)
  {
    throw InputError(path + ": expected points of three coordinates");
  }
  for (vtkIdType point = 0; point < coordinates->GetNumberOfTuples(); ++point)
  {
    double at[3];
    coordinates->GetTuple(point, at);
    CheckCoordinates(path, static_cast<std::size_t>(point), at);
  }
  vtkNew<vtkPoints> points;
  points->SetData(coordinates);
  grid->SetPoints(points);
}

void CheckCells(const PackedGrid& packed, const std::string& path, std::int64_t points)
{
  const std::vector<std::int64_t>& offsets = packed.Offsets;
  if (offsets.size() != packed.Types.size() + 1 || offsets.front() != 0 ||
    offsets.back() != static_cast<std::int64_t>(packed.Corners.size()) ||
    !std::is_sorted(offsets.begin(), offsets.end()))
  {
    throw InputError(path + ": expected a type and a list of points for each cell");
  }
  for (std::size_t cell = 0; cell < packed.Types.size(); ++cell)
  {
    const std::string place = path + ": cell " + std::to_string(cell);
    if (packed.Types[cell] == VTK_TETRA && offsets[cell + 1] - offsets[cell] != 4)
    {
      throw InputError(place + ": expected the four points of a tetrahedron, found " +
        std::to_string(offsets[cell + 1] - offsets[cell]));
    }
    for (auto at = offsets[cell]; at < offsets[cell + 1]; ++at)
    {
      const std::int64_t corner = packed.Corners[static_cast<std::size_t>(at)];
      if (corner < 0 || corner >= points)
      {
        throw InputError(place + ": expected points 0 to " + std::to_string(points - 1) +
          ", found " + std::to_string(corner));
      }
    }
  }
}

/// VTK's array of the values, which it copies.
template <typename Array, typename Value>
vtkSmartPointer<Array> Copied(const std::vector<Value>& values)
{
  auto array = vtkSmartPointer<Array>::New();
  array->SetNumberOfValues(static_cast<vtkIdType>(values.size()));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  return array;
}
}

void CheckCoordinates(const std::string& path, std::size_t point, const double* at)
{
  // Single precision is what the X-rays use; beyond it lies nothing that has a size.
  if (!std::all_of(at, at + 3, [](double value) { return std::abs(value) < 1e9; }))
  {
    throw InputError(path + ": point " + std::to_string(point) +
      ": expected coordinates below 1e9 mm, found " + std::to_string(at[0]) + " " +
      std::to_string(at[1]) + " " + std::to_string(at[2]));
  }
}

void Exchange(Parcel& parcel, PackedArray& array)
{
  parcel(array.Name, array.Type, array.NumberOfComponents, array.Bytes, array.Texts);
}

void Exchange(Parcel& parcel, PackedGrid& grid)
{
  parcel(grid.Points, grid.Offsets, grid.Corners, grid.Types, grid.PointData, grid.CellData,
    grid.FieldData);
}

PackedGrid PackGrid(vtkUnstructuredGrid* grid, const std::string& path)
{
  if (grid->GetFaces())
  {
    throw InputError(path + ": expected cells given by their points, found lists of faces");
  }
  PackedGrid packed;
  packed.Points = PackArray(grid->GetPoints()->GetData());
  vtkNew<vtkIdList> ids;
  packed.Offsets.push_back(0);
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell)
  {
    grid->GetCellPoints(cell, ids);
    packed.Corners.insert(packed.Corners.end(), ids->begin(), ids->end());
    packed.Offsets.push_back(static_cast<std::int64_t>(packed.Corners.size()));
    packed.Types.push_back(static_cast<unsigned char>(grid->GetCellType(cell)));
  }
  packed.PointData = PackFields(grid->GetPointData());
  packed.CellData = PackFields(grid->GetCellData());
  packed.FieldData = PackFields(grid->GetFieldData());
  return packed;
}

vtkSmartPointer<vtkUnstructuredGrid> UnpackGrid(const PackedGrid& packed, const std::string& path)
{
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  UnpackPoints(packed, path, grid);
  CheckCells(packed, path, grid->GetNumberOfPoints());
  vtkNew<vtkCellArray> cells;
  cells->SetData(Copied<vtkTypeInt64Array>(packed.Offsets),
    Copied<vtkTypeInt64Array>(packed.Corners));
  grid->SetCells(Copied<vtkUnsignedCharArray>(packed.Types), cells);
  UnpackFields(packed.PointData, path, grid->GetNumberOfPoints(), grid->GetPointData());
  UnpackFields(packed.CellData, path, grid->GetNumberOfCells(), grid->GetCellData());
  UnpackFields(packed.FieldData, path, -1, grid->GetFieldData());
  return grid;
}
}
