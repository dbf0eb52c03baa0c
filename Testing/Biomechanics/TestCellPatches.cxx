// SPDX-License-Identifier: Apache-2.0
#include "TestMeshes.h"
#include "mammoray/Biomechanics/Private/CellPatches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

namespace
{
using namespace mammoray;

TEST(CellPatches, HoldEveryCellOnceAndOneGroupEach)
{
  const TetrahedralMesh mesh = test::MakeBoxMesh({ 0, 0, 0 }, { 4, 4, 4 }, { 4, 4, 4 });
  std::vector<char> groups(mesh.NumberOfCells());
  for (std::size_t cell = 0; cell < groups.size(); ++cell)
  {
    groups[cell] = mesh.Point(mesh.Cells[4 * cell])[0] < 2;
  }
  const std::vector<std::int32_t> neighbours = FaceNeighbours(mesh);
  std::set<std::int32_t> seen;
  const auto patches = MakePatches(mesh, neighbours, groups);
  for (const std::vector<std::int32_t>& patch : patches)
  {
    EXPECT_LE(patch.size(), static_cast<std::size_t>(LargestPatchSize));
    for (const std::int32_t cell : patch)
    {
      EXPECT_TRUE(seen.insert(cell).second);
      EXPECT_EQ(groups[cell], groups[patch.front()]);
      // Hangs together: another cell of the patch lies behind one of its faces.
      const auto hangs = [&](int face)
      {
        const std::int32_t other = neighbours[4 * cell + face];
        return std::find(patch.begin(), patch.end(), other) != patch.end();
      };
      EXPECT_TRUE(patch.size() == 1 || hangs(0) || hangs(1) || hangs(2) || hangs(3));
    }
  }
  EXPECT_EQ(seen.size(), mesh.NumberOfCells());
  EXPECT_NEAR(static_cast<double>(mesh.NumberOfCells()) / static_cast<double>(patches.size()),
    UsualPatchSize, 1);
}
}
