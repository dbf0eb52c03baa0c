// SPDX-License-Identifier: Apache-2.0
#include "Private/CellFinder.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/FaceTable.h"
#include "mammoray/IO/MeshConversion.h"

#include "vtkCellArray.h"
#include "vtkCellType.h"
#include "vtkDataArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <span>

namespace mammoray
{
Vector3 PlaceInCell::Interpolate(vtkDataArray* values) const
{
  Vector3 sum{ 0, 0, 0 };
  for (std::size_t corner = 0; corner < 4; ++corner)
  {
    double value[3];
    values->GetTuple(this->Corners[corner], value);
    sum = sum + this->Weights[corner] * Vector3{ value[0], value[1], value[2] };
  }
  return sum;
}

CellFinder::CellFinder(vtkUnstructuredGrid* grid)
  : Grid(grid)
{
  // VTK writes as many weights of a place as its cell has corners.
  bool fits = grid->GetNumberOfCells() > 0;
  for (vtkIdType cell = 0; fits && cell < grid->GetNumberOfCells(); ++cell)
  {
    fits = grid->GetCellType(cell) == VTK_TETRA;
  }
  if (!fits)
  {
    throw InputError("mesh: expected linear tetrahedra, found none or other cells");
  }
}

/// Triangles of the outside, of the grid's own points.
void CellFinder::FindSurface()
{
  const TetrahedralMesh mesh = FromGrid(this->Grid);
  FaceTable faces(mesh);
  vtkNew<vtkCellArray> triangles;
  faces.ForEachFace(
    [&](const std::span<const FaceTable::Entry>& same)
    {
      if (same.size() == 1)
      {
        const std::array<std::int32_t, 3> corners = faces.Corners(same.front().Face);
        triangles->InsertNextCell({ corners[0], corners[1], corners[2] });
        this->SurfaceCells.push_back(static_cast<vtkIdType>(same.front().Face / 4));
      }
    });
  this->Surface->SetPoints(this->Grid->GetPoints());
  this->Surface->SetPolys(triangles);
  this->SurfaceLocator->SetDataSet(this->Surface);
  this->SurfaceLocator->BuildLocator();
  this->PointLocator->SetDataSet(this->Grid);
  this->PointLocator->BuildLocator();
}

/// What lies nearest to a point outside is on the surface.
PlaceInCell CellFinder::FindOnSurface(Vector3 point, double toleranceMm)
{
  if (this->SurfaceCells.empty())
  {
    this->FindSurface();
  }
  // No place is farther than the nearest point: without this bound much is searched.
  Vector3 bound;
  this->Grid->GetPoint(this->PointLocator->FindClosestPoint(point.data()), bound.data());
  const double radius = std::min(toleranceMm, (1 + 1e-9) * Norm(bound - point));
  PlaceInCell place;
  double closest[3];
  double distance2 = 0;
  int subId = 0;
  int inside = 0;
  vtkIdType triangle = -1;
  this->SurfaceLocator->FindClosestPointWithinRadius(point.data(), radius, closest, this->Cell,
    triangle, subId, distance2, inside);
  if (triangle >= 0)
  {
    double parametric[3];
    place.Cell = this->SurfaceCells[static_cast<std::size_t>(triangle)];
    this->Surface->GetCell(triangle, this->Cell);
    this->Cell->EvaluatePosition(closest, nullptr, subId, parametric, distance2,
      place.Weights.data());
    this->Surface->GetCellPoints(triangle, this->Ids);
    std::copy_n(this->Ids->GetPointer(0), 3, place.Corners.begin());
    place.Corners[3] = place.Corners[0];
    place.Weights[3] = 0;
  }
  return place;
}

PlaceInCell CellFinder::Find(Vector3 point, double toleranceMm)
{
  if (!this->Locator->GetDataSet())
  {
    this->Locator->SetDataSet(this->Grid);
    this->Locator->BuildLocator();
  }
  PlaceInCell place;
  double parametric[3];
  place.Cell =
    this->Locator->FindCell(point.data(), 0.0, this->Cell, parametric, place.Weights.data());
  if (place.Cell < 0)
  {
    return toleranceMm > 0 ? this->FindOnSurface(point, toleranceMm) : place;
  }
  this->Grid->GetCellPoints(place.Cell, this->Ids);
  std::copy_n(this->Ids->GetPointer(0), 4, place.Corners.begin());
  return place;
}
}
