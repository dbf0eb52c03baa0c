// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/Private/Hanging.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace mammoray;

namespace
{
/// 100 mm along the chest wall and 60 mm away from it, in pixels of 0.5 mm.
ReceptorGrid MakeGrid()
{
  ReceptorGrid grid;
  grid.Columns = 120;
  grid.Rows = 200;
  grid.ColumnStep = { 0, 0.5 };
  grid.RowStep = { -0.5, 0 };
  grid.Origin = { 49.75, 0.25 };
  return grid;
}

Mammogram Of(const char* name, char laterality)
{
  Mammogram mammogram;
  mammogram.View = name;
  mammogram.Laterality = laterality;
  return mammogram;
}
}

TEST(Hanging, TheChestWallIsAtTheSideOfTheBreast)
{
  const ReceptorGrid grid = MakeGrid();
  const std::vector<unsigned char> all(120 * 200, 1);
  const Hanging left = Hang(Of("CC", 'L'), grid, all);
  EXPECT_EQ(left.Height, 900);
  EXPECT_EQ(left.Width, 540);
  EXPECT_EQ(left.Letters, (std::array<std::string, 4>{ "P", "A", "L", "R" }));
  EXPECT_NEAR(left.ToPicture(0, 0)[0], 0, 1e-9);
  EXPECT_NEAR(left.ToPicture(0, 0)[1], 450, 1e-9);
  EXPECT_NEAR(left.ToPicture(50, 0)[1], 900, 1e-9); // lateral up
  const Hanging right = Hang(Of("CC", 'R'), grid, all);
  EXPECT_EQ(right.Letters, (std::array<std::string, 4>{ "A", "P", "R", "L" }));
  EXPECT_NEAR(right.ToPicture(0, 0)[0], 540, 1e-9);
  EXPECT_NEAR(right.ToPicture(50, 0)[1], 0, 1e-9);
  const Hanging oblique = Hang(Of("MLO", 'L'), grid, all);
  EXPECT_EQ(oblique.Letters[2].front(), 'H'); // the head is up
}

TEST(Hanging, PicturePositionsGoBackToTheGantry)
{
  const Hanging hanging =
    Hang(Of("MLO", 'R'), MakeGrid(), std::vector<unsigned char>(120 * 200, 1));
  const auto at = hanging.ToPicture(12.5, 33);
  const auto back = hanging.ToGantry(at[0], at[1]);
  EXPECT_NEAR(back[0], 12.5, 1e-9);
  EXPECT_NEAR(back[1], 33, 1e-9);
}

TEST(Hanging, ShowsTheBreastWithAMargin)
{
  const ReceptorGrid grid = MakeGrid();
  std::vector<unsigned char> shown(120 * 200, 0);
  for (int row = 80; row < 120; ++row) // gantry x from -10 to 10 mm, y from 0 to 20
  {
    std::fill_n(shown.begin() + row * 120, 40, 1);
  }
  const Hanging hanging = Hang(Of("CC", 'L'), grid, shown);
  // 8 mm around it, within the image: 36 x 28 mm.
  EXPECT_NEAR(hanging.PixelMm, 36 / 900.0, 1e-12);
  EXPECT_EQ(hanging.Width, 700);
  EXPECT_NEAR(hanging.Centre[1], 14, 1e-12);
}

TEST(Hanging, ResamplingKeepsALinearImage)
{
  const ReceptorGrid grid = MakeGrid();
  std::vector<float> image;
  for (int row = 0; row < grid.Rows; ++row)
  {
    for (int column = 0; column < grid.Columns; ++column)
    {
      const double x = grid.Origin[0] + row * grid.RowStep[0];
      const double y = grid.Origin[1] + column * grid.ColumnStep[1];
      image.push_back(static_cast<float>(3 * x - 2 * y + 5));
    }
  }
  const Hanging hanging = Hang(Of("CC", 'L'), grid, std::vector<unsigned char>(image.size(), 1));
  const std::vector<float> hung = Resample(grid, image, hanging);
  for (int y = 10; y < hanging.Height - 10; y += 37)
  {
    for (int x = 10; x < hanging.Width - 10; x += 41)
    {
      const auto point = hanging.ToGantry(x + 0.5, y + 0.5);
      EXPECT_NEAR(hung[static_cast<std::size_t>(y) * hanging.Width + x],
        3 * point[0] - 2 * point[1] + 5, 1e-3); // floats around 100
    }
  }
}
