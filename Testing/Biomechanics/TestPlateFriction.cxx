// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Biomechanics/Private/PlateFriction.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
using namespace mammoray;

TEST(PlateFriction, ForceIsCoulombsBeyondTheSlipAndElasticBelow)
{
  const Plate plate;
  FrictionPoint point; // sticks at the plate's edge
  for (const double slip : { 0.2 * FrictionPoint::SlipMm, FrictionPoint::SlipMm, 3.0 })
  {
    const FrictionTerms terms(point, plate, { 0.6 * slip, 0.8 * slip, -0.02 });
    EXPECT_NEAR(Norm(terms.Slip), slip, 1e-15);
    const double y = slip / FrictionPoint::SlipMm;
    EXPECT_NEAR(Norm(terms.Gradient()), y < 1 ? 2 * y - y * y : 1, 1e-12);
    EXPECT_NEAR(terms.Gradient()[2], 0, 1e-15);
  }
}

TEST(PlateFriction, DerivativesMatchCentralDifferences)
{
  Plate plate;
  plate.Edge = { 3, -2, 5 };
  plate.Normal = { 0.6, 0, 0.8 };
  plate.Inward = { 0, 1, 0 };
  FrictionPoint point;
  point.Anchor = { 1, 4, 0.01 };
  point.Normal = { 0, -0.6, 0.8 }; // on the round of the edge
  const PlateVelocity velocity{ { 0.3, -0.2, 0.5 }, { 0.02, 0.03, -0.05 } };
  for (const double slip : { 0.02, 0.3 })
  {
    const Vector3 x = PointFromPlate(plate, point.Anchor) + slip * Vector3{ 0.3, 0.9, 0.5 };
    const FrictionTerms terms(point, plate, x);
    constexpr double h = 1e-6;
    for (const Vector3& v : { Vector3{ 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } })
    {
      const FrictionTerms low(point, plate, x - h * v), high(point, plate, x + h * v);
      // h^2 over the square of the slip's length, 4e-4 mm^2; roundoff over h.
      EXPECT_NEAR((high.Energy - low.Energy) / (2 * h), Dot(terms.Gradient(), v), 1e-8);
      const Vector3 difference = (1 / (2 * h)) * (high.Gradient() - low.Gradient());
      EXPECT_NEAR(Norm(difference - terms.HessianTimes(v)), 0, 1e-6);
    }
    const FrictionTerms low(point, MovedPlate(plate, velocity, -h), x);
    const FrictionTerms high(point, MovedPlate(plate, velocity, h), x);
    const Vector3 difference = (1 / (2 * h)) * (high.Gradient() - low.Gradient());
    EXPECT_NEAR(Norm(difference - terms.GradientDerivative(plate, velocity, x)), 0, 1e-6);
  }
}

TEST(PlateFriction, AnAnchorIsDraggedNoFartherThanItMust)
{
  const Plate plate;
  FrictionPoint point;
  const Vector3 near{ 0.5 * FrictionPoint::SlipMm, 0, 0 };
  EXPECT_EQ(Dragged(point, plate, near).Anchor, point.Anchor);
  const Vector3 far{ 0, 2, 0.01 };
  const FrictionTerms terms(Dragged(point, plate, far), plate, far);
  EXPECT_NEAR(Norm(terms.Slip - Vector3{ 0, FrictionPoint::SlipMm, 0 }), 0, 1e-12);
}
}
