// SPDX-License-Identifier: Apache-2.0
// A patient's DICOM files in the folder of a test fixture.
#ifndef mammoray_ArchivedFiles_h
#define mammoray_ArchivedFiles_h

#include "Files.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammoray/IO/LabelVolumeIO.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

namespace mammoray::test
{
class FolderTest : public ::testing::Test
{
protected:
  test::TemporaryFolder Folder;
};

/// A mammogram, an MRI series and other files in the fixture's Folder.
template <typename Fixture>
class ArchivedFiles : public Fixture
{
protected:
  /// Linear, so that interpolation is exact.
  static float MriAt(const Vector3& p)
  {
    return static_cast<float>(500 + 4 * p[0] + 2 * p[1] + 3 * p[2]);
  }

  void SetUp() override
  {
    Fixture::SetUp();
    this->Identity.PatientName = "Doe^Jane";
    this->Identity.PatientId = "P-17";
    this->Identity.PatientBirthDate = "19700101";
    this->Identity.PatientSex.assign(1, 'F');
    this->Identity.StudyInstanceUid = NewDicomUid();
    this->Identity.StudyDate = "20260110";
    this->Identity.StudyTime = "101500";
    this->Identity.StudyId.assign(1, '1');
    this->Identity.AccessionNumber = "A-100";
    this->WriteRealMammogram();
    this->WriteMri();
    IntensityVolume synthetic;
    synthetic.Size = { 30, 50, 1 };
    synthetic.Voxels.assign(30 * 50, 0.5F);
    WriteIntensityVolume(synthetic, this->Folder.File("synthetic.mha"));
    LabelVolume lesion;
    lesion.Size = { 8, 8, 8 };
    lesion.Origin = { 6.5, 16.5, -3.5 };
    lesion.Voxels.assign(512, 1);
    WriteLabelVolume(lesion, this->Folder.File("lesion.nrrd"));
  }

  void WriteRealMammogram() const
  {
    Mammogram mammogram;
    mammogram.Columns = 30;
    mammogram.Rows = 50;
    mammogram.ColumnSpacingMm = 2;
    mammogram.RowSpacingMm = 2;
    mammogram.View = "CC";
    mammogram.Laterality = 'L';
    mammogram.RowDirection.assign(1, 'A');
    mammogram.ColumnDirection.assign(1, 'R');
    mammogram.PresentationIntent = Mammogram::Intent::ForPresentation;
    mammogram.IntensitySign = -1;
    mammogram.IntensityRelationship = Mammogram::Relationship::Logarithmic;
    mammogram.PeakKilovoltage = 29;
    for (int pixel = 0; pixel < 30 * 50; ++pixel)
    {
      mammogram.Pixels.push_back(static_cast<float>(1000 + pixel % 30 * 20));
    }
    DicomMammogramOptions options;
    options.Identity = this->Identity;
    options.SeriesDescription = "L CC";
    options.Derivation = "For a test.";
    WriteMammogram(mammogram, options, this->MammogramPath());
  }

  void WriteMri() const
  {
    IntensityVolume image;
    image.Size = { 50, 45, 30 };
    image.Spacing = { 2, 2, 2 };
    image.Origin = { -49, -19, -29 };
    image.Voxels.resize(50 * 45 * 30);
    image.ForEachVoxel([&](int i, int j, int k, std::size_t voxel)
      { image.Voxels[voxel] = std::round(MriAt(image.PointAt(i, j, k))); });
    DicomHeader header;
    header.Identity = this->Identity;
    header.Identity.StudyInstanceUid = NewDicomUid();
    header.Identity.AccessionNumber = "A-200";
    header.FrameOfReferenceUid = this->MriFrame;
    header.Manufacturer = "SIEMENS";
    header.ImageType = { "ORIGINAL", "PRIMARY", "M" };
    header.SeriesDescription = "t1 axial";
    header.ScanningSequence = { "GR" };
    header.AcquisitionType = "3D";
    header.PatientPosition = "HFP";
    header.EchoTimeMs = 2;
    header.RepetitionTimeMs = 5;
    header.HasScanOptions = true;
    std::filesystem::create_directories(this->MriPath());
    std::vector<std::string> paths;
    for (int slice = 0; slice < 30; ++slice)
    {
      paths.push_back(this->MriPath());
      paths.back().append("/").append(std::to_string(slice)).append(".dcm");
    }
    WriteMrSeries(image, header, paths);
  }

  std::string MammogramPath() const { return this->Folder.File("mammogram.dcm"); }
  std::string MriPath() const { return this->Folder.File("mri-series"); }

  DicomIdentity Identity;
  const std::string MriFrame = NewDicomUid();
};
}

#endif
