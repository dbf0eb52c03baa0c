// SPDX-License-Identifier: Apache-2.0
// Where parts overlap: what is told, and the rule that counts every stretch once.
#include "ProjectorTesting.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/OverlapMeasure.h"

#include <gmock/gmock.h>

namespace
{
using namespace mammoray;
using namespace mammoray::shapes;

const Vector3 Low1{ -30, -20, -10 };
const Vector3 High1{ 10, 20, 10 };
const Vector3 Low2{ -10, -15, 0 };
const Vector3 High2{ 30, 15, 25 };
const XRaySource Tube = PointSource({ 5, 3, 400 });

XRayDetector Film(int samples = 1)
{
  XRayDetector detector = CentredDetector({ 0, 0, -50 }, { 1, 0, 0 }, { 0, 1, 0 }, 70, 50, 35, 25);
  detector.Samples = samples;
  return detector;
}

/// Two boxes, turned a little, that overlap, each in air.
SurfaceMesh TwoBoxes()
{
  SurfaceMesh mesh;
  AddBox(mesh, Low1, High1, 1, 0, Rotation(0.1, 0.05, 0));
  AddBox(mesh, Low2, High2, 2, 0, Rotation(0, 0.1, 0.2));
  return mesh;
}

class OverlapTest : public ProjectorTest
{
protected:
  std::unique_ptr<PathLengthProjector> WithPriority(const std::vector<int>& priority) const
  {
    return MakeProjector({ .Projection = this->GetParam().Projection,
      .DoublePrecision = this->GetParam().Double,
      .Validation = true,
      .Priority = priority });
  }
};

TEST_P(OverlapTest, EveryStretchCountsOnceForTheFirstMaterial)
{
  const SurfaceMesh mesh = TwoBoxes();
  const XRayDetector detector = Film();
  const PathLengthImage sums = this->Project(mesh, Tube, detector);
  const double tolerance = this->GetParam().Double ? 3e-5 : 2e-3; // those of the projectors
  int overlapped = 0;
  for (const std::vector<int>& priority : { std::vector<int>{ 1 }, std::vector<int>{ 2 } })
  {
    const auto projector = this->WithPriority(priority);
    projector->SetSurface(mesh);
    const PathLengthImage image = projector->Project(Tube, detector);
    EXPECT_EQ(image.NumberOfInconsistentRays(), 0u);
    for (int row = 0; row < detector.Rows; ++row)
    {
      for (int column = 0; column < detector.Columns; ++column)
      {
        const Vector3 pixel = Pixel(detector, column, row);
        const auto one = BoxInterval(Low1, High1, Rotation(0.1, 0.05, 0), Tube.Position, pixel);
        const auto other = BoxInterval(Low2, High2, Rotation(0, 0.1, 0.2), Tube.Position, pixel);
        const double common =
          std::max(0.0, std::min(one[1], other[1]) - std::max(one[0], other[0]));
        overlapped += common > 0 ? 1 : 0;
        const auto n = static_cast<std::size_t>(row * detector.Columns + column);
        const double first = one[1] - one[0];
        const double second = other[1] - other[0];
        // Each of the boxes alone, when they are summed.
        ASSERT_NEAR(sums.Material(1)[n], first, tolerance);
        ASSERT_NEAR(sums.Material(2)[n], second, tolerance);
        ASSERT_NEAR(image.Material(1)[n], first - (priority[0] == 2 ? common : 0), tolerance);
        ASSERT_NEAR(image.Material(2)[n], second - (priority[0] == 1 ? common : 0), tolerance);
      }
    }
  }
  EXPECT_GT(overlapped, 300);
}

TEST_P(OverlapTest, TheSameMaterialCountsOnceAndInsideOutNever)
{
  SurfaceMesh mesh;
  AddSphere(mesh, { 0, 0, 0 }, 10, 3, 1);
  AddSphere(mesh, { 2, 0, 0 }, 5, 2, 1);     // wholly inside
  AddSphere(mesh, { 30, 0, 0 }, 4, 2, 0, 1); // inside out
  const auto projector = this->WithPriority({ 1 });
  projector->SetSurface(mesh);
  const XRayDetector detector = Film();
  const PathLengthImage image = projector->Project(Tube, detector);
  SurfaceMesh alone;
  AddSphere(alone, { 0, 0, 0 }, 10, 3, 1);
  const PathLengthImage expected = this->Project(alone, Tube, detector);
  EXPECT_EQ(image.NumberOfInconsistentRays(), 0u);
  EXPECT_THAT(image.Lengths,
    testing::Pointwise(testing::FloatNear(this->GetParam().Double ? 3e-5f : 2e-3f),
      expected.Lengths));
}

TEST_P(OverlapTest, DerivativesAreThoseOfTheRule)
{
  SurfaceMesh mesh = TwoBoxes();
  const auto projector = this->WithPriority({ 2 });
  projector->SetSurface(mesh);
  const XRayDetector detector = Film(2);
  // Field 0 moves the first box, field 1 the second, each its own way.
  const std::size_t count = mesh.Points.size();
  VectorFields velocities(2, count);
  for (std::size_t point = 0; point < mesh.NumberOfPoints(); ++point)
  {
    velocities[point < 8 ? 0 : 1][3 * point] = 0.4;
    velocities[point < 8 ? 0 : 1][3 * point + 2] = point < 8 ? 1.0 : -0.7;
  }
  PathLengthDerivatives derivatives;
  const PathLengthImage image = projector->Project(Tube, detector, velocities, derivatives);
  const double step = 1e-3;
  std::size_t compared = 0;
  for (int field = 0; field < 2; ++field)
  {
    std::array<PathLengthImage, 2> beside;
    for (int side = 0; side < 2; ++side)
    {
      std::vector<double> points = mesh.Points;
      for (std::size_t n = 0; n < count; ++n)
      {
        points[n] += (side == 0 ? -step : step) * velocities[static_cast<std::size_t>(field)][n];
      }
      projector->UpdatePoints(points);
      beside[static_cast<std::size_t>(side)] = projector->Project(Tube, detector);
    }
    for (int material = 1; material < 3; ++material)
    {
      for (std::size_t n = 0; n < image.NumberOfPixels(); ++n)
      {
        const double left = (image.Material(material)[n] - beside[0].Material(material)[n]) / step;
        const double right = (beside[1].Material(material)[n] - image.Material(material)[n]) / step;
        // Where an edge passes the ray the one-sided differences differ: no derivative there.
        const double noise = this->GetParam().Double ? 0.03 : 2; // rounding of lengths, over step
        if (std::abs(left - right) < noise)
        {
          ASSERT_NEAR(derivatives.Of(field, material)[n], 0.5 * (left + right), noise);
          ++compared;
        }
      }
    }
  }
  EXPECT_GT(compared, 3000u);
}

INSTANTIATE_TEST_SUITE_P(Projectors, OverlapTest, AllVariants(), VariantName);

TEST(OverlapMeasure, CountsRaysAndLengths)
{
  // A sphere of radius 5 at the middle of one of 10, both of which say air around them.
  SurfaceMesh mesh;
  AddSphere(mesh, { 0, 0, 0 }, 10, 4, 1);
  AddSphere(mesh, { 0, 0, 0 }, 5, 4, 2);
  const XRayDetector detector =
    CentredDetector({ 0, 0, -20 }, { 1, 0, 0 }, { 0, 1, 0 }, 30, 30, 300, 300);
  const OverlapMeasure measure = MeasureOverlap(mesh, ParallelBeam({ 0, 0, -1 }), detector);
  EXPECT_EQ(measure.Overlap.DoubledParts, 1u);
  // A quarter of the rays; chords of a sphere are 4/3 r on average. 2 %: 5000 rays, facets.
  EXPECT_NEAR(static_cast<double>(measure.Contradicting) / measure.Rays, 0.25, 0.005);
  EXPECT_NEAR(measure.MeanMm, 20.0 / 3, 0.13);
  EXPECT_NEAR(measure.Longest.LengthMm, 10, 0.05);
  const std::string warning = measure.Warning({ "air", "water", "stone" });
  EXPECT_THAT(warning, testing::HasSubstr("1 parts lie in others though their labels say air"));
  EXPECT_THAT(warning, testing::HasSubstr("25 % of the rays"));
  EXPECT_THAT(warning, testing::HasSubstr("stone in water"));

  SurfaceMesh sound;
  AddSphere(sound, { 0, 0, 0 }, 10, 4, 1);
  AddSphere(sound, { 0, 0, 0 }, 5, 4, 2, 1);
  EXPECT_EQ(MeasureOverlap(sound, ParallelBeam({ 0, 0, -1 }), detector).Warning({}), "");
}

TEST(OverlapMeasure, LargeSurfacesAreSearchedWhereLinesMeetContradictions)
{
  SurfaceMesh mesh;
  AddSphere(mesh, { 0, 0, 0 }, 40, 6, 1);
  ASSERT_GT(mesh.NumberOfTriangles(), 20000u);
  const XRayDetector detector =
    CentredDetector({ 0, 0, -60 }, { 1, 0, 0 }, { 0, 1, 0 }, 90, 90, 7, 7);
  const XRaySource outside = PointSource({ 5, 3, 400 });
  EXPECT_TRUE(MeasureOverlap(mesh, outside, detector).Overlap.None());
  // 80 triangles in 81,920, which no ray of the picture comes near.
  AddSphere(mesh, { 10.3, 5.2, -8 }, 0.1, 1, 2);
  for (const XRaySource& source :
    { outside, ParallelBeam({ 0.1, 0, -1 }), PointSource({ 1, 2, 3 }) })
  {
    const OverlapMeasure within = MeasureOverlap(mesh, source, detector);
    EXPECT_EQ(within.Overlap.DoubledParts, 1u);
    EXPECT_EQ(within.Overlap.Crossings, 0u);
    EXPECT_EQ(within.Contradicting, 0u);
    EXPECT_THAT(within.Warning({}), testing::HasSubstr("; no ray of this image is changed by it"));
  }
  // One that sticks out by half: the same counts as those of the search itself.
  AddSphere(mesh, { 0, 40, 0 }, 0.5, 2, 3);
  const OverlapMeasure crossing = MeasureOverlap(mesh, outside, detector);
  const SurfaceOverlap expected = FindOverlap(mesh, TriangleTree(mesh));
  EXPECT_GT(crossing.Overlap.Crossings, 0u);
  EXPECT_EQ(crossing.Overlap.Crossings, expected.Crossings);
  EXPECT_EQ(crossing.Overlap.DoubledParts, expected.DoubledParts);
}

TEST(OverlapPriority, RefusesAirAndRepetition)
{
  std::string reason;
  if (ListDevices(&reason).empty())
  {
    GTEST_SKIP() << reason;
  }
  EXPECT_THROW(MakeProjector({ .Priority = { 0 } }), InputError);
  EXPECT_THROW(MakeProjector({ .Priority = { 2, 1, 2 } }), InputError);
}
}
