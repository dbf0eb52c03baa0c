// SPDX-License-Identifier: Apache-2.0
// A half-ellipsoid and the mammogram of another one: where its points must go is known.
#include "LabelShapes.h"
#include "OutlineBaseline.h"
#include "Refusals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace
{
using namespace mammoray;

/// Half axes across, to the front (-y) and along the beam, mm; the chest wall is at y > 0.
constexpr Vector3 Given{ 40, 45, 36 };
constexpr double Thickness = 48;

int HalfEllipsoid(const Vector3& point)
{
  if (point[1] > 0)
  {
    return point[1] < 8 ? 2 : 0;
  }
  return std::hypot(point[0] / Given[0], point[1] / Given[1], point[2] / Given[2]) < 1 ? 1 : 0;
}

/// The unit stands with its edge at the chest wall; its axes are x, -y, z of the volume.
UnitPlacement Unit()
{
  UnitPlacement placement{ { AnatomicalAxes::FromCode("LPS"), { 0, 0, 0 } }, {} };
  placement.Unit.SourceToDetectorMm = 650;
  placement.Unit.SupportHeightMm = 20;
  return placement;
}

double Enlarged()
{
  return 650 / (650 - 20 - 0.5 * Thickness);
}

/// The shadow of a half-ellipse of these half axes whose middle is at x = 7 mm, at the height of
/// the middle between the plates.
RegistrationTarget ShadowOf(double across, double depth)
{
  RegistrationTarget target;
  target.Grid.Columns = 400;
  target.Grid.Rows = 600;
  target.Grid.Origin = { -75, 0.125 };
  target.Grid.ColumnStep = { 0, 0.25 };
  target.Grid.RowStep = { 0.25, 0 };
  for (int row = 0; row < target.Grid.Rows; ++row)
  {
    for (int column = 0; column < target.Grid.Columns; ++column)
    {
      const ReceptorPoint at = target.Grid.PositionOf(column, row);
      const double x = at[0] / Enlarged() - 7;
      const double y = at[1] / Enlarged();
      target.BreastMask.push_back(std::hypot(x / across, y / depth) < 1 ? 1 : 0);
    }
  }
  return target;
}

std::vector<Vector3> Moved(const RegistrationTarget& target, OutlineMotion motion)
{
  BreastPose pose;
  pose.ThicknessMm = Thickness;
  pose.AnteriorMm = 0;
  return MoveByOutline({ { 0, 0, 0 }, { 10, -30, 18 } }, test::LabelledCube(110, 1, HalfEllipsoid),
    { false, false, true }, Unit(), pose, target, motion);
}

// A voxel and a pixel: 1 and 0.25 mm.
constexpr double Tolerance = 1;

TEST(OutlineBaseline, MovesTheShadowOntoTheMammograms)
{
  const std::vector<Vector3> moved = Moved(ShadowOf(Given[0], 55), OutlineMotion::Rigid);
  EXPECT_NEAR(moved[0][0], 7, Tolerance);
  EXPECT_NEAR(moved[0][1], 10, Tolerance); // the tips, at 45 and 55 mm, meet
  EXPECT_NEAR(moved[0][2], 20 + 0.5 * Thickness, Tolerance);
  EXPECT_NEAR(moved[1][0], 17, Tolerance);
  EXPECT_NEAR(moved[1][1], 40, Tolerance);
  EXPECT_NEAR(moved[1][2], 20 + 0.5 * Thickness + 18, Tolerance);
}

TEST(OutlineBaseline, ScalesItToWidthDepthAndThickness)
{
  const std::vector<Vector3> moved = Moved(ShadowOf(60, 54), OutlineMotion::Affine);
  EXPECT_NEAR(moved[0][0], 7, Tolerance);
  EXPECT_NEAR(moved[0][1], 0, Tolerance);
  EXPECT_NEAR(moved[1][0], 7 + 1.5 * 10, Tolerance);
  EXPECT_NEAR(moved[1][1], 1.2 * 30, Tolerance);
  // In front of a third of the depth the breast is 0.943 of its height.
  EXPECT_NEAR(moved[1][2], 44 + 18 * Thickness / (2 * Given[2] * std::sqrt(8.0 / 9)), Tolerance);
}

TEST(OutlineBaseline, RefusesWhereThereIsNoBreast)
{
  EXPECT_THAT(test::RefusalOf([] { Moved(ShadowOf(0, 0), OutlineMotion::Rigid); }),
    testing::HasSubstr("expected a breast in front of the receptor's edge in the mammogram"));
}
}
