// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "mammoray/Meshing/Private/LabelComponents.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace
{
using namespace mammoray;

/// One row of voxels, or a slice of them.
LabelVolume SliceOf(int columns, std::vector<std::uint16_t> labels)
{
  LabelVolume volume;
  volume.Size = { columns, static_cast<int>(labels.size()) / columns, 1 };
  volume.Voxels = std::move(labels);
  return volume;
}

TEST(LabelComponents, AreOrderedByTheirFirstVoxelsAndShareFaces)
{
  const LabelComponents found = FindComponents(SliceOf(4,
    {
      0, 0, 1, 1, //
      2, 0, 1, 2, //
      2, 2, 0, 2, // 0 and 2 meet along edges only
    }));
  EXPECT_THAT(found.OfVoxel, testing::ElementsAre(0, 0, 1, 1, 2, 0, 1, 3, 2, 2, 4, 3));
  ASSERT_EQ(found.Components.size(), 5u);
  const auto& parts = found.Components;
  EXPECT_EQ(parts[0].Material, 0);
  EXPECT_EQ(parts[1].Material, 1);
  EXPECT_EQ(parts[2].Material, 2);
  EXPECT_EQ(parts[3].Material, 2);
  EXPECT_EQ(parts[0].Voxels + parts[1].Voxels + parts[2].Voxels + parts[3].Voxels + parts[4].Voxels,
    12u);
  EXPECT_EQ(parts[2].Voxels, 3u);
}

TEST(MergeSmallComponents, GoToWhatTheyShareTheMostAreaWith)
{
  // Voxels of 1 x 2 x 5 mm: two faces across x (10 mm2 each) outweigh two across y (5 mm2 each),
  // which a count of faces would not see.
  LabelVolume volume = SliceOf(5,
    {
      1, 1, 1, 1, 1, //
      2, 2, 3, 2, 2, //
      1, 1, 1, 1, 1, //
    });
  volume.Spacing = { 1, 2, 5 };
  LabelVolume merged = volume;
  EXPECT_EQ(MergeSmallComponents(merged, 10.1), 1u); // 10 mm3
  EXPECT_EQ(merged.CountLabels(), (std::map<int, std::size_t>{ { 1, 10 }, { 2, 5 } }));
  // Of exactly the limit they stay.
  merged = volume;
  EXPECT_EQ(MergeSmallComponents(merged, 10), 0u);
  EXPECT_EQ(merged.Voxels, volume.Voxels);
}

TEST(MergeSmallComponents, TheLowestWinsATieAndTheEdgeIsNoNeighbour)
{
  LabelVolume tie = SliceOf(5, { 7, 7, 9, 4, 4 });
  EXPECT_EQ(MergeSmallComponents(tie, 2), 1u);
  EXPECT_THAT(tie.Voxels, testing::ElementsAre(7, 7, 4, 4, 4));
  // Air takes small parts like any other material, and gives its own bubbles.
  LabelVolume bubble = SliceOf(4, { 5, 5, 5, 0 });
  EXPECT_EQ(MergeSmallComponents(bubble, 2), 1u);
  EXPECT_THAT(bubble.Voxels, testing::ElementsAre(5, 5, 5, 5));
}

TEST(MergeSmallComponents, SmallOnesInSmallOnesWaitTheirTurn)
{
  // A voxel of 3 in a ring of 2 (8 voxels), in 1: the ring first, then what is in it.
  LabelVolume nested = test::LabelledCube(9, 1,
    [](const Vector3& p)
    {
      const double far = std::max({ std::abs(p[0]), std::abs(p[1]), std::abs(p[2]) });
      return far < 0.5 ? 3 : far < 1.5 ? 2 : 1;
    });
  EXPECT_EQ(MergeSmallComponents(nested, 27), 27u);
  EXPECT_EQ(nested.CountLabels().size(), 1u);
  // Where all are small there is nothing to go to.
  LabelVolume small = SliceOf(4, { 1, 2, 1, 2 });
  EXPECT_EQ(MergeSmallComponents(small, 5), 0u);
}

TEST(MergeSmallComponents, LeavesNoneAndChangesNothingElse)
{
  const LabelVolume mosaic = test::Mosaic(20, 1, 10, 60, 4, 3);
  LabelVolume merged = mosaic;
  const std::size_t changed = MergeSmallComponents(merged, 100);
  EXPECT_GT(changed, 0u);
  std::size_t different = 0;
  for (std::size_t voxel = 0; voxel < mosaic.NumberOfVoxels(); ++voxel)
  {
    different += mosaic.Voxels[voxel] != merged.Voxels[voxel];
  }
  EXPECT_LE(different, changed); // a voxel may change twice
  for (const LabelComponent& part : FindComponents(merged).Components)
  {
    EXPECT_GE(part.Voxels, 100u);
  }
  EXPECT_EQ(MergeSmallComponents(merged, 100), 0u);
}

TEST(InterfaceDistance, OfASlabIsThatToItsNearerFace)
{
  LabelVolume slab;
  slab.Size = { 5, 4, 24 };
  slab.Spacing = { 1.5, 0.7, 0.5 };
  for (int n = 0; n < 5 * 4 * 24; ++n)
  {
    const int k = n / 20;
    slab.Voxels.push_back(k >= 6 && k < 16 ? 1 : 0);
  }
  const std::vector<float> distance = InterfaceDistance(slab);
  for (int k = 0; k < 24; ++k)
  {
    // Faces at 5.5 and 15.5 voxels; the volume's own border is no interface.
    const double expected = 0.5 * std::min(std::abs(k - 5.5), std::abs(k - 15.5));
    EXPECT_FLOAT_EQ(distance[slab.Index(2, 1, k)], static_cast<float>(expected)) << k;
    EXPECT_FLOAT_EQ(distance[slab.Index(0, 3, k)], static_cast<float>(expected)) << k;
  }
}

TEST(InterfaceDistance, OfABallIsItsDepthWithinTheChamfersError)
{
  const LabelVolume ball =
    test::LabelledCube(41, 1, [](const Vector3& p) { return Norm(p) < 15.2 ? 1 : 0; });
  const std::vector<float> distance = InterfaceDistance(ball);
  for (int k = 0; k < 41; ++k)
  {
    for (int i = 0; i < 41; ++i)
    {
      const double depth = std::abs(15.2 - Norm(ball.PointAt(i, 17, k)));
      // A voxel for the stairs of the surface, and 8 % for the steps.
      ASSERT_NEAR(distance[ball.Index(i, 17, k)], depth, 1 + 0.08 * depth) << i << ' ' << k;
    }
  }
}

TEST(InterfaceDistance, IsEndlessWithoutAnyInterface)
{
  const LabelVolume even = test::LabelledCube(3, 1, [](const Vector3&) { return 1; });
  for (const float distance : InterfaceDistance(even))
  {
    EXPECT_EQ(distance, std::numeric_limits<float>::max());
  }
}
}
