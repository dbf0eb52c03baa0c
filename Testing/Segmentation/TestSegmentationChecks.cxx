// SPDX-License-Identifier: Apache-2.0
#include "Refusals.h"
#include "mammoray/Segmentation/BreastSegmentation.h"
#include "mammoray/Segmentation/Private/Plausibility.h"

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
using test::RefusalOf;
using testing::HasSubstr;

IntensityVolume TwoIntensities(const std::array<int, 3>& size, double spacing)
{
  IntensityVolume volume;
  volume.Size = size;
  volume.Spacing = { spacing, spacing, spacing };
  volume.Voxels.assign(static_cast<std::size_t>(size[0]) * size[1] * size[2], 5);
  volume.Voxels.back() = 6;
  return volume;
}

std::string VerdictOn(const IntensityVolume& volume)
{
  return RefusalOf([&] { CheckImage(volume, false); });
}

TEST(CheckImage, WantsVoxelsAndTwoIntensities)
{
  EXPECT_EQ(VerdictOn(TwoIntensities({ 8, 8, 8 }, 5)), NotRefused);
  EXPECT_THAT(VerdictOn(TwoIntensities({ 8, 7, 8 }, 5)), HasSubstr("found 8 x 7 x 8"));
  EXPECT_THAT(VerdictOn(TwoIntensities({ 1, 60, 60 }, 5)), HasSubstr("found 1 x 60 x 60"));
  IntensityVolume even = TwoIntensities({ 8, 8, 8 }, 5);
  even.Voxels.back() = 5;
  EXPECT_THAT(VerdictOn(even), test::Mentions("intensity 5"));
  IntensityVolume infinite = TwoIntensities({ 8, 8, 8 }, 5);
  infinite.Voxels[9] = std::numeric_limits<float>::infinity();
  EXPECT_THAT(VerdictOn(infinite), test::Mentions("(1, 1, 0)", "inf"));
}

TEST(CheckImage, WantsVoxelsOfAPatient)
{
  EXPECT_THAT(VerdictOn(TwoIntensities({ 8, 8, 8 }, 3200)),
    test::Mentions("voxel spacing", "0.05 to 10 mm", "3200", "AcceptUnusual"));
  EXPECT_NO_THROW(CheckImage(TwoIntensities({ 8, 8, 8 }, 3200), true));
  SegmentationOptions fine;
  fine.SpacingMm = 1e-3;
  EXPECT_THAT(RefusalOf([&] { fine.Validate(); }), HasSubstr("found 0.001"));
}

TEST(CheckImage, WantsAsManyMillimetresAsTheFiltersNeed)
{
  EXPECT_THAT(VerdictOn(TwoIntensities({ 64, 64, 29 }, 1)),
    test::Mentions("30 mm", "64 x 64 x 29"));
  EXPECT_EQ(VerdictOn(TwoIntensities({ 64, 64, 30 }, 1)), NotRefused);
  // No volume that is taken is too small for a filter on the way: air, fat and muscle in as little
  // as there may be, on voxels of any size. What is found there is no breast, and said so.
  for (const double spacing : { 0.3, 0.6, 1.0, 1.6, 2.3, 2.4, 2.5, 3.0, 3.9, 4.1, 6.0 })
  {
    IntensityVolume volume;
    const int voxels = std::max(8, static_cast<int>(std::ceil(30 / spacing - 1e-9)));
    volume.Size = { voxels, voxels, voxels };
    volume.Spacing = { spacing, spacing, spacing };
    std::mt19937 generator(1);
    std::normal_distribution<double> noise(0, 10);
    for (int voxel = 0; voxel < voxels * voxels * voxels; ++voxel)
    {
      const double part = static_cast<double>(voxel / voxels % voxels) / voxels;
      const double signal = part < 0.2 ? 0 : part < 0.7 ? 1000 : 350; // the front lies at -y
      volume.Voxels.push_back(static_cast<float>(std::abs(signal + noise(generator))));
    }
    const std::string verdict = RefusalOf([&] { SegmentBreast(volume, {}); });
    EXPECT_THAT(verdict, testing::Not(HasSubstr("ITK"))) << spacing;
  }
}

TEST(CheckSteps, WantsAirThatIsMoreThanZeros)
{
  IntensityVolume volume = TwoIntensities({ 8, 8, 8 }, 5);
  for (std::size_t voxel = 0; voxel < volume.Voxels.size(); ++voxel)
  {
    volume.Voxels[voxel] = 0.5f * static_cast<float>(voxel % 16);
  }
  const auto verdict = [&](double airThreshold)
  { return RefusalOf([&] { CheckSteps(volume, airThreshold); }); };
  EXPECT_THAT(verdict(0.4), HasSubstr("found air to end at 0.4 and steps of 0.5"));
  EXPECT_EQ(verdict(0.5), NotRefused);
  // A value between steps: no such steps. A drawing in few intensities has no noise.
  volume.Voxels[7] = 1.2f;
  EXPECT_EQ(verdict(0.4), NotRefused);
  volume.Voxels.assign(volume.Voxels.size(), 0.0f);
  volume.Voxels[7] = 100;
  volume.Voxels[8] = 200;
  EXPECT_EQ(verdict(10), NotRefused);
}

TEST(CheckSegmentationOptions, NamesTheOptionAndItsRange)
{
  const auto refusalOf = [](const std::function<void(SegmentationOptions&)>& change)
  {
    SegmentationOptions options;
    change(options);
    return RefusalOf([&] { options.Validate(); });
  };
  using Options = SegmentationOptions;
  EXPECT_EQ(refusalOf([](Options&) {}), NotRefused);
  EXPECT_THAT(refusalOf([](Options& o) { o.SpacingMm = -1; }), HasSubstr("spacing: expected 0 or"));
  EXPECT_THAT(refusalOf([](Options& o) { o.SpacingMm = std::numeric_limits<double>::quiet_NaN(); }),
    HasSubstr("found nan"));
  EXPECT_THAT(refusalOf([](Options& o) { o.SkinThicknessMm = -0.1; }), HasSubstr("skin thickness"));
  EXPECT_THAT(refusalOf([](Options& o) { o.ChestWallDepthMm = 0; }),
    HasSubstr("chest wall depth: expected a positive number of mm, found 0"));
  EXPECT_THAT(refusalOf([](Options& o) { o.Classes = 1; }), HasSubstr("classes: expected 2 to 5"));
  EXPECT_THAT(refusalOf([](Options& o) { o.Classes = 6; }), HasSubstr("found 6"));
  EXPECT_THAT(
    refusalOf([](Options& o) { o.AirThreshold = std::numeric_limits<double>::infinity(); }),
    HasSubstr("air threshold"));
  EXPECT_THAT(refusalOf([](Options& o) { o.SmallestGlandMm3 = -1; }), HasSubstr("smallest gland"));
  EXPECT_THAT(refusalOf([](Options& o) { o.GlandThreshold = 1; }), HasSubstr("gland threshold"));
  EXPECT_THAT(refusalOf([](Options& o) { o.GlandThreshold = 1.5; }), HasSubstr("found 1.5"));
  // Suppressed fat: gland lies above it, and may be given so.
  const auto dark = [](double threshold)
  {
    return [threshold](Options& o)
    {
      o.Contrast = FatContrast::FatDark;
      o.GlandThreshold = threshold;
    };
  };
  EXPECT_EQ(refusalOf(dark(1.5)), NotRefused);
  EXPECT_EQ(refusalOf(dark(0)), NotRefused);
  EXPECT_THAT(refusalOf(dark(1)), HasSubstr("gland threshold"));
}
}
