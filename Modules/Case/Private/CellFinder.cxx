// SPDX-License-Identifier: Apache-2.0
#include "Private/CellFinder.h"

#include "vtkDataArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>

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
  this->Locator->SetDataSet(grid);
  this->Locator->BuildLocator();
}

PlaceInCell CellFinder::Find(Vector3 point, double toleranceMm)
{
  PlaceInCell place;
  double parametric[3];
  place.Cell =
    this->Locator->FindCell(point.data(), 0.0, this->Cell, parametric, place.Weights.data());
  if (place.Cell < 0 && toleranceMm > 0)
  {
    double closest[3];
    double distance2 = 0;
    int subId = 0;
    vtkIdType cell = -1;
    this->Locator->FindClosestPoint(point.data(), closest, this->Cell, cell, subId, distance2);
    if (cell >= 0 && distance2 <= toleranceMm * toleranceMm)
    {
      place.Cell = cell;
      this->Grid->GetCell(cell, this->Cell);
      double ignored = 0;
      this->Cell->EvaluatePosition(closest, nullptr, subId, parametric, ignored,
        place.Weights.data());
    }
  }
  if (place.Cell >= 0)
  {
    this->Grid->GetCellPoints(place.Cell, this->Ids);
    std::copy_n(this->Ids->GetPointer(0), 4, place.Corners.begin());
  }
  return place;
}
}
