// SPDX-License-Identifier: Apache-2.0
#include "SmallBreast.h"
#include "SmallScene.h"
#include "VirtualDisplay.h"
#include "mammoray/App/Pictures.h"
#include "mammoray/App/Private/RequireDisplay.h"
#include "mammoray/Foundation/Error.h"

#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPNGReader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace
{
using namespace mammoray;

constexpr int Width = 1000;
constexpr int Height = 700;

class Pictures : public testing::Test
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
    this->Options.Width = Width;
    this->Options.Height = Height;
  }
  static vtkSmartPointer<vtkImageData> Read(const std::string& path)
  {
    vtkNew<vtkPNGReader> reader;
    reader->SetFileName(path.c_str());
    reader->Update();
    return reader->GetOutput();
  }
  vtkSmartPointer<vtkImageData> Draw()
  {
    const std::string path = this->Folder.File("picture.png");
    this->Found = WriteBreastPicture(this->Viewed, this->Options, path);
    return Read(path);
  }
  /// At shares of the picture from its lower left corner.
  static double Red(vtkImageData* picture, double x, double y)
  {
    return picture->GetScalarComponentAsDouble(static_cast<int>(x * Width),
      static_cast<int>(y * Height), 0, 0);
  }
  /// How many pixels of these shares of the picture have a colour within 40 of that.
  static int Count(vtkImageData* picture, double left, double bottom, double right, double top,
    const std::array<double, 3>& color)
  {
    int count = 0;
    for (int y = static_cast<int>(bottom * Height); y < static_cast<int>(top * Height); ++y)
    {
      for (int x = static_cast<int>(left * Width); x < static_cast<int>(right * Width); ++x)
      {
        bool same = true;
        for (int part = 0; part < 3; ++part)
        {
          same = same &&
            std::abs(picture->GetScalarComponentAsDouble(x, y, 0, part) -
              color[static_cast<std::size_t>(part)]) < 40;
        }
        count += same ? 1 : 0;
      }
    }
    return count;
  }

  static constexpr std::array<double, 3> MarkGreen{ 25, 230, 115 };
  test::TemporaryFolder Folder;
  std::vector<ViewedBreast> Viewed;
  PictureOptions Options;
  std::string Found;
};

TEST_F(Pictures, ShowTheMammogramBesideTheBreast)
{
  const auto picture = this->Draw();
  EXPECT_EQ(this->Found, "");
  EXPECT_EQ(picture->GetDimensions()[0], Width);
  EXPECT_EQ(picture->GetDimensions()[1], Height);
  // The breast at the left edge of the mammogram, air beyond its right one.
  EXPECT_GT(Red(picture, 0.66, 0.5), 100);
  EXPECT_LT(Red(picture, 0.99, 0.95), 5);
  // Skin and gland, which are red, between the plates and below at rest.
  const auto reddish = [&](double bottom, double top)
  {
    int count = 0;
    for (double y = bottom; y < top; y += 0.01)
    {
      for (double x = 0; x < 0.45; x += 0.01)
      {
        count +=
          Red(picture, x, y) > picture->GetScalarComponentAsDouble(static_cast<int>(x * Width),
                                 static_cast<int>(y * Height), 0, 2) +
              12
          ? 1
          : 0;
      }
    }
    return count;
  };
  EXPECT_GT(reddish(0.5, 0.85), 100);
  EXPECT_GT(reddish(0.1, 0.38), 50);
}

TEST_F(Pictures, FollowTheSource)
{
  const auto before = this->Draw();
  this->Options.SourceOffset = { 10, 10, 0 };
  const auto moved = this->Draw();
  double difference = 0;
  for (double x = 0.6; x < 0.95; x += 0.01)
  {
    difference += std::abs(Red(before, x, 0.5) - Red(moved, x, 0.5));
  }
  EXPECT_GT(difference, 10);
}

TEST_F(Pictures, SolveForThePoseThatIsAskedFor)
{
  ViewInput input = test::WriteSmallBreast(this->Folder);
  input.Pose[ThicknessParameter] = 70;
  this->Viewed = ReadViewedBreasts(input);
  this->Draw();
  EXPECT_THAT(this->Found, testing::StartsWith("70.0 mm, "));
  EXPECT_THAT(this->Found, testing::HasSubstr(" N, compressed in "));
  this->Options.Progress = [](double, const char*) { return false; };
  EXPECT_THROW(this->Draw(), Interrupted);
}

TEST_F(Pictures, MarkInEveryView)
{
  const auto without = this->Draw();
  this->Options.Point = { 5, 20, 3 };
  const auto point = this->Draw();
  std::array<double, 2> at{};
  ASSERT_EQ(std::sscanf(this->Found.c_str(), "(5.0, 20.0, 3.0) mm in gland\npixel (%lf, %lf)",
              &at[0], &at[1]),
    2)
    << this->Found;
  this->Options.Point.reset();
  this->Options.Pixel = at;
  const auto pixel = this->Draw();
  EXPECT_THAT(this->Found, testing::StartsWith("pixel ("));
  EXPECT_THAT(this->Found, testing::HasSubstr("gland"));
  EXPECT_THAT(this->Found, testing::HasSubstr("uncertainty unknown")); // nothing registered
  this->Options.Pixel.reset();
  // Between the plates, at rest, in the mammogram.
  const std::array<double, 4> views[] = { { 0, 0.45, 0.45, 0.97 }, { 0, 0.13, 0.45, 0.43 },
    { 0.47, 0.2, 1, 0.9 } };
  for (const auto& [left, bottom, right, top] : views)
  {
    EXPECT_EQ(Count(without, left, bottom, right, top, MarkGreen), 0) << left << " " << bottom;
    EXPECT_GT(Count(pixel, left, bottom, right, top, MarkGreen), 10) << left << " " << bottom;
    EXPECT_GT(Count(point, left, bottom, right, top, MarkGreen), 10) << left << " " << bottom;
  }
  this->Options.Point = { 500, 0, 0 };
  try
  {
    this->Draw();
    FAIL();
  }
  catch (const InputError& error)
  {
    EXPECT_THAT(error.what(), testing::HasSubstr("expected a place in the breast"));
  }
}

TEST_F(Pictures, TakeSlicesThroughTheMark)
{
  this->Viewed.front().Image = test::Ramp();
  this->Options.Point = { 5, 20, 3 };
  const auto sagittalAt5 = this->Draw();
  this->Options.Point = { -25, 20, 3 };
  const auto sagittalAt25 = this->Draw();
  // The lowest of the three slices shows one x: 30 mm less is 15 of 59 steps darker, within 2 of
  // 255 for rounding.
  EXPECT_NEAR(Red(sagittalAt5, 0.36, 0.25) - Red(sagittalAt25, 0.36, 0.25), 255 * 15 / 59.0, 2);

  // A lesion of 10 mm at the mark is yellow in all of them.
  constexpr std::array<double, 3> LesionYellow{ 180, 165, 60 };
  const auto lesions = std::make_shared<LabelVolume>();
  static_cast<VolumeGrid&>(*lesions) = *this->Viewed.front().Image;
  lesions->ForEachVoxel(
    [&](int i, int j, int k, std::size_t)
    {
      const Vector3 offset{ 2.0 * i - 60 + 25, 2.0 * j - 20 - 20, 2.0 * k - 60 - 3 };
      lesions->Voxels.push_back(Norm(offset) < 10 ? 1 : 0);
    });
  this->Viewed.front().Lesions = lesions;
  const auto lesion = this->Draw();
  for (const double bottom : { 0.13, 0.42, 0.71 })
  {
    EXPECT_EQ(Count(sagittalAt25, 0.30, bottom, 0.51, bottom + 0.28, LesionYellow), 0) << bottom;
    EXPECT_GT(Count(lesion, 0.30, bottom, 0.51, bottom + 0.28, LesionYellow), 100) << bottom;
  }
}

TEST_F(Pictures, ShowBothMammogramsOfAJointResult)
{
  constexpr std::array<double, 3> Orange{ 255, 166, 64 };
  EXPECT_EQ(Count(this->Draw(), 0, 0, 0.5, 0.13, Orange), 0);
  this->Viewed.push_back(this->Viewed.front());
  this->Viewed[0].View = "cc";
  this->Viewed[1].View = "mlo";
  this->Viewed[1].Pose.RollDeg = -45;
  this->Viewed[1].Trust.Level = Trust::Doubtful;
  this->Options.Point = { 5, 20, 3 };
  const auto picture = this->Draw();
  EXPECT_THAT(this->Found, testing::HasSubstr("\ncc: pixel ("));
  EXPECT_THAT(this->Found, testing::HasSubstr("\nmlo: pixel ("));
  EXPECT_GT(Count(picture, 0.47, 0.2, 0.72, 0.9, MarkGreen), 10);
  EXPECT_GT(Count(picture, 0.74, 0.2, 1, 0.9, MarkGreen), 10);
  EXPECT_GT(Count(picture, 0, 0, 0.5, 0.13, Orange), 20); // what is doubtful is said
}

TEST_F(Pictures, ShowASceneAndItsXRay)
{
  const std::string path = this->Folder.File("scene.png");
  const Scene scene = test::SmallBox();
  EXPECT_EQ(WriteScenePicture(scene, this->Options, path), "");
  const auto without = Read(path);
  // In a row of the picture 10 of 64 pixels are white, which fill the pane's width but for 6 %.
  const double pixel = (1 - 0.46) * Width / 1.06 / 64;
  EXPECT_NEAR(Count(without, 0.46, 0.5, 1, 0.5015, { 255, 255, 255 }), 10 * pixel, 1.5 * pixel);
  this->Options.Pixel = { 31, 31 };
  EXPECT_THAT(WriteScenePicture(scene, this->Options, path), testing::EndsWith(", Al 20 um"));
  EXPECT_EQ(Count(without, 0.6, 0.3, 0.9, 0.7, MarkGreen), 0);
  EXPECT_GT(Count(Read(path), 0.6, 0.3, 0.9, 0.7, MarkGreen), 10);
  this->Options.Pixel = { 64, 0 };
  EXPECT_THROW(WriteScenePicture(scene, this->Options, path), InputError);
}

TEST_F(Pictures, AreRefusedWithoutADisplay)
{
  unsetenv("DISPLAY");
  EXPECT_THROW(RequireDisplay("view"), InputError);
  setenv("DISPLAY", ":12345", 1);
  EXPECT_THROW(this->Draw(), InputError);
}
}
