// SPDX-License-Identifier: Apache-2.0
#include "TestMeshes.h"
#include "mammoray/Meshing/MeshCheck.h"
#include "mammoray/Meshing/Private/MeshRepair.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

using namespace mammoray;

namespace
{
/// Bricks of 1 mm whose material is a function of their indices; bricks of material 0 are left out.
TetrahedralMesh Bricks(int count, const std::function<int(int, int, int)>& material)
{
  const TetrahedralMesh box = test::MakeBoxMesh({ 0, 0, 0 },
    { 1.0 * count, 1.0 * count, 1.0 * count }, { count, count, count });
  TetrahedralMesh mesh;
  std::vector<std::int32_t> newId(box.NumberOfPoints(), -1);
  for (std::size_t cell = 0; cell < box.NumberOfCells(); ++cell)
  {
    const auto brick = static_cast<int>(cell / 6);
    const int own = material(brick % count, brick / count % count, brick / count / count);
    for (std::size_t corner = 0; corner < 4 && own != 0; ++corner)
    {
      const auto old = static_cast<std::size_t>(box.Cells[4 * cell + corner]);
      if (newId[old] < 0)
      {
        newId[old] = static_cast<std::int32_t>(mesh.NumberOfPoints());
        mesh.Points.insert(mesh.Points.end(), &box.Points[3 * old], &box.Points[3 * old] + 3);
      }
      mesh.Cells.push_back(newId[old]);
    }
    if (own != 0)
    {
      mesh.Materials.push_back(own);
    }
  }
  return mesh;
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

/// Pinched before, sound after; every material within `mm3` of its volume.
void ExpectMended(TetrahedralMesh mesh, double mm3)
{
  const MeshCheck before = CheckMesh(mesh);
  ASSERT_TRUE(before.Find(MeshTrouble::Kind::Pinches));
  const std::map<int, double> volumes = Volumes(mesh);
  EXPECT_GT(MendInterfaces(mesh), 0u);
  const MeshCheck after = CheckMesh(mesh);
  EXPECT_TRUE(after.Sound()) << after.Troubles[0].Text({});
  const std::map<int, double> left = Volumes(mesh);
  ASSERT_EQ(left.size(), volumes.size());
  for (const auto& [material, volume] : volumes)
  {
    EXPECT_NEAR(left.at(material), volume, mm3) << "material " << material;
  }
}
}

TEST(MeshRepair, CubesThatShareAnEdge)
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

TEST(MeshRepair, CubesThatShareACorner)
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

TEST(MeshRepair, ThreeMaterialsAroundAnEdge)
{
  // 1, 2, 1 and 3 around it: material 1 is pinched all along a line of edges.
  ExpectMended(Bricks(2, [](int i, int j, int) { return i == j ? 1 : i == 0 ? 2 : 3; }), 0.7);
}

TEST(MeshRepair, Checkerboards)
{
  for (const int other : { 0, 2 })
  {
    TetrahedralMesh mesh =
      Bricks(4, [other](int i, int j, int k) { return (i + j + k) % 2 == 0 ? 1 : other; });
    // All points but those on the edges of the whole: 27 within and 9 on each side.
    EXPECT_EQ(MendInterfaces(mesh, 0), 27u + 6 * 9);
    EXPECT_TRUE(CheckMesh(mesh).Sound());
  }
}

TEST(MeshRepair, ASoundMeshStaysAsItIs)
{
  TetrahedralMesh mesh = Bricks(3, [](int i, int, int) { return 1 + i; });
  const TetrahedralMesh before = mesh;
  EXPECT_EQ(MendInterfaces(mesh), 0u);
  EXPECT_EQ(mesh.Points, before.Points);
  EXPECT_EQ(mesh.Cells, before.Cells);
  EXPECT_EQ(mesh.Materials, before.Materials);
}

TEST(MeshRepair, RandomMaterialsInEveryCell)
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
    MendInterfaces(mesh, seed < 3 ? 12 : 0);
    const MeshCheck check = CheckMesh(mesh);
    ASSERT_TRUE(check.Sound()) << check.Troubles[0].Text({});
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
