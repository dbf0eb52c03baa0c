// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "mammoray/Study/Private/Picture.h"

#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPNGReader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

using namespace mammoray;

namespace
{
/// Sum over all pixels of how much darker than white they are, in pixels.
double Darkness(Picture& picture)
{
  const test::TemporaryFolder folder;
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(folder.Write("picture.png", picture.Png()).c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  double sum = 0;
  for (int y = 0; y < picture.Height(); ++y)
  {
    for (int x = 0; x < picture.Width(); ++x)
    {
      sum += 1 - image->GetScalarComponentAsDouble(x, y, 0, 0) / 255;
    }
  }
  return sum;
}
}

TEST(Picture, ABoxIsClippedToThePicture)
{
  Picture picture(40, 30);
  picture.Box(30, 20, 50, 50, Black);
  EXPECT_EQ(Darkness(picture), 100);
}

TEST(Picture, ALineHasItsWidthInAnyDirection)
{
  for (const double degrees : { 0.0, 20.0, 45.0, 70.0, 90.0, 135.0 })
  {
    SCOPED_TRACE(degrees);
    Picture picture(120, 120);
    const double x = 40 * std::cos(degrees * std::numbers::pi / 180);
    const double y = 40 * std::sin(degrees * std::numbers::pi / 180);
    picture.Line({ 60 - x, 60 - y }, { 60 + x, 60 + y }, 4, Black);
    // With round ends; 2 %: opacity of a border's pixel by the distance of its middle.
    EXPECT_NEAR(Darkness(picture), 80 * 4 + 4 * std::numbers::pi, 0.02 * 332);
  }
}

TEST(Picture, ATextIsWhereItsAnchorSays)
{
  const auto draw = [](double anchor, const PictureColor* halo)
  {
    Picture picture(200, 60, halo ? PictureColor{ 128, 128, 128 } : PictureColor{ 255, 255, 255 });
    picture.Text(100, 30, anchor, "mm", { Black, 20, halo });
    const double all = Darkness(picture);
    picture.Box(100, 0, 200, 60, { 255, 255, 255 });
    return std::array<double, 2>{ all, Darkness(picture) };
  };
  const auto [all, left] = draw(0, nullptr);
  EXPECT_GT(all, 50);
  EXPECT_EQ(left, 0);
  EXPECT_NEAR(draw(1, nullptr)[1], all, 1);
  EXPECT_NEAR(draw(0.5, nullptr)[1], 0.5 * all, 0.1 * all);
  // A white rim makes a grey ground brighter than the letters make it darker.
  constexpr PictureColor White{ 255, 255, 255 };
  EXPECT_LT(draw(0, &White)[0], 200 * 60 * 127 / 255.0);
}

TEST(Picture, ShrinkingAveragesPixels)
{
  Picture picture(40, 40);
  picture.Box(0, 0, 20, 40, Black);
  picture.Set(20, 0, Black);
  picture.Shrink(4);
  EXPECT_EQ(picture.Width(), 10);
  EXPECT_NEAR(Darkness(picture), 50 + 1.0 / 16, 0.01);
}

TEST(Picture, ColoursMixAndTicksAreRound)
{
  EXPECT_EQ(Grey(2), (PictureColor{ 255, 255, 255 }));
  EXPECT_EQ(Mixed({ 0, 100, 200 }, { 100, 0, 200 }, 0.25), (PictureColor{ 25, 75, 200 }));
  EXPECT_NEAR(TickStep(10, 5), 2, 1e-12);
  EXPECT_NEAR(TickStep(0.03, 5), 0.005, 1e-12);
  EXPECT_NEAR(TickStep(80, 8), 10, 1e-12);
}
