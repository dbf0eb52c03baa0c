// SPDX-License-Identifier: Apache-2.0
#include "TestMeshes.h"
#include "mammoray/Meshing/MeshCheck.h"
#include "mammoray/Meshing/Private/EditableMesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <random>

namespace
{
using namespace mammoray;

/// count^3 bricks of 1 mm whose material is a function of their place; 0 is air, which is kept.
EditableMesh BricksInAir(const std::function<int(int, int, int)>& material, int count = 4)
{
  TetrahedralMesh mesh = test::MakeBoxMesh({ 0, 0, 0 }, { 1.0 * count, 1.0 * count, 1.0 * count },
    { count, count, count });
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    const auto brick = static_cast<int>(cell / 6);
    mesh.Materials[cell] = material(brick % count, brick / count % count, brick / count / count);
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

/// The same without air.
TetrahedralMesh Bricks(int count, const std::function<int(int, int, int)>& material)
{
  return BricksInAir(material, count).Finish();
}

std::map<int, double> Volumes(const TetrahedralMesh& mesh)
{
  std::map<int, double> volumes;
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    volumes[mesh.Materials[cell]] += mesh.CellVolume(cell);
  }
  return volumes;
}

/// Mends a mesh without air around it, and returns the number of pinched points.
std::size_t MendInterfaces(TetrahedralMesh& mesh)
{
  EditableMesh edited(mesh);
  const std::size_t pinched = RepairPinches(edited, {});
  mesh = edited.Finish();
  return pinched;
}

/// Pinched before, sound after; every material within `mm3` of its volume.
void ExpectMended(TetrahedralMesh mesh, double mm3)
{
  const MeshCheck before = CheckMesh(mesh);
  ASSERT_TRUE(before.Find(MeshDefect::Kind::Pinches));
  const std::map<int, double> volumes = Volumes(mesh);
  EXPECT_GT(MendInterfaces(mesh), 0u);
  const MeshCheck after = CheckMesh(mesh);
  EXPECT_TRUE(after.Sound()) << after.Defects[0].Text({});
  const std::map<int, double> left = Volumes(mesh);
  ASSERT_EQ(left.size(), volumes.size());
  for (const auto& [material, volume] : volumes)
  {
    EXPECT_NEAR(left.at(material), volume, mm3) << "material " << material;
  }
}

TEST(RepairPinches, CubesThatShareAnEdge)
{
  // Two cubes in air, and in a block of another material. The tube around the edge reaches a third
  // of a cell from it, which is below 0.4 mm^3 for either of them.
  const auto label = [](int other)
  {
    return [other](int i, int j, int k)
    { return (i == 1 && j == 1 && k == 1) || (i == 2 && j == 2 && k == 1) ? 1 : other; };
  };
  ExpectMended(Bricks(4, label(0)), 0.4);
  ExpectMended(Bricks(4, label(2)), 0.4);
}

TEST(RepairPinches, CubesThatShareACorner)
{
  const auto label = [](int other)
  {
    return [other](int i, int j, int k)
    { return (i == 1 && j == 1 && k == 1) || (i == 2 && j == 2 && k == 2) ? 1 : other; };
  };
  // A corner's cells are cut at a third of their edges: at most 1 / 27 of what lies around it.
  ExpectMended(Bricks(4, label(0)), 0.1);
  ExpectMended(Bricks(4, label(2)), 0.1);
}

TEST(RepairPinches, ThreeMaterialsAroundAnEdge)
{
  // 1, 2, 1 and 3 around it: material 1 is pinched all along a line of edges.
  ExpectMended(Bricks(2, [](int i, int j, int) { return i == j ? 1 : i == 0 ? 2 : 3; }), 0.7);
}

TEST(RepairPinches, Checkerboards)
{
  for (const int other : { 0, 2 })
  {
    TetrahedralMesh mesh =
      Bricks(4, [other](int i, int j, int k) { return (i + j + k) % 2 == 0 ? 1 : other; });
    // All points but those on the edges of the whole: 27 within and 9 on each side.
    EXPECT_EQ(MendInterfaces(mesh), 27u + 6 * 9);
    EXPECT_TRUE(CheckMesh(mesh).Sound());
  }
}

TEST(RepairPinches, ASoundMeshStaysAsItIs)
{
  TetrahedralMesh mesh = Bricks(3, [](int i, int, int) { return 1 + i; });
  const TetrahedralMesh before = mesh;
  EXPECT_EQ(MendInterfaces(mesh), 0u);
  EXPECT_EQ(mesh.Points, before.Points);
  EXPECT_EQ(mesh.Cells, before.Cells);
  EXPECT_EQ(mesh.Materials, before.Materials);
}

TEST(RepairPinches, RandomMaterialsInEveryCell)
{
  // Nothing is more pinched; with and without air.
  const unsigned seeds = std::getenv("MAMMORAY_LONG_TESTS") ? 300 : 20;
  for (unsigned seed = 1; seed <= seeds; ++seed)
  {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 generator(seed);
    const bool withAir = seed % 2 == 0;
    TetrahedralMesh mesh =
      Bricks(4, [&](int, int, int) { return withAir ? static_cast<int>(generator() % 4) : 1; });
    if (seed % 4 < 2)
    {
      for (std::int32_t& material : mesh.Materials)
      {
        material = 1 + static_cast<std::int32_t>(generator() % 3);
      }
    }
    const std::map<int, double> before = Volumes(mesh);
    MendInterfaces(mesh);
    const MeshCheck check = CheckMesh(mesh);
    ASSERT_TRUE(check.Sound()) << check.Defects[0].Text({});
    double sum = 0;
    for (const auto& [material, volume] : Volumes(mesh))
    {
      sum += volume;
    }
    double sumBefore = 0;
    for (const auto& [material, volume] : before)
    {
      sumBefore += volume;
    }
    if (withAir)
    {
      EXPECT_LE(sum, sumBefore + 1e-9);
    }
    else
    {
      EXPECT_NEAR(sum, 64, 1e-9); // no space is lost within a body
    }
  }
}
}
