// SPDX-License-Identifier: Apache-2.0
// Ray by ray against Embree, which shares no code and no hit test with either projector.
#include "EmbreePathLengths.h"
#include "SurfaceShapes.h"
#include "mammoray/IO/ShippedExamples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace
{
using namespace mammoray;
using test::EmbreePathLengths;
using test::HitDistance;
using Method = ProjectorOptions::Method;

/// What comparing images ray by ray gave; lengths in mm.
struct Differences
{
  std::size_t Rays = 0;
  /// Rays that Embree or the projector could not make sense of.
  std::size_t EmbreeFailed = 0;
  std::size_t Failed = 0;
  /// Compared rays that pass through material at all.
  std::size_t Crossing = 0;
  std::size_t Beyond = 0;
  double Largest = 0;
};

/// mm; see ExpectSame.
constexpr double Usual = 3e-5;

void Compare(const PathLengthImage& image, const PathLengthImage& peer, Differences& differences)
{
  ASSERT_EQ(image.Columns, peer.Columns);
  ASSERT_EQ(image.Rows, peer.Rows);
  ASSERT_EQ(image.Materials, peer.Materials);
  for (std::size_t pixel = 0; pixel < image.NumberOfPixels(); ++pixel)
  {
    ++differences.Rays;
    differences.EmbreeFailed += peer.Inconsistent[pixel];
    differences.Failed += image.Inconsistent[pixel];
    if (peer.Inconsistent[pixel] != 0 || image.Inconsistent[pixel] != 0)
    {
      continue;
    }
    bool crossing = false;
    bool beyond = false;
    for (int material = 1; material < image.Materials; ++material)
    {
      const double difference =
        std::abs(double{ image.Material(material)[pixel] } - peer.Material(material)[pixel]);
      differences.Largest =
        std::isnan(difference) ? INFINITY : std::max(differences.Largest, difference);
      beyond = beyond || !(difference <= Usual);
      crossing = crossing || peer.Material(material)[pixel] > 0.01f;
    }
    differences.Beyond += beyond ? 1 : 0;
    differences.Crossing += crossing ? 1 : 0;
  }
}

/**
 * Both sides find distances in double precision on the same planes and store floats of at most
 * 100 mm, which round to 4e-6 mm each. Next to an edge they may pick different triangles: rays and
 * corners are single precision in Embree, 4e-5 mm off at 650 mm. Path lengths are continuous there,
 * so that changes them by as much times the faces' steepness: rarely more than `Usual`, which
 * becomes 5e-3 mm on faces seen at half a degree. Embree may hit both triangles of an edge.
 */
void ExpectSame(const Differences& differences, double crossing)
{
  const auto rays = static_cast<double>(differences.Rays);
  EXPECT_LE(differences.Largest, 5e-3);
  EXPECT_LE(static_cast<double>(differences.Beyond), 2e-5 * rays);
  EXPECT_EQ(differences.Failed, 0u);
  EXPECT_LE(static_cast<double>(differences.EmbreeFailed), 2e-5 * rays);
  EXPECT_GE(static_cast<double>(differences.Crossing), crossing * rays);
}

class EmbreePeer : public testing::TestWithParam<Method>
{
protected:
  void SetUp() override
  {
    const auto devices = ListDevices();
    if (std::none_of(devices.begin(), devices.end(),
          [this](const DeviceDescription& device)
          { return device.RayTracing || this->GetParam() != Method::RayTracing; }))
    {
      GTEST_SKIP() << "no Vulkan device for " << MethodName(this->GetParam());
    }
    this->Projector = MakeProjector({ .Projection = this->GetParam() });
  }

  Differences CompareScene(ExampleScene scene, int coarser)
  {
    XRayDetector& detector = scene.Detector;
    detector.Columns /= coarser;
    detector.Rows /= coarser;
    detector.ColumnStep = coarser * detector.ColumnStep;
    detector.RowStep = coarser * detector.RowStep;
    this->Projector->SetSurface(scene.Surface);
    const EmbreePathLengths embree(scene.Surface);
    Differences differences;
    Compare(this->Projector->Project(scene.Source, detector),
      embree.Project(scene.Source, detector, HitDistance::Double), differences);
    return differences;
  }

  std::unique_ptr<PathLengthProjector> Projector;
};

/// A convex or starry closed body about the origin, of some random kind.
void AddRandomBody(SurfaceMesh& mesh, std::mt19937& random)
{
  const auto uniform = [&](double low, double high)
  { return std::uniform_real_distribution<double>(low, high)(random); };
  const std::size_t firstPoint = mesh.NumberOfPoints();
  const int inside = std::uniform_int_distribution<int>(1, 5)(random);
  if (random() % 3 == 0)
  {
    shapes::AddBox(mesh, { -uniform(1, 9), -uniform(1, 9), -uniform(1, 9) },
      { uniform(1, 9), uniform(1, 9), uniform(1, 9) }, inside);
  }
  else
  {
    shapes::AddSphere(mesh, {}, uniform(2, 9), static_cast<int>(random() % 3), inside);
    for (std::size_t point = firstPoint; point < mesh.NumberOfPoints(); ++point)
    {
      const double spike = uniform(0.6, 1.4);
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        mesh.Points[3 * point + axis] *= spike;
      }
    }
  }
  const auto axes = shapes::Rotation(uniform(0, 6), uniform(0, 6), uniform(0, 6));
  const Vector3 center{ uniform(-30, 30), uniform(-30, 30), uniform(20, 70) };
  for (std::size_t point = firstPoint; point < mesh.NumberOfPoints(); ++point)
  {
    double* place = &mesh.Points[3 * point];
    const Vector3 turned = center + shapes::Apply(axes, { place[0], place[1], place[2] });
    std::copy(turned.begin(), turned.end(), place);
  }
}
}

TEST_P(EmbreePeer, ThousandsOfRandomMeshes)
{
  std::mt19937 random(20211);
  Differences differences;
  constexpr int scenes = 50;
  constexpr int bodies = 60;
  for (int scene = 0; scene < scenes; ++scene)
  {
    SurfaceMesh mesh;
    for (int body = 0; body < bodies; ++body)
    {
      AddRandomBody(mesh, random);
    }
    XRaySource source;
    source.Position = { 5.0 * (scene % 7), 20.0 - scene, 300.0 + 8 * scene };
    if (scene % 5 == 0)
    {
      source.Type = XRaySource::Kind::Parallel;
      source.Direction = { 0.01 * scene, 0.1, -1 };
    }
    XRayDetector detector;
    detector.Columns = 60;
    detector.Rows = 50;
    detector.ColumnStep = { 1.7, 0.1, 0 };
    detector.RowStep = { 0, 1.9, 0.05 };
    detector.Origin = { -50, -47, 0 };
    this->Projector->SetSurface(mesh);
    const EmbreePathLengths embree(mesh);
    Compare(this->Projector->Project(source, detector),
      embree.Project(source, detector, HitDistance::Double), differences);
  }
  ExpectSame(differences, 0.4);
}

TEST_P(EmbreePeer, Plate)
{
  ExpectSame(this->CompareScene(MakePlateScene(), 1), 0.6);
}

TEST_P(EmbreePeer, Boxes)
{
  ExpectSame(this->CompareScene(MakeBoxesScene(), 1), 0.4);
}

TEST_P(EmbreePeer, Veins)
{
  ExpectSame(this->CompareScene(MakeVeinsScene(), 4), 0.2);
}

TEST_P(EmbreePeer, Breast)
{
  if (this->GetParam() == Method::RayTracing && ListDevices().front().Type == "CPU")
  {
    GTEST_SKIP() << "minutes where rays are traced in software";
  }
  ExpectSame(this->CompareScene(MakeExampleScene("breast"), 1), 0.4);
}

INSTANTIATE_TEST_SUITE_P(Methods, EmbreePeer,
  testing::Values(Method::RayTracing, Method::Rasterisation),
  [](const testing::TestParamInfo<Method>& method)
  { return method.param == Method::RayTracing ? "RayTracing" : "Rasterisation"; });
