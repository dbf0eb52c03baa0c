// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "mammoray/Meshing/Private/LabelComponents.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
using namespace mammoray;

/// A ball of 12 mm around the middle (1), and a rod of 1 x 1 x 20 mm beside it (2).
LabelVolume BallAndRod()
{
  return test::LabelledCube(41, 1,
    [](const Vector3& p)
    {
      const bool rod = p[0] == 17 && p[1] == 0 && std::abs(p[2]) < 10;
      return rod ? 2 : Norm(p) < 12 ? 1 : 0;
    });
}

TEST(SeedPlan, SeedsLargePartsOnceAndSmallOnesAlongTheirLength)
{
  const LabelVolume volume = BallAndRod();
  // 8 cubes of 3 mm: 216 mm3; the rod has 19, the ball 7238.
  const SeedPlan plan = PlanSeeds(volume, 3);
  ASSERT_EQ(plan.Components.Components.size(), 3u);
  for (std::size_t id = 0; id < 3; ++id)
  {
    const LabelComponent& part = plan.Components.Components[id];
    const std::vector<std::size_t>& seeds = plan.SeedVoxels[id];
    ASSERT_FALSE(seeds.empty());
    EXPECT_EQ(seeds.front(), volume.Index(part.Deepest[0], part.Deepest[1], part.Deepest[2]));
    for (const std::size_t seed : seeds)
    {
      EXPECT_EQ(plan.Components.OfVoxel[seed], id);
      EXPECT_EQ(volume.Voxels[seed], part.Material);
      EXPECT_LE(plan.Distance[seed], part.DepthMm);
    }
    if (part.Material == 1)
    {
      EXPECT_EQ(part.Deepest, (std::array<int, 3>{ 20, 20, 20 }));
      EXPECT_NEAR(part.DepthMm, 12, 1 + 0.08 * 12); // stairs and chamfer
      EXPECT_EQ(seeds.size(), 1u);
    }
    if (part.Material == 2)
    {
      EXPECT_FLOAT_EQ(static_cast<float>(part.DepthMm), 0.5f);
      // 19 voxels in a row, seeds at least 3 mm apart, and none left that is that far from all.
      EXPECT_GE(seeds.size(), 4u);
      EXPECT_LE(seeds.size(), 7u);
      for (std::size_t a = 0; a < seeds.size(); ++a)
      {
        for (std::size_t b = 0; b < a; ++b)
        {
          EXPECT_GE(std::abs(static_cast<double>(seeds[a]) - static_cast<double>(seeds[b])),
            3 * 41 * 41);
        }
      }
    }
  }
}

TEST(SeedPlan, IsMeasuredInMillimetresOnAnyVoxels)
{
  // The same row of five voxels, once 0.5 mm and once 5 mm long.
  for (const double length : { 0.5, 5.0 })
  {
    LabelVolume row;
    row.Size = { 7, 3, 3 };
    row.Spacing = { length, 1, 1 };
    row.Voxels.assign(63, 0);
    std::fill_n(&row.Voxels[row.Index(1, 1, 1)], 5, std::uint16_t{ 1 });
    const SeedPlan plan = PlanSeeds(row, 2); // small are parts below 64 mm3
    ASSERT_EQ(plan.SeedVoxels.size(), 2u);
    // 2 mm apart: of 2.5 mm the ends or their like, of 25 mm every voxel.
    EXPECT_EQ(plan.SeedVoxels[1].size(), length < 1 ? 1u : 5u);
  }
}
}
