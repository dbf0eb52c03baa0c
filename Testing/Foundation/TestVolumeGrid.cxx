// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "Refusals.h"
#include "mammoray/Foundation/Volumes.h"

#include <gmock/gmock.h>

#include <set>

namespace
{
using mammoray::test::RefusalOf;
using namespace mammoray;

VolumeGrid ObliqueGrid()
{
  VolumeGrid grid;
  grid.Size = { 3, 4, 5 };
  grid.Origin = { 10, -20, 30 };
  grid.Spacing = { 0.5, 1.5, 2.0 };
  grid.Direction = { { { 0.6, 0.8, 0 }, { -0.8, 0.6, 0 }, { 0, 0, 1 } } };
  return grid;
}

TEST(VolumeGrid, NumbersVoxelsIFastest)
{
  const VolumeGrid grid = ObliqueGrid();
  std::size_t next = 0;
  for (int k = 0; k < 5; ++k)
  {
    for (int j = 0; j < 4; ++j)
    {
      for (int i = 0; i < 3; ++i)
      {
        EXPECT_EQ(grid.Index(i, j, k), next);
        EXPECT_EQ(grid.VoxelName(next),
          "voxel (" + std::to_string(i) + ", " + std::to_string(j) + ", " + std::to_string(k) +
            ")");
        ++next;
      }
    }
  }
}

TEST(VolumeGrid, StepsOfOneVoxelAreItsSpacingLong)
{
  const VolumeGrid grid = ObliqueGrid();
  EXPECT_EQ(grid.PointAt(0, 0, 0), grid.Origin);
  EXPECT_DOUBLE_EQ(grid.VoxelVolume(), 1.5);
  const Vector3 from = grid.PointAt(1.25, 2.5, 3.75);
  // 1e-12: a few double operations on numbers of size 40.
  EXPECT_NEAR(Norm(grid.PointAt(2.25, 2.5, 3.75) - from), 0.5, 1e-12);
  EXPECT_NEAR(Norm(grid.PointAt(1.25, 3.5, 3.75) - from), 1.5, 1e-12);
  EXPECT_NEAR(Norm(grid.PointAt(1.25, 2.5, 4.75) - from), 2.0, 1e-12);
  const Vector3 index = grid.ContinuousIndex(from);
  EXPECT_NEAR(index[0], 1.25, 1e-12);
  EXPECT_NEAR(index[1], 2.5, 1e-12);
  EXPECT_NEAR(index[2], 3.75, 1e-12);
}

TEST(VolumeGrid, ValidateNamesWhatIsWrong)
{
  EXPECT_NO_THROW(ObliqueGrid().ValidateGrid("v", 60));
  EXPECT_THAT(RefusalOf([] { ObliqueGrid().ValidateGrid("v", 59); }),
    test::Mentions("v: ", "60", "59"));
  VolumeGrid grid = ObliqueGrid();
  grid.Size[2] = 0;
  EXPECT_THAT(RefusalOf([&] { grid.ValidateGrid("v", 0); }), test::Mentions("size", "axis 2", "0"));
  grid = ObliqueGrid();
  grid.Spacing[0] = -1;
  EXPECT_THAT(RefusalOf([&] { grid.ValidateGrid("v", 60); }),
    test::Mentions("spacing", "axis 0", "-1 mm"));
  grid = ObliqueGrid();
  grid.Direction[1] = { 0.8, 0.6, 0 };
  EXPECT_THAT(RefusalOf([&] { grid.ValidateGrid("v", 60); }),
    test::Mentions("axes 0 and 1", "0.96"));
}

TEST(VolumeGrid, TellsWhichAxisLeadsAlongADirection)
{
  const VolumeGrid grid = ObliqueGrid();
  EXPECT_EQ(grid.AxisAlong({ 0, 1, 0 }), 0u); // by 0.8, j by 0.6
  EXPECT_EQ(grid.AxisAlong({ 0, -1, 0 }), 0u);
  EXPECT_EQ(grid.AxisAlong({ 1, 0, 0 }), 1u);
  EXPECT_EQ(grid.AxisAlong({ 0.5, 0, 0.7 }), 2u);
}
}
