// SPDX-License-Identifier: Apache-2.0
#include "DescribedProjection.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MammogramSynthesis.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace mammoray;
using test::Describe;

TEST(MammogramSynthesis, SaysViewAndSidesOfEveryRoll)
{
  const Mammogram cc = Describe(0, 'L');
  EXPECT_EQ(cc.View, "CC");
  EXPECT_EQ(cc.RowDirection, "A");
  EXPECT_EQ(cc.ColumnDirection, "R");
  EXPECT_EQ(*cc.PositionerPrimaryAngleDeg, 0);
  EXPECT_NEAR(*cc.SourceToDetectorMm, 660, 1e-9); // rounding
  EXPECT_NEAR(cc.ColumnSpacingMm, 0.2, 1e-12);
  EXPECT_NEAR(cc.RowSpacingMm, 0.3, 1e-12);
  // The source medial is a negative roll of the left breast.
  for (const auto& [roll, view] : { std::pair{ -45.0, "MLO" }, { -90.0, "ML" }, { 90.0, "LM" },
         { 45.0, "LMO" }, { 179.0, "FB" }, { -10.0, "CC" }, { 135.0, "" } })
  {
    EXPECT_EQ(Describe(roll, 'L').View, view) << roll;
    EXPECT_EQ(Describe(-roll, 'R').View, view) << roll;
    EXPECT_NEAR(*Describe(roll, 'L').PositionerPrimaryAngleDeg, roll, 1e-9);
  }
  // Rows run along -x of the gantry, which points to the patient's left in CC and turns down with
  // the source going left.
  EXPECT_EQ(Describe(90, 'R').ColumnDirection, "H");
  EXPECT_EQ(Describe(-90, 'L').ColumnDirection, "F");
  EXPECT_EQ(Describe(-60, 'L').ColumnDirection, "FR");
  EXPECT_THROW(Describe(0, '?'), InputError);
}

TEST(MammogramSynthesis, PixelsAreOneFiniteValueEach)
{
  Mammogram mammogram = Describe(0, 'R');
  std::vector<float> values(35, 0.5f);
  SetPixels(mammogram, values, Mammogram::Intent::ForPresentation);
  EXPECT_EQ(mammogram.Pixels[34], 2000); // 4000 times 0.5
  values[3] = std::nanf("");
  EXPECT_THROW(SetPixels(mammogram, values, Mammogram::Intent::ForProcessing), InputError);
  values.pop_back();
  EXPECT_THROW(SetPixels(mammogram, values, Mammogram::Intent::ForProcessing), InputError);
}
