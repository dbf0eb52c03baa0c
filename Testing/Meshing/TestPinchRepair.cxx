// SPDX-License-Identifier: Apache-2.0
#include "TestMeshes.h"
#include "mammoray/Meshing/Private/PinchRepair.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace
{
using namespace mammoray;

/// 4^3 bricks of 1 mm whose material is a function of their place; 0 is air, which is kept.
EditableMesh BricksInAir(const std::function<int(int, int, int)>& material)
{
  TetrahedralMesh mesh = test::MakeBoxMesh({ 0, 0, 0 }, { 4, 4, 4 }, { 4, 4, 4 });
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    const auto brick = static_cast<int>(cell / 6);
    mesh.Materials[cell] = material(brick % 4, brick / 4 % 4, brick / 16);
  }
  return EditableMesh(mesh);
}

std::int32_t PointAt(int i, int j, int k)
{
  return static_cast<std::int32_t>((k * 5 + j) * 5 + i);
}

int ExcessOfAll(const EditableMesh& mesh)
{
  int excess = 0;
  for (std::size_t point = 0; point < mesh.Points.size(); ++point)
  {
    excess += PinchExcess(mesh, static_cast<std::int32_t>(point));
  }
  return excess;
}

double TissueVolume(const EditableMesh& mesh)
{
  double volume = 0;
  for (std::size_t n = 0; n < mesh.NumberOfCells(); ++n)
  {
    const auto cell = static_cast<std::int32_t>(n);
    volume += mesh.IsAlive(cell) && mesh[cell].Material != 0 ? mesh.Volume(mesh[cell].Ids) : 0;
  }
  return volume;
}

TEST(PinchExcess, OfSmoothBoundariesIsNone)
{
  EXPECT_EQ(ExcessOfAll(BricksInAir([](int, int, int) { return 1; })), 0);
  EXPECT_EQ(ExcessOfAll(BricksInAir([](int i, int, int) { return i < 2 ? 1 : 2; })), 0);
  EXPECT_EQ(
    ExcessOfAll(BricksInAir([](int i, int j, int k) { return i == 1 && j == 1 && k == 1; })), 0);
  // Three materials that meet along an edge, four at a point.
  EXPECT_EQ(ExcessOfAll(BricksInAir(
              [](int i, int j, int k) { return i < 2 ? 1
                                          : j < 2    ? 2
                                          : k < 2    ? 3
                                                     : 4; })),
    0);
}

TEST(PinchExcess, CountsCurvesAndTouches)
{
  // Two bricks that meet at the point (2, 2, 2) alone: their boundary cuts two curves out of its
  // link, and so does the boundary of the air around them.
  const EditableMesh corner = BricksInAir([](int i, int j, int k)
    { return (i == 1 && j == 1 && k == 1) || (i == 2 && j == 2 && k == 2); });
  EXPECT_EQ(PinchExcess(corner, PointAt(2, 2, 2)), 2);
  EXPECT_EQ(ExcessOfAll(corner), 2);
  // Along the edge from (2, 2, 1) to (2, 2, 2): each end sees the edge once in one curve, for
  // either material.
  const EditableMesh edge = BricksInAir([](int i, int j, int k)
    { return (i == 1 && j == 1 && k == 1) || (i == 2 && j == 2 && k == 1); });
  EXPECT_EQ(PinchExcess(edge, PointAt(2, 2, 1)), 2);
  EXPECT_EQ(PinchExcess(edge, PointAt(2, 2, 2)), 2);
  EXPECT_EQ(ExcessOfAll(edge), 4);
}

TEST(RepairPinches, LeavesNoneAndLittleChanged)
{
  const std::function<int(int, int, int)> cases[] = {
    [](int i, int j, int k)
    { return (i == 1 && j == 1 && k == 1) || (i == 2 && j == 2 && k == 2); },
    [](int i, int j, int k)
    { return (i == 1 && j == 1 && k == 1) || (i == 2 && j == 2 && k == 1); },
    // Two of one material in another, beside a third.
    [](int i, int j, int k) {
      return k == 3 ? 3 : (i == 1 && j == 1 && k == 1) || (i == 2 && j == 2 && k == 2) ? 2 : 1;
    },
    // A chess board of two materials, pinched at every inner edge.
    [](int i, int j, int k) { return 1 + (i + j + k) % 2; },
  };
  for (const auto& material : cases)
  {
    EditableMesh mesh = BricksInAir(material);
    const double before = TissueVolume(mesh);
    std::size_t pinched = 0;
    for (std::size_t point = 0; point < mesh.Points.size(); ++point)
    {
      pinched += PinchExcess(mesh, static_cast<std::int32_t>(point)) > 0;
    }
    EXPECT_EQ(RepairPinches(mesh, {}), pinched);
    EXPECT_EQ(ExcessOfAll(mesh), 0);
    EXPECT_NO_THROW(mesh.Finish().Validate("mended"));
    // What is cut out reaches a third of an edge: less than a brick for each body.
    EXPECT_NEAR(TissueVolume(mesh), before, 1);
    EXPECT_EQ(RepairPinches(mesh, {}), 0u);
  }
}

TEST(RepairPinches, MendsNoiseOfManyMaterials)
{
  std::mt19937 generator(6);
  EditableMesh mesh = BricksInAir([&](int, int, int) { return generator() % 4; });
  ASSERT_GT(ExcessOfAll(mesh), 10);
  RepairPinches(mesh, {});
  EXPECT_EQ(ExcessOfAll(mesh), 0);
  EXPECT_NO_THROW(mesh.Finish().Validate("mended"));
}
}
