// SPDX-License-Identifier: Apache-2.0
#include "MadeUpImages.h"
#include "mammoray/Segmentation/Private/Valley.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace
{
using namespace mammoray;
using test::MadeUpHeights;

/// The valley of a profile over x, columns of 2 mm, seen before a wall at 10 mm and a cut at 5 mm.
Valley ValleyOf(const std::vector<double>& profile)
{
  const int columns = static_cast<int>(profile.size());
  // Other rows are lower, and hidden behind the one that is seen.
  const HeightMap::Pointer skin = MadeUpHeights(columns, 3, 2,
    [&](int x, int z) { return profile[static_cast<std::size_t>(x)] - (z == 1 ? 0 : 20); });
  const HeightMap::Pointer wall = MadeUpHeights(columns, 3, 2, [](int, int) { return 10; });
  return DeepestValley(skin, wall, 5);
}

TEST(Valley, LiesBetweenTheTwoHillsBelowTheLower)
{
  const Valley valley = ValleyOf({ 20, 60, 90, 70, 40, 55, 80, 75, 30 });
  EXPECT_DOUBLE_EQ(valley.DepthMm, 40); // 80 - 40: the lower of the two
  EXPECT_DOUBLE_EQ(valley.MiddleMm, 9); // the middle of column 4
}

TEST(Valley, IsTheSameMirrored)
{
  const std::vector<double> profile{ 20, 60, 90, 70, 40, 41, 80, 75, 30, 32 };
  const Valley valley = ValleyOf(profile);
  const Valley mirrored = ValleyOf({ profile.rbegin(), profile.rend() });
  EXPECT_DOUBLE_EQ(valley.DepthMm, 40);
  EXPECT_DOUBLE_EQ(valley.MiddleMm, 10); // between columns 4 and 5: both are within 3 mm
  EXPECT_DOUBLE_EQ(mirrored.DepthMm, valley.DepthMm);
  EXPECT_DOUBLE_EQ(mirrored.MiddleMm, 20 - valley.MiddleMm);
}

TEST(Valley, ItsMiddleIsThatOfItsFloor)
{
  // A floor of five columns with dents, one slope steep and one gentle.
  const Valley valley = ValleyOf({ 90, 42, 41, 40, 42.9, 42, 44, 60, 85, 90 });
  EXPECT_DOUBLE_EQ(valley.DepthMm, 50);
  EXPECT_DOUBLE_EQ(valley.MiddleMm, 7); // columns 1 to 5
}

TEST(Valley, OfEqualBreastsIsAmidThem)
{
  std::vector<double> profile;
  for (int x = 0; x < 60; ++x)
  {
    profile.push_back(60 - 30 * std::cos(4 * std::numbers::pi * (x + 0.5) / 60));
  }
  const Valley valley = ValleyOf(profile);
  // The hills at 15 and 45 and the floor at 30 lie between columns: 30 (1 - cos(pi / 30)) each.
  EXPECT_NEAR(valley.DepthMm, 60, 0.4);
  EXPECT_DOUBLE_EQ(valley.MiddleMm, 60);
}

TEST(Valley, OneBreastHasNone)
{
  EXPECT_EQ(ValleyOf({ 20, 40, 60, 80, 60, 40, 20 }).DepthMm, 0);
  EXPECT_EQ(ValleyOf({ 80, 60, 40, 20 }).DepthMm, 0);
  EXPECT_EQ(ValleyOf({ 20, 40, 60, 80 }).DepthMm, 0);
  EXPECT_EQ(ValleyOf({ 50, 50, 50 }).DepthMm, 0);
  EXPECT_EQ(ValleyOf({ 50 }).DepthMm, 0);
}

TEST(Valley, IsTheDeepestOfSeveral)
{
  const Valley right = ValleyOf({ 60, 50, 90, 30, 70, 20 });
  EXPECT_DOUBLE_EQ(right.DepthMm, 40);
  EXPECT_DOUBLE_EQ(right.MiddleMm, 7);
  const Valley left = ValleyOf({ 60, 15, 90, 50, 70, 20 });
  EXPECT_DOUBLE_EQ(left.DepthMm, 45);
  EXPECT_DOUBLE_EQ(left.MiddleMm, 3);
}

TEST(Valley, ColumnsBehindTheWallOrTheCutHaveNoHeight)
{
  // What stands behind the wall (10 mm) beyond the side of one breast is no second one.
  EXPECT_EQ(ValleyOf({ 30, 80, 40, 9, 9.5, 8 }).DepthMm, 0);
  EXPECT_EQ(ValleyOf({ -1, 80, 40, -1 }).DepthMm, 0);
  // Rows count where they are before the wall only, wherever others are.
  const HeightMap::Pointer skin =
    MadeUpHeights(5, 2, 1, [](int x, int z) { return z == 1 || x == 2 ? 50 : 80; });
  const HeightMap::Pointer wall =
    MadeUpHeights(5, 2, 1, [](int, int z) { return z == 1 ? 60 : 10; });
  EXPECT_DOUBLE_EQ(DeepestValley(skin, wall, 0).DepthMm, 30);
  EXPECT_DOUBLE_EQ(DeepestValley(skin, wall, 49).DepthMm, 30);
  EXPECT_DOUBLE_EQ(DeepestValley(skin, wall, 90).DepthMm, 0);
}
}
