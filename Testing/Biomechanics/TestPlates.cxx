// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Biomechanics/Plates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace
{
using namespace mammoray;

Plate MakeTiltedPlate()
{
  return MovedPlate(Plate{ .Edge = { 1, 2, 3 }, .EdgeRadiusMm = 3 },
    { .Linear = { 0.5, -1, 2 }, .Angular = { 0.3, -0.8, 0.5 } }, 1.0);
}

TEST(Plates, DistanceIsThatToTheRoundedQuarterSpace)
{
  const Plate plate{ .EdgeRadiusMm = 3 }; // fills z <= 0, y >= 0
  EXPECT_DOUBLE_EQ(DistanceToPlate(plate, { 9, 10, 2 }).Distance, 2);
  EXPECT_DOUBLE_EQ(DistanceToPlate(plate, { 9, 10, -1 }).Distance, -1);
  EXPECT_DOUBLE_EQ(DistanceToPlate(plate, { 9, -4, -20 }).Distance, 4);
  // Beside the rounding, whose centre line is at y = 3, z = -3: 3-4-5 triangles.
  EXPECT_DOUBLE_EQ(DistanceToPlate(plate, { 0, 3 - 3, -3 + 4 }).Distance, 2);
  EXPECT_DOUBLE_EQ(DistanceToPlate(plate, { 0, 3 - 1.2, -3 + 1.6 }).Distance, -1);
}

TEST(Plates, DerivativesMatchCentralDifferences)
{
  const Plate plate = MakeTiltedPlate();
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> coordinate(-6, 6);
  int rounded = 0;
  for (int trial = 0; trial < 300; ++trial)
  {
    const Vector3 x =
      plate.Edge + Vector3{ coordinate(generator), coordinate(generator), coordinate(generator) };
    const PlateDistance at = DistanceToPlate(plate, x);
    if (std::abs(at.Distance) > 2.5)
    {
      continue; // near the ridge of the distance inside the plate there is no derivative
    }
    rounded += at.Curvature > 0;
    EXPECT_NEAR(Norm(at.Gradient), 1, 1e-12);
    for (int axis = 0; axis < 3; ++axis)
    {
      const double h = 1e-5;
      Vector3 low = x, high = x;
      low[axis] -= h;
      high[axis] += h;
      const PlateDistance a = DistanceToPlate(plate, low);
      const PlateDistance b = DistanceToPlate(plate, high);
      if ((a.Curvature > 0) != (b.Curvature > 0))
      {
        continue; // the curvature jumps where the rounding ends
      }
      // h^2 over the radius of curvature squared (> 0.5 mm): 1e-9, with roundoff 1e-11 / h.
      EXPECT_NEAR((b.Distance - a.Distance) / (2 * h), at.Gradient[axis], 1e-8);
      for (int i = 0; i < 3; ++i)
      {
        EXPECT_NEAR((b.Gradient[i] - a.Gradient[i]) / (2 * h),
          at.Curvature * at.Tangent[i] * at.Tangent[axis], 1e-8);
      }
    }
  }
  EXPECT_GT(rounded, 30);
}

TEST(Plates, MotionTakesOnePlateToTheOther)
{
  const Plate from;
  const Plate to = MakeTiltedPlate();
  const Plate reached = MovedPlate(from, PlateMotion(from, to), 1.0);
  EXPECT_NEAR(Norm(reached.Edge - to.Edge), 0, 1e-12);
  EXPECT_NEAR(Norm(reached.Normal - to.Normal), 0, 1e-12);
  EXPECT_NEAR(Norm(reached.Inward - to.Inward), 0, 1e-12);
}

TEST(Plates, VelocityIsTheDerivativeOfTheMotion)
{
  const Plate plate = MakeTiltedPlate();
  const PlateVelocity velocity{ .Linear = { 1, 2, 3 }, .Angular = { 0.1, -0.2, 0.3 } };
  const double h = 1e-5;
  const Plate a = MovedPlate(plate, velocity, -h), b = MovedPlate(plate, velocity, h);
  // The point 10 mm into the contact face, as the plate carries it along.
  const Vector3 expected = (1 / (2 * h)) * (b.Edge + 10.0 * b.Inward - (a.Edge + 10.0 * a.Inward));
  EXPECT_NEAR(Norm(expected - velocity.VelocityAt(plate, plate.Edge + 10.0 * plate.Inward)), 0,
    1e-8);
}

TEST(Plates, SlidPlatesAreTheSameNearestToTheTarget)
{
  const PlatePair from{ MakeTiltedPlate(), Plate{ .Edge = { 0, 0, 50 }, .Normal = { 0, 0, -1 } } };
  PlatePair to = from;
  to.Support.Edge = to.Support.Edge + Vector3{ 7, -3, 2 };
  to.Paddle.Edge = to.Paddle.Edge + Vector3{ 20, 0, 0 };
  const PlatePair slid = SlidTowards(from, to);
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> anywhere(-30, 30);
  for (int count = 0; count < 200; ++count)
  {
    const Vector3 point{ anywhere(generator), anywhere(generator), anywhere(generator) };
    EXPECT_NEAR(DistanceToPlate(slid.Support, point).Distance,
      DistanceToPlate(from.Support, point).Distance, 1e-12);
    EXPECT_NEAR(DistanceToPlate(slid.Paddle, point).Distance,
      DistanceToPlate(from.Paddle, point).Distance, 1e-12);
  }
  // The paddle's edge runs along x: nothing of its way is left.
  EXPECT_NEAR(Norm(slid.Paddle.Edge - to.Paddle.Edge), 0, 1e-12);
  EXPECT_LE(TravelMm(PlateMotion(slid, to)), TravelMm(PlateMotion(from, to)));
}
}
