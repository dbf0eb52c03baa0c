// SPDX-License-Identifier: Apache-2.0
// Fields and transform files as ITK itself reads and applies them.
#include "Refusals.h"
#include "SqueezedBox.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/Study/CompressedVolume.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <itkDisplacementFieldTransform.h>
#include <itkHDF5TransformIO.h>
#include <itkImageFileReader.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkResampleImageFilter.h>
#include <itkTxtTransformIO.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

using mammoray::test::RefusalOf;
using namespace mammoray;
using ::testing::HasSubstr;

namespace
{
using ItkTransform = itk::Transform<double, 3, 3>;
using FieldTransform = itk::DisplacementFieldTransform<double, 3>;

ItkTransform::ConstPointer ReadTransform(itk::TransformIOBaseTemplate<double>* reader,
  const std::string& path)
{
  reader->SetFileName(path);
  reader->Read();
  EXPECT_EQ(reader->GetTransformList().size(), 1U);
  return dynamic_cast<const ItkTransform*>(reader->GetTransformList().front().GetPointer());
}

ItkTransform::ConstPointer ReadField(itk::ImageIOBase* format, const std::string& path)
{
  const auto reader = itk::ImageFileReader<FieldTransform::DisplacementFieldType>::New();
  reader->SetImageIO(format);
  reader->SetFileName(path);
  reader->Update();
  const auto transform = FieldTransform::New();
  transform->SetDisplacementField(reader->GetOutput());
  return transform.GetPointer();
}

/// What ITK makes of the file.
ItkTransform::ConstPointer ReadByItk(const std::string& path)
{
  if (path.ends_with(".h5"))
  {
    return ReadTransform(itk::HDF5TransformIO::New(), path);
  }
  if (path.ends_with(".tfm"))
  {
    return ReadTransform(itk::TxtTransformIO::New(), path);
  }
  if (path.ends_with(".nrrd"))
  {
    return ReadField(itk::NrrdImageIO::New(), path);
  }
  if (path.ends_with(".mha"))
  {
    return ReadField(itk::MetaImageIO::New(), path);
  }
  return ReadField(itk::NiftiImageIO::New(), path);
}

Vector3 MovedBy(const ItkTransform& transform, const Vector3& point)
{
  const ItkTransform::OutputPointType moved =
    transform.TransformPoint(ItkTransform::InputPointType(point.data()));
  return { moved[0], moved[1], moved[2] };
}

class DisplacedBox : public test::SqueezedBox
{
protected:
  static Vector3 AtRest(const Vector3& p) { return { p[0] / 1.25, p[1] - 3, 2 * (p[2] - 12) }; }
  /// A place in the box at rest, at least 3 mm from its faces, where no voxel mixes in the outside.
  static Vector3 Somewhere(int n)
  {
    const auto part = [n](double step) { return std::fmod(0.5 + n * step, 1.0); };
    return { -27 + 54 * part(0.618), 3 + 44 * part(0.414), -14 + 28 * part(0.732) };
  }
};

TEST_F(DisplacedBox, ItkMovesPointsAsTheTissueByEveryFormat)
{
  const DisplacementField back =
    FindDisplacement(*this->Breast, DisplacementDirection::CompressedToVolume, 2, 10);
  const DisplacementField forth =
    FindDisplacement(*this->Breast, DisplacementDirection::VolumeToCompressed, 2.5, 10);
  for (const char* name : { "t.nrrd", "t.mha", "t.nii.gz", "t.h5", "t.tfm" })
  {
    SCOPED_TRACE(name);
    const std::string path = this->Folder.File(name);
    WriteDisplacement(back, path);
    const ItkTransform::ConstPointer toVolume = ReadByItk(path);
    WriteDisplacement(forth, path);
    const ItkTransform::ConstPointer toCompressed = ReadByItk(path);
    ASSERT_TRUE(toVolume && toCompressed);
    for (int n = 0; n < 100; ++n)
    {
      const Vector3 rest = Somewhere(n);
      // Floats of vectors up to 20 mm, and NIfTI's of the frame.
      EXPECT_LT(Norm(MovedBy(*toVolume, Squeezed(rest)) - rest), 1e-4) << n;
      EXPECT_LT(Norm(MovedBy(*toCompressed, rest) - Squeezed(rest)), 1e-4) << n;
    }
  }
}

TEST_F(DisplacedBox, ItkResamplesAnImageAsWeDo)
{
  IntensityVolume image;
  image.Size = { 40, 40, 30 };
  image.Spacing = { 2, 1.75, 2 };
  image.Direction = { { { 0.8, 0.6, 0 }, { -0.6, 0.8, 0 }, { 0, 0, 1 } } };
  image.Origin = { -10, -25, -29 };
  image.Voxels.resize(40 * 40 * 30);
  image.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      const Vector3 p = image.PointAt(i, j, k);
      image.Voxels[voxel] =
        static_cast<float>(500 + 200 * std::sin(p[0] / 7) * std::cos(p[1] / 9) + 5 * p[2]);
    });
  const CompressedVolume ours = CompressVolume(image, *this->Breast, 1.5);
  WriteIntensityVolume(image, this->Folder.File("image.mha"));
  WriteIntensityVolume(ours.Values, this->Folder.File("ours.mha"));
  const std::string path = this->Folder.File("t.h5");
  WriteDisplacement(
    FindDisplacement(*this->Breast, DisplacementDirection::CompressedToVolume, 2, 10), path);

  using Image = itk::Image<float, 3>;
  const auto read = [&](const char* name)
  {
    const auto reader = itk::ImageFileReader<Image>::New();
    reader->SetImageIO(itk::MetaImageIO::New());
    reader->SetFileName(this->Folder.File(name));
    reader->Update();
    Image::Pointer volume = reader->GetOutput();
    return volume;
  };
  const Image::Pointer grid = read("ours.mha");
  const auto resample = itk::ResampleImageFilter<Image, Image>::New();
  resample->SetInput(read("image.mha"));
  resample->SetReferenceImage(grid);
  resample->UseReferenceImageOn();
  resample->SetTransform(ReadByItk(path));
  resample->Update();
  const float* theirs = resample->GetOutput()->GetBufferPointer();
  int compared = 0;
  ours.Values.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      const Vector3 p = AtRest(ours.Values.PointAt(i, j, k));
      const Vector3 index = image.ContinuousIndex(p);
      bool within = true;
      for (int a = 0; a < 3; ++a)
      {
        within = within && p[a] > Low[a] + 4 && p[a] < High[a] - 4 && index[a] > 0 &&
          index[a] < image.Size[a] - 1;
      }
      if (within)
      {
        ++compared;
        // Both trilinear, at the same places but for floats: slopes of up to 40 a mm.
        ASSERT_NEAR(ours.Values.Voxels[voxel], theirs[voxel], 5e-3) << i << ' ' << j << ' ' << k;
      }
    });
  EXPECT_GT(compared, 3000);
}

TEST_F(DisplacedBox, MovesTheOutsideWithTheNearestTissue)
{
  const DisplacementField field =
    FindDisplacement(*this->Breast, DisplacementDirection::VolumeToCompressed, 3, 12);
  int outside = 0;
  field.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      const Vector3 p = field.PointAt(i, j, k);
      Vector3 nearest;
      for (int a = 0; a < 3; ++a)
      {
        nearest[a] = std::clamp(p[a], Low[a], High[a]);
      }
      outside += Norm(p - nearest) > 0 ? 1 : 0;
      const Vector3 by{ field.Vectors[3 * voxel], field.Vectors[3 * voxel + 1],
        field.Vectors[3 * voxel + 2] };
      // Floats.
      ASSERT_LT(Norm(by - (Squeezed(nearest) - nearest)), 1e-4) << i << ' ' << j << ' ' << k;
    });
  EXPECT_GT(outside, 1000);
  // 12 mm beyond the box at least on all sides.
  const Vector3 last = field.PointAt(field.Size[0] - 1, field.Size[1] - 1, field.Size[2] - 1);
  for (int a = 0; a < 3; ++a)
  {
    EXPECT_NEAR(field.Origin[a], Low[a] - 12, 1e-9);
    EXPECT_GE(last[a], High[a] + 12 - 1e-9);
    EXPECT_LT(last[a], High[a] + 12 + 3);
  }
}

TEST_F(DisplacedBox, RefusesWhatIsNoFieldAndStops)
{
  const auto find = [&](double spacing, double margin, const ProgressCallback& progress = {})
  {
    return FindDisplacement(*this->Breast, DisplacementDirection::CompressedToVolume, spacing,
      margin, progress);
  };
  EXPECT_THAT(RefusalOf([&] { find(0, 10); }), HasSubstr("expected positive voxels"));
  EXPECT_THAT(RefusalOf([&] { find(2, -1); }), HasSubstr("margin of at least 0"));
  EXPECT_THAT(RefusalOf([&] { find(0.01, 10); }), HasSubstr("at most 100 million"));
  EXPECT_THROW(find(2, 10, [](double, const char*) { return false; }), Interrupted);
  DisplacementField field = find(5, 5);
  EXPECT_THAT(RefusalOf([&] { WriteDisplacement(field, this->Folder.File("t.vtk")); }),
    HasSubstr(".nrrd, .mha, .nii.gz, .h5 or .tfm"));
  for (const char* name : { "t.h5", "t.nrrd" })
  {
    DisplacementField bad = field;
    bad.Vectors.back() = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(WriteDisplacement(bad, this->Folder.File(name)), InputError);
    bad = field;
    bad.Vectors.pop_back();
    EXPECT_THROW(WriteDisplacement(bad, this->Folder.File(name)), InputError);
  }
  EXPECT_THAT(
    RefusalOf([&] { WriteDisplacement(field, this->Folder.File("no/such/folder/t.h5")); }),
    HasSubstr("no/such"));
}
}
