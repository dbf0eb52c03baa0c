// SPDX-License-Identifier: Apache-2.0
#include "RegistrationResiduals.h"
#include "RegistrationTwin.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

using namespace mammoray;
using namespace mammoray::test;

namespace
{
/// Length of the difference of two vectors over that of the first, between two of their entries.
double Difference(const std::vector<double>& a, const std::vector<double>& b, std::size_t begin,
  std::size_t end)
{
  double difference = 0;
  double length = 0;
  for (std::size_t index = begin; index < end; ++index)
  {
    difference += (a[index] - b[index]) * (a[index] - b[index]);
    length += a[index] * a[index];
  }
  return std::sqrt(difference / length);
}
}

TEST(RegistrationResiduals, JacobianAgreesWithDifferencesOfSolvedStates)
{
  std::string reason;
  if (ListDevices(&reason).empty())
  {
    GTEST_SKIP() << reason;
  }
  const Twin twin(6, 10, 20.0);
  const RegistrationTarget target = Coarsen(MakeTarget(twin, Truth()), 4);
  BreastPose pose = Truth();
  pose.ThicknessMm = 49;
  pose.RollDeg = 3;
  pose.ShiftLateralMm = 2.5;
  pose.ShiftAnteriorMm = 5;
  pose.ShiftVerticalMm = 1;
  RegistrationOptions options;
  options.Parameters = DefaultParameters(pose);
  // A prior away from its middle, so that its derivative is seen.
  options.Parameters[0].Start = 47;
  const RegistrationResiduals residuals(twin.Model, target, options);
  const std::vector<double> values{ pose.ThicknessMm, pose.RollDeg, pose.ShiftLateralMm,
    pose.ShiftAnteriorMm, pose.ShiftVerticalMm };
  const auto solve = [&](const std::vector<double>& at, const CompressionState* start)
  {
    const BreastPose there = PoseOf(at);
    return twin.Simulation.Compress(
      PlatesOf(PlaceUnit(twin.Model.Axes, twin.Model.Anchor, twin.Model.Unit, there),
        twin.Model.Unit, there.ThicknessMm),
      start);
  };
  const CompressionState state = solve(values, nullptr);
  std::vector<int> wanted(values.size());
  std::iota(wanted.begin(), wanted.end(), 0);
  const RegistrationResiduals::Jacobian jacobian = residuals.Differentiate(values, state, wanted);

  const std::size_t outline = residuals.NumberOfOutlineResiduals();
  const std::size_t compared = outline + residuals.NumberOfIntensityResiduals();
  ASSERT_GT(outline, 50u);
  ASSERT_GT(compared, outline + 100);
  for (const int parameter : wanted)
  {
    double bestOutline = 1e9;
    double bestIntensity = 1e9;
    for (const double step : { 0.1, 0.01, 0.001 })
    {
      std::vector<double> sides[2];
      for (int side = 0; side < 2; ++side)
      {
        std::vector<double> moved = values;
        moved[parameter] += side == 0 ? -step : step;
        sides[side] = residuals.Evaluate(moved, solve(moved, &state));
      }
      std::vector<double> differences(sides[0].size());
      for (std::size_t index = 0; index < differences.size(); ++index)
      {
        differences[index] = (sides[1][index] - sides[0][index]) / (2 * step);
      }
      const std::vector<double>& column = jacobian.Columns[parameter];
      const double byOutline = Difference(column, differences, 0, outline);
      const double byIntensity = Difference(column, differences, outline, compared);
      bestOutline = std::min(bestOutline, byOutline);
      bestIntensity = std::min(bestIntensity, byIntensity);
      for (std::size_t prior = compared; prior < column.size(); ++prior)
      {
        EXPECT_NEAR(column[prior], differences[prior], 1e-9);
      }
    }
    // The outline is smooth between kinks: what is left is the equilibrium's own tolerance.
    EXPECT_LT(bestOutline, 1e-4) << options.Parameters[parameter].Name;
    // Path lengths have kinks where a ray goes over an edge. The fewer rays do within a step, the
    // nearer the differences come (0.3 at 0.1 mm, 0.05 at 0.01 mm); below 0.001 mm they are lost in
    // the rounding of path lengths, 1e-6 mm.
    EXPECT_LT(bestIntensity, 0.02) << options.Parameters[parameter].Name;
  }
}
