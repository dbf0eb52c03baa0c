// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "Refusals.h"
#include "mammoray/Meshing/SimulationMesh.h"

#include <gtest/gtest.h>

#include <set>

namespace
{
using mammoray::testing_support::RefusalOf;
using namespace mammoray;

/// A ball of 30 mm with muscle (3, held) behind y = -10 and a core of gland (2) in its fat (1).
LabelVolume Breast()
{
  return test::LabelledCube(34, 2,
    [](const Vector3& p)
    {
      const double radius = Norm(p);
      return radius > 30 ? 0 : p[1] < -10 ? 3 : radius < 8 ? 2 : 1;
    });
}

TEST(SimulationMesh, FollowsTheSkinAndTheHeldTissueOnly)
{
  const LabelVolume volume = Breast();
  const MeshingResult result = MeshForSimulation(volume, { false, false, false, true }, 10);
  EXPECT_NO_THROW(result.Mesh.Validate("mesh"));
  // Gland is no material of its own: fat is commoner.
  const std::set<int> found(result.Mesh.Materials.begin(), result.Mesh.Materials.end());
  EXPECT_EQ(found, (std::set<int>{ 1, 3 }));
  double volumes[2] = { 0, 0 };
  for (std::size_t cell = 0; cell < result.Mesh.NumberOfCells(); ++cell)
  {
    volumes[result.Mesh.Materials[cell] == 3 ? 1 : 0] += result.Mesh.CellVolume(cell);
  }
  auto counts = volume.CountLabels();
  // Facets of 10 mm on a ball of 30 mm, moved back to its volume by half a voxel at most.
  EXPECT_NEAR(volumes[0] / ((counts[1] + counts[2]) * 8.0), 1, 0.05);
  EXPECT_NEAR(volumes[1] / (counts[3] * 8.0), 1, 0.05);
}

TEST(SimulationMesh, TakesItsSizeFromTheVolume)
{
  const MeshingResult result = MeshForSimulation(Breast(), { false, false, false, true }, 0);
  // 3000 to 4000 for a whole breast; a ball has some more surface for its volume.
  EXPECT_GT(result.Mesh.NumberOfCells(), 1000u);
  EXPECT_LT(result.Mesh.NumberOfCells(), 6000u);
}

TEST(SimulationMesh, RefusesUnknownMaterialsAndSizes)
{
  EXPECT_EQ(RefusalOf(
              [] {
                MeshForSimulation(Breast(), { false, false, false }, 10);
              }),
    "simulation mesh: expected materials 0 to 2, found 3");
  EXPECT_EQ(RefusalOf(
              [] {
                MeshForSimulation(Breast(), { false, false, false, true }, -1);
              }),
    "simulation mesh: expected a cell size of at least 0 mm, found -1.000000");
}
}
