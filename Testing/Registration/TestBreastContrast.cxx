// SPDX-License-Identifier: Apache-2.0
#include "Refusals.h"
#include "mammoray/Registration/Private/BreastContrast.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace
{
using namespace mammoray;
using test::RefusalOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr PixelGrid FlatGrid{ 80, 60, 0.5, 0.5 };

bool IsBreastColumn(int column)
{
  return column < 35;
}

/// A breast that lets exp(-2) through beside air of 10000 counts, with 1 % of noise.
Mammogram FlatBreast(double air = 10000)
{
  Mammogram mammogram;
  mammogram.Columns = FlatGrid.Columns;
  mammogram.Rows = FlatGrid.Rows;
  mammogram.PresentationIntent = Mammogram::Intent::ForProcessing;
  mammogram.IntensityRelationship = Mammogram::Relationship::Linear;
  mammogram.IntensitySign = 1;
  mammogram.BitsStored = 14;
  std::mt19937 generator(21);
  std::normal_distribution<double> noise(1, 0.01);
  for (int row = 0; row < FlatGrid.Rows; ++row)
  {
    for (int column = 0; column < FlatGrid.Columns; ++column)
    {
      const double signal = air * (IsBreastColumn(column) ? std::exp(-2.0) : 1.0);
      mammogram.Pixels.push_back(static_cast<float>(signal * noise(generator)));
    }
  }
  return mammogram;
}

/// Mean log attenuation of the breast and of the air, and whether the edge level parts them.
struct FoundContrast
{
  double Breast = 0;
  double Air = 0;
  bool Parted = true;
  std::vector<std::string> Warnings;
  std::vector<std::string> Disagreements;
};

FoundContrast ContrastOf(const Mammogram& mammogram, const TargetOptions& options = {})
{
  FoundContrast found;
  RegistrationTarget target;
  const BreastContrast contrast = FindBreastContrast(mammogram, FlatGrid, options, target);
  found.Warnings = target.Warnings;
  found.Disagreements = target.Disagreements;
  for (int row = 0; row < FlatGrid.Rows; ++row)
  {
    for (int column = 0; column < FlatGrid.Columns; ++column)
    {
      const std::size_t pixel = FlatGrid.Index(column, row);
      const bool breast = IsBreastColumn(column);
      (breast ? found.Breast : found.Air) += contrast.LogAttenuation[pixel] /
        (FlatGrid.Rows * (breast ? 35.0 : FlatGrid.Columns - 35.0));
      found.Parted = found.Parted && (contrast.Smooth[pixel] > contrast.EdgeLevel) == breast;
    }
  }
  return found;
}

TEST(BreastContrast, LinearCountsBecomeLogAttenuationOverAir)
{
  for (const double air : { 500.0, 10000.0 })
  {
    const FoundContrast found = ContrastOf(FlatBreast(air));
    EXPECT_THAT(found.Warnings, IsEmpty());
    // 1 % of noise over 2000 pixels, and the air's median.
    EXPECT_NEAR(found.Breast, 2, 2e-3) << air;
    EXPECT_NEAR(found.Air, 0, 2e-3) << air;
    EXPECT_TRUE(found.Parted) << air;
  }
}

TEST(BreastContrast, CountsThatFallWithIntensityAreTakenFromTheLargest)
{
  Mammogram falling = FlatBreast();
  falling.IntensitySign = -1;
  for (float& value : falling.Pixels)
  {
    value = 16383 - value; // 14 bits
  }
  const FoundContrast found = ContrastOf(falling);
  EXPECT_THAT(found.Warnings, ElementsAre(HasSubstr("fall linearly with X-ray intensity")));
  EXPECT_NEAR(found.Breast, 2, 2e-3);
  EXPECT_TRUE(found.Parted);
}

TEST(BreastContrast, WhatTheHeaderLeavesOpenIsAssumedAndSaid)
{
  Mammogram unsaid = FlatBreast();
  unsaid.IntensityRelationship = Mammogram::Relationship::Unknown;
  const FoundContrast linear = ContrastOf(unsaid);
  EXPECT_THAT(linear.Warnings, ElementsAre(HasSubstr("is taken as linear")));
  EXPECT_NEAR(linear.Breast, 2, 2e-3);
  // Already logarithmic: scale as stored, air at 0.
  Mammogram logarithmic = FlatBreast();
  logarithmic.IntensityRelationship = Mammogram::Relationship::Logarithmic;
  for (float& value : logarithmic.Pixels)
  {
    value = 1000 * std::log(value);
  }
  const FoundContrast found = ContrastOf(logarithmic);
  EXPECT_THAT(found.Warnings,
    ElementsAre(HasSubstr("calls this For Processing image logarithmic")));
  EXPECT_NEAR(found.Breast, 2000, 2);
  EXPECT_TRUE(found.Parted);
}

TEST(BreastContrast, PicturesToLookAtAreShownRight)
{
  // Bright where the breast is (MONOCHROME2), or dark and inverted for display.
  for (const bool inverted : { false, true })
  {
    for (const int sign : { 0, 1, -1 })
    {
      Mammogram shown = FlatBreast();
      shown.PresentationIntent = Mammogram::Intent::ForPresentation;
      shown.IntensityRelationship = Mammogram::Relationship::Unknown;
      shown.InvertedForDisplay = inverted;
      shown.IntensitySign = sign;
      for (float& value : shown.Pixels)
      {
        value = inverted ? value / 10 : 2000 - value / 10;
      }
      const FoundContrast found = ContrastOf(shown);
      // 1000 (1 - exp(-2)) of contrast.
      EXPECT_NEAR(found.Breast, 864.7, 2) << inverted << ' ' << sign;
      EXPECT_TRUE(found.Parted);
      EXPECT_EQ(found.Disagreements.size(), sign == (inverted ? -1 : 1) ? 1u : 0u);
    }
  }
}

TEST(BreastContrast, PaddingIsAir)
{
  Mammogram padded = FlatBreast();
  for (int row = 0; row < FlatGrid.Rows; ++row)
  {
    for (int column = 60; column < FlatGrid.Columns; ++column)
    {
      padded.Pixels[FlatGrid.Index(column, row)] = std::numeric_limits<float>::quiet_NaN();
    }
  }
  const FoundContrast found = ContrastOf(padded);
  EXPECT_NEAR(found.Breast, 2, 2e-3);
  EXPECT_NEAR(found.Air, 0, 2e-3);
  EXPECT_TRUE(found.Parted);
}

TEST(BreastContrast, DeadPixelsStayFinite)
{
  Mammogram dead = FlatBreast();
  for (std::size_t pixel = 3; pixel < dead.Pixels.size(); pixel += 101)
  {
    dead.Pixels[pixel] = 0;
  }
  RegistrationTarget target;
  const BreastContrast contrast = FindBreastContrast(dead, FlatGrid, {}, target);
  for (const float value : contrast.LogAttenuation)
  {
    ASSERT_TRUE(std::isfinite(value));
    ASSERT_LE(value, std::log(10000 / 0.5) + 0.1); // half a count for none
  }
  // The median takes them out.
  EXPECT_TRUE(ContrastOf(dead).Parted);
}

TEST(BreastContrast, TheEdgeLiesWhereTheOptionsSay)
{
  RegistrationTarget target;
  TargetOptions options;
  options.EdgeFraction = 0.25;
  options.EdgeSigmas = 1e-6;
  const BreastContrast half = FindBreastContrast(FlatBreast(), FlatGrid, options, target);
  // A quarter of 2; the medians' own noise.
  EXPECT_NEAR(half.EdgeLevel, 0.5, 5e-3);
  options.EdgeFraction = 1e-6;
  options.EdgeSigmas = 20;
  const BreastContrast sigmas = FindBreastContrast(FlatBreast(), FlatGrid, options, target);
  // The median of nine values of 1 % has a deviation of 0.41 %; neighbours share them.
  EXPECT_NEAR(sigmas.EdgeLevel, 20 * 0.0041, 20 * 0.001);
}

TEST(BreastContrast, RefusesWhatIsNoMammogram)
{
  RegistrationTarget target;
  Mammogram flat = FlatBreast();
  std::fill(flat.Pixels.begin(), flat.Pixels.end(), 100.0f);
  EXPECT_THAT(RefusalOf([&] { FindBreastContrast(flat, FlatGrid, {}, target); }),
    HasSubstr("found a flat picture"));
  std::fill(flat.Pixels.begin(), flat.Pixels.end(), std::numeric_limits<float>::quiet_NaN());
  EXPECT_THAT(RefusalOf([&] { FindBreastContrast(flat, FlatGrid, {}, target); }),
    HasSubstr("found padding only"));
}
}
