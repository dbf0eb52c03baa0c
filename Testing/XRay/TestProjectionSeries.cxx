// SPDX-License-Identifier: Apache-2.0
#include "SurfaceShapes.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/ProjectionSeries.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace
{
using namespace mammoray;

/// Column and row at which the shadow of a point falls.
std::array<double, 2> ShadowOf(const XRaySource& source, const XRayDetector& detector,
  const Vector3& point)
{
  const Vector3 direction =
    source.Type == XRaySource::Kind::Point ? point - source.Position : source.Direction;
  const Vector3 normal = Cross(detector.ColumnStep, detector.RowStep);
  const double way = Dot(normal, detector.Origin - point) / Dot(normal, direction);
  const Vector3 inPlane = point + way * direction - detector.Origin;
  return { Dot(inPlane, detector.ColumnStep) / Dot(detector.ColumnStep, detector.ColumnStep),
    Dot(inPlane, detector.RowStep) / Dot(detector.RowStep, detector.RowStep) };
}

/// Source at y = -500, detector at y = 100: columns along x, rows down along -z.
XRaySource Source(XRaySource::Kind kind)
{
  XRaySource source;
  source.Type = kind;
  source.Position = { 3, -500, 7 };
  source.Direction = { 0.01, 1, 0.02 };
  return source;
}

XRayDetector Detector()
{
  XRayDetector detector;
  detector.Origin = { -20, 100, 15 };
  detector.ColumnStep = { 0.5, 0, 0 };
  detector.RowStep = { 0, 0, -0.25 };
  detector.Columns = 81;
  detector.Rows = 121;
  return detector;
}

TEST(ProjectionSeries, TurningTheSampleIsTurningItsPoints)
{
  const Vector3 point{ 4, -6, 2 };
  const AxisLine axis{ { 1, 2, 0 }, { 0, 0, 3 } };
  for (const XRaySource::Kind kind : { XRaySource::Kind::Point, XRaySource::Kind::Parallel })
  {
    const XRaySource source = Source(kind);
    const auto views = TurnSample(source, Detector(), axis, 12, 180);
    ASSERT_EQ(views.size(), 12u);
    EXPECT_EQ(views[0].AngleDeg, 0);
    EXPECT_EQ(views[11].AngleDeg, 165);
    for (const ProjectionView& view : views)
    {
      // The point turned about (1, 2), anticlockwise seen from +z, before the still detector.
      const double angle = view.AngleDeg * std::numbers::pi / 180;
      const double x = point[0] - 1;
      const double y = point[1] - 2;
      const Vector3 turned{ 1 + std::cos(angle) * x - std::sin(angle) * y,
        2 + std::sin(angle) * x + std::cos(angle) * y, point[2] };
      const auto expected = ShadowOf(source, Detector(), turned);
      const auto found = ShadowOf(view.Source, view.Detector, point);
      EXPECT_NEAR(found[0], expected[0], 1e-9) << view.AngleDeg;
      EXPECT_NEAR(found[1], expected[1], 1e-9) << view.AngleDeg;
      EXPECT_EQ(view.Detector.Columns, 81);
    }
  }
}

TEST(ProjectionSeries, SweepsTheSourceOnAnArcAboutItsMiddle)
{
  const XRaySource source = Source(XRaySource::Kind::Point);
  const AxisLine axis{ { 3, 50, 7 }, { 0, 0, 1 } };
  const auto views = SweepSource(source, Detector(), axis, 25, 50);
  ASSERT_EQ(views.size(), 25u);
  EXPECT_EQ(views[0].AngleDeg, -25);
  EXPECT_EQ(views[12].AngleDeg, 0);
  EXPECT_EQ(views[24].AngleDeg, 25);
  for (const ProjectionView& view : views)
  {
    const double angle = view.AngleDeg * std::numbers::pi / 180;
    EXPECT_EQ(view.Detector, Detector());
    EXPECT_NEAR(view.Source.Position[0], 3 + 550 * std::sin(angle), 1e-9);
    EXPECT_NEAR(view.Source.Position[1], 50 - 550 * std::cos(angle), 1e-9);
    EXPECT_NEAR(view.Source.Position[2], 7, 1e-9);
  }
  EXPECT_EQ(SweepSource(source, Detector(), axis, 1, 50)[0].AngleDeg, 0);
}

TEST(ProjectionSeries, TellsWhereTheAxisStands)
{
  // Tilted, so that its shadow is, too.
  const AxisLine axis{ { 1, 2, 0 }, { 0.1, 0.2, 1 } };
  for (const XRaySource::Kind kind : { XRaySource::Kind::Point, XRaySource::Kind::Parallel })
  {
    const XRaySource source = Source(kind);
    const auto shadow = ShadowOfAxis(source, Detector(), axis);
    ASSERT_TRUE(shadow);
    for (const double along : { -10.0, 0.0, 12.0 })
    {
      const auto [column, row] = ShadowOf(source, Detector(), axis.Point + along * axis.Direction);
      EXPECT_NEAR(column, (*shadow)[0] + row / 120 * ((*shadow)[1] - (*shadow)[0]), 1e-9);
    }
  }
  // Along the rows.
  EXPECT_FALSE(
    ShadowOfAxis(Source(XRaySource::Kind::Point), Detector(), { { 0, 0, 0 }, { 1, 0, 0 } }));
}

TEST(ProjectionSeries, RefusesWhatIsNoSeries)
{
  const XRaySource source = Source(XRaySource::Kind::Point);
  EXPECT_THROW(TurnSample(source, Detector(), {}, 0, 360), InputError);
  EXPECT_THROW(TurnSample(source, Detector(), { {}, { 0, 0, 0 } }, 4, 360), InputError);
  EXPECT_THROW(TurnSample(source, Detector(), {}, 4, std::nan("")), InputError);
  EXPECT_THROW(SweepSource(Source(XRaySource::Kind::Parallel), Detector(), {}, 4, 50), InputError);
}
}
