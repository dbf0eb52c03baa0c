// SPDX-License-Identifier: Apache-2.0
// Gradients of a loss with respect to points against derivatives, differences and closed forms.
#include "ProjectorTesting.h"
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numeric>
#include <random>

namespace
{
using mammoray::test::RefusalOf;
using namespace mammoray;
using namespace mammoray::shapes;

/// Numbers between -1 and 1.
template <typename Number>
std::vector<Number> RandomNumbers(std::size_t count, unsigned seed)
{
  std::mt19937 generator(seed);
  std::uniform_real_distribution<Number> number(-1, 1);
  std::vector<Number> values(count);
  std::generate(values.begin(), values.end(), [&] { return number(generator); });
  return values;
}

/// <J v, g> and <v, J^T g>, divided by the sum of the magnitudes of what the first one sums.
struct Identity
{
  double Forward = 0;
  double Backward = 0;
};

Identity CheckIdentity(PathLengthProjector& projector, const SurfaceMesh& mesh,
  const XRaySource& source, const XRayDetector& detector)
{
  projector.SetSurface(mesh);
  VectorFields velocities;
  velocities.Length = mesh.Points.size();
  velocities.Values = RandomNumbers<double>(mesh.Points.size(), 3);
  PathLengthDerivatives rates;
  const PathLengthImage image = projector.Project(source, detector, velocities, rates);
  std::vector<float> losses = RandomNumbers<float>(rates.Lengths.size(), 4);
  // Pixels whose rays all failed take their neighbours' values, which the transpose does not.
  for (std::size_t index = 0; index < losses.size(); ++index)
  {
    if (image.Inconsistent[index % image.NumberOfPixels()] != 0)
    {
      losses[index] = 0;
    }
  }
  const std::vector<double> gradient = projector.Backward(source, detector, losses);
  Identity identity;
  double size = 0;
  for (std::size_t index = 0; index < losses.size(); ++index)
  {
    const double part = double{ losses[index] } * rates.Lengths[index];
    identity.Forward += part;
    size += std::abs(part);
  }
  EXPECT_EQ(gradient.size(), mesh.Points.size());
  EXPECT_GT(size, 0);
  identity.Forward /= size;
  identity.Backward =
    std::inner_product(gradient.begin(), gradient.end(), velocities.Values.begin(), 0.0) / size;
  return identity;
}

class GradientTest : public ProjectorTest
{
protected:
  void ExpectIdentity(const SurfaceMesh& mesh, const XRaySource& source,
    const XRayDetector& detector, const char* what)
  {
    const Identity identity = CheckIdentity(*this->Projector, mesh, source, detector);
    // Rates are floats, 6e-8 each, and those of rasterisation rounded to 1e-6 of the largest speed;
    // both errors are random, and hundreds of pixels are summed. In single precision both passes
    // see the same rounded hits, compiled to different operations.
    EXPECT_NEAR(identity.Forward, identity.Backward, this->GetParam().Double ? 1e-6 : 1e-5) << what;
  }
};

TEST_P(GradientTest, IsTheTransposeOfTheDerivatives)
{
  // Bodies that are nested, and some that touch; hits at all angles.
  const SurfaceMesh mesh = NestedBodies();
  XRayDetector detector =
    CentredDetector({ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 120, 90, 61, 47);
  this->ExpectIdentity(mesh, PointSource({ 20, 10, 500 }), detector, "point");
  this->ExpectIdentity(mesh, ParallelBeam({ 0.2, -0.1, -1 }), detector, "parallel");
  this->ExpectIdentity(mesh, PointSource({ 1, 2, 30 }), detector, "source inside");
  detector.Samples = 3;
  this->ExpectIdentity(mesh, PointSource({ 20, 10, 500 }), detector, "averaged samples");
  const XRayDetector inside =
    CentredDetector({ 2, 1, -6 }, { 1, 0, 0 }, { 0, 1, 0 }, 30, 30, 41, 43);
  this->ExpectIdentity(mesh, PointSource({ 20, 10, 500 }), inside, "detector inside");
  // Triangles of 50 pixels and more, which many invocations share.
  const XRayDetector fine =
    CentredDetector({ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 20, 16, 200, 160);
  this->ExpectIdentity(mesh, PointSource({ 20, 10, 500 }), fine, "large triangles");
}

TEST_P(GradientTest, HoldsAtGrazingHits)
{
  // A wedge whose face leans against the beam by less than the guard's angle.
  SurfaceMesh mesh = Layers({ 0, 20 }, 10);
  for (std::size_t point = 0; point < mesh.NumberOfPoints(); ++point)
  {
    double* p = &mesh.Points[3 * point];
    p[0] += p[0] < 0 ? 0.0025 * p[2] : 5;
  }
  const XRayDetector detector =
    CentredDetector({ -9.975, 0.3, -5 }, { 1, 0, 0 }, { 0, 1, 0 }, 0.04, 6, 21, 15);
  this->ExpectIdentity(mesh, ParallelBeam({ 0, 0, -1 }), detector, "grazing");
}

TEST_P(GradientTest, FollowsTheRaysThatAreTracedAgain)
{
  // A slit of 0.004 pixels lies on the rays of a row: they are traced again beside it.
  SurfaceMesh mesh = Layers({ 0, 10 }, 40);
  mesh.Triangles.resize(mesh.Triangles.size() - 6);
  mesh.FrontMaterials.resize(mesh.NumberOfTriangles());
  mesh.BackMaterials.resize(mesh.NumberOfTriangles());
  for (const auto& [low, high] : { std::pair(-40.0, 0.249), std::pair(0.251, 40.0) })
  {
    const std::uint32_t first = AddPoint(mesh, { -40, low, 10 });
    AddPoint(mesh, { 40, low, 10 });
    AddPoint(mesh, { 40, high, 10 });
    AddPoint(mesh, { -40, high, 10 });
    AddTriangle(mesh, first, first + 1, first + 2, 1, 0);
    AddTriangle(mesh, first, first + 2, first + 3, 1, 0);
  }
  const XRayDetector detector =
    CentredDetector({ 0.01, 0, -5 }, { 1, 0, 0 }, { 0, 1, 0 }, 20, 20, 40, 40);
  this->Projector->SetSurface(mesh);
  const PathLengthImage image = this->Projector->Project(ParallelBeam({ 0, 0, -1 }), detector);
  EXPECT_EQ(image.NumberOfInconsistentRays(), 0u);
  this->ExpectIdentity(mesh, ParallelBeam({ 0, 0, -1 }), detector, "slit");
  // Sums and marks of the image before are used again, with the same result in integers.
  const std::vector<float> losses = RandomNumbers<float>(2 * detector.NumberOfPixels(), 5);
  this->Projector->SetSurface(mesh);
  const std::vector<double> first =
    this->Projector->Backward(ParallelBeam({ 0, 0, -1 }), detector, losses);
  EXPECT_EQ(this->Projector->Backward(ParallelBeam({ 0, 0, -1 }), detector, losses), first);
  this->Projector->Project(ParallelBeam({ 0, 0.1, -1 }), detector);
  EXPECT_EQ(this->Projector->Backward(ParallelBeam({ 0, 0, -1 }), detector, losses), first);
  // A hole that no offset avoids: inconsistent rays contribute nothing.
  for (std::size_t point = mesh.NumberOfPoints() - 4; point < mesh.NumberOfPoints(); ++point)
  {
    mesh.Points[3 * point + 1] += mesh.Points[3 * point + 1] < 1 ? 1.5 : 0;
  }
  this->Projector->SetSurface(mesh);
  EXPECT_GT(
    this->Projector->Project(ParallelBeam({ 0, 0, -1 }), detector).NumberOfInconsistentRays(), 40u);
  this->ExpectIdentity(mesh, ParallelBeam({ 0, 0, -1 }), detector, "hole");
}

TEST_P(GradientTest, OfASlabIsItsPixelCount)
{
  // All of the beam meets the slab: raising its top by 1 mm lengthens every path by 1 mm.
  const SurfaceMesh mesh = Layers({ 0, 10 }, 40);
  const XRayDetector detector =
    CentredDetector({ 0.013, 0.017, -5 }, { 1, 0, 0 }, { 0, 1, 0 }, 30, 20, 150, 100);
  this->Projector->SetSurface(mesh);
  std::vector<float> losses(2 * detector.NumberOfPixels(), 1.0F);
  std::fill_n(losses.begin(), detector.NumberOfPixels(), 1e30F); // air's are not used
  const std::vector<double> gradient =
    this->Projector->Backward(ParallelBeam({ 0, 0, -1 }), detector, losses);
  double top = 0;
  double bottom = 0;
  for (std::uint32_t point = 0; point < mesh.NumberOfPoints(); ++point)
  {
    EXPECT_NEAR(gradient[3 * point], 0, 1e-6);
    EXPECT_NEAR(gradient[3 * point + 1], 0, 1e-6);
    (PointOf(mesh, point)[2] > 5 ? top : bottom) += gradient[3 * point + 2];
  }
  // Floats of weights whose sum is 1.
  EXPECT_NEAR(top, 15000, 15000 * 1e-6);
  EXPECT_NEAR(bottom, -15000, 15000 * 1e-6);
}

TEST_P(GradientTest, MatchesDifferencesOfTheReference)
{
  SurfaceMesh mesh = NestedBodies();
  const XRayDetector detector =
    CentredDetector({ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 120, 90, 25, 19);
  const XRaySource source = PointSource({ 20, 10, 500 });
  this->Projector->SetSurface(mesh);
  const auto materials = static_cast<std::size_t>(mesh.NumberOfMaterials());
  const std::vector<float> losses = RandomNumbers<float>(materials * detector.NumberOfPixels(), 9);
  const std::vector<double> gradient = this->Projector->Backward(source, detector, losses);
  const auto loss = [&]
  {
    double sum = 0;
    for (std::size_t pixel = 0; pixel < detector.NumberOfPixels(); ++pixel)
    {
      const std::vector<double> lengths = ReferenceLengths(mesh, source.Position,
        Pixel(detector, static_cast<double>(pixel % 25), static_cast<double>(pixel / 25)));
      for (std::size_t material = 1; material < lengths.size(); ++material)
      {
        sum += lengths[material] * losses[material * detector.NumberOfPixels() + pixel];
      }
    }
    return sum;
  };
  const double largest = *std::max_element(gradient.begin(), gradient.end());
  std::mt19937 generator(11);
  int agreeing = 0;
  for (int trial = 0; trial < 24; ++trial)
  {
    const std::size_t coordinate =
      std::uniform_int_distribution<std::size_t>(0, mesh.Points.size() - 1)(generator);
    constexpr double step = 1e-5;
    const double place = mesh.Points[coordinate];
    mesh.Points[coordinate] = place + step;
    const double after = loss();
    mesh.Points[coordinate] = place - step;
    const double before = loss();
    mesh.Points[coordinate] = place;
    // Hits' slopes magnify what rounds in the shaders; see DerivativeTest.
    const double tolerance = (this->GetParam().Double ? 1e-5 : 1e-3) * largest;
    agreeing += std::abs((after - before) / (2 * step) - gradient[coordinate]) < tolerance ? 1 : 0;
  }
  // A ray that passes from one triangle to the next within the step has no derivative.
  EXPECT_GE(agreeing, 23);
}

TEST_P(GradientTest, RefusesUnusableLosses)
{
  const SurfaceMesh mesh = Layers({ 0, 10 }, 40);
  this->Projector->SetSurface(mesh);
  const XRayDetector detector = CentredDetector({ 0, 0, -5 }, { 1, 0, 0 }, { 0, 1, 0 }, 8, 8, 8, 8);
  const XRaySource source = PointSource({ 0, 0, 300 });
  std::vector<float> losses(128, 0.0F);
  EXPECT_THAT(this->Projector->Backward(source, detector, losses), testing::Each(0.0));
  losses[100] = NAN;
  EXPECT_THAT(RefusalOf([&] { this->Projector->Backward(source, detector, losses); }),
    testing::HasSubstr("expected finite derivatives of the loss, found nan at 100"));
  losses.resize(64);
  EXPECT_THAT(RefusalOf([&] { this->Projector->Backward(source, detector, losses); }),
    testing::HasSubstr("128 path lengths (2 materials), found 64"));
}

INSTANTIATE_TEST_SUITE_P(Methods, GradientTest, AllVariants(), VariantName);

TEST(PathLengthGradients, OverlapsAreFollowedByTheirPriority)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  SurfaceMesh mesh;
  AddSphere(mesh, { 0, 0, 0 }, 20, 3, 1);
  AddSphere(mesh, { 15, 4, 3 }, 14, 3, 2);
  const auto projector = MakeProjector({ .Validation = true, .Priority = { 2, 1 } });
  XRayDetector detector = CentredDetector({ 3, 0, -50 }, { 1, 0, 0 }, { 0, 1, 0 }, 70, 50, 35, 25);
  for (const int samples : { 1, 2 })
  {
    detector.Samples = samples;
    const Identity identity =
      CheckIdentity(*projector, mesh, PointSource({ 5, 10, 400 }), detector);
    EXPECT_NEAR(identity.Forward, identity.Backward, 1e-6) << samples;
  }
}

TEST(PathLengthGradients, ImagesLargerThanABufferAreDoneInStrips)
{
  // As in PathLengthDerivatives: 145 MB of path lengths. The parts' gradients sum to the whole's.
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const SurfaceMesh mesh = NestedBodiesOfManyMaterials();
  const auto projector =
    MakeProjector({ .Projection = ProjectorOptions::Method::Rasterisation, .Validation = true });
  projector->SetSurface(mesh);
  const XRaySource source = PointSource({ 20, 10, 500 });
  const XRayDetector whole =
    CentredDetector({ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 150, 110, 500, 400);
  const auto lossesOf = [&](int firstRow, int rows)
  {
    std::vector<float> losses;
    for (int material = 0; material < mesh.NumberOfMaterials(); ++material)
    {
      for (int row = firstRow; row < firstRow + rows; ++row)
      {
        for (int column = 0; column < 500; ++column)
        {
          losses.push_back(static_cast<float>(std::sin(0.3 * row + 0.1 * column + material)));
        }
      }
    }
    return losses;
  };
  const std::vector<double> all = projector->Backward(source, whole, lossesOf(0, 400));
  std::vector<double> sum(all.size(), 0.0);
  for (const int firstRow : { 0, 200 })
  {
    XRayDetector part = whole;
    part.Rows = 200;
    part.Origin = whole.Origin + static_cast<double>(firstRow) * whole.RowStep;
    const std::vector<double> gradient = projector->Backward(source, part, lossesOf(firstRow, 200));
    std::transform(sum.begin(), sum.end(), gradient.begin(), sum.begin(), std::plus<>());
  }
  const double largest = *std::max_element(all.begin(), all.end());
  for (std::size_t index = 0; index < all.size(); ++index)
  {
    ASSERT_NEAR(all[index], sum[index], 1e-5 * largest);
  }
}
}
