// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Study/StudyPictures.h"

#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPNGReader.h"

#include <gtest/gtest.h>

#include <array>
#include <map>

using namespace mammoray;

TEST(SlicePicture, ShowsTheImageAndTheOutlines)
{
  // A cube of label 2 in a cube of label 1, each as bright as can be told apart.
  LabelVolume labels;
  labels.Size = { 40, 40, 40 };
  IntensityVolume image;
  image.Size = labels.Size;
  for (int voxel = 0; voxel < 64000; ++voxel)
  {
    int deep = 40;
    for (const int place : { voxel % 40, voxel / 40 % 40, voxel / 1600 })
    {
      deep = std::min({ deep, place, 39 - place });
    }
    labels.Voxels.push_back(static_cast<std::uint16_t>(deep < 5 ? 0 : deep < 15 ? 1 : 2));
    image.Voxels.push_back(deep < 5 ? 0.0f : deep < 15 ? 100.0f : 50.0f);
  }
  const test::TemporaryFolder folder;
  const std::string path =
    folder.Write("slices.png", DrawLabelSlices(image, labels, {}, { "air", "fat", "gland" }).Png);
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkImageData* picture = reader->GetOutput();
  std::map<std::array<int, 3>, int> colors;
  int size[3];
  picture->GetDimensions(size);
  for (int y = 0; y < size[1]; ++y)
  {
    for (int x = 0; x < size[0]; ++x)
    {
      const auto* rgb = static_cast<unsigned char*>(picture->GetScalarPointer(x, y, 0));
      ++colors[{ rgb[0], rgb[1], rgb[2] }];
    }
  }
  // Nine slices of 40 mm of 360 pixels (the box and 5 mm around it, 9 pixels per mm): 10 mm of
  // label 2 in the middle of 30 mm of label 1. Outlines are a pixel wide. The slices are at a
  // quarter, half and three quarters of 40 mm, 10 mm from the middle: at the last voxels of label 2
  // or just beside them, so that three to nine of them cut it.
  const std::array<int, 3> fat{ 230, 159, 0 };
  const std::array<int, 3> gland{ 86, 180, 233 };
  EXPECT_GT(colors[fat], 9 * 4 * 260);
  EXPECT_LT(colors[fat], 9 * 4 * 370 + 400);
  EXPECT_GT(colors[gland], 3 * 4 * 80);
  EXPECT_LT(colors[gland], 9 * 4 * 100 + 400);
  EXPECT_GT((colors[{ 255, 255, 255 }]), 100);
  // Half of the brightest.
  EXPECT_GT((colors[{ 128, 128, 128 }]), 3 * 80 * 80);

  image.Size[0] = 39;
  EXPECT_THROW(DrawLabelSlices(image, labels, {}, {}), InputError);
  image.Size[0] = 40;
  labels.Voxels.assign(64000, 0);
  EXPECT_THROW(DrawLabelSlices(image, labels, {}, {}), InputError);
}
