// SPDX-License-Identifier: Apache-2.0
#include "MadeUpImages.h"
#include "mammoray/Segmentation/Private/FatLevel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace
{
using namespace mammoray;
using test::MadeUpImage;

/// 100 x 80 x 80 mm of cubes of 2 mm.
constexpr std::array<int, 3> FieldSize{ 50, 40, 40 };

FloatImage::Pointer Field(const std::function<double(int, int, int)>& value)
{
  return MadeUpImage<FloatImage>(FieldSize, { 2, 2, 2 }, value);
}

MaskImage::Pointer Region(const std::function<bool(int, int, int)>& in)
{
  return MadeUpImage<MaskImage>(FieldSize, { 2, 2, 2 },
    [&](int x, int y, int z) { return in(x, y, z) ? 1 : 0; });
}

bool Everywhere(int, int, int)
{
  return true;
}

/// A coil's sensitivity: falls by a factor of 3 over 100 mm, a little across.
double Sensitivity(int x, int, int z)
{
  return std::exp(-1.1 * x / 50.0 + 0.1 * std::cos(z / 13.0));
}

/// The range of one image over another.
std::array<double, 2> RangeOver(const FloatImage* image,
  const std::function<double(int, int, int)>& expected, int rim = 0)
{
  std::array<double, 2> range{ std::numeric_limits<double>::max(), 0 };
  for (int z = rim; z < FieldSize[2] - rim; ++z)
  {
    for (int y = rim; y < FieldSize[1] - rim; ++y)
    {
      for (int x = rim; x < FieldSize[0] - rim; ++x)
      {
        const double ratio = image->GetPixel({ { x, y, z } }) / expected(x, y, z);
        range[0] = ratio < range[0] ? ratio : range[0];
        range[1] = ratio > range[1] || std::isnan(ratio) ? ratio : range[1];
      }
    }
  }
  return range;
}

TEST(FatLevel, OfOneIntensityIsThatIntensity)
{
  for (const double intensity : { 1e-3, 1.0, 1e5 })
  {
    const FloatImage::Pointer image = Field([&](int, int, int) { return intensity; });
    for (const bool even : { false, true })
    {
      const FloatImage::Pointer level = FindFatLevel(image, Region(Everywhere), true, even, 0);
      ASSERT_TRUE(level);
      const auto range = RangeOver(level, [&](int, int, int) { return intensity; });
      // 1e-5 of the logarithm (up to 12) by the recursive filter in floats.
      EXPECT_NEAR(range[0], 1, 2e-4) << intensity;
      EXPECT_NEAR(range[1], 1, 2e-4) << intensity;
    }
  }
}

TEST(FatLevel, FollowsTheCoilWhateverTheGland)
{
  // Balls of gland of 10 mm on a lattice of 26 mm, a fifth of the volume.
  const auto isGland = [](int x, int y, int z)
  { return std::hypot(x % 13 - 6, y % 13 - 6, z % 13 - 6) < 5; };
  for (const bool fatBright : { true, false })
  {
    std::mt19937 generator(5);
    std::normal_distribution<double> noise(0, 0.02);
    const double gland = fatBright ? 0.4 : 2.5;
    const FloatImage::Pointer image = Field(
      [&](int x, int y, int z)
      {
        return 1000 * Sensitivity(x, y, z) * (isGland(x, y, z) ? gland : 1) *
          std::exp(noise(generator));
      });
    const FloatImage::Pointer level = FindFatLevel(image, Region(Everywhere), fatBright, false, 0);
    ASSERT_TRUE(level);
    const auto range = RangeOver(
      level, [](int x, int y, int z) { return 1000 * Sensitivity(x, y, z); }, 6);
    // The mean of a slope of 1.1 % per mm over 12 mm within, lopsided up to 12 mm from the border;
    // gland, which lies 0.9 away in the logarithm, has no weight.
    EXPECT_GT(range[0], 0.93) << fatBright;
    EXPECT_LT(range[1], 1.07) << fatBright;
  }
}

TEST(FatLevel, DoesNotRiseInCompactGland)
{
  // A ball of gland of 56 mm, wider than the reach of the estimate, under an even coil.
  const auto isGland = [](int x, int y, int z) { return std::hypot(x - 25, y - 20, z - 20) < 14; };
  for (const bool fatBright : { true, false })
  {
    const double gland = fatBright ? 0.7 : 1.5;
    std::mt19937 generator(9);
    std::normal_distribution<double> noise(0, 0.05);
    const FloatImage::Pointer image = Field([&](int x, int y, int z)
      { return 1000 * (isGland(x, y, z) ? gland : 1) * std::exp(noise(generator)); });
    const FloatImage::Pointer level =
      FindFatLevel(image, Region(Everywhere), fatBright, false, gland);
    const auto range = RangeOver(
      level, [](int, int, int) { return 1000; }, 6);
    EXPECT_GT(range[0], 0.95) << fatBright;
    EXPECT_LT(range[1], 1.05) << fatBright;
  }
}

TEST(FatLevel, IsNoneWithHardlyAVoxel)
{
  const FloatImage::Pointer image = Field([](int, int, int) { return 100; });
  EXPECT_FALSE(FindFatLevel(image, Region([](int, int, int) { return false; }), true, false, 0));
  EXPECT_FALSE(FindFatLevel(image, Region([](int x, int y, int z) { return x < 49 && y + z == 0; }),
    true, false, 0));
  EXPECT_TRUE(
    FindFatLevel(image, Region([](int, int y, int z) { return y + z == 0; }), true, false, 0));
  // Zeros have no logarithm and are not fat.
  const FloatImage::Pointer zeros = Field([](int, int, int) { return 0; });
  EXPECT_FALSE(FindFatLevel(zeros, Region(Everywhere), true, false, 0));
}

TEST(FatLevel, StaysWithinTheRegionsFatFarFromIt)
{
  // A region of 24 mm whose fat's logarithm falls by 1, in one corner of a long volume.
  const std::array<int, 3> size{ 150, 20, 20 };
  const FloatImage::Pointer image = MadeUpImage<FloatImage>(size, { 2, 2, 2 },
    [](int x, int, int) { return 1000 * std::exp(-x / 12.0); });
  const MaskImage::Pointer region =
    MadeUpImage<MaskImage>(size, { 2, 2, 2 }, [](int x, int, int) { return x < 12 ? 1 : 0; });
  const FloatImage::Pointer level = FindFatLevel(image, region, true, false, 0);
  ASSERT_TRUE(level);
  for (int x = 0; x < 150; ++x)
  {
    // The mean of what the region holds, wherever it is: between its extremes.
    const float here = level->GetPixel({ { x, 10, 10 } });
    EXPECT_GE(here, 1000 * std::exp(-1.0)) << x;
    EXPECT_LE(here, 1000) << x;
  }
}

TEST(FatLevel, IsAMeanOfTheRegionWhereTheCoilIsSteep)
{
  // Beside a coil the sensitivity falls by 5 % per mm, so that the first guess misses most of the
  // fat and tails of the means' filter decide (before they were held: a level of 1.5e7).
  constexpr std::array<int, 3> size{ 80, 60, 60 };
  std::mt19937 generator(3);
  std::normal_distribution<double> noise(0, 0.1);
  std::array<double, 2> range{ 1e9, 0 };
  const auto inRegion = [](int x, int y, int z) { return x < 30 && y < 30 && z < 30; };
  const FloatImage::Pointer image = MadeUpImage<FloatImage>(size, { 2, 2, 2 },
    [&](int x, int y, int z)
    {
      const bool gland = std::hypot(x % 13 - 6, y % 13 - 6, z % 13 - 6) < 5;
      const double value = 1000 * std::exp(noise(generator) - y / 10.0) * (gland ? 2.2 : 1);
      range = inRegion(x, y, z)
        ? std::array<double, 2>{ std::min(range[0], value), std::max(range[1], value) }
        : range;
      return value;
    });
  const MaskImage::Pointer region = MadeUpImage<MaskImage>(size, { 2, 2, 2 },
    [&](int x, int y, int z) { return inRegion(x, y, z) ? 1 : 0; });
  const FloatImage::Pointer level = FindFatLevel(image, region, false, false, 0);
  ASSERT_TRUE(level);
  const float* levels = level->GetBufferPointer();
  const auto [lowest, highest] = std::minmax_element(levels, levels + CountOf(*level));
  EXPECT_GE(*lowest, range[0]);
  EXPECT_LE(*highest, range[1]);
}

TEST(FatLevel, EvenIsOneLevelAndScalesWithTheImage)
{
  const FloatImage::Pointer image =
    Field([](int x, int y, int z) { return 1000 * Sensitivity(x, y, z); });
  const FloatImage::Pointer twice =
    Field([](int x, int y, int z) { return 2000 * Sensitivity(x, y, z); });
  for (const bool even : { false, true })
  {
    const FloatImage::Pointer level = FindFatLevel(image, Region(Everywhere), true, even, 0);
    const FloatImage::Pointer twiceLevel = FindFatLevel(twice, Region(Everywhere), true, even, 0);
    for (std::size_t voxel = 0; voxel < CountOf(*image); ++voxel)
    {
      const float here = level->GetBufferPointer()[voxel];
      // Floats of the logarithm, 7.
      ASSERT_NEAR(twiceLevel->GetBufferPointer()[voxel] / here, 2, 1e-3);
      ASSERT_TRUE(!even || here == level->GetBufferPointer()[0]);
    }
  }
}

TEST(Divide, IsTheRatioAndFiniteOverZero)
{
  const FloatImage::Pointer image = Field([](int x, int, int) { return x; });
  const FloatImage::Pointer level = Field([](int, int y, int) { return y; });
  const FloatImage::Pointer ratio = Divide(image, level);
  EXPECT_FLOAT_EQ(ratio->GetPixel({ { 30, 20, 5 } }), 1.5f);
  EXPECT_EQ(ratio->GetPixel({ { 0, 0, 5 } }), 0);
}

TEST(Fatness, IsOneInFatAndNothingInMuscleAndBeyond)
{
  // Bands of 16 mm along x: fat, between, muscle, darker than muscle; and no tissue for y < 20.
  const auto tissue = Region([](int, int y, int) { return y >= 20; });
  const auto band = [](int x) { return std::min(3, x / 12); };
  const auto fatnessOf = [&](const std::array<double, 4>& levels, double muscle, bool fatBright)
  {
    return Fatness(Field([&](int x, int, int) { return levels[band(x)]; }), tissue, muscle,
      fatBright);
  };
  const FloatImage::Pointer bright = fatnessOf({ 1.0, 0.7, 0.4, 0.1 }, 0.4, true);
  const FloatImage::Pointer dark = fatnessOf({ 1.0, 1.5, 2.0, 3.0 }, 2.0, false);
  for (const FloatImage::Pointer& fatness : { bright, dark })
  {
    // 1e-3: the Gaussian of 1 mm over the 12 mm from a band's middle to its end.
    EXPECT_NEAR(fatness->GetPixel({ { 5, 30, 20 } }), 1, 1e-3);
    EXPECT_NEAR(fatness->GetPixel({ { 17, 30, 20 } }), 0.5, 1e-3);
    EXPECT_NEAR(fatness->GetPixel({ { 29, 30, 20 } }), 0, 1e-3);
    EXPECT_NEAR(fatness->GetPixel({ { 45, 30, 20 } }), 0, 1e-3);
    EXPECT_NEAR(fatness->GetPixel({ { 5, 8, 20 } }), 0, 1e-3);
  }
  // Muscle hardly told from fat: as if it lay at the limit, so that noise does not decide.
  EXPECT_NEAR(fatnessOf({ 0.9, 0.9, 0.9, 0.9 }, 0.99, true)->GetPixel({ { 5, 30, 20 } }),
    (0.9 - BrightestMuscle) / (1 - BrightestMuscle), 1e-3);
  EXPECT_NEAR(fatnessOf({ 1.1, 1.1, 1.1, 1.1 }, 1.01, false)->GetPixel({ { 5, 30, 20 } }),
    (1.1 - DarkestMuscle) / (1 - DarkestMuscle), 1e-3);
}
}
