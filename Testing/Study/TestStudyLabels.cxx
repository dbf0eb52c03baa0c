// SPDX-License-Identifier: Apache-2.0
// A study's tissue by labels that somebody corrected, in the way that editors of segmentations
// leave them: renumbered, reordered, cropped, with names within or beside.
#include "Files.h"
#include "LabelShapes.h"
#include "Refusals.h"
#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Study/Private/Checkpoint.h"
#include "mammoray/Study/StudyCase.h"

#include <itkImageFileReader.h>
#include <itkImageFileWriter.h>
#include <itkImageRegionIterator.h>
#include <itkImageRegionIteratorWithIndex.h>
#include <itkMetaDataObject.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkRegionOfInterestImageFilter.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <utility>
#include <vector>

using namespace mammoray;
using mammoray::test::NotRefused;
using mammoray::test::RefusalOf;
using testing::HasSubstr;

namespace
{
using EditedImage = itk::Image<unsigned char, 3>;

/// The breasts' middles, mm to either side of the body's.
constexpr double AsideMm = 55;

/// Half an ellipsoid of fat with skin and a ball of gland before muscle; the front is -y.
int TissueAt(const Vector3& p)
{
  if (p[1] > 16)
  {
    return p[1] < 36 && std::hypot(p[0], p[2]) < 46 ? 4 : 0;
  }
  const double r = std::hypot(p[0] / 40, (16 - p[1]) / 45, p[2] / 36);
  return r > 1 ? 0 : Norm(p - Vector3{ 0, -6, 0 }) < 12 ? 2 : r > 0.93 ? 3 : 1;
}

class StudyLabels : public testing::Test
{
protected:
  StudyLabels()
  {
    // Both breasts before one muscle, as bright as in T1.
    IntensityVolume mri;
    mri.Size = { 130, 64, 50 };
    mri.Spacing = { 2, 2, 2 };
    mri.Origin = { -129, -63, -49 };
    mri.Voxels.assign(130 * 64 * 50, 0);
    std::mt19937 generator(1);
    mri.ForEachVoxel(
      [&](int i, int j, int k, std::size_t voxel)
      {
        const Vector3 p = mri.PointAt(i, j, k);
        const int tissue = TissueAt({ std::abs(p[0]) - AsideMm, p[1], p[2] });
        mri.Voxels[voxel] = static_cast<float>(generator() % 10) +
          (p[1] > 16        ? 350.0F
              : tissue == 2 ? 400.0F
              : tissue == 0 ? 0.0F
                            : 1000.0F);
      });
    StudySeries series;
    for (int slice = 0; slice < mri.Size[2]; ++slice)
    {
      series.Files.push_back(this->Folder.File("IM" + std::to_string(slice)));
      series.Slices.push_back({ series.Files.back() });
    }
    WriteMrSeries(mri, DicomHeader(), series.Files);
    series.Side = 'B';
    this->Choice.Plain = series;
    this->Choice.Laterality = 'L';
    this->Segments = this->Folder.File("labels.seg.nrrd");
    WriteLabelVolume(this->LeftBreast(), this->Segments);
  }

  LabelVolume LeftBreast() const
  {
    LabelVolume labels = test::LabelledCube(52, 2, TissueAt);
    labels.Origin[0] += AsideMm;
    labels.Names = this->Table.LabelNames();
    return labels;
  }

  StudyTissue Tissue(const std::string& path, bool acceptUnusual = false) const
  {
    return LabelStudy(this->Choice, { .Path = path, .AcceptUnusual = acceptUnusual }, this->Table);
  }
  std::string Refusal(const LabelVolume& labels) const
  {
    const std::string path = this->Folder.File("refused.seg.nrrd");
    WriteLabelVolume(labels, path);
    return RefusalOf([&] { this->Tissue(path); });
  }

  /// What a corrector does: fat around a place was gland.
  static bool IsCorrected(const Vector3& p) { return Norm(p - Vector3{ AsideMm, -18, 9 }) < 7; }

  /// Corrects labels by ITK, and gives each label the number `renumbered` of it.
  template <typename Format>
  EditedImage::Pointer Correct(const std::string& path,
    const std::vector<unsigned char>& renumbered) const
  {
    const auto reader = itk::ImageFileReader<EditedImage>::New();
    reader->SetImageIO(Format::New());
    reader->SetFileName(path);
    reader->Update();
    const EditedImage::Pointer image = reader->GetOutput();
    itk::ImageRegionIteratorWithIndex<EditedImage> voxel(image, image->GetBufferedRegion());
    for (; !voxel.IsAtEnd(); ++voxel)
    {
      EditedImage::PointType at;
      image->TransformIndexToPhysicalPoint(voxel.GetIndex(), at);
      const bool corrected = voxel.Get() == 1 && IsCorrected({ at[0], at[1], at[2] });
      voxel.Set(renumbered[corrected ? 2 : voxel.Get()]);
    }
    return image;
  }
  template <typename Format>
  std::string Write(const EditedImage::Pointer& image, const std::string& name) const
  {
    const auto writer = itk::ImageFileWriter<EditedImage>::New();
    writer->SetImageIO(Format::New());
    writer->SetFileName(this->Folder.File(name));
    writer->SetInput(image);
    writer->Update();
    return this->Folder.File(name);
  }

  /// Only what was corrected has changed: fat there has become gland.
  void ExpectOnlyTheCorrection(const StudyTissue& corrected) const
  {
    const StudyTissue before = this->Tissue(this->Segments);
    ASSERT_EQ(corrected.Labels.Voxels.size(), before.Labels.Voxels.size());
    std::size_t changed = 0;
    before.Labels.ForEachVoxel(
      [&](int i, int j, int k, std::size_t voxel)
      {
        const int was = before.Labels.Voxels[voxel];
        const bool change = was == 1 && IsCorrected(before.Labels.PointAt(i, j, k));
        changed += change ? 1 : 0;
        ASSERT_EQ(corrected.Labels.Voxels[voxel], change ? 2 : was);
        ASSERT_EQ(corrected.Breast.Voxels[voxel] == 0, before.Breast.Voxels[voxel] == 0);
      });
    // Balls of 7 and 12 mm whose middles are 15 mm apart: more than half is outside the gland.
    EXPECT_GT(changed, 90u);
    EXPECT_EQ(corrected.Cut.Voxels, before.Cut.Voxels);
    EXPECT_EQ(corrected.Mri.Size, before.Mri.Size);
    EXPECT_DOUBLE_EQ(corrected.BreastCm3, before.BreastCm3);
    EXPECT_GT(corrected.GlandFraction, 1.05 * before.GlandFraction);
  }

  test::TemporaryFolder Folder;
  MaterialTable Table = FindMaterialTable("segment");
  StudyChoice Choice;
  std::string Segments;
};
}

TEST_F(StudyLabels, GiveTheTissueAndTheStudyTheRest)
{
  const StudyTissue tissue = this->Tissue(this->Segments);
  const LabelVolume labels = this->LeftBreast();
  EXPECT_EQ(tissue.Labels.Voxels, labels.Voxels);
  EXPECT_EQ(tissue.Labels.Names, labels.Names);
  // Half an ellipsoid, and a ball in it.
  EXPECT_NEAR(tissue.BreastCm3, 2.0 / 3 * 3.14159 * 4 * 4.5 * 3.6, 4);
  EXPECT_NEAR(tissue.GlandFraction, 7.24 / tissue.BreastCm3, 0.01);
  EXPECT_NEAR(tissue.DepthMm, 44, 2.1);
  // The MRI on the labels' grid: fat is 1.
  ASSERT_EQ(tissue.Mri.Voxels.size(), labels.Voxels.size());
  EXPECT_NEAR(tissue.Mri.ValueAt({ AsideMm, -6, 0 }).value(), 0.4, 0.02);
  EXPECT_NEAR(tissue.Mri.ValueAt({ AsideMm + 22, 0, 0 }).value(), 1, 0.02);
  // The chest wall goes on backwards.
  EXPECT_NE(tissue.Cut.LabelAt({ AsideMm, 45, 0 }), 0);
}

TEST_F(StudyLabels, OnlyTheCorrectedPartChanges)
{
  // 3D Slicer has reordered and renumbered the segments.
  const EditedImage::Pointer image =
    this->Correct<itk::NrrdImageIO>(this->Segments, { 0, 4, 3, 2, 7 });
  itk::MetaDataDictionary& header = image->GetMetaDataDictionary();
  const std::vector<std::pair<std::string, int>> segments{ { "Chest-Wall", 7 }, { "skin", 2 },
    { "gland", 3 }, { "fat", 4 } };
  for (std::size_t segment = 0; segment < segments.size(); ++segment)
  {
    const std::string prefix = "Segment" + std::to_string(segment) + "_";
    itk::EncapsulateMetaData<std::string>(header, prefix + "Name", segments[segment].first);
    itk::EncapsulateMetaData<std::string>(header, prefix + "LabelValue",
      std::to_string(segments[segment].second));
  }
  NoteKeeper notes;
  this->ExpectOnlyTheCorrection(
    this->Tissue(this->Write<itk::NrrdImageIO>(image, "corrected.seg.nrrd")));
  EXPECT_THAT(notes.Lines(),
    testing::ElementsAre(HasSubstr("labels are taken by their names, against the numbers in the "
                                   "table 'mammoray segment': 2 'skin' (not gland), 3 'gland' "
                                   "(not skin), 4 'fat' (not chest-wall)")));
}

TEST_F(StudyLabels, OnlyTheCorrectedPartChangesBesideADescription)
{
  const std::string nifti = this->Folder.File("labels.nii.gz");
  WriteLabelVolume(this->LeftBreast(), nifti);
  // ITK-SNAP keeps the numbers; where its user has not exported their names, they are known.
  const EditedImage::Pointer same = this->Correct<itk::NiftiImageIO>(nifti, { 0, 1, 2, 3, 4 });
  this->ExpectOnlyTheCorrection(this->Tissue(this->Write<itk::NiftiImageIO>(same, "plain.nii.gz")));
  // Numbers of the user's own, exported beside the volume.
  const EditedImage::Pointer own = this->Correct<itk::NiftiImageIO>(nifti, { 0, 2, 1, 13, 4 });
  const std::string corrected = this->Write<itk::NiftiImageIO>(own, "corrected.nii.gz");
  EXPECT_THAT(RefusalOf([&] { this->Tissue(corrected); }), HasSubstr("label 13 ("));
  this->Folder.Write("corrected.txt",
    "################################################\n# ITK-SnAP Label Description File\n"
    "    0     0    0    0        0  0  0    \"Clear Label\"\n"
    "    1   255    0    0        1  1  1    \"gland\"\n"
    "    2     0  255    0        1  1  1    \"Fat\"\n"
    "    4     0    0  255        1  1  1    \"Label 4\"\n"
    "   13   255  255    0        1  1  1    \"skin\"\n");
  NoteKeeper notes;
  this->ExpectOnlyTheCorrection(this->Tissue(corrected));
  // The description is an input like the volume.
  RegistrationCase input;
  input.Labels.Path = corrected;
  input.Materials = "segment";
  const std::vector<ResultInput> inputs = InputsOf(input, corrected);
  EXPECT_EQ(inputs[0].Role, LabelRole);
  EXPECT_EQ(inputs[1].Role, "Names of labels");
  EXPECT_EQ(inputs[1].File, "*.txt");
}

TEST_F(StudyLabels, MayCoverAPartOfTheGrid)
{
  // 3D Slicer crops to what was drawn.
  const EditedImage::Pointer image =
    this->Correct<itk::NrrdImageIO>(this->Segments, { 0, 1, 2, 3, 4 });
  const auto crop = itk::RegionOfInterestImageFilter<EditedImage, EditedImage>::New();
  crop->SetInput(image);
  crop->SetRegionOfInterest({ { 2, 8, 2 }, { 48, 38, 48 } });
  crop->Update();
  const EditedImage::Pointer part = crop->GetOutput();
  part->SetMetaDataDictionary(image->GetMetaDataDictionary());
  const StudyTissue whole = this->Tissue(this->Write<itk::NrrdImageIO>(image, "whole.seg.nrrd"));
  const StudyTissue cropped = this->Tissue(this->Write<itk::NrrdImageIO>(part, "cropped.seg.nrrd"));
  EXPECT_LT(cropped.Labels.Voxels.size(), whole.Labels.Voxels.size());
  EXPECT_DOUBLE_EQ(cropped.BreastCm3, whole.BreastCm3);
  cropped.Labels.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      ASSERT_EQ(cropped.Labels.Voxels[voxel],
        whole.Labels.LabelAt(cropped.Labels.PointAt(i, j, k)));
    });
}

TEST_F(StudyLabels, OfTwoBreastsTheRegisteredOneCounts)
{
  LabelVolume both = test::LabelledCube(126, 2,
    [](const Vector3& p) {
      return TissueAt({ std::abs(p[0]) - AsideMm, p[1], p[2] });
    });
  both.Names = this->Table.LabelNames();
  const std::string path = this->Folder.File("both.seg.nrrd");
  WriteLabelVolume(both, path);
  for (const char side : { 'L', 'R' })
  {
    this->Choice.Laterality = side;
    const StudyTissue tissue = this->Tissue(path);
    EXPECT_NEAR(tissue.BreastCm3, 2.0 / 3 * 3.14159 * 4 * 4.5 * 3.6, 4);
    const double left = side == 'L' ? 1 : -1;
    EXPECT_EQ(tissue.Labels.LabelAt({ left * AsideMm, -7, 1 }), 2);
    EXPECT_EQ(tissue.Labels.LabelAt({ -left * AsideMm, -7, 1 }), 0);
  }
}

TEST_F(StudyLabels, OfAnotherFrameAreRefused)
{
  EXPECT_EQ(this->Refusal(this->LeftBreast()), NotRefused);
  LabelVolume far = this->LeftBreast();
  far.Origin[2] += 60;
  EXPECT_THAT(this->Refusal(far),
    testing::AllOf(HasSubstr("refused.seg.nrrd: expected tissue in the study's MRI, found "),
      HasSubstr(" % of it outside"), HasSubstr("set AcceptUnusual")));
  // x of an anatomical frame whose x goes to the right.
  LabelVolume mirrored = this->LeftBreast();
  mirrored.Origin[0] *= -1;
  mirrored.Direction[0] = { -1, 0, 0 };
  EXPECT_THAT(this->Refusal(mirrored),
    HasSubstr("expected the left breast, which the mammograms show, found tissue 55 mm to the "
              "right of the MRI's middle"));
  for (const double shift : { -30.0, 24.0 })
  {
    LabelVolume shifted = this->LeftBreast();
    shifted.Origin[1] += shift;
    EXPECT_THAT(this->Refusal(shifted), HasSubstr("expected the skin where the study's MRI shows"))
      << shift;
  }
  const std::string path = this->Folder.File("refused.seg.nrrd");
  EXPECT_GT(this->Tissue(path, true).BreastCm3, 100);
}
