// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Meshing/Private/EdgeRing.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace
{
using namespace mammoray;

/// `count` cells around the edge from point 0 (below) to 1 (above), the ring's points from 2 on a
/// circle of radius 1, counter-clockwise; the first `first` cells are of material 1, the others
/// of 2.
TetrahedralMesh Ring(int count, int first, double height = 1)
{
  TetrahedralMesh mesh;
  mesh.Points = { 0, 0, -height, 0, 0, height };
  for (int n = 0; n < count; ++n)
  {
    const double angle = 2 * std::numbers::pi * n / count;
    mesh.Points.insert(mesh.Points.end(), { std::cos(angle), std::sin(angle), 0 });
    mesh.Cells.insert(mesh.Cells.end(), { 0, 1, 2 + n, 2 + (n + 1) % count });
    mesh.Materials.push_back(n < first ? 1 : 2);
  }
  return mesh;
}

TEST(EdgeRing, TurnsCounterClockwiseAroundTheEdge)
{
  const TetrahedralMesh mesh = Ring(6, 2);
  ASSERT_NO_THROW(mesh.Validate("ring"));
  const EditableMesh editable(mesh);
  const auto ring = FindRing(editable, 0, 1, 8);
  ASSERT_TRUE(ring);
  EXPECT_THAT(ring->Points, testing::ElementsAre(2, 3, 4, 5, 6, 7));
  EXPECT_THAT(ring->Materials, testing::ElementsAre(1, 1, 2, 2, 2, 2));
  const auto back = FindRing(editable, 1, 0, 8);
  ASSERT_TRUE(back);
  EXPECT_THAT(std::vector<std::int32_t>(ring->Points.rbegin(), ring->Points.rend()),
    testing::UnorderedElementsAreArray(back->Points));
  EXPECT_EQ((back->Points[0] - back->Points[1] + 6) % 6, 1); // the other way round
}

TEST(EdgeRing, IsNoneWhereItIsOpenOrTooLong)
{
  TetrahedralMesh mesh = Ring(6, 6);
  EXPECT_FALSE(FindRing(EditableMesh(mesh), 0, 1, 5));
  mesh.Cells.resize(4 * 5);
  mesh.Materials.resize(5);
  EXPECT_FALSE(FindRing(EditableMesh(mesh), 0, 1, 8));
}

TEST(PolygonFill, FillsTheRingsSpaceAndTellsItsWorstCell)
{
  // A double pyramid over a hexagon, so flat that cells across it are better than those around the
  // axis.
  const TetrahedralMesh mesh = Ring(6, 6, 0.4);
  const EditableMesh editable(mesh);
  const auto ring = FindRing(editable, 0, 1, 8);
  ASSERT_TRUE(ring);
  const PolygonFill filling(editable, ring->Points, 1, 0, 1);
  std::vector<CellIds> cells;
  filling.Collect(cells);
  EXPECT_EQ(cells.size(), 8u); // two on each of four triangles
  double volume = 0;
  double worst = 1;
  for (const CellIds& cell : cells)
  {
    EXPECT_GT(editable.Volume(cell), 0);
    volume += editable.Volume(cell);
    worst = std::min(worst, editable.Quality(cell));
  }
  double before = 0;
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    before += mesh.CellVolume(cell);
  }
  EXPECT_NEAR(volume, before, 1e-14);
  EXPECT_DOUBLE_EQ(filling.Best(), worst);
}
}
