// SPDX-License-Identifier: Apache-2.0
#include "Refusals.h"
#include "mammoray/Registration/Private/PixelFilters.h"
#include "mammoray/Registration/Private/PixelMask.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace
{
using namespace mammoray;
using test::NotRefused;

constexpr PixelGrid SmallGrid{ 17, 13, 0.7, 1.1 };

mammoray::PixelMask MaskWhere(const PixelGrid& grid, const std::function<bool(int, int)>& set)
{
  mammoray::PixelMask mask;
  for (int row = 0; row < grid.Rows; ++row)
  {
    for (int column = 0; column < grid.Columns; ++column)
    {
      mask.push_back(set(column, row) ? 1 : 0);
    }
  }
  return mask;
}

int CountOfSet(const mammoray::PixelMask& mask)
{
  return static_cast<int>(std::count(mask.begin(), mask.end(), 1));
}

/// By trying all pairs.
std::vector<float> SlowDistance(const PixelGrid& grid, const mammoray::PixelMask& mask)
{
  std::vector<float> distances(mask.size(), std::numeric_limits<float>::infinity());
  for (int a = 0; a < static_cast<int>(mask.size()); ++a)
  {
    for (int b = 0; b < static_cast<int>(mask.size()); ++b)
    {
      if (!mask[static_cast<std::size_t>(b)])
      {
        const double x = (a % grid.Columns - b % grid.Columns) * grid.ColumnSpacing;
        const double y = (a / grid.Columns - b / grid.Columns) * grid.RowSpacing;
        float& distance = distances[static_cast<std::size_t>(a)];
        distance = std::min(distance, static_cast<float>(std::hypot(x, y)));
      }
    }
  }
  return distances;
}

TEST(DistanceToClear, IsTheLeastOfAllPairs)
{
  std::mt19937 generator(3);
  for (const unsigned sparse : { 2u, 20u, 100u })
  {
    const mammoray::PixelMask mask =
      MaskWhere(SmallGrid, [&](int, int) { return generator() % sparse != 0; });
    const std::vector<float> fast = DistanceToClear(SmallGrid, mask);
    const std::vector<float> slow = SlowDistance(SmallGrid, mask);
    for (std::size_t pixel = 0; pixel < mask.size(); ++pixel)
    {
      // Squares are kept as floats between the two passes.
      ASSERT_TRUE(fast[pixel] == slow[pixel] || std::abs(fast[pixel] - slow[pixel]) < 1e-5)
        << sparse << ' ' << pixel;
    }
  }
  const mammoray::PixelMask full = MaskWhere(SmallGrid, [](int, int) { return true; });
  for (const float distance : DistanceToClear(SmallGrid, full))
  {
    EXPECT_EQ(distance, std::numeric_limits<float>::infinity());
  }
  // One row, one column.
  const PixelGrid line{ 1, 5, 1, 2 };
  EXPECT_THAT(DistanceToClear(line, { 1, 1, 0, 1, 1 }), testing::ElementsAre(4, 2, 0, 2, 4));
}

TEST(SignedDistance, ChangesSignMidwayAndNotAtTheBorder)
{
  const PixelGrid grid{ 20, 10, 0.5, 0.5 };
  const mammoray::PixelMask mask = MaskWhere(grid, [](int column, int) { return column < 8; });
  const std::vector<float> distances = SignedDistance(grid, mask);
  for (int column = 0; column < 20; ++column)
  {
    // The outline lies between the columns 7 and 8.
    EXPECT_NEAR(distances[grid.Index(column, 4)], 0.5 * (column - 7.5), 1e-6) << column;
  }
  const std::vector<float> other =
    SignedDistance(grid, MaskWhere(grid, [](int column, int) { return column >= 8; }));
  for (std::size_t pixel = 0; pixel < other.size(); ++pixel)
  {
    EXPECT_NEAR(other[pixel], -distances[pixel], 1e-6);
  }
}

TEST(TouchedSides, AreMeasuredInMillimetres)
{
  const mammoray::PixelMask mask = MaskWhere(SmallGrid,
    [](int column, int row) { return (column == 0 && row < 5) || (row == 0 && column < 3); });
  const auto touched = TouchedSides(SmallGrid, mask);
  EXPECT_DOUBLE_EQ(touched[0], 5 * 1.1);
  EXPECT_DOUBLE_EQ(touched[1], 0);
  EXPECT_DOUBLE_EQ(touched[2], 3 * 0.7);
  EXPECT_DOUBLE_EQ(touched[3], 0);
}

TEST(FillDarkFrame, ContinuesTheBreastToEachSideAndNoOther)
{
  const PixelGrid grid{ 40, 30, 0.5, 0.5 };
  // A dark frame of one pixel, and the breast from 1 to 20 mm from a side.
  const auto inBreast = [&](Side side, int column, int row, bool filled)
  {
    const int along = side == Side::Left || side == Side::Right ? row : column;
    const int inward = side == Side::Left ? column
      : side == Side::Right               ? grid.Columns - 1 - column
      : side == Side::Top                 ? row
                                          : grid.Rows - 1 - row;
    return along > 8 && along < 20 && inward < 12 && (filled || inward > 0);
  };
  for (const Side side : { Side::Left, Side::Right, Side::Top, Side::Bottom })
  {
    mammoray::PixelMask mask =
      MaskWhere(grid, [&](int column, int row) { return inBreast(side, column, row, false); });
    FillDarkFrame(grid, mask);
    EXPECT_EQ(mask,
      MaskWhere(grid, [&](int column, int row) { return inBreast(side, column, row, true); }));
    // Filled twice is filled once.
    const mammoray::PixelMask once = mask;
    FillDarkFrame(grid, mask);
    EXPECT_EQ(mask, once);
  }
  // Away from all sides nothing is filled.
  mammoray::PixelMask middle =
    MaskWhere(grid, [](int column, int row) { return std::hypot(column - 20, row - 15) < 8; });
  const mammoray::PixelMask before = middle;
  FillDarkFrame(grid, middle);
  EXPECT_EQ(middle, before);
}

TEST(WithoutThinParts, TakesLinesAndKeepsCorners)
{
  const PixelGrid grid{ 60, 50, 0.5, 0.5 };
  const auto inBox = [](int column, int row)
  { return column >= 5 && column < 35 && row >= 5 && row < 40; };
  const mammoray::PixelMask box = MaskWhere(grid, inBox);
  const mammoray::PixelMask lined = MaskWhere(grid,
    [&](int column, int row)
    { return inBox(column, row) || (row >= 20 && row < 22) || (column == 50 && row < 45); });
  // Thinner than 4 mm (8 pixels): the line of 1 mm and the one across it. Of the first its root
  // stays, within twice the radius of 2 mm of the core.
  const mammoray::PixelMask kept = WithoutThinParts(grid, lined, 4);
  for (int row = 0; row < grid.Rows; ++row)
  {
    for (int column = 0; column < grid.Columns; ++column)
    {
      const bool set = kept[grid.Index(column, row)] != 0;
      EXPECT_TRUE(set || !inBox(column, row)) << column << ' ' << row;
      EXPECT_TRUE(!set || (column >= 0 && column < 40)) << column << ' ' << row;
    }
  }
  EXPECT_LT(CountOfSet(kept), CountOfSet(box) + 2 * 5 * 2 + 1);
  // Less than a pixel is not thin.
  EXPECT_EQ(WithoutThinParts(grid, lined, 0.9), lined);
}

TEST(KeepLargestPiece, SharesEdgesAndRefusesNothing)
{
  mammoray::PixelMask mask = MaskWhere(SmallGrid,
    [](int column, int row)
    { return (column < 4 && row < 4) || (column >= 4 && column < 6 && row >= 4 && row < 7); });
  EXPECT_TRUE(KeepLargestPiece(SmallGrid.Shape(), mask)); // they meet at a corner only
  EXPECT_EQ(CountOfSet(mask), 16);
  mammoray::PixelMask none(SmallGrid.Count(), 0);
  EXPECT_FALSE(KeepLargestPiece(SmallGrid.Shape(), none));
}

TEST(FillHoles, FillsWhatTouchesNoSide)
{
  mammoray::PixelMask mask = MaskWhere(SmallGrid,
    [](int column, int row)
    {
      const bool hole = column > 3 && column < 6 && row > 3 && row < 6;
      const bool bay = row == 8 && column < 5; // open at the left
      return column < 12 && row > 1 && row < 11 && !hole && !bay;
    });
  const int before = CountOfSet(mask);
  FillHoles(SmallGrid.Shape(), mask);
  EXPECT_EQ(CountOfSet(mask), before + 4);
  EXPECT_EQ(mask[SmallGrid.Index(2, 8)], 0);
  EXPECT_EQ(mask[SmallGrid.Index(4, 4)], 1);
}

TEST(Median3x3, TakesSpecksAndKeepsEdges)
{
  const PixelGrid grid{ 12, 9, 1, 1 };
  std::vector<float> step;
  for (int pixel = 0; pixel < 12 * 9; ++pixel)
  {
    step.push_back(pixel % 12 < 6 ? 1.0f : 5.0f);
  }
  std::vector<float> specked = step;
  specked[grid.Index(3, 4)] = 100;
  specked[grid.Index(8, 2)] = -100;
  const std::vector<float> kept = specked;
  EXPECT_EQ(Median3x3(grid, specked), step);
  EXPECT_EQ(specked, kept); // only read
}

TEST(RefinePicture, IsLinearBetweenThePixels)
{
  const PixelGrid grid{ 6, 5, 0.9, 0.6 };
  const PixelGrid fine{ 18, 15, 0.3, 0.2 };
  std::vector<float> ramp;
  for (int pixel = 0; pixel < 30; ++pixel)
  {
    ramp.push_back(3.0f * static_cast<float>(pixel % 6) - static_cast<float>(pixel / 6));
  }
  const std::vector<float> refined = Refine(grid, ramp, fine, 3);
  ASSERT_EQ(refined.size(), fine.Count());
  for (int row = 0; row < fine.Rows; ++row)
  {
    for (int column = 0; column < fine.Columns; ++column)
    {
      // Centres at thirds of a pixel; beyond the outer centres the outer value.
      const double x = std::clamp((column - 1) / 3.0, 0.0, 5.0);
      const double y = std::clamp((row - 1) / 3.0, 0.0, 4.0);
      // VTK's interpolator rounds places to 2^-17 of a pixel.
      EXPECT_NEAR(refined[fine.Index(column, row)], 3 * x - y, 1e-4) << column << ' ' << row;
    }
  }
  EXPECT_EQ(Refine(grid, ramp, grid, 1), ramp);
}
}
