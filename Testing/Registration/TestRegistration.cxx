// SPDX-License-Identifier: Apache-2.0
// The target is not made by the model: it has another mesh density for the mechanics and for the
// picture, another spectrum (30 instead of 20 keV), noise, and an unknown scale and offset of its
// intensities.
#include "RegistrationTwin.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Registration/Private/RegistrationResiduals.h"
#include "mammoray/Registration/Registration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

using namespace mammoray;
using namespace mammoray::test;

namespace
{
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

  /// One view of the target. Compared globally: the ball's surface is that of tetrahedra of 5 to 8
  /// mm, others in the target than in the model, so that its edges tell a gradient more of the
  /// meshes than of the pose.
  static RegistrationProblem ProblemFrom(const BreastPose& start)
  {
    RegistrationProblem problem = Model->Problem();
    View& view = problem.Views.emplace_back();
    view.Target = *Target;
    view.Parameters = DefaultParameters(start);
    problem.Options.PixelSizesMm = { 3.0 };
    problem.Options.Comparison = PictureComparison::Global;
    return problem;
  }
  /// From a place near the truth, without looking for a better start.
  static RegistrationProblem ProblemNearTruth()
  {
    BreastPose start = Truth();
    start.ThicknessMm += 1.5;
    start.RollDeg -= 3;
    start.LateralMm += 2;
    RegistrationProblem problem = ProblemFrom(start);
    BeginAtStart(problem.Views[0]);
    return problem;
  }
  static void BeginAtStart(View& view)
  {
    for (const RegistrationParameter& parameter : view.Parameters)
    {
      view.From.push_back(parameter.Start);
    }
  }
  static RegistrationResult Find(RegistrationProblem& problem,
    const ProgressCallback& progress = {}, const SearchObserver& observer = {})
  {
    for (View& view : problem.Views)
    {
      view.Levels = MakeLevels(view.Target, problem.Options.PixelSizesMm);
    }
    return Register(problem, progress, observer);
  }
  static ViewResult FindFirst(RegistrationProblem problem, const ProgressCallback& progress = {})
  {
    return Find(problem, progress).Views.front();
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
    const ViewResult result = FindFirst(ProblemFrom(start));
    EXPECT_TRUE(result.Converged) << result.StopReason;
    // The result's own standard deviations must be useful, and the errors no larger than what is
    // called useful: the ball is all that shows the angle, and thickness has little effect on a
    // z-scored picture, so that it stays near its prior, of 5 mm.
    struct Expected
    {
      int Parameter;
      double Truth;
      double Error;
      double Useful;
    };
    // Half of the 3 mm pixels for the shifts.
    for (const Expected& expected : { Expected{ ThicknessParameter, Truth().ThicknessMm, 3.0, 4.0 },
           Expected{ RollParameter, Truth().RollDeg, 6.0, 7.0 },
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
    ASSERT_GE(result.Iterations.size(), 2u);
    EXPECT_LT(result.Iterations.back().Cost, result.Iterations.front().Cost);
    EXPECT_TRUE(std::isnan(result.StandardDeviations[StiffnessParameter])); // fixed
    EXPECT_EQ(result.Pose.Stiffness, 1);
  }
}

TEST_F(Registration, NothingFreeAnswersTheStart)
{
  RegistrationProblem problem = ProblemFrom(Truth());
  for (RegistrationParameter& parameter : problem.Views[0].Parameters)
  {
    parameter.Fixed = true;
  }
  const ViewResult result = FindFirst(problem);
  EXPECT_TRUE(result.Converged);
  EXPECT_EQ(result.Pose.ThicknessMm, Truth().ThicknessMm);
  EXPECT_EQ(result.Evaluations, 1);
  // The true pose: what is left is the difference of the meshes.
  EXPECT_GT(result.After.Correlation, 0.95);
  EXPECT_LT(result.After.MeanOutlineDistanceMm, 0.7);
}

TEST_F(Registration, StopsWhenAskedWithTheBestSoFar)
{
  RegistrationProblem problem = ProblemFrom(Truth());
  int calls = 0;
  const ViewResult result = FindFirst(problem,
    [&](double, const char* stage) { return std::string(stage) != "project" || ++calls < 3; });
  EXPECT_FALSE(result.Converged);
  EXPECT_NE(result.StopReason.find("interrupted"), std::string::npos);
  EXPECT_GT(result.After.Correlation, 0.9);
}

TEST_F(Registration, ShowsEachStepToAnObserver)
{
  BreastPose start = Truth();
  start.ThicknessMm += 4;
  RegistrationProblem problem = ProblemFrom(start);
  BeginAtStart(problem.Views[0]);
  std::vector<double> outlines;
  const RegistrationResult result = Find(problem, {},
    [&](const std::vector<SearchedView>& views)
    {
      ASSERT_EQ(views.size(), 1U);
      const SearchedView& view = views.front();
      EXPECT_EQ(view.Breast.Pose().ThicknessMm, view.Result.Values[ThicknessParameter]);
      const SyntheticMammogram synthetic =
        Synthesize(view.Breast, view.Target.Grid, ChestWallCentre(view.Target), 1);
      outlines.push_back(Compare(synthetic, view.Target).MeanOutlineDistanceMm);
    });
  ASSERT_EQ(outlines.size(), result.Views.front().Iterations.size());
  EXPECT_LT(outlines.back(), 0.5 * outlines.front());
}

TEST_F(Registration, PredictedSearchEndsWhereTheSimulationAloneEnds)
{
  BreastPose start = Truth();
  start.ThicknessMm += 2;
  start.RollDeg += 5;
  start.LateralMm = 0;
  RegistrationProblem problem = ProblemFrom(start);
  problem.Options.PixelSizesMm = { 4.0, 3.0 };
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
  const ViewResult predicted = FindFirst(problem, keep);
  EXPECT_TRUE(goesOnBeyond(0.4));
  fractions.clear();
  Twin direct(6, 12, 20.0, false);
  problem.Model = direct.Problem().Model;
  const ViewResult alone = FindFirst(problem, keep);
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
  for (const ViewResult* result : { &predicted, &alone })
  {
    EXPECT_LT(result->After.MeanOutlineDistanceMm, 0.7);
    EXPECT_GT(result->After.Correlation, 0.95);
  }
}

TEST_F(Registration, GradientsAreComparedWhereTissueTellsFromWhereTheWholeHasLed)
{
  RegistrationProblem problem = ProblemNearTruth();
  problem.Options.Comparison = PictureComparison::Gradient;
  const auto comparisons = [](const ViewResult& result)
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
  const ViewResult result = FindFirst(problem);
  EXPECT_TRUE(result.Converged) << result.StopReason;
  EXPECT_EQ(comparisons(result), (std::vector<std::string>{ "global", "gradient" }));
  EXPECT_EQ(result.Values, result.Iterations.back().Parameters);
  EXPECT_GT(result.After.Correlation, 0.95);
  // Counted as the options say until then; by what residuals tell from there on.
  for (const RegistrationIteration& row : { result.Iterations.front(), result.Iterations.back() })
  {
    const bool first = row.Comparison == "global";
    problem.Options.Comparison = first ? PictureComparison::Global : PictureComparison::Gradient;
    const RegistrationTarget coarse = CoarsenTo(*Target, row.PixelSizeMm);
    const RegistrationResiduals residuals(coarse, problem.Views[0].Parameters, problem.Options);
    PosedBreast there = Model->At(PoseOf(row.Parameters), &result.State);
    const double ratio = row.IntensityCost / residuals.Costs(residuals.Evaluate(there)).Intensity;
    if (first)
    {
      EXPECT_NEAR(ratio, 1, 2e-3); // two equilibria of one pose
    }
    else
    {
      EXPECT_GT(std::abs(std::log(ratio)), 0.1);
    }
  }
  problem.Options.Comparison = PictureComparison::Gradient;
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
  problem.Options.PixelSizesMm = { 2.0 };
  problem.Views[0].Target = little;
  const ViewResult whole = FindFirst(problem);
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
  RegistrationProblem problem = ProblemFrom(Truth());
  problem.Options.PixelSizesMm = { 6.0, 4.0 };
  problem.Views[0].Target = larger;
  const ViewResult result = FindFirst(problem);
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
  const auto viewOf = [&](const BreastPose& pose, const RegistrationTarget& target)
  {
    BreastPose start = pose;
    start.ThicknessMm += 1.5;
    start.RollDeg -= 3;
    start.LateralMm += 2;
    start.Stiffness = 1;
    View view;
    view.Target = target;
    view.Parameters = DefaultParameters(start);
    view.Parameters[StiffnessParameter].Fixed = false;
    BeginAtStart(view);
    return view;
  };
  const View cc = viewOf(above, targets[0]);
  const View mlo = viewOf(oblique, targets[1]);
  RegistrationProblem problem = ProblemFrom(Truth());
  const auto find = [&](const std::vector<View>& views)
  {
    problem.Views = views;
    return Find(problem);
  };
  const RegistrationResult alone[2] = { find({ cc }), find({ mlo }) };
  const RegistrationResult joint = find({ cc, mlo });
  ASSERT_EQ(joint.Views.size(), 2u);
  EXPECT_TRUE(joint.Views[0].Converged) << joint.Views[0].StopReason;

  // One value, and two poses of which each is near its own truth: 3 sigma, as in the test of one.
  EXPECT_EQ(joint.Views[0].Pose.Stiffness, joint.Views[1].Pose.Stiffness);
  const BreastPose truths[2] = { above, oblique };
  for (int mammogram = 0; mammogram < 2; ++mammogram)
  {
    SCOPED_TRACE(mammogram);
    const ViewResult& result = joint.Views[mammogram];
    EXPECT_NEAR(result.Pose.ThicknessMm, truths[mammogram].ThicknessMm, 3.0);
    // The body is nearly round: its roll is known to 5 to 7 degrees.
    EXPECT_LT(result.StandardDeviations[RollParameter], 7.0);
    EXPECT_NEAR(result.Pose.RollDeg, truths[mammogram].RollDeg,
      3 * result.StandardDeviations[RollParameter]);
    EXPECT_NEAR(result.Pose.LateralMm, truths[mammogram].LateralMm, 1.5);
    EXPECT_LT(result.After.MeanOutlineDistanceMm, 0.7);
    EXPECT_GT(result.After.Correlation, 0.95);
    // What two pictures say of the gland is more than what one does: information adds up.
    EXPECT_LT(result.StandardDeviations[StiffnessParameter],
      alone[mammogram].Views[0].StandardDeviations[StiffnessParameter]);
  }
  EXPECT_NEAR(joint.Views[0].Pose.Stiffness, trueStiffness,
    2 * joint.Views[0].StandardDeviations[StiffnessParameter]);
  EXPECT_EQ(joint.Views[0].StandardDeviations[StiffnessParameter],
    joint.Views[1].StandardDeviations[StiffnessParameter]);

  // Eight of each mammogram and the shared one; their own covariances are parts of the joint one.
  ASSERT_EQ(joint.FreeParameters.size(), 17u);
  ASSERT_EQ(joint.Covariance.size(), 289u);
  EXPECT_EQ(std::count_if(joint.FreeParameters.begin(), joint.FreeParameters.end(),
              [](const FreeParameter& parameter) { return parameter.IsShared(); }),
    1);
  for (std::size_t i = 0; i < 17; ++i)
  {
    const FreeParameter& row = joint.FreeParameters[i];
    const ViewResult& result = joint.Views[row.Views.front()];
    EXPECT_EQ(joint.Covariance[i * 18], result.Covariance[row.Parameter * (ParameterCount + 1)]);
    // What is held with a prior makes nothing surer.
    EXPECT_GE(result.ConsideredCovariance[row.Parameter * (ParameterCount + 1)],
      joint.Covariance[i * 18]);
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
  RegistrationProblem near = ProblemNearTruth();
  const ViewResult alone = FindFirst(near);
  for (int side = 0; side < 2; ++side)
  {
    near.Views[0].Projections.push_back(
      { aside[side], MakeLevels(targets[side], near.Options.PixelSizesMm) });
  }
  const RegistrationResult joint = Find(near);
  ASSERT_EQ(joint.Views.size(), 1u);
  const ViewResult& swept = joint.Views.front();
  EXPECT_TRUE(swept.Converged) << swept.StopReason;
  // Though all three together count as much as one, thickness and roll are known better: from 20
  // degrees to a side tissue 10 mm higher lies 4 mm farther.
  EXPECT_LT(swept.StandardDeviations[ThicknessParameter],
    0.75 * alone.StandardDeviations[ThicknessParameter]);
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
  ASSERT_EQ(joint.FreeParameters.size(), 8u);
  EXPECT_EQ(joint.Covariance[0], swept.Covariance[0]);
  EXPECT_EQ(swept.ProjectionsAfter.size(), 2u);
  near.Views[0].Projections[0].FocalSpotMm[2] = 0;
  EXPECT_THROW(Find(near), InputError);
}

/// Each mammogram alone is the same search as both without anything in common.
TEST_F(Registration, MammogramsThatShareNothingFreeEndWhereEachAloneEnds)
{
  RegistrationProblem near = ProblemNearTruth();
  const ViewResult alone = FindFirst(near);
  near.Views.push_back(near.Views[0]);
  const RegistrationResult joint = Find(near);
  for (const ViewResult& result : joint.Views)
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
  ASSERT_EQ(joint.Covariance.size(), 256u);
  for (std::size_t i = 0; i < 8; ++i)
  {
    for (std::size_t j = 8; j < 16; ++j)
    {
      EXPECT_NEAR(joint.Covariance[i * 16 + j], 0, 1e-9);
    }
  }
  near.Views[1].Parameters[StiffnessParameter].Start = 2;
  EXPECT_THROW(Find(near), InputError);
  near.Views.clear();
  EXPECT_THROW(Find(near), InputError);
}

/// The shift that considering predicts is the one that registering at another held value finds.
TEST_F(Registration, ConsideredParametersMoveTheOthersAsPredicted)
{
  RegistrationProblem problem = ProblemNearTruth();
  for (const int held : { PitchParameter, YawParameter, TiltParameter })
  {
    problem.Views[0].Parameters[held].Fixed = true;
  }
  // Smooth enough to tell: no robust kinks, and a minimum found beyond the usual end.
  problem.Views[0].Parameters[PitchParameter].PriorSigma = 2;
  problem.Views[0].Parameters[YawParameter].PriorSigma = 0;
  problem.Views[0].Parameters[TiltParameter].PriorSigma = 0;
  problem.Views[0].Parameters[StiffnessParameter].PriorSigma = 0;
  const ViewResult held = FindFirst(problem);
  const auto entry = [&](const std::vector<double>& covariance, int row, int column)
  { return covariance[row * ParameterCount + column]; };
  const std::vector<double>& considered = held.ConsideredCovariance;
  EXPECT_DOUBLE_EQ(entry(considered, PitchParameter, PitchParameter), 4); // its prior's
  EXPECT_EQ(entry(considered, YawParameter, YawParameter), 0);

  problem.Views[0].Parameters[PitchParameter].Start = 2;
  problem.Views[0].From[PitchParameter] = 2;
  const ViewResult moved = FindFirst(problem);
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
  problem.Views[0].Parameters[PitchParameter].PriorSigma = 0;
  const ViewResult known = FindFirst(problem);
  for (std::size_t i = 0; i < known.Covariance.size(); ++i)
  {
    EXPECT_NEAR(known.ConsideredCovariance[i], known.Covariance[i], 1e-9);
  }
}

TEST_F(Registration, DeviationsCountEdgesRounderThanAUnits)
{
  RegistrationProblem problem = ProblemNearTruth();
  const ViewResult asTheUnit = FindFirst(problem);
  problem.Views[0].Unit.EdgeRadiusMm = SearchedEdgeRadiusMm;
  const ViewResult rounder = FindFirst(problem);
  // The paddle tilts to press out what is too thick behind round edges, as far as its prior lets
  // it.
  const double moved = rounder.Values[TiltParameter] - asTheUnit.Values[TiltParameter];
  EXPECT_GT(moved, 0.05);
  const auto variance = [](const ViewResult& result)
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
  RegistrationProblem problem = ProblemFrom(Truth());
  problem.Views[0].Parameters[RollParameter].Start = 1000;
  EXPECT_THROW(FindFirst(problem), InputError);
  problem = ProblemFrom(Truth());
  problem.Views[0].Parameters.pop_back();
  EXPECT_THROW(FindFirst(problem), InputError);
  problem = ProblemFrom(Truth());
  problem.Model =
    std::make_shared<BreastModel>(MakeAnatomy(4), Twin::Materials(), std::vector<int>());
  EXPECT_THROW(FindFirst(problem), InputError);
  problem = ProblemFrom(Truth());
  EXPECT_THROW(Register(problem), InputError) << "its levels were not made";
  std::vector<unsigned char>& mask = problem.Views[0].Target.BreastMask;
  mask.assign(mask.size(), 0);
  EXPECT_THROW(FindFirst(problem), InputError);
}
