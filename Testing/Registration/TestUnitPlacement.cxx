// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/BreastModel.h"

#include <gtest/gtest.h>

using namespace mammoray;

namespace
{
void ExpectVelocity(const Plate& minus, const Plate& plus, double step, const Plate& at,
  const PlateVelocity& velocity)
{
  // Points of the plate move with Linear + Angular x (x - Edge); 1e-7: central differences with
  // step 1e-4 of numbers of size 100.
  const auto difference = [&](const Vector3& a, const Vector3& b)
  { return (0.5 / step) * (b - a); };
  const Vector3 edge = difference(minus.Edge, plus.Edge);
  const Vector3 normal = difference(minus.Normal, plus.Normal);
  const Vector3 inward = difference(minus.Inward, plus.Inward);
  const Vector3 normalExpected = Cross(velocity.Angular, at.Normal);
  const Vector3 inwardExpected = Cross(velocity.Angular, at.Inward);
  for (int d = 0; d < 3; ++d)
  {
    EXPECT_NEAR(edge[d], velocity.Linear[d], 1e-7);
    EXPECT_NEAR(normal[d], normalExpected[d], 1e-7);
    EXPECT_NEAR(inward[d], inwardExpected[d], 1e-7);
  }
}
}

TEST(UnitPlacement, PlateVelocitiesAgreeWithDifferencesOfThePlates)
{
  for (const char* orientation : { "LPS", "ALS", "RAS", "LAS" }) // the last is left-handed
  {
    UnitPlacement placement{ { AnatomicalAxes::FromCode(orientation), { 3, -7, 11 } }, {} };
    placement.Unit.SupportEdgeMm = -0.4;
    placement.Unit.PaddleEdgeMm = 0.6;
    BreastPose pose;
    pose.ThicknessMm = 47;
    pose.RollDeg = 12;
    pose.PitchDeg = -7;
    pose.YawDeg = 15;
    pose.TiltDeg = 4;
    pose.LateralMm = -4;
    pose.AnteriorMm = 9;
    pose.VerticalMm = 2;
    const auto velocities = placement.PlateVelocitiesAt(pose);
    const auto platesAt = [&](const BreastPose& at) { return placement.PlatesAt(at); };
    const PlatePair here = platesAt(pose);
    // The stiffness moves no plate.
    ASSERT_EQ(velocities.size(), std::size_t{ StiffnessParameter });
    for (int parameter = 0; parameter < StiffnessParameter; ++parameter)
    {
      SCOPED_TRACE(std::string(orientation) + " " + PoseParameters[parameter].Name);
      double BreastPose::*const value = PoseParameters[parameter].Value;
      constexpr double step = 1e-4;
      BreastPose minus = pose;
      BreastPose plus = pose;
      minus.*value -= step;
      plus.*value += step;
      const PlatePair a = platesAt(minus);
      const PlatePair b = platesAt(plus);
      ExpectVelocity(a.Support, b.Support, step, here.Support, velocities[parameter].Support);
      ExpectVelocity(a.Paddle, b.Paddle, step, here.Paddle, velocities[parameter].Paddle);
    }
  }
}
