// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Mammogram.h"

#include <gtest/gtest.h>

using namespace mammoray;

namespace
{
/// 12 columns towards +y, 8 rows towards -x as a left CC mammogram.
const ReceptorGrid LeftCc{ 12, 8, { 7, 1 }, { 0, 2 }, { -2, 0 } };
/// Turned, and sheared.
const ReceptorGrid Turned{ 7, 9, { -4, 3 }, { 0.6, 0.8 }, { -1.2, 0.7 } };
}

TEST(ReceptorGrid, IndexIsTheInverseOfPosition)
{
  EXPECT_EQ(LeftCc.PositionOf(3, 1), (ReceptorPoint{ 5, 7 }));
  for (const double column : { -2.5, 0.0, 3.7 })
  {
    for (const double row : { -1.0, 0.25, 8.0 })
    {
      const auto index = Turned.IndexOf(Turned.PositionOf(column, row));
      // 1e-12: some operations on numbers of size 10.
      EXPECT_NEAR(index[0], column, 1e-12);
      EXPECT_NEAR(index[1], row, 1e-12);
    }
  }
}

TEST(ReceptorGrid, ContainsCountsWholePixels)
{
  EXPECT_TRUE(LeftCc.Contains({ 7.9, 0.1 }));
  EXPECT_FALSE(LeftCc.Contains({ 8.1, 0.1 }));
  EXPECT_FALSE(LeftCc.Contains({ 0, 0.9 }, 1));
  EXPECT_TRUE(LeftCc.Contains({ 0, 1.1 }, 1));
}

TEST(ReceptorGrid, SpacingsAndAreaAreThoseOfItsSteps)
{
  EXPECT_DOUBLE_EQ(Turned.ColumnSpacingMm(), 1);
  EXPECT_DOUBLE_EQ(LeftCc.RowSpacingMm(), 2);
  EXPECT_DOUBLE_EQ(LeftCc.PixelAreaMm2(), 4);
  EXPECT_EQ((ReceptorGrid{ 2, 2, { 0, 0 }, { 1, 2 }, { 2, 4 } }.PixelAreaMm2()), 0);
}

TEST(ReceptorGrid, CoarsePixelsLieInTheMiddleOfTheirFineOnes)
{
  const ReceptorGrid coarse = LeftCc.Coarsened(3);
  EXPECT_EQ(coarse.Columns, 4);
  EXPECT_EQ(coarse.Rows, 2);
  EXPECT_EQ(coarse.NumberOfPixels(), 8U);
  EXPECT_EQ(coarse.Index(1, 1), 5U);
  EXPECT_EQ(coarse.PositionOf(2, 1), LeftCc.PositionOf(7, 4));
  EXPECT_EQ(LeftCc.Coarsened(1), LeftCc);
}
