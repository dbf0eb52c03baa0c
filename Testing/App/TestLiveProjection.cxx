// SPDX-License-Identifier: Apache-2.0
#include "SmallScene.h"
#include "SurfaceShapes.h"
#include "mammoray/App/Private/LiveProjection.h"
#include "mammoray/App/Private/PaneOverlay.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ShippedData.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

namespace
{
using namespace mammoray;
using test::SmallBox;

TEST(LiveProjection, TurnsTheSamplesByClosedForm)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const Scene scene = SmallBox();
  LiveProjection live(scene, {});
  const double mu = MakeBeam(scene).MuPerMm(0, 1);
  const auto middle = [&live] { return live.Project(1)[31 * 64 + 31]; };
  const auto across = [&live]
  {
    const float* row = &live.Project(1)[31 * 64];
    return std::count_if(row, row + 64, [](float value) { return value > 0; });
  };
  // Depth and width of the box as it turns about the middle of its own; 1e-5 of the path: floats.
  EXPECT_NEAR(middle(), 0.02 * mu, 1e-5 * mu);
  EXPECT_EQ(across(), 10);
  live.SetTurn(90);
  EXPECT_NEAR(middle(), 0.01 * mu, 1e-5 * mu);
  EXPECT_EQ(across(), 20);
  live.SetTurn(20);
  EXPECT_NEAR(middle(), 0.02 * mu / std::cos(20 * std::numbers::pi / 180), 1e-5 * mu);
  // Another energy, without other rays.
  live.SetTurn(0);
  live.SetEnergy(40);
  const double harder =
    MakeBeam(scene.Materials, Spectrum::Monochromatic(40), DetectorResponse::EnergyIntegrating)
      .MuPerMm(0, 1);
  EXPECT_NEAR(middle(), 0.02 * harder, 1e-5 * harder);
  live.SetEnergy(1000);
  EXPECT_EQ(live.Energy(), 40); // twice the beam's at most
  // Half as many pixels see the same.
  EXPECT_NEAR(live.Project(2)[15 * 32 + 15], 0.02 * harder, 1e-5 * harder);
  EXPECT_THAT(live.Describe(31, 31),
    testing::MatchesRegex("pixel .31.0, 31.0.: transmission [0-9.]+, Al 20 um"));
}

TEST(LiveProjection, TurnsRightHandedlyAboutWhatIsUp)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  // What lies behind, at +y, goes to -x about +z: to the left.
  Scene scene = SmallBox();
  scene.Materials.Materials.push_back({ .Name = "Ti", .Attenuation = "Ti" });
  scene.Attenuations = FindAttenuations(scene.Materials);
  SurfaceMesh both = *scene.Samples[0].Surface;
  shapes::AddBox(both, { 1.004, 2.03, 3.01 }, { 1.006, 2.04, 3.03 }, 2);
  scene.Samples = { { std::make_shared<const SurfaceMesh>(both) } };
  LiveProjection live(scene, {});
  live.SetTurn(90);
  live.Project(1);
  using testing::HasSubstr;
  EXPECT_THAT(live.Describe(16, 31), HasSubstr(", Ti 2 um")); // 15 um from the middle
  EXPECT_THAT(live.Describe(47, 31), testing::Not(HasSubstr("Ti")));
}

TEST(LiveProjection, PlacesSourceAndDetectorAroundTheSamples)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  Scene scene = SmallBox();
  scene.Detector.Columns = scene.Detector.Rows = 512;
  PlaceAround(scene);
  LiveProjection live(scene, {});
  for (const double turn : { 0.0, 27.0, 63.0, 90.0 })
  {
    live.SetTurn(turn);
    const std::vector<float>& picture = live.Project(1);
    double inside = 0;
    for (int index = 0; index < 512; ++index)
    {
      // No shadow reaches the picture's rim.
      EXPECT_EQ(picture[static_cast<std::size_t>(index)], 0);
      EXPECT_EQ(picture[static_cast<std::size_t>(index) * 512], 0);
      EXPECT_EQ(picture[static_cast<std::size_t>(index) * 512 + 511], 0);
      EXPECT_EQ(picture[511 * 512 + static_cast<std::size_t>(index)], 0);
    }
    for (const float value : picture)
    {
      inside += value > 0 ? 1 : 0;
    }
    EXPECT_GT(inside, 0.05 * 512 * 512);
  }
  // The source at 4 diagonals, the detector at 1.5: its shadow goes as far when it goes 4 / 1.5.
  EXPECT_NEAR(live.SourceGain(), 4 / 1.5, 1e-9);
  live.SetTurn(0);
  const auto firstColumn = [&live]
  {
    const float* row = &live.Project(1)[256 * 512];
    return std::find_if(row, row + 512, [](float value) { return value > 0; }) - row;
  };
  const auto before = firstColumn();
  const double step = 20 * Norm(scene.Detector.ColumnStep) * live.SourceGain();
  live.SetSourceOffset({ step, 0, 0 });
  // At its left is the edge of the face that the rays meet first, 0.01 mm before the middle.
  const double diagonal = Norm(Vector3{ 0.01, 0.02, 0.04 });
  const double shift = step * (1.5 * diagonal + 0.01) / (4 * diagonal - 0.01);
  EXPECT_NEAR(static_cast<double>(before - firstColumn()), shift / Norm(scene.Detector.ColumnStep),
    1); // whole pixels
  // A tube's spectrum has its voltage.
  scene.XRays = FindSpectrum("W28kVp_Rh50um_Be1mm");
  LiveProjection tube(scene, {});
  EXPECT_FALSE(tube.IsSingleEnergy());
  EXPECT_EQ(tube.Energy(), 28);
  SurfaceMesh point = *scene.Samples[0].Surface;
  point.Points.assign(point.Points.size(), 1.0);
  scene.Samples = { { std::make_shared<const SurfaceMesh>(point) } };
  EXPECT_THROW(PlaceAround(scene), InputError);
}

TEST(PaneOverlay, LengthsKeepTheirDigits)
{
  EXPECT_EQ(LengthText(12.34), "12.3 mm");
  EXPECT_EQ(LengthText(0.9), "900 um");
  EXPECT_EQ(LengthText(0.012345), "12.35 um");
}

TEST(LiveProjection, RefusesAPixelBesideThePicture)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const Scene scene = SmallBox();
  LiveProjection live(scene, {});
  EXPECT_THAT(live.Describe(63.4, 0), testing::StartsWith("pixel (63.4, 0.0): transmission 1"));
  EXPECT_THROW(live.Describe(63.6, 0), InputError);
  EXPECT_THROW(live.Describe(0, -0.6), InputError);
}
}
