// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "SurfaceShapes.h"
#include "VirtualDisplay.h"
#include "mammoray/App/Private/LiveProjection.h"
#include "mammoray/App/Private/PaneOverlay.h"
#include "mammoray/App/SurfaceViewer.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ShippedData.h"

#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPNGReader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

namespace
{
using namespace mammoray;

/// A box of 10 x 20 x 40 um of aluminium before a parallel beam along y.
ViewedScene SmallBox()
{
  ViewedScene viewed;
  viewed.Name = "box";
  Scene& scene = viewed.Scene;
  SurfaceMesh box;
  shapes::AddBox(box, { 1, 2, 3 }, { 1.01, 2.02, 3.04 }, 1);
  scene.Samples = { { std::make_shared<const SurfaceMesh>(box) } };
  scene.Materials.Materials = { { .Name = "air" },
    { .Name = "Al", .Attenuation = "Al", .DensityGPerCm3 = 2.7 } };
  scene.Attenuations = FindAttenuations(scene.Materials);
  scene.XRays = Spectrum::Monochromatic(20);
  scene.Source.Type = XRaySource::Kind::Parallel;
  scene.Source.Direction = { 0, 1, 0 };
  scene.Detector.ColumnStep = { 0.001, 0, 0 };
  scene.Detector.RowStep = { 0, 0, -0.001 };
  scene.Detector.Columns = 64;
  scene.Detector.Rows = 64;
  scene.Detector.Origin = { 1.005 - 0.0315, 5, 3.02 + 0.0315 };
  return viewed;
}

class SurfaceViewerTest : public testing::Test
{
protected:
  void SetUp() override
  {
    if (!test::VirtualDisplay::Instance().Works() || ListDevices().empty())
    {
      GTEST_SKIP() << "no Vulkan device or no Xvfb";
    }
    this->Options.Width = 800;
    this->Options.Height = 600;
    this->Options.OffScreen = true;
    this->Options.PictureFolder = this->Folder.File("");
  }
  /// Columns of a row of the middle of the picture pane that are grey or white.
  double ShadowPixels(SurfaceViewer& viewer)
  {
    const std::string path = this->Folder.File("shot.png");
    viewer.WriteScreenshot(path);
    vtkNew<vtkPNGReader> reader;
    reader->SetFileName(path.c_str());
    reader->Update();
    int count = 0;
    for (int x = 380; x < 800; ++x)
    {
      count += reader->GetOutput()->GetScalarComponentAsDouble(x, 330, 0, 0) > 20 ? 1 : 0;
    }
    return count;
  }

  test::TemporaryFolder Folder;
  ViewerOptions Options;
};

TEST(LiveProjection, TurnsTheSamplesByClosedForm)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const ViewedScene scene = SmallBox();
  LiveProjection live(scene, {});
  const double mu = MakeBeam(scene.Scene).MuPerMm(0, 1);
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
  const double harder = MakeBeam(scene.Scene.Materials, Spectrum::Monochromatic(40),
    DetectorResponse::EnergyIntegrating)
                          .MuPerMm(0, 1);
  EXPECT_NEAR(middle(), 0.02 * harder, 1e-5 * harder);
  live.SetEnergy(1000);
  EXPECT_EQ(live.Energy(), 40); // twice the beam's at most
  // Half as many pixels see the same.
  EXPECT_NEAR(live.Project(2)[15 * 32 + 15], 0.02 * harder, 1e-5 * harder);
  EXPECT_EQ(live.Describe(31, 31).substr(live.Describe(31, 31).find(',')), ", Al 20 um");
}

TEST(LiveProjection, TurnsRightHandedlyAboutWhatIsUp)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  // What lies behind, at +y, goes to -x about +z: to the left.
  ViewedScene scene = SmallBox();
  scene.Scene.Materials.Materials.push_back({ .Name = "Ti", .Attenuation = "Ti" });
  scene.Scene.Attenuations = FindAttenuations(scene.Scene.Materials);
  SurfaceMesh both = *scene.Scene.Samples[0].Surface;
  shapes::AddBox(both, { 1.004, 2.03, 3.01 }, { 1.006, 2.04, 3.03 }, 2);
  scene.Scene.Samples = { { std::make_shared<const SurfaceMesh>(both) } };
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
  ViewedScene scene = SmallBox();
  scene.Scene.Detector.Columns = scene.Scene.Detector.Rows = 512;
  PlaceAround(scene.Scene);
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
  const double step = 20 * Norm(scene.Scene.Detector.ColumnStep) * live.SourceGain();
  live.SetSourceOffset({ step, 0, 0 });
  // At its left is the edge of the face that the rays meet first, 0.01 mm before the middle.
  const double diagonal = Norm(Vector3{ 0.01, 0.02, 0.04 });
  const double shift = step * (1.5 * diagonal + 0.01) / (4 * diagonal - 0.01);
  EXPECT_NEAR(static_cast<double>(before - firstColumn()),
    shift / Norm(scene.Scene.Detector.ColumnStep),
    1); // whole pixels
  // A tube's spectrum has its voltage.
  scene.Scene.XRays = FindSpectrum("W28kVp_Rh50um_Be1mm");
  LiveProjection tube(scene, {});
  EXPECT_FALSE(tube.IsSingleEnergy());
  EXPECT_EQ(tube.Energy(), 28);
  SurfaceMesh point = *scene.Scene.Samples[0].Surface;
  point.Points.assign(point.Points.size(), 1.0);
  scene.Scene.Samples = { { std::make_shared<const SurfaceMesh>(point) } };
  EXPECT_THROW(PlaceAround(scene.Scene), InputError);
}

TEST(PaneOverlay, LengthsKeepTheirDigits)
{
  EXPECT_EQ(LengthText(12.34), "12.3 mm");
  EXPECT_EQ(LengthText(0.9), "900 um");
  EXPECT_EQ(LengthText(0.012345), "12.35 um");
}

TEST_F(SurfaceViewerTest, ShowsTurnsAndMarks)
{
  const ViewedScene scene = SmallBox();
  std::string told;
  this->Options.Marked = [&](const std::string& found) { told = found; };
  SurfaceViewer viewer(scene, this->Options);
  const double narrow = this->ShadowPixels(viewer);
  EXPECT_GT(narrow, 30);
  viewer.SetTurn(90);
  EXPECT_NEAR(this->ShadowPixels(viewer), 2 * narrow, 12); // 10 to 20 um, and the same soft rims
  for (int step = 0; step < 4; ++step)
  {
    viewer.Key("minus");
  }
  EXPECT_EQ(viewer.Turn(), 70);
  viewer.SetTurn(0);
  EXPECT_TRUE(viewer.MarkPixel(31, 31));
  EXPECT_THAT(viewer.Status(), testing::HasSubstr("Al 20 um"));
  EXPECT_EQ(told, viewer.Status());
  viewer.Key("Escape");
  viewer.Tick();
  EXPECT_EQ(viewer.Status(), "");
  EXPECT_FALSE(viewer.MarkPixel(64, 0));
  EXPECT_THAT(viewer.Message(), testing::HasSubstr("expected a pixel of the picture, 64 x 64"));
  viewer.Click(590, 340); // the middle of the picture
  EXPECT_THAT(viewer.Status(), testing::StartsWith("pixel (3"));
  viewer.Key("Left");
  viewer.Tick();
  EXPECT_THAT(viewer.Message(), testing::HasSubstr("parallel beam"));
  viewer.Key("w");
  viewer.Key("h");
  viewer.Key("s");
  for (const char* name : { "mammoray-window-1.png", "mammoray-xray-1.png" })
  {
    EXPECT_TRUE(std::filesystem::exists(this->Folder.File(name))) << name;
  }
}
}
