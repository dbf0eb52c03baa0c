// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/MeshConversion.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkCellTypes.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkPolygon.h"
#include "vtkStringArray.h"
#include "vtkTypeInt32Array.h"
#include "vtkUnsignedShortArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <utility>

namespace mammoray
{
namespace
{
/// Adds the field array "MaterialNames".
void AddMaterialNames(vtkDataObject* data, const std::vector<std::string>& names)
{
  vtkNew<vtkStringArray> array;
  array->SetName(MaterialNamesArrayName);
  for (const std::string& name : names)
  {
    array->InsertNextValue(name);
  }
  data->GetFieldData()->AddArray(array);
}

/// Adds the cell array "Material".
void AddMaterials(vtkUnstructuredGrid* grid, const std::vector<std::int32_t>& materials)
{
  vtkNew<vtkIntArray> array;
  array->SetName(MaterialArrayName);
  array->SetNumberOfValues(static_cast<vtkIdType>(materials.size()));
  std::copy(materials.begin(), materials.end(), array->GetPointer(0));
  grid->GetCellData()->AddArray(array);
}

/// Names of the field array "MaterialNames"; empty where there is no such array.
std::vector<std::string> FindMaterialNames(vtkDataObject* data)
{
  std::vector<std::string> names;
  if (auto* array = vtkStringArray::SafeDownCast(
        data->GetFieldData()->GetAbstractArray(MaterialNamesArrayName)))
  {
    for (vtkIdType index = 0; index < array->GetNumberOfValues(); ++index)
    {
      names.push_back(EscapeControls(array->GetValue(index)));
    }
  }
  return names;
}

/// A cell's material. `kind`: of data, for messages.
std::uint16_t MaterialAt(vtkDataArray* array, vtkIdType cell, const char* kind)
{
  const int components = array->GetNumberOfComponents();
  const double value = array->GetComponent(cell, 0);
  if (components != 1 || !(value >= 0 && value <= 65535) || value != std::floor(value))
  {
    throw InputError(std::string(kind) + ": cell " + std::to_string(cell) + ": expected '" +
      array->GetName() + "' to be a whole number from 0 to 65535, found " +
      (components == 1 ? NumberText(value) : std::to_string(components) + " numbers"));
  }
  return static_cast<std::uint16_t>(value);
}

/// Cuts polygons, which may be concave, into triangles.
class PolygonCutter
{
public:
  explicit PolygonCutter(vtkPolyData* surface)
    : Surface(surface)
  {
  }

  /// Three points for each triangle. A polygon without area is cut from its first corner.
  const std::vector<vtkIdType>& Cut(vtkIdType polygon)
  {
    vtkIdType size = 0;
    const vtkIdType* ids = nullptr;
    this->Surface->GetPolys()->GetCellAtId(polygon, size, ids);
    this->Corners.clear();
    if (size < 3 ||
      std::any_of(ids, ids + size,
        [this](vtkIdType id) { return id < 0 || id >= this->Surface->GetNumberOfPoints(); }))
    {
      throw InputError("surface: cell " + std::to_string(polygon) +
        ": expected three points or more, all of them there, found " + std::to_string(size));
    }
    this->Ears->Reset();
    if (size > 3)
    {
      const std::vector<vtkIdType> corners(ids, ids + size);
      this->Polygon->Initialize(static_cast<int>(size), corners.data(), this->Surface->GetPoints());
      this->Polygon->Triangulate(this->Ears);
    }
    if (this->Ears->GetNumberOfIds() == 3 * (size - 2))
    {
      for (const vtkIdType ear : *this->Ears)
      {
        this->Corners.push_back(ids[ear]);
      }
      return this->Corners;
    }
    for (vtkIdType corner = 2; corner < size; ++corner)
    {
      this->Corners.insert(this->Corners.end(), { ids[0], ids[corner - 1], ids[corner] });
    }
    return this->Corners;
  }

private:
  vtkPolyData* const Surface;
  vtkNew<vtkPolygon> Polygon;
  vtkNew<vtkIdList> Ears;
  std::vector<vtkIdType> Corners;
};

/// Exchanges the sides of materials whose triangles, taken together, enclose a negative volume.
void OrientOutwards(SurfaceMesh& mesh)
{
  const auto point = [&mesh](std::uint32_t index)
  {
    return Vector3{ mesh.Points[3 * index], mesh.Points[3 * index + 1],
      mesh.Points[3 * index + 2] };
  };
  const Vector3 origin = point(mesh.Triangles.front());
  std::map<int, double> volumes;
  for (std::size_t triangle = 0; triangle < mesh.NumberOfTriangles(); ++triangle)
  {
    const std::uint32_t* ids = &mesh.Triangles[3 * triangle];
    volumes[mesh.BackMaterials[triangle]] +=
      Dot(point(ids[0]) - origin, Cross(point(ids[1]) - origin, point(ids[2]) - origin));
  }
  for (std::size_t triangle = 0; triangle < mesh.NumberOfTriangles(); ++triangle)
  {
    if (volumes[mesh.BackMaterials[triangle]] < 0)
    {
      std::swap(mesh.FrontMaterials[triangle], mesh.BackMaterials[triangle]);
    }
  }
}
}

std::string NameOfCellType(int type)
{
  std::string name;
  for (const char letter : std::string(vtkCellTypes::GetClassNameFromTypeId(type)).substr(3))
  {
    const bool begins = std::isupper(static_cast<unsigned char>(letter)) != 0;
    name += begins && !name.empty() ? " " : "";
    name += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  }
  return name == "tetra" ? "tetrahedron" : name;
}

vtkSmartPointer<vtkUnstructuredGrid> ToGrid(const TetrahedralMesh& mesh,
  const std::vector<std::string>& materialNames)
{
  vtkNew<vtkDoubleArray> coordinates;
  coordinates->SetNumberOfComponents(3);
  coordinates->SetNumberOfTuples(static_cast<vtkIdType>(mesh.NumberOfPoints()));
  std::copy(mesh.Points.begin(), mesh.Points.end(), coordinates->GetPointer(0));
  vtkNew<vtkPoints> points;
  points->SetData(coordinates);

  vtkNew<vtkCellArray> cells;
  cells->AllocateExact(static_cast<vtkIdType>(mesh.NumberOfCells()),
    static_cast<vtkIdType>(mesh.Cells.size()));
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    const std::int32_t* ids = &mesh.Cells[4 * cell];
    cells->InsertNextCell({ ids[0], ids[1], ids[2], ids[3] });
  }
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  grid->SetPoints(points);
  grid->SetCells(VTK_TETRA, cells);
  AddMaterials(grid, mesh.Materials);
  if (!materialNames.empty())
  {
    AddMaterialNames(grid, materialNames);
  }
  return grid;
}

TetrahedralMesh FromGrid(vtkUnstructuredGrid* grid, std::vector<std::string>* materialNames)
{
  TetrahedralMesh mesh;
  vtkDataArray* materials = nullptr;
  // meshio keeps the groups of gmsh and of medit under these names.
  for (const char* const name : { MaterialArrayName, "gmsh:physical", "medit:ref" })
  {
    materials = materials ? materials : grid->GetCellData()->GetArray(name);
  }
  if (!materials)
  {
    std::string found;
    for (int index = 0; index < grid->GetCellData()->GetNumberOfArrays(); ++index)
    {
      const char* const name = grid->GetCellData()->GetArrayName(index);
      found += (index == 0 ? "'" : ", '") + std::string(name ? name : "") + "'";
    }
    throw InputError(std::string("grid: expected the cell array '") + MaterialArrayName +
      "', found " + (found.empty() ? "none" : found));
  }
  const vtkIdType pointCount = grid->GetNumberOfPoints();
  mesh.Points.resize(3 * static_cast<std::size_t>(pointCount));
  for (vtkIdType point = 0; point < pointCount; ++point)
  {
    grid->GetPoint(point, &mesh.Points[3 * point]);
  }
  const vtkIdType cellCount = grid->GetNumberOfCells();
  mesh.Cells.reserve(4 * static_cast<std::size_t>(cellCount));
  mesh.Materials.reserve(static_cast<std::size_t>(cellCount));
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < cellCount; ++cell)
  {
    if (grid->GetCellType(cell) != VTK_TETRA)
    {
      throw InputError("grid: cell " + std::to_string(cell) + ": expected a tetrahedron, found a " +
        NameOfCellType(grid->GetCellType(cell)));
    }
    grid->GetCellPoints(cell, ids);
    for (int corner = 0; corner < 4; ++corner)
    {
      mesh.Cells.push_back(static_cast<std::int32_t>(ids->GetId(corner)));
    }
    mesh.Materials.push_back(MaterialAt(materials, cell, "grid"));
  }
  if (materialNames)
  {
    *materialNames = FindMaterialNames(grid);
  }
  return mesh;
}

TetrahedralMesh FitGrid(vtkUnstructuredGrid* grid, const MaterialTable& table,
  const std::string& where)
{
  std::vector<std::string> names;
  TetrahedralMesh mesh;
  try
  {
    mesh = FromGrid(grid, &names);
  }
  catch (const InputError& error)
  {
    throw InputError(where + ": " + error.what());
  }
  const std::vector<std::int32_t> given = mesh.Materials;
  table.FitMesh(mesh, names, where);
  if (mesh.Materials != given)
  {
    // Shallow copies of a grid share its field data.
    vtkNew<vtkFieldData> fields;
    fields->ShallowCopy(grid->GetFieldData());
    grid->SetFieldData(fields);
    AddMaterials(grid, mesh.Materials);
    AddMaterialNames(grid, table.Names());
  }
  return mesh;
}

void AddPlacement(vtkDataObject* data, const VolumeFromGantry& placed)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(PlacementArrayName);
  array->SetNumberOfComponents(3);
  for (const Vector3& vector : { placed.Origin, placed.X, placed.Y, placed.Z })
  {
    array->InsertNextTuple(vector.data());
  }
  data->GetFieldData()->AddArray(array);
}

std::optional<VolumeFromGantry> FindPlacement(vtkDataObject* data)
{
  vtkDataArray* array = data->GetFieldData()->GetArray(PlacementArrayName);
  if (!array || array->GetNumberOfComponents() != 3 || array->GetNumberOfTuples() != 4)
  {
    return {};
  }
  VolumeFromGantry placed;
  array->GetTuple(0, placed.Origin.data());
  array->GetTuple(1, placed.X.data());
  array->GetTuple(2, placed.Y.data());
  array->GetTuple(3, placed.Z.data());
  return placed;
}

SurfaceMesh FromPolyData(vtkPolyData* surface, std::vector<std::string>* materialNames)
{
  SurfaceMesh mesh;
  const vtkIdType pointCount = surface->GetNumberOfPoints();
  mesh.Points.resize(3 * static_cast<std::size_t>(pointCount));
  for (vtkIdType point = 0; point < pointCount; ++point)
  {
    surface->GetPoint(point, &mesh.Points[3 * point]);
  }
  vtkCellArray* polys = surface->GetPolys();
  const vtkIdType cellCount = polys ? polys->GetNumberOfCells() : 0;
  if (cellCount == 0 || surface->GetNumberOfStrips() > 0)
  {
    throw InputError("surface: expected polygons, found " +
      (surface->GetNumberOfStrips() > 0 ? std::string("strips of triangles") : "none"));
  }
  // Cells' data begin with vertices and lines, which bound nothing.
  const vtkIdType before = surface->GetNumberOfVerts() + surface->GetNumberOfLines();
  vtkCellData* data = surface->GetCellData();
  vtkDataArray* front = data->GetArray(FrontMaterialArrayName);
  vtkDataArray* back = data->GetArray(BackMaterialArrayName);
  vtkDataArray* inside = data->GetArray(MaterialArrayName);
  const bool isText = !inside && data->GetAbstractArray(MaterialArrayName);
  if (isText || (!inside && !back && surface->GetPointData()->HasArray(MaterialArrayName)))
  {
    throw InputError(std::string("surface: expected a cell array '") + MaterialArrayName +
      "' of whole numbers, found one of " + (isText ? "texts" : "points"));
  }
  if (!front != !back)
  {
    throw InputError(std::string("surface: expected both cell arrays '") + FrontMaterialArrayName +
      "' and '" + BackMaterialArrayName + "', found one of them");
  }
  PolygonCutter cutter(surface);
  for (vtkIdType polygon = 0; polygon < cellCount; ++polygon)
  {
    const vtkIdType cell = before + polygon;
    const std::uint16_t ahead = front ? MaterialAt(front, cell, "surface") : std::uint16_t{ 0 };
    const std::uint16_t behind = back ? MaterialAt(back, cell, "surface")
      : inside                        ? MaterialAt(inside, cell, "surface")
                                      : std::uint16_t{ 1 };
    for (const vtkIdType corner : cutter.Cut(polygon))
    {
      mesh.Triangles.push_back(static_cast<std::uint32_t>(corner));
    }
    mesh.FrontMaterials.resize(mesh.NumberOfTriangles(), ahead);
    mesh.BackMaterials.resize(mesh.NumberOfTriangles(), behind);
  }
  mesh.Validate("surface");
  if (!back)
  {
    OrientOutwards(mesh);
  }
  if (materialNames)
  {
    *materialNames = FindMaterialNames(surface);
  }
  return mesh;
}

vtkSmartPointer<vtkPolyData> ToPolyData(const SurfaceMesh& surface,
  const std::vector<std::string>& materialNames)
{
  surface.Validate("surface");
  vtkNew<vtkPoints> points;
  points->SetDataTypeToFloat();
  points->SetNumberOfPoints(static_cast<vtkIdType>(surface.NumberOfPoints()));
  for (std::size_t point = 0; point < surface.NumberOfPoints(); ++point)
  {
    points->SetPoint(static_cast<vtkIdType>(point), &surface.Points[3 * point]);
  }
  const std::size_t triangleCount = surface.NumberOfTriangles();
  vtkNew<vtkTypeInt32Array> connectivity;
  connectivity->SetNumberOfValues(static_cast<vtkIdType>(surface.Triangles.size()));
  std::copy(surface.Triangles.begin(), surface.Triangles.end(), connectivity->GetPointer(0));
  vtkNew<vtkTypeInt32Array> offsets;
  offsets->SetNumberOfValues(static_cast<vtkIdType>(triangleCount) + 1);
  for (std::size_t triangle = 0; triangle <= triangleCount; ++triangle)
  {
    offsets->SetValue(static_cast<vtkIdType>(triangle), static_cast<int>(3 * triangle));
  }
  vtkNew<vtkCellArray> triangles;
  triangles->SetData(offsets, connectivity);

  auto result = vtkSmartPointer<vtkPolyData>::New();
  result->SetPoints(points);
  result->SetPolys(triangles);
  for (const auto& [name, materials] :
    { std::pair{ FrontMaterialArrayName, &surface.FrontMaterials },
      std::pair{ BackMaterialArrayName, &surface.BackMaterials } })
  {
    vtkNew<vtkUnsignedShortArray> array;
    array->SetName(name);
    array->SetNumberOfValues(static_cast<vtkIdType>(triangleCount));
    std::copy(materials->begin(), materials->end(), array->GetPointer(0));
    result->GetCellData()->AddArray(array);
  }
  AddMaterialNames(result, materialNames);
  return result;
}
}
