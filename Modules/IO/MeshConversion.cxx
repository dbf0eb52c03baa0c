// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/MeshConversion.h"

#include "Private/MaterialNames.h"
#include "mammoray/Foundation/Error.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>

namespace mammoray
{
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
  vtkNew<vtkIntArray> materials;
  materials->SetName(MaterialArrayName);
  materials->SetNumberOfValues(static_cast<vtkIdType>(mesh.Materials.size()));
  std::copy(mesh.Materials.begin(), mesh.Materials.end(), materials->GetPointer(0));

  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  grid->SetPoints(points);
  grid->SetCells(VTK_TETRA, cells);
  grid->GetCellData()->AddArray(materials);
  if (!materialNames.empty())
  {
    AddMaterialNames(grid, materialNames);
  }
  return grid;
}

TetrahedralMesh FromGrid(vtkUnstructuredGrid* grid, std::vector<std::string>* materialNames)
{
  TetrahedralMesh mesh;
  vtkDataArray* materials = grid->GetCellData()->GetArray(MaterialArrayName);
  if (!materials)
  {
    throw InputError(std::string("grid: expected the cell array '") + MaterialArrayName +
      "', found none of that name");
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
      throw InputError("grid: cell " + std::to_string(cell) +
        ": expected a linear tetrahedron (type 10), found type " +
        std::to_string(grid->GetCellType(cell)));
    }
    grid->GetCellPoints(cell, ids);
    for (int corner = 0; corner < 4; ++corner)
    {
      mesh.Cells.push_back(static_cast<std::int32_t>(ids->GetId(corner)));
    }
    mesh.Materials.push_back(static_cast<std::int32_t>(materials->GetComponent(cell, 0)));
  }
  if (materialNames)
  {
    *materialNames = FindMaterialNames(grid);
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
}
