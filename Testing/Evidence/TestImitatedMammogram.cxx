// SPDX-License-Identifier: Apache-2.0
#include "Private/ImitatedMammogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>

namespace mammoray
{
namespace
{
TEST(ImitatedMammogram, AFieldBeginsAtTheChestWallAndIsCentredOnTheBreast)
{
  for (const DetectorField& field : { SmallField, LargeField })
  {
    for (const double up : { 1.0, -1.0 })
    {
      const RegistrationTarget grid = ImitatedDetector(0.5, up, field);
      // The left breast's chest wall is at the left, the right one's at the right.
      const int wall = up > 0 ? 0 : grid.Columns - 1;
      const ReceptorPoint first = PixelPosition(grid, wall, 0);
      const ReceptorPoint last = PixelPosition(grid, grid.Columns - 1 - wall, grid.Rows - 1);
      EXPECT_NEAR(first[0], -last[0], 1e-9);
      EXPECT_NEAR(up * (first[0] - last[0]), field.WidthMm - 0.5, 1e-9);
      EXPECT_NEAR(first[1], 0.25, 1e-9);
      EXPECT_NEAR(last[1], field.DepthMm - 0.25, 1e-9);
    }
  }
}

TEST(ImitatedMammogram, IsCutAtItsFrontAndNowhereElse)
{
  const RegistrationTarget grid = ImitatedDetector(10);
  std::vector<float> picture(grid.BreastMask.size(), 0.0F);
  EXPECT_FALSE(IsCutAtFront(picture, grid));
  const auto columns = static_cast<std::size_t>(grid.Columns);
  // All along the chest wall, both sides, and up to the last but one column.
  for (std::size_t pixel = 0; pixel < picture.size(); ++pixel)
  {
    picture[pixel] = pixel % columns + 1 < columns ? 1.0F : 0.0F;
  }
  EXPECT_FALSE(IsCutAtFront(picture, grid));
  picture[7 * columns - 1] = 0.01F;
  EXPECT_TRUE(IsCutAtFront(picture, grid));
  std::fill(picture.begin(), picture.end(), 0.0F);
  picture[7 * columns] = 0.01F;
  EXPECT_FALSE(IsCutAtFront(picture, grid));
  EXPECT_TRUE(IsCutAtFront(picture, ImitatedDetector(10, -1)));
}
}
}
