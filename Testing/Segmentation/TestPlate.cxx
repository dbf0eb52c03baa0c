// SPDX-License-Identifier: Apache-2.0
#include "MadeUpImages.h"
#include "mammoray/Segmentation/Private/Plate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace
{
using namespace mammoray;
using test::MadeUpHeights;

/// The largest difference of a plate and a formula over all columns at least `rim` from the rim.
double LargestAway(const HeightMap* plate, const std::function<double(int, int)>& height,
  int rim = 0)
{
  const auto size = plate->GetLargestPossibleRegion().GetSize();
  double largest = 0;
  for (int z = rim; z < static_cast<int>(size[1]) - rim; ++z)
  {
    for (int x = rim; x < static_cast<int>(size[0]) - rim; ++x)
    {
      const double away = std::abs(plate->GetPixel({ { x, z } }) - height(x, z));
      largest = away > largest || std::isnan(away) ? away : largest;
    }
  }
  return largest;
}

HeightMap::Pointer EvenWeights(int columns, int rows, double spacing)
{
  return MadeUpHeights(columns, rows, spacing, [](int, int) { return 1; });
}

TEST(FitPlate, APlaneIsNotBent)
{
  const auto plane = [](int x, int z) { return 40 + 0.5 * x - 0.25 * z; };
  const HeightMap::Pointer plate =
    FitPlate(MadeUpHeights(30, 20, 2, plane), EvenWeights(30, 20, 2), 20);
  // 1e-5 of the norm of all heights (600 columns of about 45 mm): the solver's tolerance.
  EXPECT_LT(LargestAway(plate, plane), 0.02);
  // Cells of 6 columns: heights go to the next node, half a column beside their own mean within and
  // a column and a half at the rim; with the slopes 0.5 and 0.25 that is at most 0.4 and 1.2 mm.
  const HeightMap::Pointer stiff =
    FitPlate(MadeUpHeights(90, 60, 2, plane), EvenWeights(90, 60, 2), 220);
  EXPECT_LT(LargestAway(stiff, plane), 1.2);
}

TEST(FitPlate, WavesAreDampedByTheStatedShare)
{
  // 1 / (1 + stiffness (2 - 2 cos k)^2) for waves of k along x, of the stated wavelength a half.
  constexpr double cellMm = 2;
  const double stiffness = std::pow(20 / (2 * std::numbers::pi * cellMm), 4.0);
  for (const double periodMm : { 10.0, 20.0, 40.0, 80.0 })
  {
    const double k = 2 * std::numbers::pi * cellMm / periodMm;
    const auto wave = [&](int x, int) { return 10 * std::cos(k * (x - 60)); };
    const HeightMap::Pointer plate =
      FitPlate(MadeUpHeights(121, 61, cellMm, wave), EvenWeights(121, 61, cellMm), 20);
    const double share = 1 / (1 + stiffness * std::pow(2 - 2 * std::cos(k), 2.0));
    // The free rim is forgotten over three wavelengths (30 columns): exp(-30 / sqrt(2) / 1.6). And
    // the solver's 1e-5 of the norm of 7381 columns of 7 mm.
    for (int x = 30; x <= 90; ++x)
    {
      EXPECT_NEAR(plate->GetPixel({ { x, 30 } }), share * wave(x, 30), 0.01)
        << periodMm << ' ' << x;
    }
    if (periodMm == 20)
    {
      EXPECT_NEAR(share, 0.5, 0.02); // but for the differences' own error, k^2 / 6
    }
  }
}

TEST(FitPlate, TurnsWithTheMap)
{
  std::mt19937 generator(2);
  std::uniform_real_distribution<double> height(20, 80);
  std::vector<double> values(15 * 15);
  std::generate(values.begin(), values.end(), [&] { return height(generator); });
  const auto given = [&](int x, int z) { return values[static_cast<std::size_t>(15 * z + x)]; };
  const HeightMap::Pointer plate =
    FitPlate(MadeUpHeights(15, 15, 2, given), EvenWeights(15, 15, 2), 30);
  const HeightMap::Pointer turned =
    FitPlate(MadeUpHeights(15, 15, 2, [&](int x, int z) { return given(z, x); }),
      EvenWeights(15, 15, 2), 30);
  // Twice the solver's tolerance, 1e-5 of the norm of 225 columns of 50 mm.
  EXPECT_LT(LargestAway(turned, [&](int x, int z) { return plate->GetPixel({ { z, x } }); }), 0.02);
  // Linear in the heights: twice the heights, and 7 mm more.
  const HeightMap::Pointer other =
    FitPlate(MadeUpHeights(15, 15, 2, [&](int x, int z) { return 2 * given(x, z) + 7; }),
      EvenWeights(15, 15, 2), 30);
  EXPECT_LT(LargestAway(other,
              [&](int x, int z) {
                return 2 * plate->GetPixel({ { x, z } }) + 7;
              }),
    0.04);
}

TEST(FitPlate, BendsOnStraightWhereNothingIsKnown)
{
  // Heights of a plane in the left half; the rest has a weight of 0 and heights that mislead.
  const auto plane = [](int x, int z) { return 30 + x + 0.5 * z; };
  const HeightMap::Pointer heights =
    MadeUpHeights(24, 16, 2, [&](int x, int z) { return x < 12 ? plane(x, z) : -1e6; });
  const HeightMap::Pointer weights =
    MadeUpHeights(24, 16, 2, [](int x, int) { return x < 12 ? 1 : 0; });
  const HeightMap::Pointer plate = FitPlate(heights, weights, 20);
  // The solver's 1e-5 of the norm (400 mm over 192 columns), carried on over 12 columns.
  EXPECT_LT(LargestAway(plate, plane), 0.3);
}

TEST(FitPlate, OneRowAndOneColumnAreMapsToo)
{
  const auto line = [](int x, int z) { return 10 + x + 2 * z; };
  EXPECT_LT(LargestAway(FitPlate(MadeUpHeights(12, 1, 2, line), EvenWeights(12, 1, 2), 20), line),
    0.01);
  EXPECT_LT(LargestAway(FitPlate(MadeUpHeights(1, 12, 2, line), EvenWeights(1, 12, 2), 20), line),
    0.01);
  EXPECT_LT(LargestAway(FitPlate(MadeUpHeights(1, 1, 2, line), EvenWeights(1, 1, 2), 20), line),
    0.01);
}

TEST(FitRobustPlate, OutliersDoNotCount)
{
  const auto plane = [](int x, int z) { return 60 + 0.2 * x - 0.3 * z; };
  // Every ninth column is 40 mm off, all to one side.
  const HeightMap::Pointer heights = MadeUpHeights(36, 27, 2,
    [&](int x, int z) { return plane(x, z) + (x % 3 == 0 && z % 3 == 0 ? 40 : 0); });
  const HeightMap::Pointer weights = EvenWeights(36, 27, 2);
  const HeightMap::Pointer plate = FitRobustPlate(heights, weights, 20, { 15, 8 });
  // At the end an outlier's weight is 0 and the plane is not bent; the solver's tolerance.
  EXPECT_LT(LargestAway(plate, plane), 0.05);
  // Without that they pull by their mean, 40 / 9.
  EXPECT_GT(LargestAway(FitPlate(heights, weights, 20), plane), 3);
}

TEST(FitParaboloid, IsTheOneGivenAndGoesOnWhereNothingIsKnown)
{
  const auto bowl = [](int x, int z)
  { return 80 + 0.3 * x - 0.2 * z - 0.02 * x * x + 0.004 * x * z - 0.01 * z * z; };
  const HeightMap::Pointer heights =
    MadeUpHeights(40, 24, 2, [&](int x, int z) { return x < 30 ? bowl(x, z) : 1e4; });
  const HeightMap::Pointer weights =
    MadeUpHeights(40, 24, 2, [](int x, int) { return x < 30 ? 0.5 : 0; });
  // The share of a millionth that settles what heights leave open, of heights of 90 mm.
  EXPECT_LT(LargestAway(FitParaboloid(heights, weights), bowl), 0.05);
  // The plate of this shape is not bent; a flat one goes on straight and misses by 0.02 10^2 or so.
  const HeightMap::Pointer curved =
    FitRobustPlate(heights, weights, 20, { 20, 15 }, PlateShape::Paraboloid);
  EXPECT_LT(LargestAway(curved, bowl), 0.1);
  EXPECT_GT(LargestAway(FitRobustPlate(heights, weights, 20, { 20, 15 }), bowl), 1);
}
}
