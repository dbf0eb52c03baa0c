// SPDX-License-Identifier: Apache-2.0
#include "Private/MeshParcel.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
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
enum class ArrayKind : std::uint8_t
{
  Numbers,
  Texts
};

/// Bits have no values that lie side by side in memory.
int TypeOnTheWay(const vtkAbstractArray* array)
{
  const int type = const_cast<vtkAbstractArray*>(array)->GetDataType();
  return type == VTK_BIT ? VTK_UNSIGNED_CHAR : type;
}

void PackNumbers(vtkDataArray* array, ParcelWriter& parcel)
{
  const int type = TypeOnTheWay(array);
  parcel(std::string(array->GetName() ? array->GetName() : ""), type,
    array->GetNumberOfComponents(), static_cast<std::uint64_t>(array->GetNumberOfTuples()));
  vtkSmartPointer<vtkDataArray> sent = array;
  if (type != array->GetDataType() || !array->HasStandardMemoryLayout())
  {
    sent = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(type));
    sent->DeepCopy(array);
  }
  parcel.Block(sent->GetVoidPointer(0),
    static_cast<std::uint64_t>(sent->GetNumberOfValues()) * sent->GetDataTypeSize());
}

vtkSmartPointer<vtkDataArray> UnpackNumbers(ParcelReader& parcel, const std::string& path)
{
  std::string name;
  int type = 0;
  int components = 0;
  std::uint64_t tuples = 0;
  parcel(name, type, components, tuples);
  // VTK makes doubles of a type that it does not know, and prints so.
  const bool isKnown = (type >= VTK_CHAR && type <= VTK_ID_TYPE) || type == VTK_SIGNED_CHAR ||
    type == VTK_LONG_LONG || type == VTK_UNSIGNED_LONG_LONG;
  auto array =
    vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(isKnown ? type : VTK_DOUBLE));
  if (!isKnown || array->GetDataType() != type || components < 1 || components > 1024 ||
    tuples > (std::uint64_t{ 1 } << 40))
  {
    throw InputError(path + ": array '" + name + "': expected numbers of 1 to 1024 components");
  }
  const std::uint64_t bytes = tuples * static_cast<std::uint64_t>(components) *
    static_cast<std::uint64_t>(array->GetDataTypeSize());
  // Before memory is taken for them: the bytes are there.
  const unsigned char* const values = parcel.Block(bytes);
  array->SetName(name.empty() ? nullptr : name.c_str());
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(static_cast<vtkIdType>(tuples));
  if (bytes > 0)
  {
    std::memcpy(array->GetVoidPointer(0), values, bytes);
  }
  return array;
}

/// Arrays of other kinds (variants) are left out.
void PackFields(vtkFieldData* fields, ParcelWriter& parcel)
{
  std::vector<vtkAbstractArray*> sent;
  for (int index = 0; index < fields->GetNumberOfArrays(); ++index)
  {
    vtkAbstractArray* const array = fields->GetAbstractArray(index);
    if (vtkDataArray::SafeDownCast(array) || vtkStringArray::SafeDownCast(array))
    {
      sent.push_back(array);
    }
  }
  parcel(std::uint64_t{ sent.size() });
  for (vtkAbstractArray* const array : sent)
  {
    if (auto* const texts = vtkStringArray::SafeDownCast(array))
    {
      std::vector<std::string> values;
      for (vtkIdType value = 0; value < texts->GetNumberOfValues(); ++value)
      {
        values.push_back(texts->GetValue(value));
      }
      parcel(ArrayKind::Texts, std::string(array->GetName() ? array->GetName() : ""), values);
      continue;
    }
    parcel(ArrayKind::Numbers);
    PackNumbers(vtkDataArray::SafeDownCast(array), parcel);
  }
}

/// `tuples`: how many an array of numbers must have; any where negative.
void UnpackFields(ParcelReader& parcel, const std::string& path, vtkIdType tuples,
  vtkFieldData* fields)
{
  std::uint64_t count = 0;
  parcel(count);
  for (std::uint64_t index = 0; index < count; ++index)
  {
    ArrayKind kind{};
    parcel(kind);
    if (kind == ArrayKind::Texts)
    {
      std::string name;
      std::vector<std::string> values;
      parcel(name, values);
      vtkNew<vtkStringArray> texts;
      texts->SetName(name.empty() ? nullptr : name.c_str());
      for (const std::string& value : values)
      {
        texts->InsertNextValue(value);
      }
      fields->AddArray(texts);
      continue;
    }
    const auto array = UnpackNumbers(parcel, path);
    if (tuples >= 0 && array->GetNumberOfTuples() != tuples)
    {
      throw InputError(path + ": array '" + (array->GetName() ? array->GetName() : "") +
        "': expected " + std::to_string(tuples) + " values, found " +
        std::to_string(array->GetNumberOfTuples()));
    }
    fields->AddArray(array);
  }
}

void PackAttributes(vtkDataSetAttributes* attributes, ParcelWriter& parcel)
{
  PackFields(attributes, parcel);
  for (int type = 0; type < vtkDataSetAttributes::NUM_ATTRIBUTES; ++type)
  {
    vtkAbstractArray* const active = attributes->GetAbstractAttribute(type);
    parcel(std::string(active && active->GetName() ? active->GetName() : ""));
  }
}

void UnpackAttributes(ParcelReader& parcel, const std::string& path, vtkIdType tuples,
  vtkDataSetAttributes* attributes)
{
  UnpackFields(parcel, path, tuples, attributes);
  for (int type = 0; type < vtkDataSetAttributes::NUM_ATTRIBUTES; ++type)
  {
    std::string active;
    parcel(active);
    if (!active.empty())
    {
      attributes->SetActiveAttribute(active.c_str(), type);
    }
  }
}

void PackCells(vtkCellArray* cells, ParcelWriter& parcel)
{
  vtkNew<vtkCellArray> sent;
  if (cells)
  {
    sent->DeepCopy(cells);
  }
  sent->ConvertTo64BitStorage();
  PackNumbers(sent->GetOffsetsArray64(), parcel);
  PackNumbers(sent->GetConnectivityArray64(), parcel);
}

/// Cells `first` and following, all of whose points are there.
vtkSmartPointer<vtkCellArray> UnpackCells(ParcelReader& parcel, const std::string& path,
  vtkIdType points, vtkIdType first)
{
  vtkNew<vtkTypeInt64Array> offsets;
  vtkNew<vtkTypeInt64Array> corners;
  for (vtkTypeInt64Array* const list : { offsets.Get(), corners.Get() })
  {
    const auto numbers = UnpackNumbers(parcel, path);
    if (numbers->GetDataType() != list->GetDataType() || numbers->GetNumberOfComponents() != 1)
    {
      throw InputError(path + ": expected lists of the cells' points");
    }
    list->ShallowCopy(numbers);
  }
  const vtkIdType count = offsets->GetNumberOfValues() - 1;
  if (count < 0 || offsets->GetValue(0) != 0 ||
    offsets->GetValue(count) != corners->GetNumberOfValues())
  {
    throw InputError(path + ": expected lists of the cells' points that are as long as they say");
  }
  for (vtkIdType cell = 0; cell < count; ++cell)
  {
    const auto place = [&] { return path + ": cell " + std::to_string(first + cell); };
    if (offsets->GetValue(cell) > offsets->GetValue(cell + 1) ||
      offsets->GetValue(cell + 1) > corners->GetNumberOfValues())
    {
      throw InputError(
        place() + ": expected a list of points, found one that ends before it begins");
    }
    for (auto at = offsets->GetValue(cell); at < offsets->GetValue(cell + 1); ++at)
    {
      if (corners->GetValue(at) < 0 || corners->GetValue(at) >= points)
      {
        throw InputError(place() + ": expected points 0 to " + std::to_string(points - 1) +
          ", found " + std::to_string(corners->GetValue(at)));
      }
    }
  }
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  cells->SetData(offsets, corners);
  return cells;
}

void PackPoints(vtkPointSet* mesh, ParcelWriter& parcel)
{
  vtkNew<vtkPoints> none;
  vtkPoints* const points = mesh->GetPoints() ? mesh->GetPoints() : none.Get();
  PackNumbers(points->GetData(), parcel);
}

void UnpackPoints(ParcelReader& parcel, const std::string& path, vtkPointSet* mesh)
{
  const auto coordinates = UnpackNumbers(parcel, path);
  if (coordinates->GetNumberOfComponents() != 3)
  {
    throw InputError(path + ": expected points of three coordinates, found " +
      std::to_string(coordinates->GetNumberOfComponents()));
  }
  for (vtkIdType point = 0; point < coordinates->GetNumberOfTuples(); ++point)
  {
    double at[3];
    coordinates->GetTuple(point, at);
    // Single precision is what the X-rays see; beyond it lies nothing that has a size.
    const auto usable = [](double value) { return std::abs(value) < 1e9; };
    if (!std::all_of(std::begin(at), std::end(at), usable))
    {
      throw InputError(path + ": point " + std::to_string(point) +
        ": expected coordinates below 1e9 mm, found " + std::to_string(at[0]) + " " +
        std::to_string(at[1]) + " " + std::to_string(at[2]));
    }
  }
  vtkNew<vtkPoints> points;
  points->SetData(coordinates);
  mesh->SetPoints(points);
}

void PackArrays(vtkDataSet* mesh, ParcelWriter& parcel)
{
  PackAttributes(mesh->GetPointData(), parcel);
  PackAttributes(mesh->GetCellData(), parcel);
  PackFields(mesh->GetFieldData(), parcel);
}

void UnpackArrays(ParcelReader& parcel, const std::string& path, vtkDataSet* mesh)
{
  UnpackAttributes(parcel, path, mesh->GetNumberOfPoints(), mesh->GetPointData());
  UnpackAttributes(parcel, path, mesh->GetNumberOfCells(), mesh->GetCellData());
  UnpackFields(parcel, path, -1, mesh->GetFieldData());
}
}

void PackMesh(vtkUnstructuredGrid* mesh, const std::string& path, ParcelWriter& parcel)
{
  if (mesh->GetFaces())
  {
    throw InputError(path + ": expected cells given by their points, found lists of faces");
  }
  PackPoints(mesh, parcel);
  PackCells(mesh->GetCells(), parcel);
  vtkNew<vtkUnsignedCharArray> types;
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
  {
    types->InsertNextValue(static_cast<unsigned char>(mesh->GetCellType(cell)));
  }
  PackNumbers(types, parcel);
  PackArrays(mesh, parcel);
}

void UnpackMesh(ParcelReader& parcel, const std::string& path, vtkUnstructuredGrid* mesh)
{
  UnpackPoints(parcel, path, mesh);
  const auto cells = UnpackCells(parcel, path, mesh->GetNumberOfPoints(), 0);
  const auto types = UnpackNumbers(parcel, path);
  auto* const kept = vtkUnsignedCharArray::SafeDownCast(types);
  if (!kept || kept->GetNumberOfValues() != cells->GetNumberOfCells())
  {
    throw InputError(path + ": expected a type for each of " +
      std::to_string(cells->GetNumberOfCells()) + " cells");
  }
  for (vtkIdType cell = 0; cell < kept->GetNumberOfValues(); ++cell)
  {
    if (kept->GetValue(cell) == VTK_TETRA && cells->GetCellSize(cell) != 4)
    {
      throw InputError(path + ": cell " + std::to_string(cell) +
        ": expected the four points of a tetrahedron, found " +
        std::to_string(cells->GetCellSize(cell)));
    }
  }
  mesh->SetCells(kept, cells);
  UnpackArrays(parcel, path, mesh);
}

void PackMesh(vtkPolyData* mesh, const std::string&, ParcelWriter& parcel)
{
  PackPoints(mesh, parcel);
  for (vtkCellArray* const cells :
    { mesh->GetVerts(), mesh->GetLines(), mesh->GetPolys(), mesh->GetStrips() })
  {
    PackCells(cells, parcel);
  }
  PackArrays(mesh, parcel);
}

void UnpackMesh(ParcelReader& parcel, const std::string& path, vtkPolyData* mesh)
{
  UnpackPoints(parcel, path, mesh);
  vtkIdType before = 0;
  for (const auto set : { &vtkPolyData::SetVerts, &vtkPolyData::SetLines, &vtkPolyData::SetPolys,
         &vtkPolyData::SetStrips })
  {
    const auto cells = UnpackCells(parcel, path, mesh->GetNumberOfPoints(), before);
    before += cells->GetNumberOfCells();
    if (cells->GetNumberOfCells() > 0)
    {
      (mesh->*set)(cells);
    }
  }
  UnpackArrays(parcel, path, mesh);
}
}
