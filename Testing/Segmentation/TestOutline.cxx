// SPDX-License-Identifier: Apache-2.0
#include "MadeUpImages.h"
#include "mammoray/Segmentation/Private/Masks.h"
#include "mammoray/Segmentation/Private/Outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace
{
using namespace mammoray;
using test::MadeUpImage;
using test::NumberDifferent;
using test::NumberSet;

/// Cubes of 2 mm; 64 x 60 x 48 mm, air before y = 36 mm (18 voxels).
constexpr std::array<int, 3> ScanSize{ 32, 30, 24 };
constexpr int BodyVoxels = 18;

/// A magnitude image: what a formula says, plus noise of both channels with its deviation there.
FloatImage::Pointer Magnitude(const std::function<double(int, int, int)>& signal,
  const std::function<double(int, int, int)>& deviation)
{
  std::mt19937 generator(23);
  std::normal_distribution<double> normal(0, 1);
  return MadeUpImage<FloatImage>(ScanSize, { 2, 2, 2 },
    [&](int x, int y, int z)
    {
      const double d = deviation(x, y, z);
      const double real = signal(x, y, z) + d * normal(generator);
      return std::hypot(real, d * normal(generator));
    });
}

MaskImage::Pointer MaskOf(const std::function<bool(int, int, int)>& in)
{
  return MadeUpImage<MaskImage>(ScanSize, { 2, 2, 2 },
    [&](int x, int y, int z) { return in(x, y, z) ? 1 : 0; });
}

bool InSlab(int, int y, int)
{
  return y < BodyVoxels;
}

TEST(FindOutline, SplitsAirFromBody)
{
  const auto body = [](int x, int y, int z) { return InSlab(x, y, z) ? 300 : 0; };
  const FloatImage::Pointer image = Magnitude(body, [](int, int, int) { return 10; });
  const Outline outline = FindOutline(image, image, 0);
  EXPECT_EQ(NumberDifferent(outline.Body, MaskOf(InSlab)), 0u);
  EXPECT_EQ(NumberDifferent(outline.Tissue, MaskOf(InSlab)), 0u);
  EXPECT_GT(outline.AirThreshold, 13); // the noise's mean
  EXPECT_LT(outline.AirThreshold, 300);
  // 300 over the mean of Rayleigh's noise, 10 sqrt(pi / 2): medians of smoothed images.
  EXPECT_NEAR(outline.Contrast, 300 / 12.53, 2);
}

TEST(FindOutline, DoesNotDependOnTheUnit)
{
  const auto body = [](int x, int y, int z) { return InSlab(x, y, z) ? 300 : 0; };
  for (const double unit : { 1e-3, 1.0, 1e3 })
  {
    const FloatImage::Pointer image =
      Magnitude([&](int x, int y, int z) { return unit * body(x, y, z); },
        [&](int, int, int) { return 10 * unit; });
    const Outline outline = FindOutline(image, image, 0);
    EXPECT_EQ(NumberDifferent(outline.Body, MaskOf(InSlab)), 0u) << unit;
    EXPECT_NEAR(outline.Contrast, 300 / 12.53, 2) << unit;
  }
}

TEST(FindOutline, TakesTheGivenThreshold)
{
  // Three levels: a given threshold decides to which side the middle one goes.
  const auto levels = [](int, int y, int) { return y < 10 ? 300 : y < BodyVoxels ? 100 : 5; };
  const FloatImage::Pointer image = MadeUpImage<FloatImage>(ScanSize, { 2, 2, 2 }, levels);
  const Outline low = FindOutline(image, image, 50);
  EXPECT_EQ(low.AirThreshold, 50);
  EXPECT_EQ(NumberDifferent(low.Body, MaskOf(InSlab)), 0u);
  const Outline high = FindOutline(image, image, 200);
  EXPECT_EQ(NumberDifferent(high.Body, MaskOf([](int, int y, int) { return y < 10; })), 0u);
  EXPECT_EQ(high.Threshold->GetPixel({ { 3, 25, 3 } }), 200);
}

TEST(FindOutline, DarkCavitiesAreBodyAndNoTissue)
{
  const auto inCavity = [](int x, int y, int z)
  { return std::abs(x - 16) < 6 && y > 3 && y < 12 && std::abs(z - 12) < 6; };
  const auto body = [&](int x, int y, int z)
  { return InSlab(x, y, z) && !inCavity(x, y, z) ? 300 : 0; };
  const FloatImage::Pointer image = Magnitude(body, [](int, int, int) { return 10; });
  const Outline outline = FindOutline(image, image, 0);
  EXPECT_EQ(NumberDifferent(outline.Body, MaskOf(InSlab)), 0u);
  EXPECT_EQ(outline.Tissue->GetPixel({ { 16, 8, 12 } }), 0);
  // The cavity of 11 x 8 x 11 voxels: smoothing by half a voxel moves its face by none or one.
  EXPECT_NEAR(static_cast<double>(NumberSet(MaskOf(InSlab)) - NumberSet(outline.Tissue)),
    11 * 8 * 11, 2 * (2 * 11 * 8 + 11 * 11));
}

TEST(FindOutline, GhostsAndWhatHangsByAThreadAreNoBody)
{
  // Before the body a ghost that touches nothing, and a coil's shell on a bridge one voxel thick.
  const auto isGhost = [](int x, int y, int z) { return x < 7 && y > 20 && y < 26 && z < 9; };
  const auto isShell = [](int x, int y, int) { return x > 14 && x < 26 && y > 22 && y < 27; };
  const auto isBridge = [](int x, int y, int z)
  { return x == 20 && y >= BodyVoxels && y <= 22 && z == 12; };
  const auto bright = [&](int x, int y, int z)
  { return InSlab(x, y, z) || isGhost(x, y, z) || isShell(x, y, z) || isBridge(x, y, z); };
  const FloatImage::Pointer image =
    Magnitude([&](int x, int y, int z) { return bright(x, y, z) ? 300 : 0; },
      [](int, int, int) { return 10; });
  const Outline outline = FindOutline(image, image, 0);
  EXPECT_GT(NumberSet(outline.Tissue), NumberSet(MaskOf(InSlab)) + 500);
  std::size_t beyond = 0;
  for (int z = 0; z < ScanSize[2]; ++z)
  {
    for (int x = 0; x < ScanSize[0]; ++x)
    {
      for (int y = 0; y < ScanSize[1]; ++y)
      {
        const bool set = outline.Body->GetPixel({ { x, y, z } }) != 0;
        ASSERT_TRUE(set || !InSlab(x, y, z)) << x << ' ' << y << ' ' << z;
        ASSERT_TRUE(!set || InSlab(x, y, z) || isBridge(x, y, z)) << x << ' ' << y << ' ' << z;
        beyond += set && !InSlab(x, y, z) ? 1 : 0;
      }
    }
  }
  // The bridge's root only, within the ball of 6 mm around the body's core.
  EXPECT_LE(beyond, 3u);
}

TEST(FindOutline, AmplifiedNoiseIsAir)
{
  // A scanner evens out its coil: away from the body, towards x = 0, noise is as bright as fat.
  const auto body = [](int x, int y, int z) { return InSlab(x, y, z) && x > 5 ? 300 : 0; };
  const auto deviation = [](int x, int, int) { return x < 12 ? 120.0 - 8.5 * x : 18.0; };
  const FloatImage::Pointer image = Magnitude(body,
    [&](int x, int y, int z) { return body(x, y, z) > 0 ? 15 : deviation(x, y, z); });
  const Outline outline = FindOutline(image, image, 0);
  const MaskImage::Pointer truth =
    MaskOf([](int x, int y, int z) { return InSlab(x, y, z) && x > 5; });
  // The rim along the loud noise, 18 x 24 voxels, is found to a voxel.
  EXPECT_LT(NumberDifferent(outline.Body, truth), 2u * 18 * 24);
  // A plain threshold takes the noise for tissue.
  const Outline plain = FindOutline(image, image, outline.AirThreshold);
  EXPECT_GT(NumberDifferent(plain.Tissue, truth), NumberDifferent(outline.Tissue, truth) + 500);
}

TEST(FindOutline, LeavesOutPlanesAsDarkAsNoise)
{
  // Towards the feet the signal falls off: 20 mm at the noise, then rising.
  const auto signal = [](int x, int y, int z) {
    return !InSlab(x, y, z) ? 0.0 : z < 10 ? 0.0 : 20.0 * (z - 9);
  };
  const Outline outline = FindOutline(Magnitude(signal, [](int, int, int) { return 10; }),
    Magnitude(signal, [](int, int, int) { return 10; }), 0);
  // Noise has a mean of 12.5; tissue is twice as bright from plane 10 or 11 on, a few by the reach
  // of its level.
  EXPECT_GE(outline.Planes[0], 8);
  EXPECT_LE(outline.Planes[0], 13);
  EXPECT_EQ(outline.Planes[1], ScanSize[2] - 1);
  EXPECT_GT(outline.Clarity->GetPixel({ { 16, 8, 22 } }), 4);
  // The body goes on beyond as in the first plane that counts.
  for (int y = 0; y < ScanSize[1]; ++y)
  {
    EXPECT_EQ(outline.Body->GetPixel({ { 16, y, 0 } }),
      outline.Body->GetPixel({ { 16, y, outline.Planes[0] } }))
      << y;
  }
}

TEST(FindOutline, WithoutAirEverythingIsBody)
{
  const FloatImage::Pointer image =
    Magnitude([](int, int, int) { return 300; }, [](int, int, int) { return 10; });
  const Outline outline = FindOutline(image, image, 50);
  EXPECT_EQ(NumberSet(outline.Body), CountOf(*image));
  EXPECT_EQ(outline.Contrast, 0);
  const Outline nothing = FindOutline(image, image, 1000);
  EXPECT_EQ(NumberSet(nothing.Body), 0u);
  EXPECT_EQ(nothing.Contrast, 0);
}

TEST(SkinThreshold, IsAShareOfTheRimOfTheBody)
{
  // The outer 4 mm at 120, the rest at 400, which must not count.
  const FloatImage::Pointer image = MadeUpImage<FloatImage>(ScanSize, { 2, 2, 2 },
    [](int, int y, int) { return y < BodyVoxels - 2 ? 400
                            : y < BodyVoxels        ? 120
                                                    : 2; });
  Outline outline;
  outline.Body = MaskOf(InSlab);
  outline.Threshold = MadeUpImage<FloatImage>(ScanSize, { 2, 2, 2 },
    [](int x, int, int) { return x < 16 ? 10 : 50; });
  const FloatImage::Pointer bright = SkinThreshold(outline, image, true);
  const FloatImage::Pointer dark = SkinThreshold(outline, image, false);
  for (int y = BodyVoxels - 3; y < BodyVoxels + 3; ++y)
  {
    // Means of equal values: rounding of the recursive filter.
    EXPECT_NEAR(bright->GetPixel({ { 4, y, 12 } }), 0.25 * 120, 0.01) << y;
    EXPECT_NEAR(dark->GetPixel({ { 4, y, 12 } }), 0.55 * 120, 0.01) << y;
    // No less than the outline's own.
    EXPECT_NEAR(bright->GetPixel({ { 28, y, 12 } }), 50, 0.01) << y;
  }
  // Far from the skin there is none.
  EXPECT_EQ(dark->GetPixel({ { 4, 0, 12 } }), 10);
}
}
