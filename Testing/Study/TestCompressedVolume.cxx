// SPDX-License-Identifier: Apache-2.0
#include "Refusals.h"
#include "SqueezedBox.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/Study/CompressedVolume.h"

#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkUnstructuredGrid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

using mammoray::test::RefusalOf;
using namespace mammoray;
using ::testing::HasSubstr;

namespace
{
class FusedBox : public test::SqueezedBox
{
protected:
  /// Linear in the place: interpolation is exact. Oblique about z, as scanners' grids are.
  static float ValueAt(const Vector3& p)
  {
    return static_cast<float>(100 + 2 * p[0] - 0.5 * p[1] + 3 * p[2]);
  }
  static IntensityVolume MakeImage()
  {
    IntensityVolume image;
    image.Size = { 70, 70, 30 };
    image.Spacing = { 1.5, 1.5, 2 };
    image.Direction = { { { 0.8, 0.6, 0 }, { -0.6, 0.8, 0 }, { 0, 0, 1 } } };
    image.Origin = { -10, -45, -29 };
    for (int k = 0; k < image.Size[2]; ++k)
    {
      for (int j = 0; j < image.Size[1]; ++j)
      {
        for (int i = 0; i < image.Size[0]; ++i)
        {
          image.Voxels.push_back(ValueAt(image.PointAt(i, j, k)));
        }
      }
    }
    return image;
  }
};

TEST_F(FusedBox, CarriesValuesWithTheTissue)
{
  const CompressedVolume compressed = CompressVolume(MakeImage(), *this->Breast, 1.0);
  const IntensityVolume& image = compressed.Values;
  double volume = 0;
  for (int k = 0; k < image.Size[2]; ++k)
  {
    for (int j = 0; j < image.Size[1]; ++j)
    {
      for (int i = 0; i < image.Size[0]; ++i)
      {
        const std::size_t voxel = image.Index(i, j, k);
        const Vector3 p = image.PointAt(i, j, k);
        const Vector3 before{ p[0] / 1.25, p[1] - 3, 2 * (p[2] - 12) };
        if (compressed.Inside[voxel])
        {
          volume += 1;
          // Linear in the tetrahedra and in the image; what is left is float's.
          ASSERT_NEAR(image.Voxels[voxel], ValueAt(before), 1e-3) << i << ' ' << j << ' ' << k;
        }
        else
        {
          ASSERT_EQ(image.Voxels[voxel], 0);
        }
      }
    }
  }
  // 75 x 50 x 20 mm in voxels of 1 mm: to the voxels of half its surface.
  EXPECT_NEAR(volume, 75 * 50 * 20, 0.5 * 2 * (75 * 50 + 75 * 20 + 50 * 20));
}

TEST_F(FusedBox, ProjectsAlongTheRays)
{
  const CompressedVolume compressed = CompressVolume(MakeImage(), *this->Breast, 0.5);
  const auto projection = ProjectVolume(compressed, *this->Breast);
  const auto values = [&](const char* name)
  { return vtkFloatArray::SafeDownCast(projection->GetPointData()->GetArray(name)); };
  int seen = 0;
  for (int row = 0; row < 50; ++row)
  {
    for (int column = 0; column < 30; ++column)
    {
      const vtkIdType pixel = row * 30 + column;
      const double x = 48 - 2 * row;
      const double y = 1 + 2 * column;
      // Where the ray from (0, 0, 650) is at the heights of the box, 2 to 22 mm.
      const auto at = [&](double z) {
        return Vector3{ x * (650 - z) / 650, y * (650 - z) / 650, z };
      };
      const Vector3 low = at(2);
      const Vector3 high = at(22);
      const bool through = std::abs(low[0]) < 36.5 && low[1] > 4 && low[1] < 52 && high[1] > 4;
      if (through)
      {
        ++seen;
        // Half a step and a voxel at both ends.
        const double expected = Norm(high - low);
        EXPECT_NEAR(values("PathLength")->GetValue(pixel), expected, 1.0);
        const Vector3 middle = 0.5 * (low + high);
        const Vector3 before{ middle[0] / 1.25, middle[1] - 3, 2 * (middle[2] - 12) };
        // A mean is that of the ray's middle, to half a voxel of 6 per mm of compressed height.
        EXPECT_NEAR(values("Mean")->GetValue(pixel), ValueAt(before), 1.5) << row << ' ' << column;
        // The largest is at the top.
        const Vector3 top{ high[0] / 1.25, high[1] - 3, 20 };
        EXPECT_NEAR(values("Maximum")->GetValue(pixel), ValueAt(top), 4.0);
      }
      else if (std::abs(high[0]) > 38.5 || low[1] < 2.5 || high[1] > 53.5)
      {
        EXPECT_EQ(values("PathLength")->GetValue(pixel), 0);
        EXPECT_EQ(values("Maximum")->GetValue(pixel), 0);
      }
    }
  }
  EXPECT_GT(seen, 800);
}

TEST_F(FusedBox, ValuesAtTheBorderAreNotMixedWithTheOutside)
{
  // An even image that shows only a part of the box.
  IntensityVolume image = MakeImage();
  std::fill(image.Voxels.begin(), image.Voxels.end(), 7.0F);
  image.Size[2] = 12;
  image.Voxels.resize(70 * 70 * 12);
  const CompressedVolume compressed = CompressVolume(image, *this->Breast, 1.0);
  const auto projection = ProjectVolume(compressed, *this->Breast);
  const auto values = [&](const char* name)
  { return vtkFloatArray::SafeDownCast(projection->GetPointData()->GetArray(name)); };
  int seen = 0;
  for (vtkIdType pixel = 0; pixel < 30 * 50; ++pixel)
  {
    if (values("PathLength")->GetValue(pixel) > 0)
    {
      ++seen;
      // Sums and quotients of floats.
      ASSERT_NEAR(values("Mean")->GetValue(pixel), 7, 1e-4) << pixel;
      ASSERT_NEAR(values("Maximum")->GetValue(pixel), 7, 1e-4) << pixel;
    }
  }
  EXPECT_GT(seen, 800);
}

TEST_F(FusedBox, RefusesAnImageOfAnotherPlace)
{
  IntensityVolume image = MakeImage();
  image.Origin[2] = 500;
  EXPECT_THAT(RefusalOf([&] { CompressVolume(image, *this->Breast, 1.0); }),
    HasSubstr("found no voxel there"));
  EXPECT_THROW(CompressVolume(MakeImage(), *this->Breast, 0.0), InputError);
  EXPECT_THROW(
    CompressVolume(MakeImage(), *this->Breast, 1.0, [](double, const char*) { return false; }),
    Interrupted);
}

TEST_F(FusedBox, IntensitiesSurviveEveryFormat)
{
  const IntensityVolume image = MakeImage();
  for (const char* name : { "image.nrrd", "image.mha", "image.nii.gz" })
  {
    const std::string path = this->Folder.File(name);
    WriteIntensityVolume(image, path);
    const IntensityVolume back = ReadIntensityVolume(path);
    EXPECT_EQ(back.Size, image.Size);
    EXPECT_EQ(back.Voxels, image.Voxels) << name;
    for (int a = 0; a < 3; ++a)
    {
      // NIfTI keeps its frame in floats.
      EXPECT_NEAR(back.Origin[a], image.Origin[a], 1e-4);
      EXPECT_NEAR(back.Spacing[a], image.Spacing[a], 1e-6);
      EXPECT_NEAR(Norm(back.Direction[a] - image.Direction[a]), 0, 1e-6);
    }
  }
  EXPECT_THROW(WriteIntensityVolume(image, this->Folder.File("image.png")), InputError);
}
}
