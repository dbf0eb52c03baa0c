// SPDX-License-Identifier: Apache-2.0
#include "SurfaceShapes.h"
#include "mammoray/Foundation/SurfaceOverlap.h"
#include "mammoray/XRay/Private/LineBundle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

namespace
{
using namespace mammoray;
using namespace mammoray::shapes;

/// Many small triangles and few large ones; an overlap, one within, one inside out, one sound.
SurfaceMesh Bodies()
{
  SurfaceMesh mesh;
  AddSphere(mesh, { 0, 0, 0 }, 30, 4, 1);
  AddSphere(mesh, { 10, 5, -8 }, 6, 3, 2);
  AddBox(mesh, { 20, -10, -5 }, { 45, 14, 11 }, 3, 0, Rotation(0.1, 0.2, 0.3));
  AddSphere(mesh, { -15, 0, 0 }, 5, 2, 2, 1);
  AddSphere(mesh, { -40, 20, 5 }, 4, 2, 0, 1);
  return mesh;
}

TEST(LineBundle, FindsTheContradictionsThatTheTreeFinds)
{
  const SurfaceMesh mesh = Bodies();
  const TriangleTree tree(mesh);
  XRaySource point;
  point.Position = { 5, -20, 300 };
  XRaySource parallel;
  parallel.Type = XRaySource::Kind::Parallel;
  parallel.Direction = { 0.2, 1, -0.4 };
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> place(-30, 30);
  for (const XRaySource& source : { point, parallel })
  {
    std::vector<LineHit> hits;
    std::vector<CrossingLine> sound;
    int contradicting = 0;
    for (int n = 0; n < 400; ++n)
    {
      const CrossingLine line =
        LineThrough(source, { place(generator), place(generator), place(generator) });
      tree.CrossLine(line.Begin(), line.Direction(), hits);
      const bool expected = !FindContradictions(mesh, line.Begin(), line.Direction(), hits).empty();
      ASSERT_EQ(AnyContradiction(mesh, source, { line }), expected) << n;
      contradicting += expected ? 1 : 0;
      if (!expected)
      {
        sound.push_back(line);
      }
      else
      {
        std::vector<CrossingLine> one = sound;
        one.push_back(line);
        ASSERT_EQ(AnyContradiction(mesh, source, one), true) << n;
      }
    }
    EXPECT_GT(contradicting, 30);
    EXPECT_GT(sound.size(), 50u);
    EXPECT_EQ(AnyContradiction(mesh, source, sound), false);
    EXPECT_EQ(AnyContradiction(mesh, source, {}), false);
  }
}

TEST(LineBundle, KnowsNothingOfASurfaceAroundTheSource)
{
  const SurfaceMesh mesh = Bodies();
  XRaySource source;
  source.Position = { 0, 0, 10 };
  EXPECT_FALSE(AnyContradiction(mesh, source, { LineThrough(source, { 5, 5, 5 }) }));
  source.Position = { 0, 60, 5 }; // beside it, but before all of it
  EXPECT_TRUE(AnyContradiction(mesh, source, { LineThrough(source, { 5, 5, 5 }) }));
}

TEST(LineBundle, SamplesEveryPart)
{
  const SurfaceMesh mesh = Bodies();
  const auto sample = SampleParts(mesh, 200, 8);
  ASSERT_TRUE(sample);
  EXPECT_TRUE(std::is_sorted(sample->begin(), sample->end()));
  // 12 of the box and 40 or more, less than twice that, of the others.
  std::map<int, int> found;
  for (const std::uint32_t triangle : *sample)
  {
    found[mesh.BackMaterials[triangle] * 10 + mesh.FrontMaterials[triangle]] += 1;
  }
  EXPECT_EQ(found.size(), 5u);
  EXPECT_EQ(found[30], 12);
  for (const int sphere : { 10, 20, 21, 1 })
  {
    EXPECT_GE(found[sphere], 40);
    EXPECT_LT(found[sphere], 80);
  }
  EXPECT_FALSE(SampleParts(mesh, 39, 8));
  EXPECT_TRUE(SampleParts(mesh, 40, 8));
}
}
