// SPDX-License-Identifier: Apache-2.0
// Pictures with lines over them: the breast in space, slices through a point, contours.
#include "Files.h"
#include "TestMeshes.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Study/ContourLines.h"
#include "mammoray/Study/StudyPictures.h"

#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPNGReader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

using namespace mammoray;
using testing::HasSubstr;

namespace
{
/// Its pixels as (red, green, blue), from the lower left corner.
std::array<int, 3> PixelAt(const LayeredPicture& picture, int x, int y)
{
  const test::TemporaryFolder folder;
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(folder.Write("picture.png", picture.Png).c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  EXPECT_EQ(image->GetDimensions()[0], picture.Width);
  EXPECT_EQ(image->GetDimensions()[1], picture.Height);
  const auto* rgb = static_cast<unsigned char*>(image->GetScalarPointer(x, y, 0));
  return { rgb[0], rgb[1], rgb[2] };
}

MaterialTable Tissues()
{
  MaterialTable table;
  table.Materials = { { .Name = "air" }, { .Name = "fat" }, { .Name = "gland" },
    { .Name = "wall", .Fixed = true } };
  return table;
}

/// A cube of fat, 40 mm, whose upper half in z is wall where `wall`, with gland in its middle.
SurfaceMesh Cube(bool wall)
{
  TetrahedralMesh mesh = test::MakeBoxMesh({ 0, 0, 0 }, { 40, 40, 40 }, { 8, 8, 8 });
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    Vector3 middle{ 0, 0, 0 };
    for (int corner = 0; corner < 4; ++corner)
    {
      middle = middle + 0.25 * mesh.Point(mesh.Cells[4 * cell + corner]);
    }
    const bool inside = std::max({ std::abs(middle[0] - 20), std::abs(middle[1] - 20),
                          std::abs(middle[2] - 20) }) < 10;
    mesh.Materials[cell] = wall && middle[2] > 15 ? 3 : inside ? 2 : 1;
  }
  return ExtractInterfaces(mesh);
}
}

TEST(ContourLines, FollowACircle)
{
  constexpr int Size = 60;
  std::vector<float> distance;
  for (int row = 0; row < Size; ++row)
  {
    for (int column = 0; column < Size; ++column)
    {
      distance.push_back(static_cast<float>(std::hypot(column - 30.5, row - 28.0) - 17));
    }
  }
  const auto lines = ContourLines(distance.data(), Size, Size, 0);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].front(), lines[0].back());
  for (const auto& [x, y] : lines[0])
  {
    // Linear between pixels of a distance whose curvature is 1 / 17: 1 / 8 of that at most.
    EXPECT_NEAR(std::hypot(x - 30.5, y - 28.0), 17, 0.01);
  }
}

TEST(ContourLines, CloseAlongTheBorderWhereTheyAreTold)
{
  const std::vector<float> full(12, 1.0F); // 4 x 3 pixels, all inside
  EXPECT_TRUE(ContourLines(full.data(), 4, 3, 0.5F).empty());
  const auto lines = ContourLines(full.data(), 4, 3, 0.5F, 0.0F);
  ASSERT_EQ(lines.size(), 1u);
  for (const auto& [x, y] : lines[0])
  {
    EXPECT_TRUE(std::abs(x - 1.5) == 2 || std::abs(y - 1) == 1.5) << x << ' ' << y;
  }
}

TEST(BreastPicture, TellsWhatLiesInWhat)
{
  for (const bool wall : { false, true })
  {
    SCOPED_TRACE(wall);
    const SurfaceMesh cube = Cube(wall);
    int host = 0;
    const std::vector<int> enclosed = EnclosedMaterials(cube, Tissues(), &host);
    EXPECT_EQ(host, 1); // though there is more wall than fat
    std::map<int, int> counts;
    for (std::size_t triangle = 0; triangle < enclosed.size(); ++triangle)
    {
      const std::array<int, 2> sides{ cube.FrontMaterials[triangle], cube.BackMaterials[triangle] };
      const bool air = sides[0] == 0 || sides[1] == 0;
      EXPECT_EQ(enclosed[triangle] == 0, air);
      EXPECT_NE(enclosed[triangle], 1);
      ++counts[enclosed[triangle]];
    }
    EXPECT_GT(counts[2], 0);
    EXPECT_EQ(counts[3] > 0, wall);
  }
}

TEST(BreastPicture, ShowsWhatLiesInsideThroughTheSkinAndMarksOverIt)
{
  const SurfaceMesh cube = Cube(false);
  const MaterialTable tissues = Tissues();
  BreastInSpace breast;
  breast.Surface = &cube;
  breast.Materials = &tissues;
  breast.Marks = { { "7", { 20, 20, 0 } } };
  const LayeredPicture picture = DrawBreast(breast);
  // From +z: 40 mm fill 720 pixels but for a margin of 24 on either side.
  EXPECT_EQ(picture.Width, 720);
  EXPECT_EQ(picture.Height, 720);
  const auto middle = PixelAt(picture, 360, 250); // gland: the palette's first, orange
  EXPECT_GT(middle[0], middle[2] + 60);
  const auto beside = PixelAt(picture, 60, 250); // only skin over the ground
  EXPECT_LT(beside[0], 130);
  const auto outside = PixelAt(picture, 10, 250);
  EXPECT_LT(outside[0], 40);
  EXPECT_THAT(picture.Lines, HasSubstr(">7</text>"));
  EXPECT_THAT(picture.Lines, HasSubstr("M365.6 360L376 360")); // the cross's right arm
  EXPECT_THROW(DrawBreast({}), InputError);
}

TEST(PointSlices, GoThroughThePoint)
{
  // A volume whose grey is x, all of one label.
  LabelVolume labels;
  labels.Size = { 40, 30, 20 };
  labels.Spacing = { 2, 2, 2 };
  IntensityVolume image;
  image.Size = labels.Size;
  image.Spacing = labels.Spacing;
  labels.ForEachVoxel(
    [&](int i, int, int, std::size_t)
    {
      labels.Voxels.push_back(1);
      image.Voxels.push_back(static_cast<float>(i));
    });
  PointSlices shown;
  shown.Image = &image;
  shown.Labels = &labels;
  shown.Names = { "air", "fat" };
  shown.Point = { 30, 40, 20 };
  const LayeredPicture picture = DrawPointSlices(shown);
  // Of the box, 78 + 10 mm along x are 360 pixels; slices of 360, 360 and 279 with 12 between.
  const double perMm = 360 / 88.0;
  EXPECT_EQ(picture.Width, 360 + 360 + static_cast<int>(std::ceil(68 * perMm)) + 4 * 12);
  // The sagittal slice, at the right, is at x = 30: 15 of 39 steps of grey, white at the 99.5th
  // percentile. The crosses are lines, not in the picture.
  const auto sagittal = PixelAt(picture, 12 + 360 + 12 + 360 + 12 + 100, picture.Height - 60);
  EXPECT_NEAR(sagittal[0], 255 * 15 / 39.0, 2);
  EXPECT_EQ(sagittal[0], sagittal[1]);
  // Its cross: P is at the right and y grows to it; 5 mm of border.
  const double x = 12 + 360 + 12 + 360 + 12 + (40 + 5) * perMm;
  char arm[40];
  std::snprintf(arm, sizeof arm, "M%.1f ", x + 0.35 * 16);
  EXPECT_THAT(picture.Lines, HasSubstr(arm));

  shown.Image = nullptr; // tissues in colour, with a legend at the right
  const LayeredPicture tissues = DrawPointSlices(shown);
  EXPECT_EQ(tissues.Width, picture.Width + 170);
  const auto fat = PixelAt(tissues, 12 + 100, tissues.Height - 60);
  EXPECT_GT(fat[0], fat[2] + 60);
  labels.Voxels.assign(labels.Voxels.size(), 0);
  EXPECT_THROW(DrawPointSlices(shown), InputError);
}
