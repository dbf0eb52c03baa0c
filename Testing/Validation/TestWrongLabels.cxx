// SPDX-License-Identifier: Apache-2.0
#include "WrongLabels.h"

#include "mammoray/Foundation/Vector3.h"

#include <gtest/gtest.h>

using namespace mammoray;

namespace
{
/// 8 x 4 x 2 voxels of 2 mm: the first layer along i is held, the others are breast but for a
/// corner.
LabelVolume SmallBreast()
{
  LabelVolume breast;
  breast.Size = { 8, 4, 2 };
  breast.Spacing = { 2, 2, 2 };
  breast.Origin = { 10, 0, 0 };
  breast.Voxels.assign(64, 1);
  for (int j = 0; j < 4; ++j)
  {
    for (int k = 0; k < 2; ++k)
    {
      breast.Voxels[breast.Index(0, j, k)] = 2;
    }
  }
  breast.Voxels[breast.Index(7, 3, 1)] = 0;
  return breast;
}

const std::vector<bool> Fixed{ false, false, true };
}

TEST(WrongLabels, AreAsLargeAsTheyShouldBe)
{
  const LabelVolume breast = SmallBreast();
  EXPECT_DOUBLE_EQ(BreastVolume(breast, Fixed), (64 - 8 - 1) * 8.0);
  const LabelVolume larger = Resized(breast, 1.5);
  EXPECT_DOUBLE_EQ(BreastVolume(larger, Fixed), 3.375 * BreastVolume(breast, Fixed));
  EXPECT_LT(Norm(larger.PointAt(7, 3, 1) - 1.5 * breast.PointAt(7, 3, 1)), 1e-12);
}

TEST(WrongLabels, AMirrorImageKeepsItsBounds)
{
  const LabelVolume breast = SmallBreast();
  const LabelVolume mirrored = Mirrored(breast, { 0, -1, 0 });
  EXPECT_EQ(mirrored.Voxels[mirrored.Index(7, 0, 1)], 0);
  EXPECT_EQ(mirrored.Voxels[mirrored.Index(7, 3, 1)], 1);
  EXPECT_EQ(mirrored.Voxels[mirrored.Index(0, 2, 0)], 2);
  EXPECT_EQ(Mirrored(mirrored, { 0, 1, 0 }).Voxels, breast.Voxels);
}

TEST(WrongLabels, TheQuarterThatIsLostIsTheFarthest)
{
  // The breast's middles go from 12 to 24 mm: 21 mm is three quarters of the way.
  const LabelVolume cut = WithoutQuarter(SmallBreast(), Fixed, { 1, 0, 0 });
  for (int i = 0; i < 8; ++i)
  {
    EXPECT_EQ(cut.Voxels[cut.Index(i, 0, 0)], i == 0 ? 2 : i < 6 ? 1 : 0) << i;
  }
  // The other way round held tissue stays where it is.
  EXPECT_EQ(WithoutQuarter(SmallBreast(), Fixed, { -1, 0, 0 }).Voxels[0], 2);
}
