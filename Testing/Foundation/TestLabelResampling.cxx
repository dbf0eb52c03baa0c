// SPDX-License-Identifier: Apache-2.0
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/LabelEditing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using mammoray::test::RefusalOf;
using namespace mammoray;

namespace
{
LabelVolume Row(std::vector<std::uint16_t> labels, double spacing)
{
  LabelVolume volume;
  volume.Size = { static_cast<int>(labels.size()), 1, 1 };
  volume.Spacing = { spacing, spacing, spacing };
  volume.Origin = { 5, 6, 7 };
  volume.Direction = { { { 0, 1, 0 }, { -1, 0, 0 }, { 0, 0, 1 } } };
  volume.Voxels = std::move(labels);
  return volume;
}
}

TEST(LabelResampling, TheLabelThatFillsMostWins)
{
  LabelVolume row = Row({ 1, 1, 2, 2, 2, 3, 3, 1, 0, 0 }, 0.2);
  row.Spacing = { 0.2, 0.5, 0.5 };
  // 2.5 voxels each: {1, 1, half 2}, {half 2, 2, 2}, {3, 3, half 1}, {half 1, 0, 0}.
  const LabelVolume coarse = ResampleLabels(row, 0.5);
  EXPECT_EQ(coarse.Size, (std::array<int, 3>{ 4, 1, 1 }));
  EXPECT_THAT(coarse.Voxels, testing::ElementsAre(1, 2, 3, 0));
  // The first corner stays: half a voxel before the centre, along i (the y axis).
  EXPECT_NEAR(coarse.Origin[1] - 0.25, row.Origin[1] - 0.1, 1e-12);
  EXPECT_NEAR(coarse.Origin[0], row.Origin[0], 1e-12);
}

TEST(LabelResampling, TiesGoToTheSmallestLabelAndOutsideIsAir)
{
  LabelVolume row = Row({ 2, 1, 3, 4, 5 }, 1.0);
  row.Spacing = { 1, 2, 2 };
  // {2, 1}, {3, 4}, {5, outside}.
  EXPECT_THAT(ResampleLabels(row, 2.0).Voxels, testing::ElementsAre(1, 3, 0));
}

TEST(LabelResampling, SameSpacingAndFinerOnesKeepTheVoxels)
{
  const LabelVolume row = Row({ 7, 0, 9 }, 1.0);
  EXPECT_EQ(ResampleLabels(row, 1.0).Voxels, row.Voxels);
  const LabelVolume fine = ResampleLabels(row, 0.5);
  EXPECT_EQ(fine.Size, (std::array<int, 3>{ 6, 2, 2 }));
  for (int k = 0; k < 2; ++k)
  {
    for (int i = 0; i < 6; ++i)
    {
      EXPECT_EQ(fine.Voxels[fine.Index(i, 1, k)], row.LabelAt(fine.PointAt(i, 1, k)));
    }
  }
  EXPECT_THROW(ResampleLabels(row, 0), InputError);
  EXPECT_THROW(ResampleLabels(row, 1e-9), InputError);
}

TEST(LabelResampling, ABoxKeepsItsVoxelsAtTheirPlaces)
{
  LabelVolume volume = Row({}, 0.5);
  volume.Size = { 4, 3, 2 };
  for (std::uint16_t voxel = 0; voxel < 24; ++voxel)
  {
    volume.Voxels.push_back(voxel);
  }
  const LabelVolume box = CropToBox(volume, { { 1, 1, 0 }, { 2, 2, 1 } });
  EXPECT_EQ(box.Size, (std::array<int, 3>{ 2, 2, 2 }));
  EXPECT_THAT(box.Voxels, testing::ElementsAre(5, 6, 9, 10, 17, 18, 21, 22));
  for (int i = 0; i < 2; ++i)
  {
    EXPECT_EQ(volume.LabelAt(box.PointAt(i, 1, 1)), box.Voxels[box.Index(i, 1, 1)]);
  }
  EXPECT_EQ(CropToBox(volume, { { 0, 0, 0 }, { 3, 2, 1 } }).Voxels, volume.Voxels);
  for (const VoxelBox& bad : { VoxelBox{ { 2, 0, 0 }, { 1, 2, 1 } },
         VoxelBox{ { 0, 0, 0 }, { 4, 2, 1 } }, VoxelBox{ { 0, -1, 0 }, { 3, 2, 1 } } })
  {
    EXPECT_THAT(RefusalOf([&] { CropToBox(volume, bad); }),
      testing::AllOf(testing::StartsWith("crop " + std::to_string(bad.First[0]) + ":"),
        test::Mentions("0:3 0:2 0:1")));
  }
}

TEST(LabelResampling, CropKeepsEveryVoxelsPlace)
{
  const LabelVolume row = Row({ 0, 0, 0, 4, 0, 5, 0, 0 }, 1.0);
  const LabelVolume cropped = CropToTissue(row, 1);
  EXPECT_THAT(cropped.Voxels, testing::ElementsAre(0, 4, 0, 5, 0));
  for (int i = 0; i < 5; ++i)
  {
    EXPECT_EQ(row.LabelAt(cropped.PointAt(i, 0, 0)), cropped.Voxels[i]);
  }
  EXPECT_THROW(CropToTissue(Row({ 0, 0 }, 1.0), 1), InputError);
}
