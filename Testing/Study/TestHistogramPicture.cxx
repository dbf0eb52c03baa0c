// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Study/StudyPictures.h"

#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPNGReader.h"

#include <gtest/gtest.h>

#include <filesystem>

using namespace mammoray;

TEST(HistogramPicture, BarsAreAsHighAsTheRootsOfTheirCounts)
{
  const test::TemporaryFolder folder;
  const std::string path = folder.File("histogram.png");
  // A quarter of the largest bar: half as high. Orange is the first group's colour.
  WriteHistogramPicture({ { "quality", 10, { { "fat", { 100, 25, 0, 0 } } } } }, path);
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  const auto orangeInColumn = [&](int x)
  {
    int count = 0;
    for (int y = 0; y < image->GetDimensions()[1]; ++y)
    {
      const auto* pixel = static_cast<unsigned char*>(image->GetScalarPointer(x, y, 0));
      count += pixel[0] > pixel[2] + 100 ? 1 : 0;
    }
    return count;
  };
  const int first = orangeInColumn(150);
  EXPECT_GT(first, 250);
  EXPECT_NEAR(orangeInColumn(260), first / 2, 2);
  EXPECT_EQ(orangeInColumn(370), 0);
}

TEST(HistogramPicture, RefusesNothing)
{
  const test::TemporaryFolder folder;
  const std::string path = folder.File("histogram.png");
  EXPECT_THROW(WriteHistogramPicture({}, path), InputError);
  EXPECT_THROW(WriteHistogramPicture({ { "quality", 10, {} } }, path), InputError);
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_THROW(WriteHistogramPicture({ { "quality", 10, { { "fat", { 1 } } } } },
                 folder.File("absent/histogram.png")),
    InputError);
}
