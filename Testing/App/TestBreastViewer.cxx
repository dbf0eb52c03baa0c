// SPDX-License-Identifier: Apache-2.0
#include "SmallBreast.h"
#include "VirtualDisplay.h"
#include "mammoray/App/BreastViewer.h"
#include "mammoray/App/Private/RequireDisplay.h"
#include "mammoray/Foundation/Error.h"

#include "vtkCommand.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPNGReader.h"
#include "vtkRenderWindow.h"
#include "vtkRenderWindowInteractor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <thread>

namespace
{
using namespace mammoray;

class BreastViewerTest : public testing::Test
{
protected:
  void SetUp() override
  {
    if (ListDevices().empty())
    {
      GTEST_SKIP() << "no Vulkan device";
    }
    if (!test::VirtualDisplay::Instance().Works())
    {
      GTEST_SKIP() << "no Xvfb";
    }
    this->Viewed = ReadViewedBreasts(test::WriteSmallBreast(this->Folder));
    this->Options.Width = 1000;
    this->Options.Height = 700;
    this->Options.PictureFolder = this->Folder.File("");
  }

  /// Mouse at a place of the window, of 1 from its lower left corner.
  static void Mouse(BreastViewer& viewer, double x, double y, unsigned long event)
  {
    vtkRenderWindowInteractor* interactor = viewer.Window()->GetInteractor();
    interactor->SetEventInformation(static_cast<int>(x * 1000), static_cast<int>(y * 700));
    interactor->InvokeEvent(event);
  }
  static void Drag(BreastViewer& viewer, double x0, double y0, double x1, double y1)
  {
    Mouse(viewer, x0, y0, vtkCommand::MouseMoveEvent);
    Mouse(viewer, x0, y0, vtkCommand::LeftButtonPressEvent);
    Mouse(viewer, x1, y1, vtkCommand::MouseMoveEvent);
    Mouse(viewer, x1, y1, vtkCommand::LeftButtonReleaseEvent);
  }
  vtkSmartPointer<vtkImageData> Shot(BreastViewer& viewer)
  {
    const std::string path = this->Folder.File("shot.png");
    viewer.WriteScreenshot(path);
    vtkNew<vtkPNGReader> reader;
    reader->SetFileName(path.c_str());
    reader->Update();
    return reader->GetOutput();
  }
  static double Grey(vtkImageData* picture, double x, double y)
  {
    return picture->GetScalarComponentAsDouble(static_cast<int>(x * 1000),
      static_cast<int>(y * 700), 0, 0);
  }

  test::TemporaryFolder Folder;
  std::vector<ViewedBreast> Viewed;
  ViewerOptions Options;
};

TEST_F(BreastViewerTest, ShowsTheMammogramBesideTheBreast)
{
  this->Options.OffScreen = true;
  BreastViewer viewer(this->Viewed, this->Options);
  const auto picture = this->Shot(viewer);
  EXPECT_EQ(picture->GetDimensions()[0], 1000);
  EXPECT_EQ(picture->GetDimensions()[1], 700);
  // The breast at the left edge of the picture, air beyond its right one.
  EXPECT_GT(Grey(picture, 0.66, 0.5), 100);
  EXPECT_LT(Grey(picture, 0.99, 0.95), 5);
}

TEST_F(BreastViewerTest, CompressesWhenTheThicknessIsDragged)
{
  BreastViewer viewer(this->Viewed, this->Options);
  viewer.Tick();
  const std::vector<double> before = viewer.Points();
  const double thickness = viewer.Pose().ThicknessMm;
  // The first slider from its middle towards thicker plates, so that they hardly touch: one of
  // three across 1000 pixels, in the upper row of the strip of 136.
  const double left = 0.149;
  const double right = 0.320;
  const double y = 108.0 / 700;
  Drag(viewer, 0.5 * (left + right), y, 0.8 * right + 0.2 * left, y);
  EXPECT_GT(viewer.Pose().ThicknessMm, thickness + 5);
  EXPECT_EQ(viewer.Points(), before);
  const auto begin = std::chrono::steady_clock::now();
  while (viewer.Points() == before &&
    std::chrono::steady_clock::now() - begin < std::chrono::seconds(120))
  {
    viewer.Tick();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ASSERT_NE(viewer.Points(), before) << viewer.Status();
  EXPECT_THAT(viewer.Status(), testing::HasSubstr(" N, compressed in "));
  double high = -1e9;
  double low = 1e9;
  for (std::size_t index = 0; index < viewer.Points().size(); index += 3)
  {
    if (viewer.Points()[index + 1] > 20)
    {
      high = std::max(high, viewer.Points()[index + 2]);
      low = std::min(low, viewer.Points()[index + 2]);
    }
  }
  EXPECT_LT(high - low, viewer.Pose().ThicknessMm);
}

TEST_F(BreastViewerTest, FollowsThePaddleByEquilibriaThatItKnows)
{
  this->Options.OffScreen = true;
  BreastViewer viewer(this->Viewed, this->Options);
  const double thickness = viewer.Pose().ThicknessMm;
  const auto motion = viewer.BenchmarkPaddle(3);
  ASSERT_TRUE(motion.has_value());
  EXPECT_NEAR(viewer.Pose().ThicknessMm, thickness + 2.4, 1e-9);
  // The tissue moves by up to 2 mm from either end to there; to second order it is 0.2 at most.
  EXPECT_LT(motion->PercentileMm95, 0.4);
  EXPECT_GT(motion->MedianMm, 0);
  EXPECT_THAT(viewer.Message(), testing::HasSubstr(" N, compressed in "));
  // Where the paddle goes on from there it is shown at once.
  const std::vector<double> exact = viewer.Points();
  viewer.SetThickness(thickness + 3);
  EXPECT_NE(viewer.Points(), exact);
}

TEST_F(BreastViewerTest, FollowsTheDraggedSource)
{
  BreastViewer viewer(this->Viewed, this->Options);
  viewer.Tick();
  const auto before = this->Shot(viewer);
  viewer.Key("Left");
  viewer.Key("Up");
  viewer.Tick();
  const auto moved = this->Shot(viewer);
  double difference = 0;
  for (double x = 0.6; x < 0.95; x += 0.01)
  {
    difference += std::abs(Grey(before, x, 0.5) - Grey(moved, x, 0.5));
  }
  EXPECT_GT(difference, 10);
  viewer.Key("Home");
  const auto back = this->Shot(viewer);
  for (double x = 0.6; x < 0.95; x += 0.01)
  {
    EXPECT_EQ(Grey(before, x, 0.5), Grey(back, x, 0.5));
  }
}

TEST_F(BreastViewerTest, MarksWhatIsClickedInEveryView)
{
  BreastViewer viewer(this->Viewed, this->Options);
  viewer.Tick();
  Drag(viewer, 0.73, 0.6, 0.73, 0.6); // the middle of the mammogram
  viewer.Tick();
  EXPECT_THAT(viewer.Status(), testing::StartsWith("pixel ("));
  EXPECT_THAT(viewer.Status(), testing::HasSubstr("gland"));
  EXPECT_THAT(viewer.Status(), testing::HasSubstr("uncertainty unknown")); // nothing registered
  Drag(viewer, 0.23, 0.35, 0.23, 0.35); // the breast at rest, in the middle of its view
  viewer.Tick();
  EXPECT_THAT(viewer.Status(), testing::HasSubstr("mm in "));
  viewer.Key("Escape");
  viewer.Tick();
  EXPECT_EQ(viewer.Status(), "");
  EXPECT_FALSE(viewer.MarkPoint({ 500, 0, 0 }));
  EXPECT_THAT(viewer.Message(), testing::HasSubstr("expected a place in the breast"));
}

/// A volume around the small breast whose grey is its x.
std::shared_ptr<IntensityVolume> Ramp()
{
  auto volume = std::make_shared<IntensityVolume>();
  volume->Size = { 60, 40, 60 };
  volume->Spacing = { 2, 2, 2 };
  volume->Origin = { -60, -20, -60 };
  volume->ForEachVoxel([&](int i, int, int, std::size_t) { volume->Voxels.push_back(i); });
  return volume;
}

TEST_F(BreastViewerTest, SlicesFollowAMarkAndAreMarkedThemselves)
{
  this->Viewed.front().Image = Ramp();
  BreastViewer viewer(this->Viewed, this->Options);
  viewer.Tick();
  ASSERT_TRUE(viewer.MarkPoint({ 5, 20, 3 }));
  const auto sagittalAt5 = this->Shot(viewer);
  ASSERT_TRUE(viewer.MarkPoint({ -25, 20, 3 }));
  const auto sagittalAt25 = this->Shot(viewer);
  // The lowest of the three slices shows one x: 30 mm less is 15 of 59 steps darker, within 2 of
  // 255 for rounding.
  EXPECT_NEAR(Grey(sagittalAt5, 0.36, 0.32) - Grey(sagittalAt25, 0.36, 0.32), 255 * 15 / 59.0, 2);
  // A click in the middle of the axial slice, the uppermost: on the slice through the mark.
  Drag(viewer, 0.405, 0.865, 0.405, 0.865);
  viewer.Tick();
  double x = 0;
  double y = 0;
  double z = 0;
  ASSERT_EQ(std::sscanf(viewer.Status().c_str(), "(%lf, %lf, %lf) mm in", &x, &y, &z), 3)
    << viewer.Status();
  EXPECT_NEAR(z, 3, 0.06); // as it is printed
  EXPECT_NEAR(x, 0, 2);    // the breast's middle is framed, half a pixel is 0.2 mm
  EXPECT_NEAR(y, 15, 9);   // from the chest wall, 15 mm behind, to the nipple at 45
}

TEST_F(BreastViewerTest, WheelGoesThroughSlicesAndDragsChangeTheirGrey)
{
  this->Viewed.front().Image = Ramp();
  BreastViewer viewer(this->Viewed, this->Options);
  viewer.Tick();
  const auto before = this->Shot(viewer);
  for (int step = 0; step < 10; ++step)
  {
    Mouse(viewer, 0.36, 0.32, vtkCommand::MouseWheelForwardEvent);
  }
  const auto scrolled = this->Shot(viewer);
  // Towards the patient's right, 10 voxels of 59.
  EXPECT_NEAR(Grey(before, 0.36, 0.32) - Grey(scrolled, 0.36, 0.32), 255 * 10 / 59.0, 2);
  Drag(viewer, 0.36, 0.30, 0.36, 0.34); // up: brighter
  const auto brighter = this->Shot(viewer);
  EXPECT_GT(Grey(brighter, 0.36, 0.32), Grey(scrolled, 0.36, 0.32) + 10);
  viewer.Key("r");
  const auto back = this->Shot(viewer);
  EXPECT_EQ(Grey(back, 0.36, 0.32), Grey(before, 0.36, 0.32));
}

TEST_F(BreastViewerTest, MarksInBothMammogramsOfAJointResult)
{
  this->Viewed.push_back(this->Viewed.front());
  this->Viewed[0].View = "cc";
  this->Viewed[1].View = "mlo";
  this->Viewed[1].Pose.RollDeg = -45;
  BreastViewer viewer(this->Viewed, this->Options);
  viewer.Tick();
  Drag(viewer, 0.595, 0.6, 0.595, 0.6); // the middle of the first one
  viewer.Tick();
  EXPECT_THAT(viewer.Status(), testing::StartsWith("cc: pixel ("));
  EXPECT_EQ(viewer.Pose().RollDeg, 0);
  Drag(viewer, 0.865, 0.6, 0.865, 0.6);
  viewer.Tick();
  EXPECT_THAT(viewer.Status(), testing::StartsWith("mlo: pixel ("));
  EXPECT_EQ(viewer.Pose().RollDeg, -45); // its unit is the one between the plates now
  ASSERT_TRUE(viewer.MarkPoint({ 5, 20, 3 }));
  viewer.Tick();
  EXPECT_THAT(viewer.Status(), testing::HasSubstr("cc: pixel ("));
  EXPECT_THAT(viewer.Status(), testing::HasSubstr("mlo: pixel ("));
}

TEST_F(BreastViewerTest, GoesToLesions)
{
  auto lesions = std::make_shared<LabelVolume>();
  lesions->Size = { 1, 1, 1 };
  lesions->Origin = { 5, 20, 3 };
  lesions->Voxels = { 4 };
  this->Viewed.front().Lesions = lesions;
  this->Viewed.front().LesionList = { { 4, 1, { 5, 20, 3 } } };
  BreastViewer viewer(this->Viewed, this->Options);
  viewer.Key("n");
  viewer.Tick();
  EXPECT_THAT(viewer.Status(), testing::StartsWith("(5.0, 20.0, 3.0) mm in gland"));
}

TEST_F(BreastViewerTest, SavesPicturesUnderFreeNames)
{
  BreastViewer viewer(this->Viewed, this->Options);
  viewer.Key("s");
  viewer.Key("s");
  for (const char* name : { "mammoray-window-1.png", "mammoray-window-2.png",
         "mammoray-mammogram-1.png", "mammoray-mammogram-2.png" })
  {
    EXPECT_TRUE(std::filesystem::exists(this->Folder.File(name))) << name;
  }
}

TEST_F(BreastViewerTest, EndsByKeyAndWhenAsked)
{
  int asked = 0;
  this->Options.Stop = [&] { return ++asked > 3; };
  BreastViewer viewer(this->Viewed, this->Options);
  viewer.Run(); // comes back
  EXPECT_GT(asked, 3);
}

TEST_F(BreastViewerTest, RefusesWithoutADisplay)
{
  unsetenv("DISPLAY");
  EXPECT_THROW(RequireDisplay("view"), InputError);
  setenv("DISPLAY", ":12345", 1);
  EXPECT_THROW(BreastViewer(this->Viewed, this->Options), InputError);
}
}
