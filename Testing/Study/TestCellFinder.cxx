// SPDX-License-Identifier: Apache-2.0
#include "TestMeshes.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/Study/Private/CellFinder.h"

#include "vtkCellType.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkUnstructuredGrid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

namespace
{
using namespace mammoray;

/// A box of 4 x 6 x 8 mm with a point array that is a linear function of the place.
vtkSmartPointer<vtkUnstructuredGrid> LinearBox()
{
  vtkSmartPointer<vtkUnstructuredGrid> grid =
    ToGrid(test::MakeBoxMesh({ -2, -3, -4 }, { 2, 3, 4 }, { 3, 4, 5 }), {});
  vtkNew<vtkDoubleArray> values;
  values->SetName("Linear");
  values->SetNumberOfComponents(3);
  for (vtkIdType point = 0; point < grid->GetNumberOfPoints(); ++point)
  {
    double p[3];
    grid->GetPoint(point, p);
    values->InsertNextTuple3(p[0] + 2 * p[1], p[1] - p[2], 5 + p[2]);
  }
  grid->GetPointData()->AddArray(values);
  return grid;
}

TEST(CellFinder, InterpolatesLinearlyWithin)
{
  const auto grid = LinearBox();
  CellFinder finder(grid);
  vtkDataArray* values = grid->GetPointData()->GetArray("Linear");
  std::mt19937 generator(2);
  std::uniform_real_distribution<double> unit(-0.999, 0.999);
  for (int n = 0; n < 300; ++n)
  {
    const Vector3 point{ 2 * unit(generator), 3 * unit(generator), 4 * unit(generator) };
    const PlaceInCell place = finder.Find(point, 0);
    ASSERT_GE(place.Cell, 0);
    EXPECT_NEAR(std::accumulate(place.Weights.begin(), place.Weights.end(), 0.0), 1, 1e-9);
    for (const double weight : place.Weights)
    {
      EXPECT_GE(weight, -1e-9);
    }
    // Points of the grid are floats or doubles: rounding.
    const Vector3 value = place.Interpolate(values);
    EXPECT_NEAR(value[0], point[0] + 2 * point[1], 1e-5);
    EXPECT_NEAR(value[1], point[1] - point[2], 1e-5);
    EXPECT_NEAR(value[2], 5 + point[2], 1e-5);
  }
}

TEST(CellFinder, TakesTheNearestWithinTheToleranceOnly)
{
  const auto grid = LinearBox();
  CellFinder finder(grid);
  vtkDataArray* values = grid->GetPointData()->GetArray("Linear");
  const Vector3 outside{ 2.4, 0.5, 1.5 };
  EXPECT_EQ(finder.Find(outside, 0).Cell, -1);
  EXPECT_EQ(finder.Find(outside, 0.39).Cell, -1);
  const PlaceInCell place = finder.Find(outside, 0.41);
  ASSERT_GE(place.Cell, 0);
  // The value at the face, (2, 0.5, 1.5).
  const Vector3 value = place.Interpolate(values);
  EXPECT_NEAR(value[0], 3, 1e-5);
  EXPECT_NEAR(value[1], -1, 1e-5);
  EXPECT_NEAR(value[2], 6.5, 1e-5);
  // Beside an edge and a corner.
  EXPECT_EQ(finder.Find({ 2.3, 3.3, 0 }, 0.4).Cell, -1); // 0.42 mm
  EXPECT_GE(finder.Find({ 2.3, 3.3, 0 }, 0.45).Cell, 0);
  EXPECT_EQ(finder.Find({ 100, 0, 0 }, 1).Cell, -1);
}

TEST(CellFinder, RefusesOtherCellsThanTetrahedra)
{
  const vtkNew<vtkUnstructuredGrid> empty;
  EXPECT_THROW(CellFinder{ empty }, InputError);
  const auto grid = LinearBox();
  const vtkIdType corners[] = { 0, 1, 2, 3, 4, 5, 6, 7 };
  grid->InsertNextCell(VTK_HEXAHEDRON, 8, corners);
  EXPECT_THROW(CellFinder{ grid }, InputError);
}
}
