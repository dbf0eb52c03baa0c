// SPDX-License-Identifier: Apache-2.0
// Tables of made-up runs, whose figures are counted by hand.
#include "MadeUpEvidence.h"
#include "mammoray/Evidence/EvidenceTables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace mammoray;
using test::MadeUpRun;
using testing::HasSubstr;
using testing::Not;

TEST(EvidenceTables, NothingGathered)
{
  EXPECT_EQ(EvidenceTables({}), "");
}

TEST(EvidenceTables, TwinsByKindAndPhantom)
{
  RegistrationEvidence evidence;
  const auto add = [&](const char* phantom, int number, double errorMm, double thicknessErrorMm)
  {
    evidence.Twins.push_back(
      MadeUpRun(phantom, TwinKind::Plain, TwinSearch::Register, number, errorMm, thicknessErrorMm));
  };
  add("a", 0, 1, 0.5);
  add("a", 1, 2, -1.5);
  add("b", 0, 4, 3);
  const std::string text = EvidenceTables(evidence);
  // Thickness is within two sigma in both runs of a and not in that of b, roll is in all.
  EXPECT_THAT(text,
    HasSubstr("| plain | a | 3000 | 2 | 1.50 (2.00) | 100 % | 12 (12) | 20 | 8 | 100 % |"));
  EXPECT_THAT(text,
    HasSubstr("| plain | b | 3000 | 1 | 4.00 (4.00) | 0 % | 12 (12) | 20 | 8 | 50 "
              "% |"));
  EXPECT_THAT(text,
    HasSubstr("| plain | all |  | 3 | 2.00 (4.00) | 67 % | 12 (12) | 20 | 8 | 83 % |"));
  EXPECT_THAT(text, HasSubstr("| thickness, mm | 1.50 (3.00); 67 % |"));
  EXPECT_THAT(text, HasSubstr("| roll, deg | 0.50 (0.50); 100 % |"));
  EXPECT_THAT(text, Not(HasSubstr("pitch"))); // fixed
  EXPECT_THAT(text, Not(HasSubstr("wrong-start")));
}

TEST(EvidenceTables, ARunThatFoundNothingDidNotConverge)
{
  RegistrationEvidence evidence;
  evidence.Twins.push_back(MadeUpRun("a", TwinKind::Plain, TwinSearch::Register, 0, 1, 0));
  evidence.Twins.push_back(
    MadeUpRun("a", TwinKind::Plain, TwinSearch::Register, 1, test::Nothing, 0));
  EXPECT_THAT(EvidenceTables(evidence), HasSubstr("| plain | a | 3000 | 2 | 1.00 (1.00) | 50 % |"));
}

TEST(EvidenceTables, SearchesToTheCostOfTheExactOne)
{
  RegistrationEvidence evidence;
  TwinRun exact = MadeUpRun("a", TwinKind::Plain, TwinSearch::Exact, 0, 1, 0);
  TwinRun differences = MadeUpRun("a", TwinKind::Plain, TwinSearch::CentralDifferences, 0, 1, 0);
  differences.IterationSeconds = { 1, 21, 41 };
  TwinRun annealing = MadeUpRun("a", TwinKind::Plain, TwinSearch::Annealing, 0, 6, 0);
  annealing.IterationCosts = { 100, 50, 30 };
  evidence.Twins = { exact, differences, annealing };
  const std::string text = EvidenceTables(evidence);
  // Cost 10 is reached 4 s after the start by the one, after 40 s by the next, never by the last.
  EXPECT_THAT(text, HasSubstr("| exact | a, 0 | 20 | 8.0 | 10.00 | 4.0 | 1.00 |"));
  EXPECT_THAT(text, HasSubstr("| central-differences | a, 0 | 20 | 8.0 | 10.00 | 40.0 | 1.00 |"));
  EXPECT_THAT(text, HasSubstr("| annealing | a, 0 | 20 | 8.0 | 30.00 | never | 6.00 |"));
  EXPECT_THAT(text, HasSubstr("Exact derivatives get there 10.0 times as fast"));
}

TEST(EvidenceTables, LandmarksAndMammograms)
{
  RegistrationEvidence evidence;
  evidence.Landmarks.push_back(
    { "ball, CC", { { "registered", { 12, 1.06, 1.2, 2.5 }, { 12, 0.74, 0.8, 1.42 } } }, 0.61, 0.25,
      "good", 1.5, {}, 14, 25, 30 });
  evidence.Landmarks.push_back(
    { "ball, MLO", { { "registered", { 12, 2.06, 2.2, 3.5 }, { 12, 1.74, 1.8, 2.42 } } },
      test::Nothing, test::Nothing, "none", test::Nothing, {}, 14, 25, 30 });
  evidence.Mammograms.push_back({ "real", 2.5, 7, 0.8, 0.4, "doubtful", {}, 12, "" });
  evidence.Mammograms.push_back({ "other", 0, 0, 0, 0, "", {}, 0, "no equilibrium" });
  const std::string text = EvidenceTables(evidence);
  EXPECT_THAT(text, HasSubstr("| registered | 1.06 (2.50) | 0.74 (1.42) |"));
  EXPECT_THAT(text, HasSubstr("| ball, CC, imaged landmarks: median (largest) error, mm |"));
  EXPECT_THAT(text,
    HasSubstr("Gland overlap (Dice) 0.61, at rest 0.25. Trust: good, expected: 1.50 mm. 14 iter"));
  EXPECT_THAT(text, HasSubstr("| ball, MLO, imaged landmarks"));
  EXPECT_THAT(text, HasSubstr("\nTrust: none, expected: - mm. 14 iterations"));
  EXPECT_THAT(text, HasSubstr("| real | 2.50 (7.00) | 0.80, 0.40 | doubtful | 12 |"));
  EXPECT_THAT(text, HasSubstr("| other | - | - | no result: no equilibrium | - |"));
  // They are wrong pairs, whether registered or refused.
  EXPECT_THAT(text, HasSubstr("| real mammograms, another breast | 2 | 0 | 1 | 1 | - |"));
}

TEST(EvidenceTables, Studies)
{
  RegistrationEvidence evidence;
  evidence.Studies.push_back(test::MadeUpStudyRun("ball", 4, { 1, 2, 6 }));
  StudyRun& refused = evidence.Studies.emplace_back();
  refused.Phantom = "cube";
  refused.Seed = 5;
  refused.Failure = "no breast";
  const std::string text = EvidenceTables(evidence);
  // 95 %: nine tenths of the way from the second of three to the last.
  EXPECT_THAT(text,
    HasSubstr("| ball, 4 | right | 2.00 (5.60) | 2.00 (5.60) | 1.00 (3.00) | 20.00 (20.00) | good, "
              "good | 75 |"));
  EXPECT_THAT(text, HasSubstr("| cube, 5 | left | no result: no breast |"));
  EXPECT_THAT(text, HasSubstr("All 6 imaged points of 1 studies: in 3D 2.00 mm in the middle"));
  EXPECT_THAT(text, HasSubstr("those behind the receptor's edge (2): 20.00 mm in the middle"));
  EXPECT_THAT(text, HasSubstr("1 without a result."));
  EXPECT_THAT(text,
    HasSubstr(
      "3 shadows back into the MRI: from CC alone (the middle of the tissue behind it) 12.00 mm "
      "in the middle, 95 % below 13.80 mm; from CC and MLO 2.00 mm"));
}

namespace
{
/// A wrong pair whose tissue correlates so.
TwinRun MadeUpPair(TwinKind kind, int number, double tissue, const char* trust)
{
  TwinRun run = MadeUpRun("a", kind, TwinSearch::Register, number, test::Nothing, 0);
  run.TissueCorrelation = tissue;
  run.Trust = trust;
  return run;
}
}

TEST(EvidenceTables, TrustByWhatIsRightAndWrong)
{
  RegistrationEvidence evidence;
  for (int number = 0; number < 4; ++number)
  {
    evidence.Twins.push_back(
      MadeUpRun("a", TwinKind::Plain, TwinSearch::Register, number, 1 + number, 0));
  }
  evidence.Twins[3].TissueCorrelation = 0.5;
  evidence.Twins[3].Trust = "doubtful";
  evidence.Twins.push_back(MadeUpPair(TwinKind::OtherBreast, 0, 0.45, "doubtful"));
  evidence.Twins.push_back(MadeUpPair(TwinKind::OtherBreast, 1, 0.65, "good"));
  evidence.Twins.push_back(MadeUpPair(TwinKind::HalfPicture, 0, test::Nothing, "none"));
  const std::string text = EvidenceTables(evidence);
  EXPECT_THAT(text, HasSubstr("| twins | 4 | 3 | 1 | 0 | 2.00 (3.00) |"));
  EXPECT_THAT(text, HasSubstr("| other-breast | 2 | 1 | 1 | 0 | - |"));
  EXPECT_THAT(text, HasSubstr("| half-picture | 1 | 0 | 0 | 1 | - |"));
  // 0.46 keeps the wrong ones of even numbers out, not that of number 1; of number 3 it is passed.
  EXPECT_THAT(text, HasSubstr("4 right results (3D error below 5 mm in the middle) and 3 wrong"));
  EXPECT_THAT(text,
    HasSubstr("Limit of 0.46, chosen on even numbers: 0 % of the wrong and 100 % of "
              "the right ones pass; of odd numbers 100 % of the wrong and 100 %"));
  EXPECT_THAT(text, HasSubstr("of odd ones 100 % of the wrong and 50 % of the right ones."));
  // Wrong pairs are no twins of a table of errors.
  EXPECT_THAT(text, Not(HasSubstr("| other-breast | a |")));
  const std::string curve = TrustCurveSvg(evidence);
  EXPECT_THAT(curve, testing::StartsWith("<svg"));
  EXPECT_THAT(curve, Not(HasSubstr("nan")));
  // Of the odd numbers one of one is wrong, one of two right: the middle of the right edge.
  EXPECT_THAT(curve, HasSubstr("<circle cx=\"460.0\" cy=\"220.0\""));
}

TEST(EvidenceTables, HowOftenTheTruthIsWithinTwoSigma)
{
  RegistrationEvidence evidence;
  evidence.Twins.push_back(MadeUpRun("a", TwinKind::Plain, TwinSearch::Register, 0, 1, 0.5));
  evidence.Twins.push_back(MadeUpRun("b", TwinKind::Plain, TwinSearch::Register, 0, 1, 3));
  evidence.Twins[1].CoordinatesWithin = 0.87;
  evidence.Studies.push_back(test::MadeUpStudyRun("b", 4, { 1, 2, 6 }));
  const std::string text = EvidenceTables(evidence);
  EXPECT_THAT(text, HasSubstr("| a | 100.0 % (2) | 97.0 % (1) | - | - |"));
  EXPECT_THAT(text, HasSubstr("| b | 50.0 % (2) | 87.0 % (1) | 94.0 % (2) | 1.00 |"));
  EXPECT_THAT(text, HasSubstr("| all | 75.0 % (4) | 92.0 % (2) | 94.0 % (2) | 1.00 |"));
  EXPECT_THAT(text, Not(HasSubstr("For 95 %")));
  // 2 mm expected and found; two of three within the 5 mm of 95 %.
  EXPECT_THAT(text, HasSubstr("expects: 1.00 in the middle of 2 views (1.00 to 1.00); 66.7 % of"));
  // The other half of the numbers.
  evidence.Studies.push_back(test::MadeUpStudyRun("b", 5, { 1, 2, 6 }));
  for (StudyViewErrors& view : evidence.Studies.back().Views)
  {
    view.ModelErrorNeeded = { 2.0 };
  }
  EXPECT_THAT(EvidenceTables(evidence),
    HasSubstr(
      "For 95 %: the model's own error times 1.00 by studies of even numbers, times 2.00 by "
      "those of odd ones."));
}

TEST(Quantile, IsLinearBetweenValues)
{
  EXPECT_EQ(Quantile({ 3, 1, 2 }, 0), 1);
  EXPECT_EQ(Quantile({ 3, 1, 2 }, 1), 3);
  EXPECT_DOUBLE_EQ(Quantile({ 3, 1, 2 }, 0.75), 2.5);
  EXPECT_TRUE(std::isnan(Quantile({}, 0.5)));
}

TEST(TwinTable, ARowForEachRun)
{
  const std::string text =
    TwinTable({ MadeUpRun("a", TwinKind::Plain, TwinSearch::Register, 0, 1.25, 0.5) });
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
  EXPECT_THAT(text, testing::StartsWith("phantom,kind,search,number,median_error_mm,"));
  EXPECT_THAT(text, HasSubstr("thickness_truth,thickness_start,thickness_found,thickness_sigma"));
  EXPECT_THAT(text,
    HasSubstr("\na,plain,register,0,1.2500,2.5000,0.5000,0.9500,12,20,8.00,1,50.00000,52.00000,"
              "50.50000,1.00000,"));
}

TEST(EvidenceTables, TellWhatProjectionsAddToACc)
{
  RegistrationEvidence evidence;
  evidence.Studies.push_back(test::MadeUpStudyRun("ball", 4, { 1, 2, 6 }));
  EXPECT_THAT(EvidenceTables(evidence), Not(HasSubstr("along the beam")));
  StudyRun& run = evidence.Studies.back();
  run.CcAlone = { test::MadeUpStudyRun("ball", 4, { 4, 8, 12 }).Views[0] };
  run.Swept = { test::MadeUpStudyRun("ball", 4, { 1, 1, 1 }).Views[0] };
  const std::string tables = EvidenceTables(evidence);
  EXPECT_THAT(tables, HasSubstr("imaged points of 1 studies' CC"));
  EXPECT_THAT(tables,
    HasSubstr("| CC alone | 8.00 (11.60) | 2.00 (2.90) | 4.00 (5.80) | 94.0 % |"));
  EXPECT_THAT(tables, HasSubstr("| CC with MLO | 2.00 (5.60) | 0.50 (1.40) |"));
  EXPECT_THAT(tables,
    HasSubstr("| projections of the CC's compression | 1.00 (1.00) | 0.25 (0.25) |"));
}
