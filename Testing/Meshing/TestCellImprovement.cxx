// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Meshing/Private/EditableMesh.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace
{
using namespace mammoray;

/// `count` cells around the edge from point 0 (below) to 1 (above), the ring's points from 2 on a
/// circle of radius 1, counter-clockwise; the first `first` cells are of material 1, the others
/// of 2.
TetrahedralMesh Ring(int count, int first, double height)
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

double MaterialVolume(const TetrahedralMesh& mesh, int material)
{
  double volume = 0;
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    EXPECT_GT(mesh.CellVolume(cell), 0);
    volume += mesh.Materials[cell] == material ? mesh.CellVolume(cell) : 0;
  }
  return volume;
}

TetrahedralMesh Improved(const TetrahedralMesh& mesh)
{
  EditableMesh edited(mesh);
  ImproveCells(edited, 40, 0, {});
  return edited.Finish();
}

TEST(CellImprovement, FillsTheRingOfALongEdgeAnew)
{
  // A double pyramid over a hexagon, so tall that cells across it are better than those around the
  // axis.
  const TetrahedralMesh mesh = Ring(6, 6, 3);
  const TetrahedralMesh improved = Improved(mesh);
  EXPECT_EQ(improved.NumberOfCells(), 8u); // two on each of four triangles
  EXPECT_EQ(improved.NumberOfPoints(), 8u);
  EXPECT_NEAR(MaterialVolume(improved, 1), MaterialVolume(mesh, 1), 1e-12);
  const auto worst = [](const TetrahedralMesh& of)
  {
    double quality = 1;
    for (std::size_t cell = 0; cell < of.NumberOfCells(); ++cell)
    {
      const std::int32_t* ids = &of.Cells[4 * cell];
      quality = std::min(quality, EditableMesh(of).Quality({ ids[0], ids[1], ids[2], ids[3] }));
    }
    return quality;
  };
  EXPECT_GT(worst(improved), worst(mesh));
}

TEST(CellImprovement, KeepsEveryMaterialItsVolume)
{
  for (const int first : { 1, 2, 3 })
  {
    const TetrahedralMesh mesh = Ring(6, first, 3);
    const TetrahedralMesh improved = Improved(mesh);
    for (const int material : { 1, 2 })
    {
      EXPECT_NEAR(MaterialVolume(improved, material), MaterialVolume(mesh, material), 1e-12)
        << first;
    }
  }
}

TEST(CellImprovement, LeavesAnOpenRing)
{
  TetrahedralMesh mesh = Ring(6, 6, 3);
  mesh.Cells.resize(4 * 5);
  mesh.Materials.resize(5);
  EXPECT_EQ(Improved(mesh).Cells, mesh.Cells);
}
}
