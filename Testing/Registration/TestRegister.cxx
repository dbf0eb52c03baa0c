// SPDX-License-Identifier: Apache-2.0
// The target is not made by the model: it has another mesh density for the mechanics and for the
// picture, another spectrum (30 instead of 20 keV), noise, and an unknown scale and offset of its
// intensities.
#include "Annealing.h"
#include "Error.h"
#include "Registration.h"
#include "RegistrationTwin.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

using namespace mammoray;
using namespace mammoray::test;

namespace
{
RegistrationOptions OptionsFrom(const BreastPose& start)
{
  RegistrationOptions options;
  options.Parameters = DefaultParameters(start);
  options.PixelSizesMm = { 3.0 };
  return options;
}

/// From a place near the truth, without looking for a better start.
RegistrationOptions OptionsNearTruth()
{
  BreastPose start = Truth();
  start.ThicknessMm += 1.5;
  start.RollDeg -= 3;
  start.ShiftLateralMm += 2;
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
    const Twin other(8, 16, 30.0);
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
    start.ShiftLateralMm = Truth().ShiftLateralMm - sense * 15;
    start.ShiftAnteriorMm = 3;
    const RegistrationResult result = Register(Model->Model, *Target, OptionsFrom(start), {});
    EXPECT_TRUE(result.Converged) << result.StopReason;
    // The result's own standard deviations must be useful, and the errors no larger than what is
    // called useful: the ball is all that shows the angle, and thickness has little effect on a
    // z-scored picture.
    struct Expected
    {
      int Parameter;
      double Truth;
      double Useful;
    };
    // Half of the 3 mm pixels for the shifts.
    for (const Expected& expected : { Expected{ ThicknessParameter, Truth().ThicknessMm, 3.0 },
           Expected{ RollParameter, Truth().RollDeg, 6.0 },
           Expected{ LateralParameter, Truth().ShiftLateralMm, 1.5 },
           Expected{ AnteriorParameter, Truth().ShiftAnteriorMm, 1.5 } })
    {
      const double deviation = result.StandardDeviations[expected.Parameter];
      SCOPED_TRACE(result.Parameters[expected.Parameter].Name);
      EXPECT_GT(deviation, 0);
      EXPECT_LT(deviation, expected.Useful);
      EXPECT_NEAR(result.Values[expected.Parameter], expected.Truth, expected.Useful);
    }
    EXPECT_LT(result.After.MeanOutlineDistanceMm, 0.7);
    EXPECT_GT(result.After.Correlation, 0.95);
    EXPECT_GT(result.After.Correlation, result.Before.Correlation);
    ASSERT_GE(result.Iterations.size(), 2u);
    EXPECT_LT(result.Iterations.back().Cost, result.Iterations.front().Cost);
    EXPECT_TRUE(std::isnan(result.StandardDeviations[VerticalParameter])); // fixed
    EXPECT_EQ(result.Pose.ShiftVerticalMm, 0);
  }
}

TEST_F(Registration, NothingFreeAnswersTheStart)
{
  RegistrationOptions options = OptionsFrom(Truth());
  for (RegistrationParameter& parameter : options.Parameters)
  {
    parameter.Fixed = true;
  }
  const RegistrationResult result = Register(Model->Model, *Target, options, {});
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
  const RegistrationResult result = Register(Model->Model, *Target, options,
    [&](double, const char* stage) { return std::string(stage) != "project" || ++calls < 3; });
  EXPECT_FALSE(result.Converged);
  EXPECT_NE(result.StopReason.find("interrupted"), std::string::npos);
  EXPECT_GT(result.After.Correlation, 0.9);
}

TEST_F(Registration, ScoutingEndsWhereTheRealSimulationAloneEnds)
{
  BreastPose start = Truth();
  start.ThicknessMm += 2;
  start.RollDeg += 5;
  start.ShiftLateralMm = 0;
  RegistrationOptions options = OptionsFrom(start);
  options.PixelSizesMm = { 4.0, 3.0 };
  const RegistrationResult scouted = Register(Model->Model, *Target, options, {});
  RegistrationModel unscouted = Model->Model;
  unscouted.Scout = nullptr;
  EXPECT_THROW(Register(unscouted, *Target, options, {}), InputError); // an embedding in nothing
  unscouted.ScoutEmbedding = nullptr;
  const RegistrationResult alone = Register(unscouted, *Target, options, {});
  EXPECT_TRUE(scouted.Converged) << scouted.StopReason;
  EXPECT_TRUE(alone.Converged) << alone.StopReason;
  // The state answered is one of the real simulation, whose nodes are more.
  EXPECT_EQ(scouted.State.Positions.size(), alone.State.Positions.size());
  // The cost of this small twin has dents, in one of which each ends: three standard deviations of
  // each of the two, and an outline and picture that both agree.
  for (const int parameter :
    { ThicknessParameter, RollParameter, LateralParameter, AnteriorParameter })
  {
    EXPECT_NEAR(scouted.Values[parameter], alone.Values[parameter],
      3 * (scouted.StandardDeviations[parameter] + alone.StandardDeviations[parameter]))
      << alone.Parameters[parameter].Name;
  }
  for (const RegistrationResult* result : { &scouted, &alone })
  {
    EXPECT_LT(result->After.MeanOutlineDistanceMm, 0.7);
    EXPECT_GT(result->After.Correlation, 0.95);
  }
}

TEST_F(Registration, DifferencesEndWhereExactDerivativesEndAtMoreEquilibria)
{
  RegistrationOptions options = OptionsNearTruth();
  const RegistrationResult exact = Register(Model->Model, *Target, options, {});
  options.Derivatives = RegistrationDerivatives::CentralDifferences;
  const RegistrationResult differences = Register(Model->Model, *Target, options, {});
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
  const RegistrationResult stopped =
    Register(Model->Model, *Target, options, [&](double, const char*) { return ++calls < 200; });
  EXPECT_FALSE(stopped.Converged);
  EXPECT_NE(stopped.StopReason.find("interrupted"), std::string::npos);
}

TEST_F(Registration, AnnealingSpendsItsEquilibriaAndKeepsTheBest)
{
  const RegistrationOptions options = OptionsNearTruth();
  AnnealingOptions annealing;
  annealing.Equilibria = 6;
  annealing.FirstStep = 0.3;
  const RegistrationResult result = Anneal(Model->Model, *Target, options, annealing, {});
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
  const RegistrationResult stopped = Anneal(Model->Model, *Target, options, annealing, stopAtThird);
  EXPECT_EQ(stopped.Evaluations, 3);
  EXPECT_NE(stopped.StopReason.find("interrupted"), std::string::npos);
  EXPECT_LE(stopped.Iterations.back().Cost, stopped.Iterations.front().Cost);
  annealing.Equilibria = 0;
  EXPECT_THROW(Anneal(Model->Model, *Target, options, annealing, {}), InputError);
}

TEST_F(Registration, UnusableInputIsRefused)
{
  RegistrationOptions options = OptionsFrom(Truth());
  options.Parameters[RollParameter].Start = 1000;
  EXPECT_THROW(Register(Model->Model, *Target, options, {}), InputError);
  options = OptionsFrom(Truth());
  options.Parameters.pop_back();
  EXPECT_THROW(Register(Model->Model, *Target, options, {}), InputError);
  RegistrationModel incomplete = Model->Model;
  incomplete.Projector = nullptr;
  EXPECT_THROW(Register(incomplete, *Target, OptionsFrom(Truth()), {}), InputError);
  RegistrationTarget target = *Target;
  target.BreastMask.assign(target.BreastMask.size(), 0);
  EXPECT_THROW(Register(Model->Model, target, OptionsFrom(Truth()), {}), InputError);
}
