// SPDX-License-Identifier: Apache-2.0
// Path lengths against closed forms, against a slow reference, and identities.
#include "ProjectorTesting.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <numeric>
#include <random>

namespace
{
using namespace mammoray;
using namespace mammoray::shapes;

class PathLengthTest : public ProjectorTest
{
protected:
  /// mm over the paths here, which are shorter than 300 mm. Double: results are stored as floats,
  /// 6e-8 relative of at most 100 mm, and the hit test moves edges by 1e-5 mm. Single: rays and
  /// positions are off by up to 1e-4 mm (6e-8 of the source's 600 mm), and steep faces make some 20
  /// times that of it; rasterisation sees corners in pixels, of up to 5 mm here, and places them to
  /// 1e-4 of a pixel, which steep faces magnify as well.
  double Tolerance() const
  {
    if (this->GetParam().Double)
    {
      return 3e-5;
    }
    return this->GetParam().Projection == Method::RayTracing ? 2e-3 : 1e-2;
  }
  /// Relative, where distances are exact: the result's rounding to float; rasterisation's sums have
  /// steps of 2^-31 of the mesh's box besides, 4e-7 mm of 20 mm and more here.
  double Resolution() const
  {
    return this->GetParam().Projection == Method::RayTracing ? 6.1e-8 : 1e-7;
  }
};

Vector3 RayStart(const XRaySource& source, const Vector3& pixel)
{
  return source.Type == XRaySource::Kind::Point
    ? source.Position
    : pixel - (1e4 / Norm(source.Direction)) * source.Direction;
}

/// Largest difference from the reference, mm; rays that the reference cannot walk are left out.
double LargestError(const PathLengthImage& image, const SurfaceMesh& mesh, const XRaySource& source,
  const XRayDetector& detector, std::size_t* compared = nullptr)
{
  double largest = 0;
  std::size_t count = 0;
  for (int row = 0; row < image.Rows; ++row)
  {
    for (int column = 0; column < image.Columns; ++column)
    {
      const Vector3 pixel = Pixel(detector, column, row);
      const auto lengths = ReferenceLengths(mesh, RayStart(source, pixel), pixel);
      for (std::size_t material = 0; material < lengths.size(); ++material)
      {
        const double found =
          image.Material(static_cast<int>(material))[row * image.Columns + column];
        largest = std::max(largest, std::abs(found - lengths[material]));
      }
      count += lengths.empty() ? 0 : 1;
    }
  }
  if (compared)
  {
    *compared = count;
  }
  return largest;
}

TEST_P(PathLengthTest, TwoLayersMatchClosedForm)
{
  // Layers of 20 and 30 mm; the ray's cosine makes both longer by the same factor.
  const SurfaceMesh mesh = Layers({ 10, 30, 60 }, 200);
  const XRaySource source = PointSource({ 0, 0, 650 });
  const XRayDetector detector =
    CentredDetector({ 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, 140, 100, 41, 31);
  const PathLengthImage image = this->Project(mesh, source, detector);
  EXPECT_EQ(image.NumberOfInconsistentRays(), 0u);
  double largest = 0;
  for (int row = 0; row < image.Rows; ++row)
  {
    for (int column = 0; column < image.Columns; ++column)
    {
      const Vector3 ray = Pixel(detector, column, row) - source.Position;
      const double stretch = Norm(ray) / std::abs(ray[2]);
      const std::size_t pixel = static_cast<std::size_t>(row) * image.Columns + column;
      largest = std::max(largest, std::abs(image.Material(1)[pixel] / (20 * stretch) - 1));
      largest = std::max(largest, std::abs(image.Material(2)[pixel] / (30 * stretch) - 1));
      EXPECT_EQ(image.Material(0)[pixel], 0.0f);
    }
  }
  // Double: rounding of the result to float only. Single: 1e-6, a few roundings of 6e-8 of 25 mm.
  EXPECT_LT(largest, this->GetParam().Double ? this->Resolution() : 1e-6);
}

TEST_P(PathLengthTest, RotatedBoxMatchesReference)
{
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> angle(-3, 3);
  for (int round = 0; round < 6; ++round)
  {
    SurfaceMesh mesh;
    AddBox(mesh, { -30, -20, -10 }, { 25, 30, 15 }, 1, 0,
      Rotation(angle(generator), angle(generator), angle(generator)));
    const auto axes = Rotation(angle(generator), angle(generator), angle(generator));
    const XRayDetector detector =
      CentredDetector(-80.0 * axes[2], axes[0], axes[1], 100, 90, 23, 17);
    for (const XRaySource& source :
      { PointSource(400.0 * axes[2] + 30.0 * axes[0]), ParallelBeam(-3.0 * axes[2] + axes[1]) })
    {
      const PathLengthImage image = this->Project(mesh, source, detector);
      EXPECT_EQ(image.NumberOfInconsistentRays(), 0u);
      EXPECT_LT(LargestError(image, mesh, source, detector), this->Tolerance());
    }
  }
}

TEST_P(PathLengthTest, AxisAlignedBoxInParallelBeamCountsDiagonalsOnce)
{
  // Every ray of the diagonal meets the shared edge of two triangles, in front and behind: a double
  // count would cancel in the crossings and show as twice the length.
  SurfaceMesh mesh;
  AddBox(mesh, { -8, -8, 0 }, { 8, 8, 12 }, 1);
  const XRayDetector detector =
    CentredDetector({ 0, 0, -20 }, { 1, 0, 0 }, { 0, 1, 0 }, 16, 16, 16, 16);
  const PathLengthImage image = this->Project(mesh, ParallelBeam({ 0, 0, -1 }), detector);
  EXPECT_EQ(image.NumberOfInconsistentRays(), 0u);
  for (std::size_t pixel = 0; pixel < image.NumberOfPixels(); ++pixel)
  {
    ASSERT_NEAR(image.Material(1)[pixel], 12, 1e-5) << "pixel " << pixel;
  }
}

TEST_P(PathLengthTest, RaysThroughVerticesAndEdges)
{
  // A regular grid of vertices on both faces; every ray runs exactly through one of them.
  SurfaceMesh mesh;
  const int count = 9;
  for (const double z : { 0.0, 10.0 })
  {
    for (int y = 0; y < count; ++y)
    {
      for (int x = 0; x < count; ++x)
      {
        AddPoint(mesh, { x - 4.0, y - 4.0, z });
      }
    }
  }
  const auto id = [&](int x, int y, int top)
  { return static_cast<std::uint32_t>((top * count + y) * count + x); };
  for (int y = 0; y + 1 < count; ++y)
  {
    for (int x = 0; x + 1 < count; ++x)
    {
      AddTriangle(mesh, id(x, y, 1), id(x + 1, y, 1), id(x + 1, y + 1, 1), 1, 0);
      AddTriangle(mesh, id(x, y, 1), id(x + 1, y + 1, 1), id(x, y + 1, 1), 1, 0);
      AddTriangle(mesh, id(x, y, 0), id(x + 1, y + 1, 0), id(x + 1, y, 0), 1, 0);
      AddTriangle(mesh, id(x, y, 0), id(x, y + 1, 0), id(x + 1, y + 1, 0), 1, 0);
    }
  }
  for (int k = 0; k + 1 < count; ++k)
  {
    const int last = count - 1;
    const auto wall = [&](std::uint32_t a, std::uint32_t b, std::uint32_t aTop, std::uint32_t bTop)
    {
      AddTriangle(mesh, a, b, bTop, 1, 0);
      AddTriangle(mesh, a, bTop, aTop, 1, 0);
    };
    wall(id(k, 0, 0), id(k + 1, 0, 0), id(k, 0, 1), id(k + 1, 0, 1));
    wall(id(k + 1, last, 0), id(k, last, 0), id(k + 1, last, 1), id(k, last, 1));
    wall(id(0, k + 1, 0), id(0, k, 0), id(0, k + 1, 1), id(0, k, 1));
    wall(id(last, k, 0), id(last, k + 1, 0), id(last, k, 1), id(last, k + 1, 1));
  }
  const XRayDetector detector = CentredDetector({ 0, 0, -5 }, { 1, 0, 0 }, { 0, 1, 0 }, 7, 7, 7, 7);
  const PathLengthImage image = this->Project(mesh, ParallelBeam({ 0, 0, -1 }), detector);
  EXPECT_EQ(image.NumberOfInconsistentRays(), 0u);
  for (std::size_t pixel = 0; pixel < image.NumberOfPixels(); ++pixel)
  {
    ASSERT_NEAR(image.Material(1)[pixel], 10, 1e-5) << "pixel " << pixel;
  }
}

TEST_P(PathLengthTest, SphereMatchesReferenceAndChord)
{
  SurfaceMesh mesh;
  AddSphere(mesh, { 3, -2, 40 }, 30, 3, 1);
  const XRaySource source = PointSource({ 0, 0, 600 });
  const XRayDetector detector =
    CentredDetector({ 3, -2, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, 70, 70, 29, 31);
  const PathLengthImage image = this->Project(mesh, source, detector);
  EXPECT_EQ(image.NumberOfInconsistentRays(), 0u);
  std::size_t compared = 0;
  EXPECT_LT(LargestError(image, mesh, source, detector, &compared), this->Tolerance());
  EXPECT_GT(compared, image.NumberOfPixels() * 9 / 10);

  // The polyhedron lies between the sphere and one smaller by the sagitta of its longest edge.
  double longest = 0;
  for (std::size_t triangle = 0; triangle < mesh.NumberOfTriangles(); ++triangle)
  {
    for (int side = 0; side < 3; ++side)
    {
      longest = std::max(longest,
        Norm(PointOf(mesh, mesh.Triangles[3 * triangle + side]) -
          PointOf(mesh, mesh.Triangles[3 * triangle + (side + 1) % 3])));
    }
  }
  // Circumradius of an equilateral triangle: edge / sqrt 3.
  const double inner = std::sqrt(30 * 30.0 - longest * longest / 3);
  for (int row = 0; row < image.Rows; ++row)
  {
    for (int column = 0; column < image.Columns; ++column)
    {
      const Vector3 ray = Pixel(detector, column, row) - source.Position;
      const Vector3 toCenter = Vector3{ 3, -2, 40 } - source.Position;
      const double distance = Norm(Cross(toCenter, ray)) / Norm(ray);
      const auto chord = [distance](double radius)
      { return 2 * std::sqrt(std::max(0.0, radius * radius - distance * distance)); };
      const double found = image.Material(1)[row * image.Columns + column];
      ASSERT_LT(found, chord(30) + 1e-3);
      ASSERT_GT(found, chord(inner) - 1e-3);
    }
  }
}

TEST_P(PathLengthTest, NestedAndTouchingBodies)
{
  const SurfaceMesh mesh = NestedBodies();
  const auto axes = Rotation(0.4, -0.3, 0.2);
  const XRayDetector detector =
    CentredDetector(-90.0 * axes[2], axes[0], axes[1], 200, 110, 53, 29);
  const XRaySource source = PointSource(500.0 * axes[2]);
  const PathLengthImage image = this->Project(mesh, source, detector);
  EXPECT_EQ(image.NumberOfInconsistentRays(), 0u);
  EXPECT_LT(LargestError(image, mesh, source, detector), this->Tolerance());
}

TEST_P(PathLengthTest, BigTrianglesUnderAStrongCone)
{
  // Rays leave at up to 63 degrees, and the box is wider than the source is far.
  SurfaceMesh mesh;
  AddBox(mesh, { -300, -300, 5 }, { 300, 300, 25 }, 1);
  const XRaySource source = PointSource({ 0, 0, 100 });
  const XRayDetector detector =
    CentredDetector({ 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, 300, 300, 33, 35);
  const PathLengthImage image = this->Project(mesh, source, detector);
  EXPECT_EQ(image.NumberOfInconsistentRays(), 0u);
  for (int row = 0; row < image.Rows; ++row)
  {
    for (int column = 0; column < image.Columns; ++column)
    {
      const Vector3 ray = Pixel(detector, column, row) - source.Position;
      const double expected = 20 * Norm(ray) / std::abs(ray[2]);
      // Single: 600 mm of mesh leave 3e-5 mm of rounding per coordinate.
      ASSERT_NEAR(image.Material(1)[row * image.Columns + column] / expected, 1,
        this->GetParam().Double ? this->Resolution() : 1e-5);
    }
  }
}

TEST_P(PathLengthTest, SourceAndDetectorInsideTheBody)
{
  // Only what lies between source and pixel counts, wherever the two are.
  const SurfaceMesh mesh = NestedBodies();
  for (const auto& [from, to] :
    std::vector<std::pair<Vector3, Vector3>>{ { { 0, 0, 30 }, { 0, 0, -80 } },
      { { 0, 0, 300 }, { 3, 2, 1 } }, { { 0, 0, 30 }, { 2, 1, -30 } },
      { { 11, 6, -8 }, { -90, 10, 5 } }, { { 0, 0, 200 }, { 0, 0, 100 } } })
  {
    const Vector3 n = (1 / Norm(to - from)) * (to - from);
    const Vector3 u = (1 / Norm(Cross(n, { 0.3, 1, 0.2 }))) * Cross(n, { 0.3, 1, 0.2 });
    const XRayDetector detector = CentredDetector(to, u, Cross(n, u), 30, 30, 11, 13);
    const XRaySource source = PointSource(from);
    const PathLengthImage image = this->Project(mesh, source, detector);
    EXPECT_EQ(image.NumberOfInconsistentRays(), 0u);
    for (int row = 0; row < image.Rows; ++row)
    {
      for (int column = 0; column < image.Columns; ++column)
      {
        const auto expected = ReferenceLengths(mesh, from, Pixel(detector, column, row));
        ASSERT_FALSE(expected.empty());
        for (std::size_t material = 1; material < expected.size(); ++material)
        {
          ASSERT_NEAR(image.Material(static_cast<int>(material))[row * image.Columns + column],
            expected[material], this->Tolerance());
        }
      }
    }
  }
}

TEST_P(PathLengthTest, FarFromTheOrigin)
{
  SurfaceMesh mesh = NestedBodies();
  const Vector3 shift{ 1e4, -1e4, 1e4 };
  for (std::size_t index = 0; index < mesh.Points.size(); ++index)
  {
    mesh.Points[index] += shift[index % 3];
  }
  const XRayDetector detector =
    CentredDetector(shift + Vector3{ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 120, 90, 31, 23);
  const XRaySource source = PointSource(shift + Vector3{ 1, 2, 500 });
  const PathLengthImage image = this->Project(mesh, source, detector);
  EXPECT_EQ(image.NumberOfInconsistentRays(), 0u);
  EXPECT_LT(LargestError(image, mesh, source, detector), this->Tolerance());
}

TEST_P(PathLengthTest, RefitEqualsRebuild)
{
  SurfaceMesh mesh = NestedBodies();
  const XRayDetector detector =
    CentredDetector({ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 120, 90, 41, 33);
  const XRaySource source = PointSource({ 0, 0, 500 });
  this->Project(mesh, source, detector);
  for (std::size_t point = 0; point < mesh.NumberOfPoints(); ++point)
  {
    double* p = &mesh.Points[3 * point];
    p[0] = 1.2 * p[0] + 0.1 * p[2] + 5;
    p[1] = 0.9 * p[1] + 0.001 * p[0] * p[2];
    p[2] = 0.6 * p[2] - 20;
  }
  this->Projector->UpdatePoints(mesh.Points);
  const PathLengthImage refitted = this->Projector->Project(source, detector);
  const PathLengthImage rebuilt = this->Project(mesh, source, detector);
  EXPECT_EQ(refitted.Inconsistent, rebuilt.Inconsistent);
  // The same hits in another order: the sums differ by rounding.
  EXPECT_THAT(refitted.Lengths,
    testing::Pointwise(testing::FloatNear(this->GetParam().Double ? 1e-6f : 1e-4f),
      rebuilt.Lengths));
  EXPECT_LT(LargestError(refitted, mesh, source, detector), this->Tolerance());
}

TEST_P(PathLengthTest, OrderAndOrientationOfTrianglesDoNotMatter)
{
  const SurfaceMesh mesh = NestedBodies();
  const XRayDetector detector =
    CentredDetector({ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 120, 90, 41, 33);
  const XRaySource source = PointSource({ 0, 0, 500 });
  const PathLengthImage expected = this->Project(mesh, source, detector);

  std::vector<std::size_t> order(mesh.NumberOfTriangles());
  std::iota(order.begin(), order.end(), std::size_t{ 0 });
  std::mt19937 generator(11);
  std::shuffle(order.begin(), order.end(), generator);
  SurfaceMesh shuffled;
  shuffled.Points = mesh.Points;
  for (const std::size_t triangle : order)
  {
    const std::uint32_t* ids = &mesh.Triangles[3 * triangle];
    const int front = mesh.FrontMaterials[triangle];
    const int back = mesh.BackMaterials[triangle];
    if (generator() % 2 == 0)
    {
      AddTriangle(shuffled, ids[0], ids[1], ids[2], back, front);
    }
    else
    {
      AddTriangle(shuffled, ids[0], ids[2], ids[1], front, back);
    }
  }
  const PathLengthImage found = this->Project(shuffled, source, detector);
  EXPECT_EQ(found.NumberOfInconsistentRays(), 0u);
  EXPECT_THAT(found.Lengths,
    testing::Pointwise(testing::FloatNear(this->GetParam().Double ? 1e-6f : 1e-4f),
      expected.Lengths));

  // Exchanged labels exchange the images.
  SurfaceMesh swapped = mesh;
  for (auto* side : { &swapped.FrontMaterials, &swapped.BackMaterials })
  {
    for (std::uint16_t& material : *side)
    {
      material = material == 1 ? 6 : material == 6 ? 1 : material;
    }
  }
  const PathLengthImage exchanged = this->Project(swapped, source, detector);
  for (std::size_t pixel = 0; pixel < expected.NumberOfPixels(); ++pixel)
  {
    ASSERT_FLOAT_EQ(exchanged.Material(6)[pixel], expected.Material(1)[pixel]);
    ASSERT_FLOAT_EQ(exchanged.Material(1)[pixel], expected.Material(6)[pixel]);
  }
}

TEST_P(PathLengthTest, ManyMaterialsAndManyHits)
{
  // 40 thin layers in 40 materials: more crossings and labels than any fixed list would hold.
  std::vector<double> heights;
  for (int layer = 0; layer <= 40; ++layer)
  {
    heights.push_back(0.5 * layer + 0.01 * layer * layer);
  }
  const SurfaceMesh mesh = Layers(heights, 60);
  const XRayDetector detector =
    CentredDetector({ 0, 0, -10 }, { 1, 0, 0 }, { 0, 1, 0 }, 20, 20, 5, 7);
  const PathLengthImage image = this->Project(mesh, ParallelBeam({ 0, 0, -1 }), detector);
  ASSERT_EQ(image.Materials, 41);
  EXPECT_EQ(image.NumberOfInconsistentRays(), 0u);
  for (int layer = 0; layer < 40; ++layer)
  {
    for (std::size_t pixel = 0; pixel < image.NumberOfPixels(); ++pixel)
    {
      ASSERT_NEAR(image.Material(layer + 1)[pixel],
        heights[static_cast<std::size_t>(layer) + 1] - heights[static_cast<std::size_t>(layer)],
        1e-5);
    }
  }
}

TEST_P(PathLengthTest, SamplesAreTheMeanOfTheirRays)
{
  const SurfaceMesh mesh = NestedBodies();
  XRayDetector coarse = CentredDetector({ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 120, 90, 12, 9);
  XRayDetector fine = CentredDetector({ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 120, 90, 36, 27);
  coarse.Samples = 3;
  const XRaySource source = PointSource({ 0, 0, 500 });
  const PathLengthImage mean = this->Project(mesh, source, coarse);
  const PathLengthImage rays = this->Projector->Project(source, fine);
  for (int material = 1; material < mean.Materials; ++material)
  {
    for (int row = 0; row < mean.Rows; ++row)
    {
      for (int column = 0; column < mean.Columns; ++column)
      {
        double sum = 0;
        for (int k = 0; k < 9; ++k)
        {
          sum += rays.Material(material)[(3 * row + k / 3) * fine.Columns + 3 * column + k % 3];
        }
        ASSERT_NEAR(mean.Material(material)[row * mean.Columns + column], sum / 9,
          this->Tolerance());
      }
    }
  }
}

TEST_P(PathLengthTest, AHoleIsMarkedAndNotBright)
{
  SurfaceMesh closed;
  AddSphere(closed, { 0, 0, 40 }, 30, 3, 1);
  const XRaySource source = PointSource({ 0, 0, 600 });
  const XRayDetector detector =
    CentredDetector({ 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, 70, 70, 71, 71);
  const PathLengthImage whole = this->Project(closed, source, detector);

  SurfaceMesh open;
  open.Points = closed.Points;
  // Leave out the triangle that faces the source nearest to (5, 5).
  std::size_t missing = 0;
  double nearest = 1e9;
  for (std::size_t triangle = 0; triangle < closed.NumberOfTriangles(); ++triangle)
  {
    Vector3 middle{ 0, 0, 0 };
    for (int corner = 0; corner < 3; ++corner)
    {
      middle = middle + (1 / 3.0) * PointOf(closed, closed.Triangles[3 * triangle + corner]);
    }
    const double distance = std::hypot(middle[0] - 5, middle[1] - 5);
    if (middle[2] > 40 && distance < nearest)
    {
      nearest = distance;
      missing = triangle;
    }
  }
  for (std::size_t triangle = 0; triangle < closed.NumberOfTriangles(); ++triangle)
  {
    if (triangle != missing)
    {
      const std::uint32_t* ids = &closed.Triangles[3 * triangle];
      AddTriangle(open, ids[0], ids[1], ids[2], 1, 0);
    }
  }
  const PathLengthImage leaky = this->Project(open, source, detector);
  // The triangle has edges of about 4.5 mm: some ten pixels.
  EXPECT_GT(leaky.NumberOfInconsistentRays(), 3u);
  EXPECT_LT(leaky.NumberOfInconsistentRays(), 30u);
  EXPECT_EQ(whole.InconsistencyWarning(), "");
  EXPECT_EQ(leaky.InconsistencyWarning().find(
              std::to_string(leaky.NumberOfInconsistentRays()) + " pixels in columns "),
    0u);
  double largest = 0;
  for (std::size_t pixel = 0; pixel < whole.NumberOfPixels(); ++pixel)
  {
    const double difference = std::abs(whole.Material(1)[pixel] - leaky.Material(1)[pixel]);
    largest = std::max(largest, difference);
    if (leaky.Inconsistent[pixel] == 0)
    {
      // A ray just inside the hole may be taken a tenth of a pixel (0.1 mm) beside; the sphere's
      // chord changes by at most 0.6 mm per mm there.
      ASSERT_LT(difference, 0.06);
    }
  }
  // Chords of about 58 mm; filling from the neighbours errs by the chord's change over a few
  // pixels.
  EXPECT_LT(largest, 1.5);
}

TEST_P(PathLengthTest, HairlineCracksAreTracedAgain)
{
  // The top's halves meet along y = 0, but for a corner of one that stands 4 um off: a crack, in
  // which a row of rays lies. A little beside, the mesh is whole.
  SurfaceMesh mesh = Layers({ 0, 10 }, 20);
  mesh.Triangles.resize(mesh.Triangles.size() - 6);
  mesh.FrontMaterials.resize(mesh.NumberOfTriangles());
  mesh.BackMaterials.resize(mesh.NumberOfTriangles());
  const std::uint32_t west = AddPoint(mesh, { -20, 0, 10 });
  const std::uint32_t east = AddPoint(mesh, { 20, 0, 10 });
  const std::uint32_t middle = AddPoint(mesh, { 0, 0.004, 10 });
  AddTriangle(mesh, 4, 5, east, 1, 0);
  AddTriangle(mesh, 4, east, west, 1, 0);
  AddTriangle(mesh, west, middle, 7, 1, 0);
  AddTriangle(mesh, middle, 6, 7, 1, 0);
  AddTriangle(mesh, middle, east, 6, 1, 0);
  // Triangles of many pixels and of few.
  for (const int fineness : { 4, 1 })
  {
    XRayDetector detector = CentredDetector({ 0.2, 0.001, -5 }, { 1, 0, 0 }, { 0, 1, 0 }, 28, 12,
      7 * fineness, 2 * fineness + 1);
    for (const int samples : { 1, 3 })
    {
      detector.Samples = samples;
      const PathLengthImage image = this->Project(mesh, ParallelBeam({ 0, 0, -1 }), detector);
      EXPECT_EQ(image.NumberOfInconsistentRays(), 0u) << fineness << ", " << samples << " samples";
      for (std::size_t pixel = 0; pixel < image.NumberOfPixels(); ++pixel)
      {
        ASSERT_NEAR(image.Material(1)[pixel], 10, 1e-5) << "pixel " << pixel;
      }
    }
  }
}

TEST_P(PathLengthTest, InsideOutLabelsAreMarked)
{
  SurfaceMesh mesh;
  AddBox(mesh, { -5, -5, 0 }, { 5, 5, 5 }, 0, 1);
  const XRayDetector detector = CentredDetector({ 0, 0, -5 }, { 1, 0, 0 }, { 0, 1, 0 }, 8, 8, 8, 8);
  const PathLengthImage image = this->Project(mesh, PointSource({ 0.1, 0.2, 300 }), detector);
  EXPECT_EQ(image.NumberOfInconsistentRays(), 64u);
  EXPECT_THAT(image.Lengths, testing::Each(0.0f));
}

TEST_P(PathLengthTest, RefusesUnusableInput)
{
  SurfaceMesh mesh;
  AddBox(mesh, { -5, -5, 0 }, { 5, 5, 5 }, 1);
  this->Projector->SetSurface(mesh);
  XRayDetector detector = CentredDetector({ 0, 0, -5 }, { 1, 0, 0 }, { 0, 1, 0 }, 8, 8, 8, 8);
  EXPECT_THROW(this->Projector->Project(PointSource({ 1, 2, -5 }), detector), InputError);
  EXPECT_THROW(this->Projector->Project(ParallelBeam({ 0, 0, 0 }), detector), InputError);
  EXPECT_THROW(this->Projector->Project(ParallelBeam({ 1, 0, 0 }), detector), InputError);
  EXPECT_THROW(this->Projector->Project(PointSource({ 0, NAN, 300 }), detector), InputError);
  XRayDetector huge = detector;
  huge.Columns = huge.Rows = 100000;
  EXPECT_THROW(this->Projector->Project(PointSource({ 0, 0, 300 }), huge), InputError);
  detector.RowStep = 2.0 * detector.ColumnStep;
  EXPECT_THROW(this->Projector->Project(PointSource({ 0, 0, 300 }), detector), InputError);
  EXPECT_THROW(this->Projector->UpdatePoints({ 1, 2, 3 }), InputError);
  std::vector<double> points = mesh.Points;
  points[4] = INFINITY;
  EXPECT_THROW(this->Projector->UpdatePoints(points), InputError);
  mesh.Triangles[5] = 99;
  EXPECT_THROW(this->Projector->SetSurface(mesh), InputError);
  EXPECT_THROW(this->Projector->SetSurface({}), InputError);
}

TEST_P(PathLengthTest, MatchesReferenceOnRandomBodies)
{
  // Bumpy bodies inside one another in random poses; every method and precision must find what the
  // sorted walk finds, so all agree.
  std::mt19937 generator(23);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int round = 0; round < 12; ++round)
  {
    SurfaceMesh mesh;
    AddSphere(mesh, { 0, 0, 0 }, 40, 3, 1);
    AddSphere(mesh, { 8, 3, -4 }, 20, 3, 2, 1);
    AddSphere(mesh, { 9, 4, -5 }, 8, 2, 3, 2);
    const auto axes = Rotation(3 * number(generator), 3 * number(generator), number(generator));
    for (std::size_t point = 0; point < mesh.NumberOfPoints(); ++point)
    {
      // Up to 1 mm, less than the bodies' distances.
      const Vector3 bump{ number(generator), number(generator), number(generator) };
      const Vector3 moved =
        Apply(axes, PointOf(mesh, static_cast<std::uint32_t>(point)) + 0.5 * bump);
      std::copy(moved.begin(), moved.end(),
        mesh.Points.begin() + static_cast<std::ptrdiff_t>(3 * point));
    }
    const XRayDetector detector =
      CentredDetector({ 5 * number(generator), 0, -60 }, { 1, 0, 0 }, { 0, 1, 0 }, 100, 90, 37, 31);
    const XRaySource source = round % 3 == 0
      ? ParallelBeam({ number(generator), number(generator), -3 })
      : PointSource({ 50 * number(generator), 50 * number(generator), 300 });
    const PathLengthImage image = this->Project(mesh, source, detector);
    EXPECT_EQ(image.NumberOfInconsistentRays(), 0u);
    std::size_t compared = 0;
    EXPECT_LT(LargestError(image, mesh, source, detector, &compared), this->Tolerance());
    EXPECT_GT(compared, image.NumberOfPixels() * 99 / 100);
  }
}

TEST(RasterisationProjector, BandsOfRowsMatchOneBand)
{
  // 14 x 14 samples of 300 x 200 pixels in 6 materials and air are 330 MB of sums, more than is
  // worked on at once.
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const auto projector =
    MakeProjector({ .Projection = ProjectorOptions::Method::Rasterisation, .Validation = true });
  EXPECT_EQ(projector->Method(), Method::Rasterisation);
  projector->SetSurface(NestedBodies());
  const XRaySource source = PointSource({ 0, 0, 500 });
  XRayDetector many = CentredDetector({ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 120, 90, 300, 200);
  many.Samples = 14;
  const PathLengthImage mean = projector->Project(source, many);
  EXPECT_EQ(mean.NumberOfInconsistentRays(), 0u);
  many.Samples = 3;
  const PathLengthImage few = projector->Project(source, many);
  // Two means over a pixel of 0.4 mm: inside, path lengths bend little; outlines differ.
  for (int material = 1; material < mean.Materials; ++material)
  {
    double difference = 0;
    for (std::size_t pixel = 0; pixel < mean.NumberOfPixels(); ++pixel)
    {
      difference += std::abs(mean.Material(material)[pixel] - few.Material(material)[pixel]);
    }
    EXPECT_LT(difference / static_cast<double>(mean.NumberOfPixels()), 0.01);
  }
}

TEST(RasterisationProjector, TakesMoreRowsThanWorkgroups)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const auto projector =
    MakeProjector({ .Projection = ProjectorOptions::Method::Rasterisation, .Validation = true });
  projector->SetSurface(Layers({ 0, 10 }, 20));
  // 70000 rows of samples 0.15 um apart, two to a pixel; the plate ends in their middle.
  XRayDetector line = CentredDetector({ 0, 20, -5 }, { 1, 0, 0 }, { 0, 1, 0 }, 2, 10.5, 2, 35000);
  line.Samples = 2;
  const PathLengthImage image = projector->Project(ParallelBeam({ 0, 0, -1 }), line);
  EXPECT_EQ(image.NumberOfInconsistentRays(), 0u);
  for (std::size_t pixel = 0; pixel < image.NumberOfPixels(); ++pixel)
  {
    ASSERT_NEAR(image.Material(1)[pixel], pixel < 35000 ? 10 : 0, 1e-4) << "pixel " << pixel;
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, PathLengthTest, AllVariants(), VariantName);

/// Ends the process with 0 where nothing is found though a loader is there.
[[noreturn]] void LookForDevicesWithoutDrivers()
{
  // Both names, for old and new loaders.
  setenv("VK_DRIVER_FILES", "/nonexistent", 1);
  setenv("VK_ICD_FILENAMES", "/nonexistent", 1);
  std::string reason;
  EXPECT_TRUE(ListDevices(&reason).empty());
  EXPECT_THAT(reason, testing::HasSubstr("no Vulkan"));
  EXPECT_THAT(reason, testing::Not(testing::HasSubstr("\n")));
  EXPECT_THROW(MakeProjector({ .Projection = ProjectorOptions::Method::RayTracing }), DeviceError);
  EXPECT_THROW(MakeProjector(), DeviceError);
  std::exit(testing::Test::HasFailure() ? 1 : 0);
}

TEST(ProjectorDevice, AbsentDriverIsOneLine)
{
  // In a process of its own: the loader looks for drivers once in each.
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(LookForDevicesWithoutDrivers(), testing::ExitedWithCode(0), "");
}

TEST(ProjectorDevice, UnknownNameListsTheKnown)
{
  const auto devices = ListDevices();
  if (devices.empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  try
  {
    MakeProjector({ .Device = "no such device" });
    FAIL() << "expected a DeviceError";
  }
  catch (const DeviceError& error)
  {
    EXPECT_THAT(error.what(), testing::HasSubstr(devices.front().Name));
  }
}
}
