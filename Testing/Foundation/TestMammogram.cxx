// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Mammogram.h"

#include <gtest/gtest.h>

namespace
{
using namespace mammoray;

std::optional<double> Roll(const std::string& view, char laterality,
  std::optional<double> angle = std::nullopt)
{
  Mammogram mammogram;
  mammogram.View = view;
  mammogram.Laterality = laterality;
  mammogram.PositionerPrimaryAngleDeg = angle;
  return NominalRollDeg(mammogram);
}

TEST(SideName, NamesBothBreasts)
{
  EXPECT_EQ(SideName('L'), "left");
  EXPECT_EQ(SideName('R'), "right");
  EXPECT_EQ(SideName('?'), "unnamed");
}

TEST(NominalRoll, FollowsTheView)
{
  EXPECT_EQ(Roll("CC", '?'), 0);
  EXPECT_EQ(Roll("XCCL", 'L'), 0);
  EXPECT_EQ(Roll("FB", '?'), 180);
  // The source is medial: at the left of the right breast, which a positive roll means.
  EXPECT_EQ(Roll("ML", 'R'), 90);
  EXPECT_EQ(Roll("MLO", 'R', 50), 50);
  EXPECT_EQ(Roll("LM", 'R'), -90);
}

TEST(NominalRoll, IsMirroredForTheOtherBreast)
{
  for (const char* view : { "ML", "LM", "MLO", "LMO" })
  {
    ASSERT_TRUE(Roll(view, 'L'));
    EXPECT_EQ(*Roll(view, 'L'), -*Roll(view, 'R')) << view;
  }
}

TEST(NominalRoll, TakesTheSizeOfTheHeadersAngle)
{
  EXPECT_EQ(Roll("MLO", 'R', -50), 50);
  EXPECT_EQ(Roll("MLO", 'R', 130), 50);
  EXPECT_EQ(Roll("MLO", 'R', 0), 45);
  EXPECT_EQ(Roll("MLO", 'R'), 45);
}

TEST(NominalRoll, IsUnknownWithoutViewOrSide)
{
  EXPECT_FALSE(Roll("", 'L'));
  EXPECT_FALSE(Roll("MLO", '?'));
}
}
