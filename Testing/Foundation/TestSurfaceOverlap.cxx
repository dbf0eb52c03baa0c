// SPDX-License-Identifier: Apache-2.0
#include "SurfaceShapes.h"
#include "mammoray/Foundation/SurfaceOverlap.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numbers>
#include <random>

namespace
{
using namespace mammoray;
using namespace mammoray::shapes;

SurfaceOverlap Overlap(const SurfaceMesh& mesh)
{
  const TriangleTree tree(mesh);
  return FindOverlap(mesh, tree);
}

TEST(TriangleTree, CrossesABoxThroughFacesEdgesAndCorners)
{
  SurfaceMesh mesh;
  AddBox(mesh, { -1, -1, -1 }, { 1, 1, 1 }, 1);
  const TriangleTree tree(mesh);
  std::vector<LineHit> hits;
  // Through the diagonals of two faces: one hit each.
  tree.CrossLine({ 0, 0, 10 }, { 0, 0, -1 }, hits);
  ASSERT_EQ(hits.size(), 2u);
  EXPECT_NEAR(hits[0].T, 9, 1e-14);
  EXPECT_NEAR(hits[1].T, 11, 1e-14);
  EXPECT_TRUE(hits[0].FacesBeginning);
  EXPECT_FALSE(hits[1].FacesBeginning);
  // Through edges and corners: in as often as out.
  for (const Vector3& begin :
    std::vector<Vector3>{ { 1, 0.3, 10 }, { 1, 1, 10 }, { -1, 1, 10 }, { 0, -1, 3 } })
  {
    tree.CrossLine(begin, { 0, 0, -1 }, hits);
    EXPECT_EQ(std::count_if(hits.begin(), hits.end(),
                [](const LineHit& hit) { return hit.FacesBeginning; }) *
        2,
      static_cast<std::ptrdiff_t>(hits.size()));
  }
  const double d = 1 / std::numbers::sqrt3;
  tree.CrossLine({ -5, -5, -5 }, { d, d, d }, hits);
  EXPECT_EQ(hits.size() % 2, 0u);
}

TEST(TriangleTree, LinesMatchTheReference)
{
  SurfaceMesh mesh;
  AddSphere(mesh, { 0, 0, 0 }, 40, 3, 1);
  AddBox(mesh, { -20, -10, -5 }, { -6, 4, 11 }, 3, 1, Rotation(0.1, 0.2, 0.3));
  const TriangleTree tree(mesh);
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> place(-50, 50);
  std::vector<LineHit> hits;
  for (int n = 0; n < 300; ++n)
  {
    const Vector3 begin{ place(generator), place(generator), 90 };
    const Vector3 end{ place(generator), place(generator), -90 };
    const double length = Norm(end - begin);
    tree.CrossLine(begin, (1 / length) * (end - begin), hits);
    std::vector<double> lengths(4, 0.0);
    for (const LineHit& hit : hits)
    {
      const double t = hit.FacesBeginning ? hit.T : -hit.T;
      lengths[mesh.FrontMaterials[hit.Triangle]] += t;
      lengths[mesh.BackMaterials[hit.Triangle]] -= t;
    }
    const auto expected = ReferenceLengths(mesh, begin, end);
    for (std::size_t m = 1; m < expected.size(); ++m)
    {
      EXPECT_NEAR(lengths[m], expected[m], 1e-10);
    }
  }
}

TEST(SurfaceOverlap, SoundBodiesHaveNone)
{
  SurfaceMesh mesh = Layers({ 0, 1, 3 }, 2);
  EXPECT_TRUE(Overlap(mesh).None());
  mesh = {};
  AddSphere(mesh, { 0, 0, 0 }, 40, 3, 1);
  AddSphere(mesh, { 10, 5, -8 }, 12, 2, 2, 1); // says what is around it
  AddBox(mesh, { 41, -10, -10 }, { 60, 10, 10 }, 4);
  AddBox(mesh, { 60, -10, -10 }, { 70, 10, 10 }, 6);
  EXPECT_TRUE(Overlap(mesh).None());
}

TEST(SurfaceOverlap, TouchingIsNoCrossing)
{
  // Boxes that touch with parts of faces, along an edge, at a corner, flush and not.
  SurfaceMesh mesh;
  AddBox(mesh, { 0, 0, 0 }, { 1, 1, 1 }, 1);
  AddBox(mesh, { 1, 0.2, 0.5 }, { 2, 0.8, 1.5 }, 2);
  AddBox(mesh, { -1, 1, 0.5 }, { 0, 2, 1.5 }, 2);
  AddBox(mesh, { 0.25, -1, 0 }, { 0.75, 0, 1 }, 1);
  AddBox(mesh, { -1, -1, -1 }, { 0, 0, 0 }, 3);
  EXPECT_TRUE(Overlap(mesh).None());
}

TEST(SurfaceOverlap, CrossingSpheresAreCountedWhereTheyMeet)
{
  SurfaceMesh mesh;
  AddSphere(mesh, { -3, 0, 0 }, 5, 3, 1);
  AddSphere(mesh, { 3, 0, 0 }, 5, 3, 2);
  const SurfaceOverlap overlap = Overlap(mesh);
  // They meet in a circle of radius 4 at x = 0. Each crosses some 2 pi 4 / 0.5 triangles of the
  // other; what counts is that there are about as many pairs.
  EXPECT_GT(overlap.Crossings, 50u);
  EXPECT_LT(overlap.Crossings, 400u);
  ASSERT_EQ(overlap.CrossingPlaces.size(), SurfaceOverlap::MostPlaces);
  for (const Vector3& place : overlap.CrossingPlaces)
  {
    // Facets of 0.8 mm: their middles are within one of them.
    EXPECT_NEAR(place[0], 0, 0.8);
    EXPECT_NEAR(std::hypot(place[1], place[2]), 4, 0.8);
  }
  ASSERT_EQ(overlap.Regions.empty(), false);
  // The lens reaches from x = -2 to 2.
  EXPECT_GE(overlap.DoubledParts, 1u);
  EXPECT_EQ(overlap.NegativeParts, 0u);
}

TEST(SurfaceOverlap, SymmetricCrossingThroughDiagonals)
{
  // Edges of the one meet the diagonals of the other's faces: no edge passes inside a triangle.
  SurfaceMesh mesh;
  AddBox(mesh, { 0, 0, 0 }, { 1, 1, 1 }, 1);
  AddBox(mesh, { 0.5, 0.5, 0.5 }, { 1.5, 1.5, 1.5 }, 1);
  const SurfaceOverlap overlap = Overlap(mesh);
  EXPECT_GE(overlap.Crossings, 6u);
  // With common planes there is nothing but touching; lines find the stretch.
  mesh = {};
  AddBox(mesh, { 0, 0, 0 }, { 1, 1, 1 }, 1);
  AddBox(mesh, { 0.5, 0, 0 }, { 1.5, 1, 1 }, 2);
  const SurfaceOverlap common = Overlap(mesh);
  EXPECT_EQ(common.DoubledParts, 2u);
}

TEST(SurfaceOverlap, ASurfaceThatFoldsThroughItself)
{
  // One closed surface, whose top is pushed out through its bottom.
  SurfaceMesh mesh;
  AddSphere(mesh, { 0, 0, 0 }, 10, 3, 1);
  EXPECT_TRUE(Overlap(mesh).None());
  for (std::size_t point = 0; point < mesh.NumberOfPoints(); ++point)
  {
    double* at = &mesh.Points[3 * point];
    at[2] = at[2] > 8 ? -at[2] - 6 : at[2];
  }
  const SurfaceOverlap overlap = Overlap(mesh);
  EXPECT_GT(overlap.Crossings, 10u);
}

TEST(SurfaceOverlap, TheInnerPartIsNamedFirstAndCountedAlone)
{
  // Whatever the order of parts and materials, within the other or with a face in common.
  for (const double low : { 0.0, 2.0 })
  {
    for (const int inner : { 1, 2 })
    {
      for (const bool innerFirst : { false, true })
      {
        SurfaceMesh mesh;
        for (const bool isInner : { innerFirst, !innerFirst })
        {
          isInner ? AddBox(mesh, { -3, -3, low }, { 3, 3, 6 }, inner)
                  : AddBox(mesh, { -10, -10, 0 }, { 10, 10, 10 }, 3 - inner);
        }
        const SurfaceOverlap overlap = Overlap(mesh);
        EXPECT_EQ(overlap.DoubledParts, 1u) << low << ' ' << inner << ' ' << innerFirst;
        ASSERT_FALSE(overlap.Contradictions.empty());
        EXPECT_THAT(overlap.Contradictions[0].Materials, testing::ElementsAre(inner, 3 - inner));
      }
    }
  }
}

TEST(SurfaceOverlap, NestedInAirAndInsideOut)
{
  SurfaceMesh mesh;
  AddSphere(mesh, { 0, 0, 0 }, 10, 2, 1);
  AddSphere(mesh, { 1, 0, 0 }, 4, 2, 2); // says air around it
  SurfaceOverlap overlap = Overlap(mesh);
  EXPECT_EQ(overlap.Crossings, 0u);
  EXPECT_EQ(overlap.DoubledParts, 1u);
  ASSERT_EQ(overlap.Contradictions.size(), 1u);
  EXPECT_LT(Norm(overlap.Contradictions[0].Place - Vector3{ 1, 0, 0 }), 4);
  EXPECT_THAT(overlap.Contradictions[0].Materials, testing::UnorderedElementsAre(1, 2));
  EXPECT_LE(overlap.Contradictions[0].LengthMm, 8);

  mesh = {};
  AddSphere(mesh, { 0, 0, 0 }, 10, 2, 0, 1); // inside out
  overlap = Overlap(mesh);
  EXPECT_EQ(overlap.NegativeParts + overlap.DoubledParts, 1u);
  // A hole hides nothing and adds nothing.
  mesh = {};
  AddSphere(mesh, { 0, 0, 0 }, 10, 2, 1);
  mesh.Triangles.resize(mesh.Triangles.size() - 30);
  mesh.FrontMaterials.resize(mesh.FrontMaterials.size() - 10);
  mesh.BackMaterials.resize(mesh.BackMaterials.size() - 10);
  EXPECT_TRUE(Overlap(mesh).None());
}
}
