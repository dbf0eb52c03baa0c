// SPDX-License-Identifier: Apache-2.0
// The target is not made by the model: it has another mesh density for the mechanics and for the
// picture, another spectrum (30 instead of 20 keV), noise, and an unknown scale and offset of its
// intensities.
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
           Expected{ RollParameter, Truth().RollDeg, 5.0 },
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
