// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Mammogram.h"

#include <gtest/gtest.h>

using namespace mammoray;

TEST(NominalRoll, TurnsTheSourceToTheSideOfTheView)
{
  Mammogram mammogram;
  mammogram.View = "CC";
  EXPECT_EQ(NominalRollDeg(mammogram), 0.0);
  mammogram.View = "MLO";
  EXPECT_FALSE(NominalRollDeg(mammogram)); // the side decides, and is not known
  // Medial is to the patient's left of the right breast: a positive roll.
  mammogram.Laterality = 'R';
  EXPECT_EQ(NominalRollDeg(mammogram), 45.0);
  mammogram.PositionerPrimaryAngleDeg = -50;
  EXPECT_EQ(NominalRollDeg(mammogram), 50.0);
  mammogram.Laterality = 'L';
  EXPECT_EQ(NominalRollDeg(mammogram), -50.0);
  mammogram.View = "LM";
  EXPECT_EQ(NominalRollDeg(mammogram), 90.0);
  mammogram.View = "spot";
  EXPECT_FALSE(NominalRollDeg(mammogram));
}
