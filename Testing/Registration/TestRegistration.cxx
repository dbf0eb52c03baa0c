// SPDX-License-Identifier: Apache-2.0
// The target is not made by the model: it has another mesh density for the mechanics and for the
// picture, another spectrum (30 instead of 20 keV), noise, and an unknown scale and offset of its
// intensities.
#include "RegistrationTwin.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Registration/Annealing.h"
#include "mammoray/Registration/Registration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

using namespace mammoray;
using namespace mammoray::test;

namespace
{
/// Compared globally: the ball's surface is that of tetrahedra of 5 to 8 mm, others in the target
/// than in the model, so that its edges tell a gradient more of the meshes than of the pose.
RegistrationOptions OptionsFrom(const BreastPose& start)
{
  RegistrationOptions options;
  options.Parameters = DefaultParameters(start);
  options.PixelSizesMm = { 3.0 };
  options.Comparison = PictureComparison::Global;
  return options;
}

/// From a place near the truth, without looking for a better start.
RegistrationOptions OptionsNearTruth()
{
  BreastPose start = Truth();
  start.ThicknessMm += 1.5;
  start.RollDeg -= 3;
  start.LateralMm += 2;
  RegistrationOptions options = OptionsFrom(start);
  for (const RegistrationParameter& parameter : options.Parameters)
  {
    options.From.push_back(parameter.Start);
  }
  return options;
}

/// Skips the test where there is no device; a shared setup, because meshes and pipelines take
/// seconds.
class Registration : public testing::Test
{
protected:
  void SetUp() override
  {
    std::string reason;
    if (ListDevices(&reason).empty())
    {
      GTEST_SKIP() << reason;
    }
    if (Target)
    {
      return;
    }
    Model = std::make_unique<Twin>(6, 12, 20.0);
    Twin other(8, 16, 30.0);
    Target = std::make_unique<RegistrationTarget>(MakeTarget(other, Truth()));
  }
  static void TearDownTestSuite()
  {
    Model.reset();
    Target.reset();
  }

  static inline std::unique_ptr<Twin> Model;
  static inline std::unique_ptr<RegistrationTarget> Target;
};
}

TEST_F(Registration, RecoversATwinMadeWithAnotherMeshSpectrumAndNoise)
{
  for (const double sense : { 1.0, -1.0 })
  {
    BreastPose start;
    start.ThicknessMm = 50;
    start.RollDeg = Truth().RollDeg + sense * 20;
    start.LateralMm = Truth().LateralMm - sense * 15;
    start.AnteriorMm = 3;
    const RegistrationResult result =
      Register(Model->Model, Model->Placement, *Target, OptionsFrom(start), {});
    EXPECT_TRUE(result.Converged) << result.StopReason;
    // The result's own standard deviations must be useful, and the errors no larger than what is
    // called useful: the ball is all that shows the angle, and thickness has little effect on a
    // z-scored picture.
    struct Expected
    {
      int Parameter;
      double Truth;
      double Error;
      double Useful;
    };
    // Half of the 3 mm pixels for the shifts.
    for (const Expected& expected : { Expected{ ThicknessParameter, Truth().ThicknessMm, 3.0, 3.0 },
           Expected{ RollParameter, Truth().RollDeg, 6.0, 6.5 },
           Expected{ LateralParameter, Truth().LateralMm, 1.5, 1.5 },
           Expected{ AnteriorParameter, Truth().AnteriorMm, 1.5, 1.5 } })
    {
      const double deviation = result.StandardDeviations[expected.Parameter];
      SCOPED_TRACE(result.Parameters[expected.Parameter].Name);
      EXPECT_GT(deviation, 0);
      EXPECT_LT(deviation, expected.Useful);
      EXPECT_NEAR(result.Values[expected.Parameter], expected.Truth, expected.Error);
    }
    EXPECT_LT(result.After.MeanOutlineDistanceMm, 0.7);
    EXPECT_GT(result.After.Correlation, 0.95);
    EXPECT_GT(result.After.Correlation, result.Before.Correlation);
    ASSERT_GE(result.Iterations.size(), 2u);
    EXPECT_LT(result.Iterations.back().Cost, result.Iterations.front().Cost);
    EXPECT_TRUE(std::isnan(result.StandardDeviations[VerticalParameter])); // fixed
    EXPECT_EQ(result.Pose.VerticalMm, 0);
  }
}

TEST_F(Registration, NothingFreeAnswersTheStart)
{
  RegistrationOptions options = OptionsFrom(Truth());
  for (RegistrationParameter& parameter : options.Parameters)
  {
    parameter.Fixed = true;
  }
  const RegistrationResult result = Register(Model->Model, Model->Placement, *Target, options, {});
  EXPECT_TRUE(result.Converged);
  EXPECT_EQ(result.Pose.ThicknessMm, Truth().ThicknessMm);
  EXPECT_EQ(result.Evaluations, 1);
  // The true pose: what is left is the difference of the meshes.
  EXPECT_GT(result.After.Correlation, 0.95);
  EXPECT_LT(result.After.MeanOutlineDistanceMm, 0.7);
}

TEST_F(Registration, StopsWhenAskedWithTheBestSoFar)
{
  RegistrationOptions options = OptionsFrom(Truth());
  int calls = 0;
  const RegistrationResult result = Register(Model->Model, Model->Placement, *Target, options,
    [&](double, const char* stage) { return std::string(stage) != "project" || ++calls < 3; });
  EXPECT_FALSE(result.Converged);
  EXPECT_NE(result.StopReason.find("interrupted"), std::string::npos);
  EXPECT_GT(result.After.Correlation, 0.9);
}

TEST_F(Registration, PredictedSearchEndsWhereTheSimulationAloneEnds)
{
  BreastPose start = Truth();
  start.ThicknessMm += 2;
  start.RollDeg += 5;
  start.LateralMm = 0;
  RegistrationOptions options = OptionsFrom(start);
  options.PixelSizesMm = { 4.0, 3.0 };
  // Told of, either goes on and never back, as far as its equilibria lead: the search of the
  // simulation alone takes two after the start's tenth, a breast's 25 and more.
  std::vector<double> fractions;
  const ProgressCallback keep = [&](double fraction, const char*)
  {
    fractions.push_back(fraction);
    return true;
  };
  const auto goesOnBeyond = [&](double least)
  {
    return std::is_sorted(fractions.begin(), fractions.end()) && fractions.front() >= 0 &&
      fractions.back() <= 1 && fractions.back() > least;
  };
  const RegistrationResult predicted =
    Register(Model->Model, Model->Placement, *Target, options, keep);
  EXPECT_TRUE(goesOnBeyond(0.4));
  fractions.clear();
  Twin direct(6, 12, 20.0, false);
  const RegistrationResult alone = Register(direct.Model, direct.Placement, *Target, options, keep);
  EXPECT_TRUE(goesOnBeyond(0.1));
  EXPECT_TRUE(predicted.Converged) << predicted.StopReason;
  EXPECT_TRUE(alone.Converged) << alone.StopReason;
  // Lower than wide, it lies in one way only; folds at the plates' edges may differ.
  EXPECT_GE(predicted.OtherEquilibriumMm, 0);
  EXPECT_LT(predicted.OtherEquilibriumMm, 0.5);
  // The state answered is one of the simulation itself, whose nodes are more.
  EXPECT_EQ(predicted.State.Positions.size(), alone.State.Positions.size());
  // The cost of this small twin has dents, in one of which each ends: three standard deviations of
  // each of the two, and an outline and picture that both agree.
  for (const int parameter :
    { ThicknessParameter, RollParameter, LateralParameter, AnteriorParameter })
  {
    EXPECT_NEAR(predicted.Values[parameter], alone.Values[parameter],
      3 * (predicted.StandardDeviations[parameter] + alone.StandardDeviations[parameter]))
      << alone.Parameters[parameter].Name;
  }
  for (const RegistrationResult* result : { &predicted, &alone })
  {
    EXPECT_LT(result->After.MeanOutlineDistanceMm, 0.7);
    EXPECT_GT(result->After.Correlation, 0.95);
  }
}

TEST_F(Registration, GradientsAreComparedWhereTissueTellsFromWhereTheWholeHasLed)
{
  RegistrationOptions options = OptionsNearTruth();
  options.Comparison = PictureComparison::Gradient;
  const auto comparisons = [](const RegistrationResult& result)
  {
    std::vector<std::string> found;
    for (const RegistrationIteration& iteration : result.Iterations)
    {
      if (found.empty() || found.back() != iteration.Comparison)
      {
        found.push_back(iteration.Comparison);
      }
    }
    return found;
  };
  const RegistrationResult result = Register(Model->Model, Model->Placement, *Target, options, {});
  EXPECT_TRUE(result.Converged) << result.StopReason;
  EXPECT_EQ(comparisons(result), (std::vector<std::string>{ "global", "gradient" }));
  EXPECT_EQ(result.Values, result.Iterations.back().Parameters);
  EXPECT_GT(result.After.Correlation, 0.95);
  // Counted as the options say until then; by what residuals tell from there on.
  for (const RegistrationIteration& row : { result.Iterations.front(), result.Iterations.back() })
  {
    const bool first = row.Comparison == "global";
    options.Comparison = first ? PictureComparison::Global : PictureComparison::Gradient;
    const RegistrationTarget coarse = CoarsenTo(*Target, row.PixelSizeMm);
    const RegistrationResiduals residuals(coarse, options);
    EvaluatedState there = Model->At(PoseOf(row.Parameters), &result.State);
    const double ratio = row.IntensityCost / residuals.Costs(residuals.Evaluate(there)).Intensity;
    if (first)
    {
      EXPECT_NEAR(ratio, 1, 1e-3);
    }
    else
    {
      EXPECT_GT(std::abs(std::log(ratio)), 0.1);
    }
  }
  options.Comparison = PictureComparison::Gradient;
  EXPECT_LT(result.After.MeanOutlineDistanceMm, 0.7);

  // 81 mm^2 of tissue cannot tell that gradients have found no worse.
  RegistrationTarget little = *Target;
  little.Excluded.assign(little.BreastMask.size(), 1);
  for (int row = 0; row < little.Grid.Rows; ++row)
  {
    for (int column = 0; column < little.Grid.Columns; ++column)
    {
      const ReceptorPoint at = little.Grid.PositionOf(column, row);
      little.Excluded[static_cast<std::size_t>(row) * little.Grid.Columns + column] =
        std::abs(at[0]) < 4.5 && std::abs(at[1] - 20) < 4.5 ? 0 : 1;
    }
  }
  options.PixelSizesMm = { 2.0 };
  const RegistrationResult whole = Register(Model->Model, Model->Placement, little, options, {});
  EXPECT_TRUE(std::isnan(whole.After.TissueCorrelation));
  EXPECT_EQ(comparisons(whole), std::vector<std::string>{ "global" });
  EXPECT_FALSE(whole.Covariance.empty());
}

TEST_F(Registration, OutlinesFarApartEndTheSearchBeforeItsFinestPixels)
{
  // The picture of a breast more than twice as large.
  RegistrationTarget larger = *Target;
  for (std::size_t axis = 0; axis < 2; ++axis)
  {
    larger.Grid.Origin[axis] *= 2.2;
    larger.Grid.ColumnStep[axis] *= 2.2;
    larger.Grid.RowStep[axis] *= 2.2;
  }
  for (float& distance : larger.SignedDistanceMm)
  {
    distance *= 2.2F;
  }
  RegistrationOptions options = OptionsFrom(Truth());
  options.PixelSizesMm = { 6.0, 4.0 };
  const RegistrationResult result = Register(Model->Model, Model->Placement, larger, options, {});
  EXPECT_FALSE(result.Converged);
  EXPECT_NE(result.StopReason.find("the fine one was left out"), std::string::npos)
    << result.StopReason;
  EXPECT_GT(result.After.MeanOutlineDistanceMm, 10);
  for (const RegistrationIteration& iteration : result.Iterations)
  {
    EXPECT_EQ(iteration.PixelSizeMm, 6);
  }
  EXPECT_FALSE(result.State.Positions.empty());
}

TEST_F(Registration, DifferencesEndWhereExactDerivativesEndAtMoreEquilibria)
{
  RegistrationOptions options = OptionsNearTruth();
  const RegistrationResult exact = Register(Model->Model, Model->Placement, *Target, options, {});
  options.Derivatives = RegistrationDerivatives::CentralDifferences;
  const RegistrationResult differences =
    Register(Model->Model, Model->Placement, *Target, options, {});
  EXPECT_TRUE(differences.Converged) << differences.StopReason;
  // Both stop within half a standard deviation of the best.
  for (const int parameter :
    { ThicknessParameter, RollParameter, LateralParameter, AnteriorParameter })
  {
    EXPECT_NEAR(differences.Values[parameter], exact.Values[parameter],
      exact.StandardDeviations[parameter])
      << exact.Parameters[parameter].Name;
    // Differences over 0.1 mm and degrees of what is piecewise smooth.
    EXPECT_NEAR(differences.StandardDeviations[parameter], exact.StandardDeviations[parameter],
      0.2 * exact.StandardDeviations[parameter]);
  }
  // Two beside it for each of four parameters at every accepted point.
  EXPECT_GE(differences.Evaluations, 8 * static_cast<int>(differences.Iterations.size()));
  EXPECT_LE(exact.Evaluations, 10);

  // Stopped among the differences.
  int calls = 0;
  const RegistrationResult stopped = Register(Model->Model, Model->Placement, *Target, options,
    [&](double, const char*) { return ++calls < 200; });
  EXPECT_FALSE(stopped.Converged);
  EXPECT_NE(stopped.StopReason.find("interrupted"), std::string::npos);
}

TEST_F(Registration, AnnealingSpendsItsEquilibriaAndKeepsTheBest)
{
  const RegistrationOptions options = OptionsNearTruth();
  AnnealingOptions annealing;
  annealing.Equilibria = 6;
  annealing.FirstStep = 0.3;
  const RegistrationResult result =
    Anneal(Model->Model, Model->Placement, *Target, options, annealing, {});
  EXPECT_EQ(result.Evaluations, 6);
  EXPECT_EQ(result.Iterations.front().Parameters, options.From);
  ASSERT_GE(result.Iterations.size(), 2u);
  for (std::size_t index = 1; index < result.Iterations.size(); ++index)
  {
    EXPECT_LT(result.Iterations[index].Cost, result.Iterations[index - 1].Cost);
  }
  EXPECT_EQ(result.Values, result.Iterations.back().Parameters);
  EXPECT_EQ(result.Values[VerticalParameter], 0); // fixed
  for (int index = 0; index < ParameterCount; ++index)
  {
    EXPECT_GE(result.Values[index], options.Parameters[index].Lower);
    EXPECT_LE(result.Values[index], options.Parameters[index].Upper);
  }
  EXPECT_FALSE(result.Converged);

  // The same seed walks the same way; a stop leaves the best so far.
  annealing.Equilibria = 4;
  int calls = 0;
  const auto stopAtThird = [&](double, const char* stage)
  { return std::string(stage) != "anneal" || ++calls < 3; };
  const RegistrationResult stopped =
    Anneal(Model->Model, Model->Placement, *Target, options, annealing, stopAtThird);
  EXPECT_EQ(stopped.Evaluations, 3);
  EXPECT_NE(stopped.StopReason.find("interrupted"), std::string::npos);
  EXPECT_LE(stopped.Iterations.back().Cost, stopped.Iterations.front().Cost);
  annealing.Equilibria = 0;
  EXPECT_THROW(Anneal(Model->Model, Model->Placement, *Target, options, annealing, {}), InputError);
}

/// CC and MLO of one truth whose gland is stiffer than the model believes.
TEST_F(Registration, TwoMammogramsShareTheStiffnessAndKnowItBetter)
{
  Twin other(8, 16, 30.0);
  const double trueStiffness = 1.6;
  BreastPose above = Truth();
  above.Stiffness = trueStiffness;
  BreastPose oblique = above;
  oblique.ThicknessMm = 43;
  oblique.RollDeg = 45;
  oblique.LateralMm = -3;
  const RegistrationTarget targets[2] = { MakeTarget(other, above), MakeTarget(other, oblique) };
  const auto mammogramOf = [&](const BreastPose& pose, const RegistrationTarget& target)
  {
    BreastPose start = pose;
    start.ThicknessMm += 1.5;
    start.RollDeg -= 3;
    start.LateralMm += 2;
    start.Stiffness = 1;
    JointMammogram mammogram{ &Model->Model, Model->Placement, &target, DefaultParameters(start),
      {} };
    mammogram.Parameters[StiffnessParameter].Fixed = false;
    for (const RegistrationParameter& parameter : mammogram.Parameters)
    {
      mammogram.From.push_back(parameter.Start);
    }
    return mammogram;
  };
  const JointMammogram cc = mammogramOf(above, targets[0]);
  const JointMammogram mlo = mammogramOf(oblique, targets[1]);
  const RegistrationOptions options = OptionsFrom(Truth());
  const JointRegistrationResult alone[2] = { RegisterTogether({ cc }, options),
    RegisterTogether({ mlo }, options) };
  const JointRegistrationResult joint = RegisterTogether({ cc, mlo }, options);
  ASSERT_EQ(joint.Mammograms.size(), 2u);
  EXPECT_TRUE(joint.Mammograms[0].Converged) << joint.Mammograms[0].StopReason;

  // One value, and two poses of which each is near its own truth: 3 sigma, as in the test of one.
  EXPECT_EQ(joint.Mammograms[0].Pose.Stiffness, joint.Mammograms[1].Pose.Stiffness);
  const BreastPose truths[2] = { above, oblique };
  for (int mammogram = 0; mammogram < 2; ++mammogram)
  {
    SCOPED_TRACE(mammogram);
    const RegistrationResult& result = joint.Mammograms[mammogram];
    EXPECT_NEAR(result.Pose.ThicknessMm, truths[mammogram].ThicknessMm, 3.0);
    // The body is nearly round: its roll is known to 4 or 5 degrees.
    EXPECT_LT(result.StandardDeviations[RollParameter], 6.0);
    EXPECT_NEAR(result.Pose.RollDeg, truths[mammogram].RollDeg,
      3 * result.StandardDeviations[RollParameter]);
    EXPECT_NEAR(result.Pose.LateralMm, truths[mammogram].LateralMm, 1.5);
    EXPECT_LT(result.After.MeanOutlineDistanceMm, 0.7);
    EXPECT_GT(result.After.Correlation, 0.95);
    // What two pictures say of the gland is more than what one does: information adds up.
    EXPECT_LT(result.StandardDeviations[StiffnessParameter],
      alone[mammogram].Mammograms[0].StandardDeviations[StiffnessParameter]);
  }
  EXPECT_NEAR(joint.Mammograms[0].Pose.Stiffness, trueStiffness,
    2 * joint.Mammograms[0].StandardDeviations[StiffnessParameter]);
  EXPECT_EQ(joint.Mammograms[0].StandardDeviations[StiffnessParameter],
    joint.Mammograms[1].StandardDeviations[StiffnessParameter]);

  // Seven of each mammogram and the shared one; their own covariances are parts of the joint one.
  ASSERT_EQ(joint.Unknowns.size(), 15u);
  ASSERT_EQ(joint.Covariance.size(), 225u);
  EXPECT_EQ(std::count_if(joint.Unknowns.begin(), joint.Unknowns.end(),
              [](const JointUnknown& unknown) { return unknown.Shared; }),
    1);
  for (std::size_t i = 0; i < 15; ++i)
  {
    const JointUnknown& row = joint.Unknowns[i];
    const RegistrationResult& result = joint.Mammograms[row.Mammogram];
    EXPECT_EQ(joint.Covariance[i * 16], result.Covariance[row.Parameter * (ParameterCount + 1)]);
    // What is held with a prior makes nothing surer.
    EXPECT_GE(result.ConsideredCovariance[row.Parameter * (ParameterCount + 1)],
      joint.Covariance[i * 16]);
  }
}

/// Projections of one compression see what lies how high: one view alone cannot tell a roll from a
/// shift of what is in the breast.
TEST_F(Registration, ProjectionsOfOneCompressionSeeHowHighTissueLies)
{
  Twin other(8, 16, 30.0);
  const Vector3 aside[2] = { { 230, 0, 605 }, { -230, 0, 605 } }; // 20 degrees about z = 40 mm
  const RegistrationTarget targets[2] = { MakeTarget(other, Truth(), aside[0]),
    MakeTarget(other, Truth(), aside[1]) };
  const RegistrationOptions near = OptionsNearTruth();
  JointMammogram mammogram{ &Model->Model, Model->Placement, Target.get(), near.Parameters,
    near.From, {} };
  const RegistrationResult alone = RegisterTogether({ mammogram }, near).Mammograms.front();
  mammogram.Others = { { &targets[0], aside[0] }, { &targets[1], aside[1] } };
  const JointRegistrationResult joint = RegisterTogether({ mammogram }, near);
  ASSERT_EQ(joint.Mammograms.size(), 1u);
  const RegistrationResult& swept = joint.Mammograms.front();
  EXPECT_TRUE(swept.Converged) << swept.StopReason;
  // Though all three together count as much as one, thickness and roll are known better: from 20
  // degrees to a side tissue 10 mm higher lies 4 mm farther.
  EXPECT_LT(swept.StandardDeviations[ThicknessParameter],
    0.7 * alone.StandardDeviations[ThicknessParameter]);
  EXPECT_LT(swept.StandardDeviations[RollParameter], 0.9 * alone.StandardDeviations[RollParameter]);
  for (const PoseParameter& parameter : PoseParameters)
  {
    if (!swept.Parameters[parameter.Index].Fixed)
    {
      EXPECT_NEAR(swept.Values[parameter.Index], Truth().*parameter.Value,
        2 * swept.StandardDeviations[parameter.Index])
        << parameter.Name;
    }
  }
  EXPECT_LT(swept.After.MeanOutlineDistanceMm, 0.7);
  // 3 pictures at each state, and at the start that of the middle.
  EXPECT_GT(swept.Projections, 2 * alone.Projections);
  ASSERT_EQ(joint.Unknowns.size(), 7u);
  EXPECT_EQ(joint.Covariance[0], swept.Covariance[0]);
  mammogram.Others[0].FocalSpotMm[2] = 0;
  EXPECT_THROW(RegisterTogether({ mammogram }, near), InputError);
}

/// Each mammogram alone is the same search as both without anything in common.
TEST_F(Registration, MammogramsThatShareNothingFreeEndWhereEachAloneEnds)
{
  const RegistrationOptions near = OptionsNearTruth();
  const JointMammogram mammogram{ &Model->Model, Model->Placement, Target.get(), near.Parameters,
    near.From };
  const RegistrationResult alone = Register(Model->Model, Model->Placement, *Target, near);
  const JointRegistrationResult joint = RegisterTogether({ mammogram, mammogram }, near);
  for (const RegistrationResult& result : joint.Mammograms)
  {
    for (const int parameter :
      { ThicknessParameter, RollParameter, LateralParameter, AnteriorParameter })
    {
      // The trust region is one of twice as many unknowns, so that steps differ; both stop within
      // half a standard deviation of the best.
      EXPECT_NEAR(result.Values[parameter], alone.Values[parameter],
        alone.StandardDeviations[parameter]);
    }
  }
  // No entry between the one and the other.
  ASSERT_EQ(joint.Covariance.size(), 196u);
  for (std::size_t i = 0; i < 7; ++i)
  {
    for (std::size_t j = 7; j < 14; ++j)
    {
      EXPECT_NEAR(joint.Covariance[i * 14 + j], 0, 1e-9);
    }
  }
  EXPECT_THROW(RegisterTogether({}, near), InputError);
  JointMammogram stiffer = mammogram;
  stiffer.Parameters[StiffnessParameter].Start = 2;
  EXPECT_THROW(RegisterTogether({ mammogram, stiffer }, near), InputError);
}

/// The shift that considering predicts is the one that registering at another held value finds.
TEST_F(Registration, ConsideredParametersMoveTheOthersAsPredicted)
{
  RegistrationOptions options = OptionsNearTruth();
  for (const int held : { PitchParameter, YawParameter, TiltParameter })
  {
    options.Parameters[held].Fixed = true;
  }
  // Smooth enough to tell: no robust kinks, and a minimum found beyond the usual end.
  options.Parameters[PitchParameter].PriorSigma = 2;
  options.Parameters[YawParameter].PriorSigma = 0;
  options.Parameters[TiltParameter].PriorSigma = 0;
  options.Parameters[StiffnessParameter].PriorSigma = 0;
  const RegistrationResult held = Register(Model->Model, Model->Placement, *Target, options);
  const auto entry = [&](const std::vector<double>& covariance, int row, int column)
  { return covariance[row * ParameterCount + column]; };
  const std::vector<double>& considered = held.ConsideredCovariance;
  EXPECT_DOUBLE_EQ(entry(considered, PitchParameter, PitchParameter), 4); // its prior's
  EXPECT_EQ(entry(considered, YawParameter, YawParameter), 0);

  options.Parameters[PitchParameter].Start = 2;
  options.From[PitchParameter] = 2;
  const RegistrationResult moved = Register(Model->Model, Model->Placement, *Target, options);
  for (const int parameter :
    { ThicknessParameter, RollParameter, LateralParameter, AnteriorParameter })
  {
    // Of one sigma of the pitch: covariance over sigma.
    const double predicted = entry(considered, parameter, PitchParameter) / 2;
    EXPECT_NEAR(entry(considered, parameter, parameter),
      entry(held.Covariance, parameter, parameter) + predicted * predicted, 1e-9);
    // Each search stops within half a standard deviation of its best.
    EXPECT_NEAR(moved.Values[parameter] - held.Values[parameter], predicted,
      held.StandardDeviations[parameter])
      << held.Parameters[parameter].Name;
  }
  // Where everything held is known, nothing is left to consider.
  options.Parameters[PitchParameter].PriorSigma = 0;
  const RegistrationResult known = Register(Model->Model, Model->Placement, *Target, options);
  for (std::size_t i = 0; i < known.Covariance.size(); ++i)
  {
    EXPECT_NEAR(known.ConsideredCovariance[i], known.Covariance[i], 1e-9);
  }
}

TEST_F(Registration, DeviationsCountEdgesRounderThanAUnits)
{
  const RegistrationOptions options = OptionsNearTruth();
  UnitPlacement round = Model->Placement;
  round.Unit.EdgeRadiusMm = SearchedEdgeRadiusMm;
  const RegistrationResult asTheUnit = Register(Model->Model, Model->Placement, *Target, options);
  const RegistrationResult rounder = Register(Model->Model, round, *Target, options);
  // The paddle tilts to press out what is too thick behind round edges.
  const double moved = rounder.Values[TiltParameter] - asTheUnit.Values[TiltParameter];
  EXPECT_GT(moved, 0.3);
  const auto variance = [](const RegistrationResult& result)
  { return std::pow(result.StandardDeviations[TiltParameter], 2); };
  // Deviations know it by the model's derivatives: half to twice of what two searches, which stop
  // within half a deviation, are apart.
  const double counted = std::sqrt(std::max(0.0, variance(rounder) - variance(asTheUnit)));
  EXPECT_GT(counted, 0.5 * moved);
  EXPECT_LT(counted, 2 * moved);
  EXPECT_NEAR(rounder.Values[TiltParameter], Truth().TiltDeg,
    2 * rounder.StandardDeviations[TiltParameter]);
}

TEST_F(Registration, UnusableInputIsRefused)
{
  RegistrationOptions options = OptionsFrom(Truth());
  options.Parameters[RollParameter].Start = 1000;
  EXPECT_THROW(Register(Model->Model, Model->Placement, *Target, options, {}), InputError);
  options = OptionsFrom(Truth());
  options.Parameters.pop_back();
  EXPECT_THROW(Register(Model->Model, Model->Placement, *Target, options, {}), InputError);
  BreastModel withoutXRays(MakeAnatomy(4), Twin::Materials(), {});
  EXPECT_THROW(Register(withoutXRays, Model->Placement, *Target, OptionsFrom(Truth()), {}),
    InputError);
  RegistrationTarget target = *Target;
  target.BreastMask.assign(target.BreastMask.size(), 0);
  EXPECT_THROW(Register(Model->Model, Model->Placement, target, OptionsFrom(Truth()), {}),
    InputError);
}
