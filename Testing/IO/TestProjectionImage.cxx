// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/ProjectionImage.h"

#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <numeric>

using namespace mammoray;
using test::ReadFile;
using test::TemporaryFolder;

namespace
{
/// Three columns of 0.5 mm and two rows of 2 mm, turned about z, with 0 to 5 as the transmission
/// and ten times that as the path length in fat.
vtkSmartPointer<vtkImageData> Image()
{
  XRayDetector detector;
  detector.Columns = 3;
  detector.Rows = 2;
  detector.Origin = { 7, -8, 9 };
  detector.ColumnStep = { 0.3, 0.4, 0 };
  detector.RowStep = { -1.6, 1.2, 0 };
  auto image = MakeDetectorImage(detector);
  for (const auto& [name, scale] : { std::pair{ "Transmission", 1.0f },
         std::pair{ "PathLength_fat", 10.0f }, std::pair{ "PathLength_gland", 100.0f } })
  {
    vtkNew<vtkFloatArray> values;
    values->SetName(name);
    for (int pixel = 0; pixel < 6; ++pixel)
    {
      values->InsertNextValue(scale * static_cast<float>(pixel));
    }
    image->GetPointData()->AddArray(values);
  }
  image->GetPointData()->SetActiveScalars("Transmission");
  return image;
}
}

TEST(ProjectionImage, FilesOfFloatsKeepThePose)
{
  const TemporaryFolder folder;
  for (const char* name : { "image.mha", "image.nrrd" })
  {
    WriteProjection(Image(), folder.File(name));
    const IntensityVolume read = ReadIntensityFile(folder.File(name));
    EXPECT_EQ(read.Size, (std::array<int, 3>{ 3, 2, 1 })) << name;
    EXPECT_THAT(read.Voxels, testing::ElementsAre(0, 1, 2, 3, 4, 5)) << name;
    // Doubles with 17 digits, normalised once.
    EXPECT_LT(Norm(read.PointAt(2, 1, 0) - Vector3{ 7 + 0.6 - 1.6, -8 + 0.8 + 1.2, 9 }), 1e-12)
      << name;
  }
}

TEST(ProjectionImage, PathLengthsAreChannels)
{
  const TemporaryFolder folder;
  WriteProjection(Image(), folder.File("lengths.mha"), true);
  const std::string bytes = ReadFile(folder.File("lengths.mha"));
  EXPECT_THAT(bytes, testing::HasSubstr("ElementNumberOfChannels = 2"));
  std::vector<float> values(12);
  ASSERT_GT(bytes.size(), 48u);
  std::memcpy(values.data(), bytes.data() + bytes.size() - 48, 48);
  EXPECT_THAT(values, testing::ElementsAre(0, 0, 10, 100, 20, 200, 30, 300, 40, 400, 50, 500));
  EXPECT_THROW(WriteProjection(Image(), folder.File("lengths.png"), true), InputError);
  EXPECT_THROW(WriteProjection(Image(), "/nonexistent/image.mha"), InputError);
  EXPECT_THROW(WriteProjection(Image(), "/nonexistent/image.nrrd"), InputError);
}

TEST(ProjectionImage, WhiteIsWhatOnePixelInAThousandExceeds)
{
  std::vector<float> values(2001);
  std::iota(values.rbegin(), values.rend(), 0.0f);
  EXPECT_EQ(FindWhite(values.data(), values.size()), 1998);
  std::fill(values.begin(), values.end(), -1.0f);
  EXPECT_EQ(FindWhite(values.data(), values.size()), 1);
}
