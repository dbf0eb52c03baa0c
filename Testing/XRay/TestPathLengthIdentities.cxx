// SPDX-License-Identifier: Apache-2.0
// What must hold of path lengths whatever the mesh, and of a projector after many frames.
#include "ProjectorTesting.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <numeric>
#include <random>

#include <unistd.h>

namespace
{
using namespace mammoray;
using namespace mammoray::shapes;

class IdentityTest : public ProjectorTest
{
protected:
  /// mm of paths of 100 mm, as for the closed forms of PathLengthTest.
  double Tolerance() const
  {
    if (this->GetParam().Double)
    {
      return 3e-5;
    }
    return this->GetParam().Projection == Method::RayTracing ? 2e-3 : 1e-2;
  }

  /// Projects nested bodies, and again after `move` was applied to all points and `turn` to all
  /// directions; lengths must be `scale` times as long.
  void CompareMoved(const std::function<Vector3(const Vector3&)>& move,
    const std::function<Vector3(const Vector3&)>& turn, double scale, bool mirrored)
  {
    SurfaceMesh mesh = NestedBodies();
    XRayDetector detector =
      CentredDetector({ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 150, 110, 47, 37);
    XRaySource point = PointSource({ 20, 10, 400 });
    XRaySource parallel = ParallelBeam({ 0.3, -0.2, -1 });
    this->Projector->SetSurface(mesh);
    const PathLengthImage cone = this->Projector->Project(point, detector);
    const PathLengthImage beam = this->Projector->Project(parallel, detector);

    for (std::uint32_t id = 0; id < mesh.NumberOfPoints(); ++id)
    {
      const Vector3 moved = move(PointOf(mesh, id));
      std::copy(moved.begin(), moved.end(), mesh.Points.begin() + 3 * std::ptrdiff_t{ id });
    }
    if (mirrored) // fronts become backs
    {
      std::swap(mesh.FrontMaterials, mesh.BackMaterials);
    }
    point.Position = move(point.Position);
    parallel.Direction = turn(parallel.Direction);
    detector.Origin = move(detector.Origin);
    detector.ColumnStep = turn(detector.ColumnStep);
    detector.RowStep = turn(detector.RowStep);
    this->Projector->SetSurface(mesh);
    this->ExpectScaled(this->Projector->Project(point, detector), cone, scale);
    this->ExpectScaled(this->Projector->Project(parallel, detector), beam, scale);
  }

  void ExpectScaled(const PathLengthImage& found, const PathLengthImage& expected, double scale)
  {
    EXPECT_EQ(found.NumberOfInconsistentRays(), 0u);
    for (std::size_t index = 0; index < expected.Lengths.size(); ++index)
    {
      ASSERT_NEAR(found.Lengths[index], scale * expected.Lengths[index], scale * this->Tolerance());
    }
  }
};

TEST_P(IdentityTest, BoxesInAnyPoseMatchClosedForm)
{
  std::mt19937 generator(77);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int round = 0; round < 60; ++round)
  {
    const auto axes = Rotation(3 * number(generator), 3 * number(generator), 3 * number(generator));
    const Vector3 low{ -30 + 9 * number(generator), -20 + 9 * number(generator),
      -12 + 9 * number(generator) };
    const Vector3 high{ 30 + 9 * number(generator), 20 + 9 * number(generator),
      12 + 9 * number(generator) };
    SurfaceMesh mesh;
    AddBox(mesh, low, high, 1, 0, axes);
    const auto frame = Rotation(3 * number(generator), 3 * number(generator), number(generator));
    const XRayDetector detector =
      CentredDetector(-70.0 * frame[2], frame[0], frame[1], 90, 80, 13, 11);
    const XRaySource source = round % 2 == 0
      ? PointSource(300.0 * frame[2] + 80 * number(generator) * frame[0])
      : ParallelBeam(-1.0 * frame[2] + 0.4 * number(generator) * frame[1]);
    const PathLengthImage image = this->Project(mesh, source, detector);
    EXPECT_EQ(image.NumberOfInconsistentRays(), 0u);
    for (int row = 0; row < detector.Rows; ++row)
    {
      for (int column = 0; column < detector.Columns; ++column)
      {
        const Vector3 pixel = Pixel(detector, column, row);
        const Vector3 from = source.Type == XRaySource::Kind::Point
          ? source.Position
          : pixel - (1e3 / Norm(source.Direction)) * source.Direction;
        ASSERT_NEAR(image.Material(1)[row * detector.Columns + column],
          BoxChord(low, high, axes, from, pixel), this->Tolerance());
      }
    }
  }
}

TEST_P(IdentityTest, MirroredSceneGivesTheSameImage)
{
  const auto mirror = [](const Vector3& p) { return Vector3{ -p[0], p[1], p[2] }; };
  this->CompareMoved(mirror, mirror, 1, true);
}

TEST_P(IdentityTest, MovedSceneGivesTheSameImage)
{
  const auto axes = Rotation(0.3, -1.2, 2.1);
  this->CompareMoved(
    [&](const Vector3& p) {
      return Apply(axes, p) + Vector3{ 12, -700, 95 };
    },
    [&](const Vector3& d) { return Apply(axes, d); }, 1, false);
}

TEST_P(IdentityTest, ScaledSceneScalesLengths)
{
  for (const double factor : { 0.1, 7.0 })
  {
    const auto scale = [=](const Vector3& p) { return factor * p; };
    this->CompareMoved(scale, scale, factor, false);
  }
}

TEST_P(IdentityTest, LengthsOfSeparateBodiesAdd)
{
  // Bodies one behind the other and beside; the same material, and one of its own.
  const auto first = [](SurfaceMesh& mesh) { AddSphere(mesh, { 0, 0, 30 }, 25, 3, 1); };
  const auto second = [](SurfaceMesh& mesh) {
    AddBox(mesh, { -30, -15, -20 }, { 20, 15, -5 }, 1, 0, Rotation(0.1, 0.2, 0.5));
  };
  const auto third = [](SurfaceMesh& mesh) { AddSphere(mesh, { 30, 10, -40 }, 18, 3, 2); };
  SurfaceMesh together;
  std::vector<SurfaceMesh> apart(3);
  first(together);
  second(together);
  third(together);
  first(apart[0]);
  second(apart[1]);
  third(apart[2]);
  const XRaySource source = PointSource({ 20, 10, 400 });
  const XRayDetector detector =
    CentredDetector({ 5, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 120, 100, 47, 37);
  const PathLengthImage all = this->Project(together, source, detector);
  std::vector<double> sum(2 * all.NumberOfPixels());
  for (const SurfaceMesh& mesh : apart)
  {
    const PathLengthImage one = this->Project(mesh, source, detector);
    for (int material = 1; material < one.Materials; ++material)
    {
      for (std::size_t pixel = 0; pixel < one.NumberOfPixels(); ++pixel)
      {
        sum[(material - 1) * one.NumberOfPixels() + pixel] += one.Material(material)[pixel];
      }
    }
  }
  for (std::size_t index = 0; index < sum.size(); ++index)
  {
    ASSERT_NEAR(all.Lengths[all.NumberOfPixels() + index], sum[index], 3 * this->Tolerance());
  }
}

TEST_P(IdentityTest, RaysAlmostAndExactlyAlongAFace)
{
  const Vector3 low{ -60, -20, -0.5 };
  const Vector3 high{ 60, 20, 0.5 };
  SurfaceMesh mesh;
  AddBox(mesh, low, high, 1);
  const auto axes = Rotation(0, 0, 0);
  for (const double angle : { 0.1, 1e-2, 1e-3, 1e-5, 0.0 })
  {
    const Vector3 direction{ std::cos(angle), 0, -std::sin(angle) };
    // Rows step through the plate's thickness; the faces themselves lie between two.
    const XRayDetector detector =
      CentredDetector({ 90, 0.1, 0.003 }, { 0, 1, 0 }, { 0, 0, 1 }, 44, 6, 11, 60);
    const PathLengthImage image = this->Project(mesh, ParallelBeam(direction), detector);
    EXPECT_EQ(image.NumberOfInconsistentRays(), 0u);
    for (int row = 0; row < detector.Rows; ++row)
    {
      for (int column = 0; column < detector.Columns; ++column)
      {
        const Vector3 pixel = Pixel(detector, column, row);
        const double expected = BoxChord(low, high, axes, pixel - 1e3 * direction, pixel);
        // What a ray is off by, 1e-12 mm or, in single precision, 1e-4 mm, a face magnifies by
        // 1 / angle; below 1e-3 no ray here passes through the faces it runs along.
        const double magnified =
          angle < 1e-3 ? 0 : (this->GetParam().Double ? 1e-12 : 1e-4) / angle;
        ASSERT_NEAR(image.Material(1)[row * detector.Columns + column], expected,
          this->Tolerance() + magnified)
          << "angle " << angle << " row " << row;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, IdentityTest, AllVariants(), VariantName);

/// Resident memory of this process, bytes.
std::size_t Resident()
{
  std::size_t total = 0;
  std::size_t resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

class FrameTest : public testing::TestWithParam<Method>
{
};

TEST_P(FrameTest, TenThousandFramesLeakNothing)
{
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "AddressSanitizer keeps what is freed, and finds leaks itself";
#endif
  const auto devices = ListDevices();
  if (std::none_of(devices.begin(), devices.end(),
        [](const DeviceDescription& device)
        { return device.RayTracing || GetParam() == Method::Rasterisation; }))
  {
    GTEST_SKIP() << "no device for " << MethodName(GetParam());
  }
  const auto projector = MakeProjector({ .Projection = GetParam() });
  SurfaceMesh mesh;
  AddSphere(mesh, { 0, 0, 0 }, 20, 1, 1);
  const XRaySource source = PointSource({ 1, 2, 300 });
  const XRayDetector detector =
    CentredDetector({ 0, 0, -30 }, { 1, 0, 0 }, { 0, 1, 0 }, 50, 50, 12, 8);
  const VectorFields velocities(std::vector<double>(2 * mesh.Points.size(), 0.5),
    mesh.Points.size());
  PathLengthDerivatives derivatives;
  projector->SetSurface(mesh);
  const std::vector<float> first = projector->Project(source, detector).Lengths;
  std::vector<double> resident;
  for (int frame = 0; frame < 10000; ++frame)
  {
    if (frame % 3000 == 1000) // at the first, caches and pools have their size
    {
      resident.push_back(static_cast<double>(Resident()));
    }
    if (frame % 100 == 0)
    {
      projector->SetSurface(mesh);
    }
    projector->UpdatePoints(mesh.Points);
    if (frame % 10 == 0)
    {
      projector->Project(source, detector, velocities, derivatives);
    }
    else
    {
      projector->Project(source, detector);
    }
  }
  resident.push_back(static_cast<double>(Resident()));
  // What leaks grows by each 3000 frames; a pool that a busy machine lets grow late, by some only.
  // 120 bytes for each frame are less than any object of Vulkan takes.
  std::adjacent_difference(resident.begin(), resident.end(), resident.begin());
  EXPECT_LT(*std::min_element(resident.begin() + 1, resident.end()), 3000 * 120);
  EXPECT_EQ(projector->Project(source, detector).Lengths, first);
}

INSTANTIATE_TEST_SUITE_P(Methods, FrameTest,
  testing::Values(Method::RayTracing, Method::Rasterisation),
  [](const testing::TestParamInfo<Method>& instance)
  { return instance.param == Method::RayTracing ? "RayTracing" : "Rasterisation"; });
}
