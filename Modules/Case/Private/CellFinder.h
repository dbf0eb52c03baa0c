// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_CellFinder_h
#define mammoray_CellFinder_h

#include "mammoray/Foundation/Vector3.h"
#include "mammorayCaseModule.h"

#include "vtkGenericCell.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkStaticCellLocator.h"
#include "vtkType.h"

#include <array>

class vtkDataArray;
class vtkUnstructuredGrid;

namespace mammoray
{
/// A cell of a tetrahedral grid and the weights of its corners at a place.
struct MAMMORAYCASE_EXPORT PlaceInCell
{
  /// -1: in none.
  vtkIdType Cell = -1;
  std::array<vtkIdType, 4> Corners{};
  std::array<double, 4> Weights{};

  /// The value there of a point array with three components.
  Vector3 Interpolate(vtkDataArray* values) const;
};

/// Finds the cells of a grid of linear tetrahedra, which must outlive it.
class MAMMORAYCASE_EXPORT CellFinder
{
public:
  explicit CellFinder(vtkUnstructuredGrid* grid);

  /// The cell that holds the point, or, within `toleranceMm`, lies nearest to it.
  PlaceInCell Find(Vector3 point, double toleranceMm);

private:
  vtkUnstructuredGrid* Grid;
  vtkNew<vtkStaticCellLocator> Locator;
  vtkNew<vtkGenericCell> Cell;
  vtkNew<vtkIdList> Ids;
};
}

#endif
