// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/Display.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

namespace
{
using namespace mammoray;

constexpr int Size = 120;

XRayDetector DisplayDetector()
{
  XRayDetector detector;
  detector.ColumnStep = { 0.5, 0, 0 };
  detector.RowStep = { 0, 0.5, 0 };
  detector.Columns = Size;
  detector.Rows = Size;
  return detector;
}

/// A breast that thins towards a rim at column 90, with a bar that absorbs a little more.
Exposure MakeExposure()
{
  Exposure exposure;
  auto lengths = std::make_shared<PathLengthImage>();
  lengths->Columns = Size;
  lengths->Rows = Size;
  lengths->Materials = 2;
  lengths->Lengths.resize(2 * Size * Size);
  for (int row = 0; row < Size; ++row)
  {
    for (int column = 0; column < Size; ++column)
    {
      const double depth = 0.5 * (90 - column);
      const double thickness =
        depth <= 0 ? 0 : 50 * std::sqrt(1 - std::pow(1 - std::min(depth, 15.0) / 15, 2));
      const auto pixel = static_cast<std::size_t>(row * Size + column);
      lengths->Lengths[Size * Size + pixel] = static_cast<float>(thickness);
      const double bar = row > 55 && row < 65 && thickness > 0 ? 0.1 : 0;
      exposure.LogAttenuation.push_back(static_cast<float>(0.05 * thickness + bar));
      exposure.Transmission.push_back(std::exp(-exposure.LogAttenuation.back()));
    }
  }
  exposure.Lengths = std::move(lengths);
  return exposure;
}

TEST(Display, ShowsTheRimAsTheMidstAndAirBlack)
{
  const Exposure exposure = MakeExposure();
  DisplayOptions options;
  const std::vector<float> shown = DisplayValues(exposure, DisplayDetector(), options);
  options.RimShare = 0;
  const std::vector<float> plain = DisplayValues(exposure, DisplayDetector(), options);
  const auto at = [](const std::vector<float>& values, int row, int column)
  { return values[static_cast<std::size_t>(row * Size + column)]; };
  // Six mm from the skin line against the midst, by the contrast of the bar, since the window goes
  // with what is to be shown.
  const auto darkness = [&](const std::vector<float>& values)
  { return (at(values, 20, 20) - at(values, 20, 78)) / (at(values, 60, 20) - at(values, 40, 20)); };
  EXPECT_LT(darkness(shown), 0.6F * darkness(plain));
  // The bar is brighter than what is beside it, at the rim, too.
  EXPECT_GT(at(shown, 60, 20), at(shown, 40, 20));
  EXPECT_GT(at(shown, 60, 84), at(shown, 40, 84));
  EXPECT_LT(at(shown, 20, 110), 0.1F);
  for (const float value : shown)
  {
    ASSERT_GE(value, 0);
    ASSERT_LE(value, 1);
  }
}

TEST(Display, MoreDetailIsMoreContrast)
{
  DisplayOptions options;
  options.DetailShare = 0;
  options.WindowDeviations = 20;
  const std::vector<float> plain = DisplayValues(MakeExposure(), DisplayDetector(), options);
  options.DetailShare = 2;
  const std::vector<float> sharp = DisplayValues(MakeExposure(), DisplayDetector(), options);
  const auto contrast = [](const std::vector<float>& values)
  { return values[56 * Size + 20] - values[55 * Size + 20]; };
  EXPECT_GT(contrast(sharp), 1.3F * contrast(plain));
}

TEST(Display, RefusesAirAndOptionsOutOfRange)
{
  Exposure air = MakeExposure();
  auto nothing = std::make_shared<PathLengthImage>(*air.Lengths);
  std::fill(nothing->Lengths.begin(), nothing->Lengths.end(), 0.0F);
  air.Lengths = nothing;
  EXPECT_THROW(DisplayValues(air, DisplayDetector()), InputError);
  DisplayOptions options;
  options.RimMm = 0;
  EXPECT_THROW(DisplayValues(MakeExposure(), DisplayDetector(), options), InputError);
  options = {};
  options.WindowDeviations = NAN;
  EXPECT_THROW(DisplayValues(MakeExposure(), DisplayDetector(), options), InputError);
}
}
