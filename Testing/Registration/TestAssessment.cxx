// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/RegistrationResult.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

using namespace mammoray;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace
{
ViewResult GoodResult()
{
  ViewResult result;
  result.Parameters = { { "thickness", "mm", 52, 40, 64, 2 }, { "roll", "deg", 0, -15, 15, 3 } };
  result.Values = { 50.4, -1.25 };
  result.After = { 0.93, 0.62, 2.1, 0.8 };
  result.Converged = true;
  return result;
}
}

TEST(Assessment, IsGoodWithoutAReason)
{
  const Assessment assessment = Assess(GoodResult());
  EXPECT_EQ(assessment.Level, Trust::Good);
  EXPECT_TRUE(assessment.Reasons.empty());
}

TEST(Assessment, FallsWithEachFigure)
{
  struct Case
  {
    Similarity After;
    Trust Level;
  };
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  for (const Case& bad :
    { Case{ { 0.49, 0.6, 2, 0.8 }, Trust::Doubtful },
      Case{ { 0.9, 0.6, 2, 0.54 }, Trust::Doubtful }, Case{ { 0.9, 0.6, 2, 0.29 }, Trust::None },
      Case{ { 0.9, 0.6, 2, unknown }, Trust::Doubtful },
      Case{ { 0.9, 1.6, 2, 0.8 }, Trust::Doubtful }, Case{ { 0.9, 3.1, 2, 0.8 }, Trust::None },
      Case{ { 0.9, 0.6, 5.1, 0.8 }, Trust::Doubtful }, Case{ { 0.9, 0.6, 10.1, 0.8 }, Trust::None },
      Case{ { unknown, 0.6, 2, 0.8 }, Trust::None }, Case{ { 0.9, unknown, 2, 0.8 }, Trust::None },
      Case{ { 0.9, 0.6, unknown, 0.8 }, Trust::None } })
  {
    ViewResult result = GoodResult();
    result.After = bad.After;
    const Assessment assessment = Assess(result);
    EXPECT_EQ(assessment.Level, bad.Level);
    EXPECT_EQ(assessment.Reasons.size(), 1U);
  }
}

TEST(Assessment, TellsEveryReasonAndTheWorstCounts)
{
  ViewResult result = GoodResult();
  result.After.TissueCorrelation = 0.14;
  result.Converged = false;
  result.StopReason = "stopped by the user";
  const Assessment assessment = Assess(result);
  EXPECT_EQ(assessment.Level, Trust::None);
  EXPECT_THAT(assessment.Reasons, ElementsAre(HasSubstr("0.14"), HasSubstr("stopped by the user")));
}

TEST(Assessment, AParameterAtItsBoundIsDoubtful)
{
  ViewResult result = GoodResult();
  result.Values[1] = 15;
  const Assessment assessment = Assess(result);
  EXPECT_EQ(assessment.Level, Trust::Doubtful);
  EXPECT_THAT(assessment.Reasons, ElementsAre(HasSubstr("limit of what was allowed")));
  EXPECT_TRUE(AtBound(result.Parameters[1], 15 - 0.02)); // a thousandth of 30 degrees
  EXPECT_FALSE(AtBound(result.Parameters[1], 15 - 0.04));
  result.Parameters[1].Fixed = true;
  EXPECT_FALSE(AtBound(result.Parameters[1], 15));
}

TEST(Assessment, AParameterFarFromWhatWasExpectedIsDoubtful)
{
  ViewResult result = GoodResult();
  result.Parameters[1].PriorSigma = 5;
  result.Values[1] = -14.9;
  EXPECT_EQ(Assess(result).Level, Trust::Good) << "an angle is 2.98 standard deviations off";
  result.Parameters[1].PriorSigma = 4;
  EXPECT_EQ(Assess(result).Level, Trust::Doubtful);
  EXPECT_THAT(Assess(result).Reasons, ElementsAre(HasSubstr("ended 3.7 standard deviations")));
  // A value that is hardly known is not far from anything.
  result.StandardDeviations = { 0.1, 3, 0.1 };
  EXPECT_EQ(Assess(result).Level, Trust::Good) << "14.9 is 2.98 times 5";
  result.StandardDeviations[1] = 2.9;
  EXPECT_THAT(Assess(result).Reasons, ElementsAre(HasSubstr("ended 3.0 standard deviations")));
}

TEST(Assessment, WhatMechanicsDoNotSettleIsDoubtful)
{
  ViewResult result = GoodResult();
  result.State.Positions = { 0, 0, 0 };
  EXPECT_THAT(Assess(result).Reasons, ElementsAre(HasSubstr("presses with 0.0 N")))
    << "nothing touches the breast";
  result.State.SupportForceN = 20;
  result.State.PaddleForceN = 0.9;
  EXPECT_THAT(Assess(result).Reasons,
    ElementsAre(HasSubstr("paddle presses with 0.9 N, the support with 20.0 N")));
  result.State.SupportForceN = 0.04;
  EXPECT_THAT(Assess(result).Reasons, ElementsAre(HasSubstr("the support with 0.0 N")));
  result.State.SupportForceN = 4.7;
  result.State.PaddleForceN = 0.7;
  result.OtherEquilibriumMm = 2.9;
  EXPECT_EQ(Assess(result).Level, Trust::Good);
  result.OtherEquilibriumMm = 24;
  EXPECT_EQ(Assess(result).Level, Trust::Doubtful);
  EXPECT_THAT(Assess(result).Reasons, ElementsAre(HasSubstr("24 mm away")));
}

TEST(Assessment, LevelsHaveNames)
{
  EXPECT_STREQ(NameOf(Trust::Good), "good");
  EXPECT_STREQ(NameOf(Trust::Doubtful), "doubtful");
  EXPECT_STREQ(NameOf(Trust::None), "none");
}

TEST(Assessment, CountsWhatTheHeaderDisagreesOn)
{
  ViewResult result = GoodResult();
  result.Pose.ThicknessMm = 50.4;
  // 15 % of the readout.
  for (const double readout : { 44.0, 59.0 })
  {
    result.HeaderThicknessMm = readout;
    EXPECT_EQ(Assess(result).Level, Trust::Good) << readout;
  }
  for (const double readout : { 43.0, 60.0 })
  {
    result.HeaderThicknessMm = readout;
    EXPECT_EQ(Assess(result).Level, Trust::Doubtful) << readout;
  }
  EXPECT_EQ(Assess(result).Level, Trust::Doubtful);
  EXPECT_THAT(Assess(result).Reasons,
    ElementsAre(HasSubstr("found 50.4 mm thick, the mammogram's header says 60.0 mm")));
  for (const double readout : { 34.0, 73.0 })
  {
    result.HeaderThicknessMm = readout;
    EXPECT_EQ(Assess(result).Level, Trust::None) << readout;
  }
  // Of thin breasts 5 mm.
  result.Pose.ThicknessMm = 22;
  result.HeaderThicknessMm = 26.9;
  EXPECT_EQ(Assess(result).Level, Trust::Good);
  result.HeaderThicknessMm = 27.1;
  EXPECT_EQ(Assess(result).Level, Trust::Doubtful);
  result.HeaderThicknessMm.reset();
  result.Disagreements = { "The side should be looked at." };
  EXPECT_EQ(Assess(result).Level, Trust::Doubtful);
  EXPECT_THAT(Assess(result).Reasons, ElementsAre("The side should be looked at."));
}
