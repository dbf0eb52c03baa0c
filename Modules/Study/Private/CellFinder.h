// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_CellFinder_h
#define mammoray_CellFinder_h

#include "mammoray/Foundation/Vector3.h"
#include "mammorayStudyModule.h"

#include "vtkGenericCell.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkStaticCellLocator.h"
#include "vtkStaticPointLocator.h"
#include "vtkType.h"

#include <array>
#include <vector>

class vtkDataArray;
class vtkUnstructuredGrid;

namespace mammoray
{
/// A cell of a tetrahedral grid and the weights of its corners at a place.
struct MAMMORAYSTUDY_EXPORT PlaceInCell
{
  /// -1 if there is none.
  vtkIdType Cell = -1;
  std::array<vtkIdType, 4> Corners{};
  std::array<double, 4> Weights{};

  /// Interpolates a point array with three components.
  Vector3 Interpolate(vtkDataArray* values) const;
};

/// Finds the cells of a grid of linear tetrahedra, which must outlive it.
class MAMMORAYSTUDY_EXPORT CellFinder
{
public:
  /// Throws InputError on a grid without cells or with cells of another type.
  explicit CellFinder(vtkUnstructuredGrid* grid);

  /// The cell that contains the point, or the nearest one within `toleranceMm`.
  PlaceInCell Find(Vector3 point, double toleranceMm);

private:
  void FindSurface();
  PlaceInCell FindOnSurface(Vector3 point, double toleranceMm);

  vtkUnstructuredGrid* Grid;
  /// This and the members below are built when they are first needed.
  vtkNew<vtkStaticCellLocator> Locator;
  /// The grid's outer surface, and the cell behind each of its triangles.
  vtkNew<vtkPolyData> Surface;
  std::vector<vtkIdType> SurfaceCells;
  vtkNew<vtkStaticCellLocator> SurfaceLocator;
  vtkNew<vtkStaticPointLocator> PointLocator;
  vtkNew<vtkGenericCell> Cell;
  vtkNew<vtkIdList> Ids;
};
}

#endif
