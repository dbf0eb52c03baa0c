// SPDX-License-Identifier: Apache-2.0
#include "SurfaceShapes.h"
#include "mammoray/Registration/PosedBreast.h"
#include "mammoray/Registration/Private/Silhouette.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

using namespace mammoray;

namespace
{
/// Points and edges of a regular polygon around a centre.
void Polygon(const ReceptorPoint& centre, double radius, std::uint32_t corners,
  std::vector<ReceptorPoint>& points, std::vector<std::array<std::uint32_t, 2>>& edges)
{
  const auto first = static_cast<std::uint32_t>(points.size());
  for (std::uint32_t corner = 0; corner < corners; ++corner)
  {
    const double angle = 2 * std::numbers::pi * corner / corners + 0.1;
    points.push_back(
      { centre[0] + radius * std::cos(angle), centre[1] + radius * std::sin(angle) });
    edges.push_back({ first + corner, first + (corner + 1) % corners });
  }
}
}

TEST(Silhouette, RadiusOfASquareIsExactInEveryDirection)
{
  const std::vector<ReceptorPoint> points{ { 1, -1 }, { 1, 1 }, { -1, 1 }, { -1, -1 } };
  const std::vector<std::array<std::uint32_t, 2>> edges{ { 0, 1 }, { 1, 2 }, { 2, 3 }, { 0, 3 } };
  std::vector<ReceptorPoint> directions;
  for (int degrees = -179; degrees < 180; degrees += 7)
  {
    const double angle = degrees * std::numbers::pi / 180;
    directions.push_back({ std::cos(angle), std::sin(angle) });
  }
  const auto radii = SilhouetteRadii(points, edges, { 0, 0 }, directions);
  for (std::size_t index = 0; index < directions.size(); ++index)
  {
    const double expected =
      1 / std::max(std::abs(directions[index][0]), std::abs(directions[index][1]));
    EXPECT_NEAR(radii[index], expected, 1e-12) << index;
  }
}

TEST(Silhouette, TheOutermostOfSeveralPolygonsCounts)
{
  std::vector<ReceptorPoint> points;
  std::vector<std::array<std::uint32_t, 2>> edges;
  Polygon({ 0, 30 }, 20, 720, points, edges);
  Polygon({ 0, 60 }, 2, 720, points, edges); // a nipple in front of it
  const auto radii = SilhouetteRadii(points, edges, { 0, 0 }, { { 0, 1 }, { 1, 0 } });
  // 1e-3: sagitta of a 720-gon of radius 2 is 2e-5, of the chord crossing the axis less than 1e-4.
  EXPECT_NEAR(radii[0], 62, 1e-3);
  EXPECT_EQ(radii[1], 0); // no outline in that direction
}

TEST(Silhouette, PointsAreMagnifiedFromTheFocalSpot)
{
  VolumeFromGantry placed;
  placed.Origin = { 10, 20, 30 };
  MammographyUnit unit;
  unit.SourceToDetectorMm = 600;
  const Vector3 point = placed.Point({ 5, 40, 100 });
  const auto projected = ProjectToReceptor({ point[0], point[1], point[2] }, placed, unit);
  EXPECT_NEAR(projected[0][0], 5 * 600.0 / 500.0, 1e-12);
  EXPECT_NEAR(projected[0][1], 40 * 600.0 / 500.0, 1e-12);
  const Vector3 behind = placed.Point({ 5, 40, 700 });
  EXPECT_TRUE(
    std::isnan(ProjectToReceptor({ behind[0], behind[1], behind[2] }, placed, unit)[0][0]));
}

TEST(Silhouette, OnlyEdgesBetweenTissueAndAirAreOuter)
{
  SurfaceMesh surface;
  surface.Points = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0 };
  surface.Triangles = { 0, 1, 2, 2, 1, 3 };
  surface.FrontMaterials = { 0, 1 };
  surface.BackMaterials = { 1, 2 };
  EXPECT_EQ(OuterEdges(surface).size(), 3u);
  surface.FrontMaterials[1] = 0;
  EXPECT_EQ(OuterEdges(surface).size(), 5u); // the shared edge once
}

TEST(Silhouette, DerivativesAgreeWithDifferences)
{
  // A box in a cone beam, every corner moving its own way.
  SurfaceMesh box;
  shapes::AddBox(box, { -30, -20, 20 }, { 34, 62, 70 }, 1, 0);
  const auto edges = OuterEdges(box);
  const auto directions = HalfCircleDirections(40);
  const ReceptorPoint centre{ 1, 0 };
  VolumeFromGantry placed;
  placed.Origin = { 2, -3, 5 };
  MammographyUnit unit;
  std::vector<double> velocities(box.Points.size());
  for (std::size_t index = 0; index < velocities.size(); ++index)
  {
    velocities[index] = std::sin(1.0 + 2.7 * static_cast<double>(index));
  }
  const auto project = [&](double step)
  {
    std::vector<double> points = box.Points;
    for (std::size_t index = 0; index < points.size(); ++index)
    {
      points[index] += step * velocities[index];
    }
    return ProjectToReceptor(points, placed, unit);
  };
  const auto here = project(0);
  std::vector<std::int32_t> crossed;
  const std::vector<double> radii = SilhouetteRadii(here, edges, centre, directions, &crossed);
  const std::vector<double> rates = SilhouetteDerivatives(here,
    ReceptorVelocities(box.Points, velocities, placed, unit), edges, centre, directions, crossed);
  constexpr double step = 1e-5;
  const std::vector<double> plus = SilhouetteRadii(project(step), edges, centre, directions);
  const std::vector<double> minus = SilhouetteRadii(project(-step), edges, centre, directions);
  for (std::size_t index = 0; index < directions.size(); ++index)
  {
    ASSERT_GE(crossed[index], 0);
    ASSERT_GT(radii[index], 0);
    // Central differences of numbers near 100 with this step: 1e-14 * 100 / 1e-5 and step^2.
    EXPECT_NEAR(rates[index], (plus[index] - minus[index]) / (2 * step), 1e-6) << index;
  }
}
