// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/Composition.h"
#include "mammoray/XRay/DetectorPlane.h"
#include "mammoray/XRay/Exposure.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace
{
using namespace mammoray;

/// Chest wall at column 0; columns run along +y, the focus stands above pixel (0, 10).
XRayDetector Receptor()
{
  XRayDetector detector;
  detector.ColumnStep = { 0, 10, 0 };
  detector.RowStep = { -10, 0, 0 };
  detector.Origin = { 100, 0, 0 };
  detector.Columns = 25;
  detector.Rows = 21;
  return detector;
}

XRaySource Focus()
{
  XRaySource source;
  source.Position = { 0, 0, 650 };
  return source;
}

const auto Counting = DetectorResponse::PhotonCounting;

TEST(DetectorPlane, FindsTheFootAlsoOfSkewSteps)
{
  XRayDetector detector = Receptor();
  detector.RowStep = { -10, 4, 0 };
  XRaySource source = Focus();
  const DetectorPlane above(source, detector);
  EXPECT_NEAR(above.Normal[2], 1, 1e-15);
  EXPECT_DOUBLE_EQ(above.HeightMm, 650);
  // 10 rows lead from x = 100 to 0, and by 40 mm along y, which 4 columns go back.
  EXPECT_NEAR(above.FootRow, 10, 1e-12);
  EXPECT_NEAR(above.FootColumn, -4, 1e-12);
  source.Position = { 0, 0, -300 };
  const DetectorPlane below(source, detector);
  EXPECT_NEAR(below.Normal[2], -1, 1e-15);
  EXPECT_DOUBLE_EQ(below.HeightMm, 300);
  EXPECT_NEAR(below.FootRow, 10, 1e-12);
  source.Type = XRaySource::Kind::Parallel;
  source.Direction = { 1, 0, -2 };
  const DetectorPlane parallel(source, detector);
  EXPECT_NEAR(parallel.Normal[2], 1, 1e-15);
  EXPECT_TRUE(std::isinf(parallel.HeightMm));
}

TEST(OpenField, InverseSquareIsClosedForm)
{
  const XRayDetector detector = Receptor();
  const auto field =
    OpenField(Focus(), detector, Spectrum::Monochromatic(20), Counting, { true, {} });
  for (int row = 0; row < detector.Rows; ++row)
  {
    for (int column = 0; column < detector.Columns; ++column)
    {
      const double x = 100 - 10.0 * row;
      const double y = 10.0 * column;
      // cos / r^2, relative to 1 / 650^2.
      const double r = std::sqrt(x * x + y * y + 650 * 650);
      EXPECT_NEAR(field[row * 25 + column], 650 * 650 / (r * r) * (650 / r), 1e-6);
    }
  }
}

TEST(OpenField, HeelIsClosedFormAndTurnsWithTheAnode)
{
  XRayDetector detector = Receptor();
  OpenFieldOptions options;
  options.Heel = { 22, 0.001, "W" };
  const auto field = OpenField(Focus(), detector, Spectrum::Monochromatic(20), Counting, options);
  AttenuationTable tungsten;
  ASSERT_TRUE(FindComposition("W", tungsten));
  const double mu = tungsten.MuAt(20, tungsten.NominalDensityGPerCm3);
  const double a = 22 * std::numbers::pi / 180;
  // Along the row of the focus the ray's angle adds to the target's.
  for (int column = 0; column < 25; ++column)
  {
    const double angle = std::atan2(10.0 * column, 650);
    const double way = 0.001 * std::cos(a) * (1 / std::sin(a - angle) - 1 / std::sin(a));
    EXPECT_NEAR(field[10 * 25 + column], std::exp(-mu * way), 1e-6);
  }
  EXPECT_EQ(field[10 * 25], 1);
  EXPECT_LT(field[10 * 25 + 24], 0.7);
  // Symmetric across.
  EXPECT_NEAR(field[5 * 25 + 7], field[15 * 25 + 7], 1e-6);
  // Toward the cathode there is more.
  detector.ColumnStep = { 0, -10, 0 };
  detector.Origin = { 100, 100, 0 };
  const auto turned = OpenField(Focus(), detector, Spectrum::Monochromatic(20), Counting, options);
  EXPECT_GT(turned[10 * 25], 1);
  // Below the target's surface nothing leaves.
  options.Heel.TargetAngleDeg = 10;
  EXPECT_EQ(
    OpenField(Focus(), Receptor(), Spectrum::Monochromatic(20), Counting, options)[10 * 25 + 24],
    0);
}

TEST(OpenField, SpectraAverageOverTheirEnergies)
{
  Spectrum two;
  two.EnergiesKeV = { 15, 25 };
  two.Weights = { 2, 1 };
  OpenFieldOptions options{ true, { 20, 0.002, "Mo" } };
  const XRayDetector detector = Receptor();
  const auto low = OpenField(Focus(), detector, Spectrum::Monochromatic(15), Counting, options);
  const auto high = OpenField(Focus(), detector, Spectrum::Monochromatic(25), Counting, options);
  const auto both = OpenField(Focus(), detector, two, DetectorResponse::EnergyIntegrating, options);
  for (std::size_t pixel = 0; pixel < both.size(); ++pixel)
  {
    EXPECT_NEAR(both[pixel], (30 * low[pixel] + 25 * high[pixel]) / 55, 1e-6);
  }
}

TEST(OpenField, RefusesWhatIsNoTube)
{
  const Spectrum line = Spectrum::Monochromatic(20);
  XRaySource parallel;
  parallel.Type = XRaySource::Kind::Parallel;
  EXPECT_THROW(OpenField(parallel, Receptor(), line, Counting, { true, {} }), InputError);
  for (const HeelEffect& heel :
    { HeelEffect{ -5, 0.001, "W" }, HeelEffect{ 90, 0.001, "W" }, HeelEffect{ 20, -1, "W" },
      HeelEffect{ 20, std::nan(""), "W" }, HeelEffect{ 20, 0.001, "cheese" } })
  {
    EXPECT_THROW(OpenField(Focus(), Receptor(), line, Counting, { false, heel }), InputError);
  }
  EXPECT_EQ(OpenField(parallel, Receptor(), line, Counting, {}).front(), 1);
}
}
