// SPDX-License-Identifier: Apache-2.0
#include "Refusals.h"
#include "SurfaceShapes.h"
#include "mammoray/Meshing/MeshCheck.h"
#include "mammoray/Meshing/SurfaceMesher.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace mammoray;

namespace
{
SurfaceMesh RepairBall(double radius = 5)
{
  SurfaceMesh ball;
  shapes::AddSphere(ball, { 10, 20, 30 }, radius, 2, 1);
  return ball;
}

/// Every triangle with points of its own, each up to `byMm` beside its place.
SurfaceMesh TakenApart(const SurfaceMesh& surface, double byMm)
{
  SurfaceMesh apart;
  for (std::size_t triangle = 0; triangle < surface.NumberOfTriangles(); ++triangle)
  {
    std::uint32_t ids[3];
    for (std::size_t corner = 0; corner < 3; ++corner)
    {
      const double step = byMm * std::sin(static_cast<double>(3 * triangle + corner));
      ids[corner] =
        shapes::AddPoint(apart, surface.Corner(triangle, corner) + Vector3{ step, 0, 0 });
    }
    shapes::AddTriangle(apart, ids[0], ids[1], ids[2], 1, 0);
  }
  return apart;
}

void TurnTriangle(SurfaceMesh& surface, std::size_t triangle)
{
  std::swap(surface.Triangles[3 * triangle], surface.Triangles[3 * triangle + 1]);
}

void RemoveTriangle(SurfaceMesh& surface, std::size_t triangle)
{
  const auto begin = surface.Triangles.begin() + static_cast<std::ptrdiff_t>(3 * triangle);
  surface.Triangles.erase(begin, begin + 3);
  surface.FrontMaterials.pop_back();
  surface.BackMaterials.pop_back();
}

/// Sound, with this volume and, along lines through it, the chords of the other.
void ExpectSameBody(const SurfaceMesh& surface, const SurfaceMesh& other, double tolerance)
{
  const MeshCheck check = CheckSurface(surface);
  EXPECT_TRUE(check.Sound()) << (check.Sound() ? "" : check.Defects.front().Text({}));
  EXPECT_NEAR(check.Materials.at(0).VolumeMm3, CheckSurface(other).Materials.at(0).VolumeMm3,
    tolerance * 100);
  for (const double shift : { -2.1, 0.3, 3.7 })
  {
    const Vector3 from{ 10 + shift, 20.2, -100 };
    const Vector3 to{ 10.1 + shift, 20.4, 100 };
    const std::vector<double> chords = shapes::ReferenceLengths(surface, from, to);
    ASSERT_EQ(chords.size(), 2u);
    EXPECT_NEAR(chords[1], shapes::ReferenceLengths(other, from, to)[1], tolerance) << shift;
  }
}
}

TEST(SurfaceRepair, WhatIsSoundStays)
{
  const SurfaceMesh ball = RepairBall();
  const RepairedSurface repaired = RepairSurface(ball);
  EXPECT_EQ(repaired.WeldedPoints + repaired.FlatTriangles + repaired.DoubledTriangles +
      repaired.TurnedTriangles + repaired.ClosedHoles + repaired.OpenHoles,
    0u);
  EXPECT_EQ(repaired.Surface.NumberOfPoints(), ball.NumberOfPoints());
  EXPECT_EQ(repaired.Surface.NumberOfTriangles(), ball.NumberOfTriangles());
  ExpectSameBody(repaired.Surface, ball, 1e-9);
}

TEST(SurfaceRepair, PointsAreWeldedWithinATolerance)
{
  const SurfaceMesh ball = RepairBall();
  const SurfaceMesh apart = TakenApart(ball, 1e-4);
  ASSERT_TRUE(CheckSurface(apart).Find(MeshDefect::Kind::Holes));
  const RepairedSurface repaired = RepairSurface(apart, 1e-3);
  EXPECT_EQ(repaired.WeldedPoints, apart.NumberOfPoints() - ball.NumberOfPoints());
  EXPECT_EQ(repaired.Surface.NumberOfPoints(), ball.NumberOfPoints());
  ExpectSameBody(repaired.Surface, ball, 1e-3);
}

TEST(SurfaceRepair, DoubledFlatAndTurnedTrianglesAreMended)
{
  const SurfaceMesh ball = RepairBall();
  SurfaceMesh bad = ball;
  for (const std::size_t triangle : { 3, 40, 41, 200 })
  {
    TurnTriangle(bad, triangle);
  }
  const std::uint32_t* ids = &ball.Triangles[3 * 77];
  shapes::AddTriangle(bad, ids[1], ids[2], ids[0], 1, 0);
  shapes::AddTriangle(bad, ids[1], ids[0], ids[2], 1, 0);
  shapes::AddTriangle(bad, ids[1], ids[1], ids[2], 1, 0);
  const RepairedSurface repaired = RepairSurface(bad);
  EXPECT_EQ(repaired.DoubledTriangles, 2u);
  EXPECT_EQ(repaired.FlatTriangles, 1u);
  EXPECT_EQ(repaired.TurnedTriangles, 4u);
  ExpectSameBody(repaired.Surface, ball, 1e-9);
  // All turned inside out; a hollow is turned inwards.
  SurfaceMesh inside = ball;
  for (std::size_t triangle = 0; triangle < inside.NumberOfTriangles(); ++triangle)
  {
    TurnTriangle(inside, triangle);
  }
  EXPECT_EQ(RepairSurface(inside).TurnedTriangles, ball.NumberOfTriangles());
  ExpectSameBody(RepairSurface(inside).Surface, ball, 1e-9);
  SurfaceMesh hollow = ball;
  shapes::AddSphere(hollow, { 10, 20, 30 }, 2, 2, 1);
  const double volume = CheckSurface(ball).Materials.at(0).VolumeMm3 * (1 - 8.0 / 125);
  EXPECT_NEAR(CheckSurface(RepairSurface(hollow).Surface).Materials.at(0).VolumeMm3, volume,
    1e-9 * volume);
}

TEST(SurfaceRepair, WallsBetweenPartsThatTouchGo)
{
  SurfaceMesh boxes;
  shapes::AddBox(boxes, { 0, 0, 0 }, { 10, 20, 30 }, 1);
  shapes::AddBox(boxes, { 10, 0, 0 }, { 20, 20, 30 }, 1);
  const RepairedSurface repaired = RepairSurface(boxes);
  EXPECT_EQ(repaired.DoubledTriangles, 4u);
  EXPECT_TRUE(CheckSurface(repaired.Surface).Sound());
  EXPECT_NEAR(CheckSurface(repaired.Surface).Materials.at(0).VolumeMm3, 12000, 1e-6);
  // A surface of two sides is one; a triangle that is there once more, turned, is no wall.
  SurfaceMesh twoSided = RepairBall();
  const std::size_t count = twoSided.NumberOfTriangles();
  for (std::size_t triangle = 0; triangle < count; ++triangle)
  {
    const std::uint32_t ids[3] = { twoSided.Triangles[3 * triangle],
      twoSided.Triangles[3 * triangle + 1], twoSided.Triangles[3 * triangle + 2] };
    shapes::AddTriangle(twoSided, ids[1], ids[0], ids[2], 1, 0);
  }
  EXPECT_EQ(RepairSurface(twoSided).DoubledTriangles, count);
  ExpectSameBody(RepairSurface(twoSided).Surface, RepairBall(), 1e-9);
  SurfaceMesh one = RepairBall();
  const std::uint32_t ids[3] = { one.Triangles[0], one.Triangles[1], one.Triangles[2] };
  shapes::AddTriangle(one, ids[1], ids[0], ids[2], 1, 0);
  EXPECT_EQ(RepairSurface(one).DoubledTriangles, 1u);
  ExpectSameBody(RepairSurface(one).Surface, RepairBall(), 1e-9);
}

TEST(SurfaceRepair, SmallHolesAreClosed)
{
  const SurfaceMesh ball = RepairBall();
  SurfaceMesh open = ball;
  RemoveTriangle(open, 250);
  RemoveTriangle(open, 30);
  RepairedSurface repaired = RepairSurface(open, {}, 20);
  EXPECT_EQ(repaired.ClosedHoles, 2u);
  EXPECT_EQ(repaired.OpenHoles, 0u);
  ExpectSameBody(repaired.Surface, ball, 1e-9);
  // Their borders are some 4 mm long.
  repaired = RepairSurface(open, {}, 1);
  EXPECT_EQ(repaired.ClosedHoles, 0u);
  EXPECT_EQ(repaired.OpenHoles, 2u);
}

TEST(SurfaceRepair, RefusesWhatItCannotMend)
{
  SurfaceMesh two = RepairBall();
  shapes::AddSphere(two, { 30, 20, 30 }, 2, 1, 2);
  EXPECT_THAT(test::RefusalOf([&] { RepairSurface(two); }),
    testing::HasSubstr("expected one material to repair, found 2"));
  EXPECT_THAT(test::RefusalOf([&] { RepairSurface(RepairBall(), -1); }),
    testing::HasSubstr("to weld"));
}
