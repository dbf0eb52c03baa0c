// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Biomechanics/CompressionSimulation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
using namespace mammoray;

TEST(PlacedPlates, FaceEachOtherAcrossTheThickness)
{
  MammographyUnit unit;
  unit.SupportEdgeMm = 1;
  unit.PaddleEdgeMm = 2;
  const AnatomicalAxes axes = AnatomicalAxes::FromCode("ALS");
  BreastPose pose;
  pose.ThicknessMm = 40;
  pose.RollDeg = 30;
  const VolumeFromGantry placed = PlaceUnit({ axes, { 1, 2, 3 } }, unit, pose);
  const PlatePair plates = PlatesOf(placed, unit, 40);
  EXPECT_NEAR(Norm(placed.ToGantry(plates.Support.Edge) - Vector3{ 0, 1, 2 }), 0, 1e-12);
  EXPECT_NEAR(Norm(placed.ToGantry(plates.Paddle.Edge) - Vector3{ 0, 2, 42 }), 0, 1e-12);
  EXPECT_NEAR(Norm(plates.Support.Normal + plates.Paddle.Normal), 0, 1e-12);
  EXPECT_NEAR(Dot(plates.Paddle.Edge - plates.Support.Edge, plates.Support.Normal), 40, 1e-12);
  EXPECT_NEAR(Dot(plates.Paddle.Inward, axes.Anterior), 1, 1e-12);
}

TEST(PlacedPlates, TiltOpensThePaddleTowardsTheNipple)
{
  VolumeFromGantry placed; // X, Y, Z as they are
  MammographyUnit unit;
  unit.PaddleEdgeMm = 4;
  const PlatePair plates = PlatesOf(placed, unit, 50, 5);
  const double c = std::cos(5 * M_PI / 180), s = std::sin(5 * M_PI / 180);
  EXPECT_NEAR(GapMm(plates), 50, 1e-12);
  // The face's point 30 mm in lies farther from the support by 30 sin 5 degrees.
  const Vector3 inside = plates.Paddle.Edge + 30 * plates.Paddle.Inward;
  EXPECT_NEAR(inside[1], 4 + 30 * c, 1e-12);
  EXPECT_NEAR(inside[2], unit.SupportHeightMm + 50 + 30 * s, 1e-12);
  EXPECT_NEAR(Dot(plates.Paddle.Normal, plates.Paddle.Inward), 0, 1e-15);
  EXPECT_NEAR(
    DistanceToPlate(plates.Paddle, inside - 7 * c * Vector3{ 0, 0, 1 } + 7 * s * Vector3{ 0, 1, 0 })
      .Distance,
    7, 1e-12);
}

TEST(PlacedPlates, GravityPointsDownwards)
{
  const AnatomicalAxes axes = AnatomicalAxes::FromCode("LAS");
  const Vector3 prone = GravityIn(PatientPosition::Prone, axes);
  EXPECT_EQ(prone, (Vector3{ 0, StandardGravityMPerS2, 0 }));
  EXPECT_EQ(GravityIn(PatientPosition::Supine, axes), (Vector3{ 0, -StandardGravityMPerS2, 0 }));
  EXPECT_EQ(GravityIn(PatientPosition::Upright, axes), (Vector3{ 0, 0, -StandardGravityMPerS2 }));
}
}
