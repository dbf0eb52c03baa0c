// SPDX-License-Identifier: Apache-2.0
#include "ProjectorTesting.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/Composition.h"
#include "mammoray/XRay/Refraction.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <numeric>

namespace
{
using namespace mammoray;
using namespace mammoray::shapes;

constexpr double Delta = 1e-6;
const XRaySource Down = ParallelBeam({ 0, 0, -1 });

/// A material that hardly absorbs, 1e-6 / mm, in a beam of one energy.
Beam Clear(double mu = 1e-6)
{
  AttenuationTable table{ "clear", 1, { 10, 30 }, { mu, mu } };
  return Beam(Spectrum::Monochromatic(20), DetectorResponse::PhotonCounting, { nullptr, &table },
    { 0, 1 });
}

/// A long cylinder of `sides` facets along y whose axis is x = z = 0.
SurfaceMesh Cylinder(double radius, int sides)
{
  SurfaceMesh mesh;
  for (const double y : { -500.0, 500.0 })
  {
    AddPoint(mesh, { 0, y, 0 });
    for (int side = 0; side < sides; ++side)
    {
      const double angle = 2 * std::numbers::pi * side / sides;
      AddPoint(mesh, { radius * std::sin(angle), y, radius * std::cos(angle) });
    }
  }
  const auto n = static_cast<std::uint32_t>(sides);
  for (std::uint32_t side = 0; side < n; ++side)
  {
    const std::uint32_t a = 1 + side;
    const std::uint32_t b = 1 + (side + 1) % n;
    AddTriangle(mesh, 0, b, a, 0, 1);
    AddTriangle(mesh, n + 1, n + 1 + a, n + 1 + b, 0, 1);
    AddTriangle(mesh, a, b, n + 1 + b, 1, 0);
    AddTriangle(mesh, a, n + 1 + b, n + 1 + a, 1, 0);
  }
  return mesh;
}

class RefractionTest : public ProjectorTest
{
protected:
  Exposure Refracted(const SurfaceMesh& mesh, const XRaySource& source,
    const XRayDetector& detector, RefractionOptions::Law law, double distance,
    const Beam& beam = Clear(), double delta = Delta)
  {
    this->Projector->SetSurface(mesh);
    return Refract(*this->Projector, mesh.NumberOfPoints(), source, detector, beam, { 0, delta },
      { law, distance });
  }
};

const auto Geometric = RefractionOptions::Law::Geometric;
const auto NearField = RefractionOptions::Law::NearField;

TEST_P(RefractionTest, AWedgeBendsByDeltaTimesItsSlope)
{
  // Thickness 10 + 0.5 x from x = -10 to 10: tan = 0.5. Rays bend towards the thin side.
  SurfaceMesh mesh;
  AddBox(mesh, { -10, -10, 0 }, { 10, 10, 10 }, 1);
  for (std::size_t point = 0; point < mesh.NumberOfPoints(); ++point)
  {
    double* at = &mesh.Points[3 * point];
    at[2] += at[2] > 5 ? 0.5 * at[0] : 0;
  }
  const XRayDetector detector =
    CentredDetector({ 0, 0, -100 }, { 1, 0, 0 }, { 0, 1, 0 }, 8, 8, 9, 9);
  const Exposure image = this->Refracted(mesh, Down, detector, NearField, 100);
  for (std::size_t pixel = 0; pixel < 81; ++pixel)
  {
    // Exact for planes but for the rounding of rates, 1e-6 of them.
    EXPECT_NEAR(image.Deflection[pixel], -0.5 * Delta, 2e-6 * Delta);
    EXPECT_NEAR(image.Deflection[81 + pixel], 0, 2e-6 * Delta);
    EXPECT_NEAR(image.Transmission[pixel], 1, 2e-5); // all are moved alike
  }
}

TEST_P(RefractionTest, ACylinderBendsByItsClosedForm)
{
  const XRayDetector detector =
    CentredDetector({ 0, 0, -100 }, { 1, 0, 0 }, { 0, 1, 0 }, 1.8, 0.1, 90, 1);
  const Exposure image = this->Refracted(Cylinder(1, 4000), Down, detector, NearField, 10);
  for (int column = 0; column < 90; ++column)
  {
    const double x = Pixel(detector, column, 0)[0];
    const double expected = 2 * Delta * x / std::sqrt(1 - x * x);
    // Facets of 0.09 degrees: their normal is off by up to half of that, 8e-4, and by that times
    // 1 / (1 - x^2) of the slope.
    EXPECT_NEAR(image.Deflection[static_cast<std::size_t>(column)], expected,
      2 * Delta * 8e-4 * std::pow(1 - x * x, -1.5));
  }
}

TEST_P(RefractionTest, ASphereFollowsSnellsLawTracedExactly)
{
  // Snell's law at both faces of a sphere of index 1 - delta: a ray at x turns by twice the
  // difference of the angles to the normal, outwards.
  SurfaceMesh mesh;
  AddSphere(mesh, { 0, 0, 0 }, 1, 6, 1);
  const XRayDetector detector =
    CentredDetector({ 0, 0, -100 }, { 1, 0, 0 }, { 0, 1, 0 }, 1.6, 1.6, 41, 41);
  const double delta = 1e-5;
  const Exposure image = this->Refracted(mesh, Down, detector, NearField, 10, Clear(), delta);
  double sum = 0;
  int compared = 0;
  for (int row = 0; row < 41; ++row)
  {
    for (int column = 0; column < 41; ++column)
    {
      const Vector3 at = Pixel(detector, column, row);
      const double distance = std::hypot(at[0], at[1]);
      if (distance < 0.05 || distance > 0.8)
      {
        continue;
      }
      const double inside = std::asin(distance / (1 - delta));
      const double bend = 2 * (inside - std::asin(distance));
      const auto pixel = static_cast<std::size_t>(row * 41 + column);
      const double outwards =
        (image.Deflection[pixel] * at[0] + image.Deflection[1681 + pixel] * at[1]) / distance;
      // Facets of 0.02 have normals that are off by 0.01, either way: 5 % of the largest bends
      // here; on average much less.
      EXPECT_NEAR(outwards, bend, 0.05 * 2 * delta * 0.8 / 0.6);
      sum += outwards / bend - 1;
      ++compared;
    }
  }
  EXPECT_GT(compared, 1000);
  EXPECT_NEAR(sum / compared, 0, 0.005);
}

TEST_P(RefractionTest, BothLawsKeepTheIntensityAndAgreeInTheNearField)
{
  if (!this->GetParam().Double)
  {
    GTEST_SKIP() << "single precision's noise is no subject here";
  }
  // Within a lens with thickness 4 - x^2 / 8 (a wave of facets), 1 + R delta L'' of intensity.
  const SurfaceMesh mesh = Cylinder(4, 2000);
  XRayDetector detector =
    CentredDetector({ 0, 0, -100 }, { 1, 0, 0 }, { 0, 1, 0 }, 12, 0.3, 120, 3);
  detector.Samples = 4;
  const Beam beam = Clear(0.05);
  const Exposure geometric = this->Refracted(mesh, Down, detector, Geometric, 2000, beam, 1e-6);
  const Exposure near = this->Refracted(mesh, Down, detector, NearField, 2000, beam, 1e-6);
  double whole[2] = { 0, 0 };
  double open = 0;
  for (int column = 0; column < 120; ++column)
  {
    const auto pixel = static_cast<std::size_t>(120 + column);
    const double x = Pixel(detector, column, 0)[0];
    whole[0] += geometric.Transmission[pixel];
    whole[1] += near.Transmission[pixel];
    if (std::abs(x) < 3)
    {
      // The largest displacement there is 0.005 mm, a twentieth of a pixel: second order 1e-3.
      EXPECT_NEAR(geometric.Transmission[pixel], near.Transmission[pixel], 2e-3) << x;
    }
    double mean = 0;
    for (int sample = 0; sample < 64; ++sample)
    {
      const double place = x + 0.1 * ((sample + 0.5) / 64 - 0.5);
      mean += std::exp(-0.05 * 2 * std::sqrt(std::max(0.0, 16 - place * place))) / 64;
    }
    open += mean;
  }
  // Nothing leaves the detector, so that what comes in there is what passed: facets, sampling.
  EXPECT_NEAR(whole[0] / open, 1, 5e-4);
  EXPECT_NEAR(whole[1] / open, 1, 5e-4);
}

TEST_P(RefractionTest, AFibreHasABrightRimOutsideAndADarkOneInside)
{
  const SurfaceMesh mesh = Cylinder(0.05, 1000); // 0.1 mm thick
  XRayDetector detector =
    CentredDetector({ 0, 0, -100 }, { 1, 0, 0 }, { 0, 1, 0 }, 0.2, 0.01, 100, 1);
  detector.Samples = 3;
  for (const auto law : { Geometric, NearField })
  {
    const Exposure image = this->Refracted(mesh, Down, detector, law, 200);
    const auto inside = image.Transmission.begin() + 28; // x from -0.044
    const auto outside = image.Transmission.begin() + 20;
    EXPECT_LT(*std::min_element(outside + 3, inside), 0.97);
    EXPECT_GT(*std::max_element(outside, outside + 6), 1.03);
    EXPECT_NEAR(image.Transmission[50], 1, 0.02);
    EXPECT_NEAR(image.Transmission[3], 1, 1e-4);
  }
}

TEST_P(RefractionTest, MagnificationAndObliqueRays)
{
  // A wedge off the axis of a point source: a ray of direction d bends at right angles to itself.
  SurfaceMesh mesh;
  AddBox(mesh, { -200, -200, 0 }, { 200, 200, 10 }, 1);
  for (std::size_t point = 0; point < mesh.NumberOfPoints(); ++point)
  {
    double* at = &mesh.Points[3 * point];
    at[2] += at[2] > 5 ? 0.04 * at[0] : 0;
  }
  const XRaySource source = PointSource({ 0, 0, 400 });
  const XRayDetector detector =
    CentredDetector({ 100, 50, -100 }, { 1, 0, 0 }, { 0, 1, 0 }, 10, 10, 5, 5);
  const Exposure image = this->Refracted(mesh, source, detector, NearField, 100);
  // By differences: shift of the body, along x and along y.
  const PathLengthImage here = this->Project(mesh, source, detector);
  for (std::size_t axis = 0; axis < 2; ++axis)
  {
    SurfaceMesh moved = mesh;
    for (std::size_t point = 0; point < moved.NumberOfPoints(); ++point)
    {
      moved.Points[3 * point + axis] += 1;
    }
    const PathLengthImage there = this->Project(moved, source, detector);
    for (std::size_t pixel = 0; pixel < 25; ++pixel)
    {
      // Planes: linear, but for the rounding of lengths of 10 mm.
      EXPECT_NEAR(image.Deflection[25 * axis + pixel] / Delta,
        there.Material(1)[pixel] - here.Material(1)[pixel], this->GetParam().Double ? 1e-4 : 1e-3);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Projectors, RefractionTest, AllVariants(), VariantName);

TEST(RefractiveDecrement, KnownValuesAndRefusals)
{
  // Henke, Gullikson and Davis (CXRO): water 5.76e-7 at 20 keV, aluminium 5.4e-6 at 10 keV; 1 %:
  // other tables.
  EXPECT_NEAR(RefractiveDecrement("Water, Liquid", 20), 5.76e-7, 6e-9);
  EXPECT_NEAR(RefractiveDecrement("Al", 10), 5.46e-6, 6e-8);
  EXPECT_NEAR(RefractiveDecrement("H2O", 20, 2), 2 * RefractiveDecrement("H2O", 20, 1), 1e-15);
  EXPECT_THROW(RefractiveDecrement("H2O", 20), InputError);
  // Far above all edges by the density of electrons, as the square of the wavelength; carbon's
  // other scattering factor is 5e-4 of its electrons at 20 keV.
  EXPECT_NEAR(RefractiveDecrement("C", 40) / RefractiveDecrement("C", 20), 0.25, 0.25 * 1e-3);
  EXPECT_THROW(RefractiveDecrement("butter", 20), InputError);
}

TEST(Refraction, RefusesWhatDoesNotFit)
{
  std::string reason;
  if (ListDevices(&reason).empty())
  {
    GTEST_SKIP() << reason;
  }
  const auto projector = MakeProjector();
  const SurfaceMesh mesh = Cylinder(1, 8);
  projector->SetSurface(mesh);
  const XRayDetector detector;
  EXPECT_THROW(Refract(*projector, mesh.NumberOfPoints(), Down, detector, Clear(), { 0 }, {}),
    InputError);
  EXPECT_THROW(Refract(*projector, mesh.NumberOfPoints(), Down, detector, Clear(), { 0, 1e-6 },
                 { Geometric, -1 }),
    InputError);
}
}
