// SPDX-License-Identifier: Apache-2.0
#include "Refusals.h"
#include "mammoray/Registration/Private/AirLevel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace
{
using namespace mammoray;
using testing::HasSubstr;

/// 240 x 180 mm.
constexpr PixelGrid AirGrid{ 240, 180, 1, 1 };

/// A heel, an inverse square and an offset, in log attenuation.
double TrueLevel(int column, int row)
{
  const double x = column / 100.0;
  const double y = (row - 90) / 100.0;
  return -9 + 0.12 * x + 0.02 * x * x + 0.03 * y * y - 0.01 * x * y;
}

struct Sky
{
  std::vector<float> Values = std::vector<float>(AirGrid.Count());
  PixelMask Air = PixelMask(AirGrid.Count(), 1);
};

template <class Level>
Sky SkyOf(Level level, double noise)
{
  Sky sky;
  std::mt19937 generator(5);
  std::normal_distribution<double> normal(0, 1);
  for (int row = 0; row < AirGrid.Rows; ++row)
  {
    for (int column = 0; column < AirGrid.Columns; ++column)
    {
      sky.Values[AirGrid.Index(column, row)] =
        static_cast<float>(level(column, row) + noise * normal(generator));
    }
  }
  return sky;
}

/// Clears what lies in front of the chest wall, within `radius` of its middle.
void CoverByBreast(double radius, Sky& sky)
{
  for (int row = 0; row < AirGrid.Rows; ++row)
  {
    for (int column = 0; column < AirGrid.Columns; ++column)
    {
      if (std::hypot(column, row - 90) < radius)
      {
        sky.Values[AirGrid.Index(column, row)] = -6;
        sky.Air[AirGrid.Index(column, row)] = 0;
      }
    }
  }
}

double WorstError(const AirLevel& level)
{
  double worst = 0;
  for (int row = 0; row < AirGrid.Rows; ++row)
  {
    for (int column = 0; column < AirGrid.Columns; ++column)
    {
      worst = std::max(worst, std::abs(level.At(column, row) - TrueLevel(column, row)));
    }
  }
  return worst;
}

TEST(AirLevel, FollowsASlopingLevelUnderTheBreast)
{
  Sky sky = SkyOf(TrueLevel, 0.01);
  CoverByBreast(80, sky);
  const AirLevel level(AirGrid, sky.Values, sky.Air, 2.5);
  // Medians of 100 pixels of 1 %, 300 of them, told on under 80 mm of breast.
  EXPECT_LT(WorstError(level), 0.003);
  EXPECT_NEAR(level.Sigma(), 0.01, 0.001); // of 100 pixels a block, 2 % of all
  EXPECT_NEAR(level.LocalAt(200, 90), TrueLevel(200, 90), 0.003);
}

TEST(AirLevel, BlocksWithSomethingInThemDoNotBendIt)
{
  Sky sky = SkyOf(TrueLevel, 0.01);
  CoverByBreast(80, sky);
  for (int row = 20; row < 50; ++row) // a label that was taken for air
  {
    for (int column = 170; column < 210; ++column)
    {
      sky.Values[AirGrid.Index(column, row)] += 1;
    }
  }
  // Twelve of 300 blocks a hundred deviations off: Huber's loss counts each as one and a half.
  EXPECT_LT(WorstError(AirLevel(AirGrid, sky.Values, sky.Air, 2.5)), 0.006);
}

TEST(AirLevel, ScatterCountsBesideTheBreastOnly)
{
  const auto glow = [](int column, int row)
  { return -0.08 * std::exp(-std::max(0.0, std::hypot(column, row - 90) - 80) / 15); };
  Sky sky =
    SkyOf([&](int column, int row) { return TrueLevel(column, row) + glow(column, row); }, 0.005);
  CoverByBreast(85, sky);
  const AirLevel level(AirGrid, sky.Values, sky.Air, 2.5);
  // Averaged over a spread of 12 mm, to one side: a third of the glow.
  EXPECT_NEAR(level.LocalAt(90, 90), TrueLevel(90, 90) + glow(90, 90), 0.025);
  EXPECT_NEAR(level.LocalAt(200, 90), TrueLevel(200, 90), 0.005);
  // The smooth level is bent by a part of it.
  EXPECT_LT(WorstError(level), 0.03);
}

TEST(AirLevel, StaysTameWhereLittleAirIsSeen)
{
  Sky sky = SkyOf(TrueLevel, 0.01);
  for (std::size_t pixel = 0; pixel < sky.Air.size(); ++pixel)
  {
    sky.Air[pixel] = pixel % AirGrid.Columns >= 220; // a strip of 20 mm at the front
  }
  // It tells the slope over 200 mm to a part of the prior's 0.15 of 2.5 per 100 mm.
  EXPECT_LT(WorstError(AirLevel(AirGrid, sky.Values, sky.Air, 2.5)), 0.4);
  // A single pixel: its value everywhere.
  sky.Air.assign(sky.Air.size(), 0);
  sky.Air[AirGrid.Index(230, 100)] = 1;
  const AirLevel flat(AirGrid, sky.Values, sky.Air, 2.5);
  EXPECT_NEAR(flat.At(0, 0), sky.Values[AirGrid.Index(230, 100)], 1e-6);
  sky.Air.assign(sky.Air.size(), 0);
  EXPECT_THAT(test::RefusalOf([&] { AirLevel(AirGrid, sky.Values, sky.Air, 2.5); }),
    HasSubstr("expected air"));
}

TEST(AirLevel, AConstantIsOne)
{
  const Sky sky = SkyOf([](int, int) { return 1234.0; }, 0);
  const AirLevel level(AirGrid, sky.Values, sky.Air, 900);
  EXPECT_EQ(level.At(3, 5), 1234);
  EXPECT_EQ(level.LocalAt(200, 100), 1234);
  EXPECT_EQ(level.Sigma(), 0);
}
}
