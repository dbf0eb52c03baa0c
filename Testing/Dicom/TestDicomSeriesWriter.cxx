// SPDX-License-Identifier: Apache-2.0
#include "DicomTesting.h"
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Dicom/DicomWriter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using namespace mammoray;
using testing::ElementsAre;
using testing::HasSubstr;

namespace
{
/// An oblique grid of 4 x 3 x 2 voxels, each with a value of its own.
IntensityVolume ObliqueVolume()
{
  IntensityVolume volume;
  volume.Size = { 4, 3, 2 };
  volume.Spacing = { 0.75, 0.5, 2.5 };
  volume.Origin = { 10, -20, 30 };
  volume.Direction = { { { 0.8, 0.6, 0 }, { 0, 0, -1 }, { -0.6, 0.8, 0 } } };
  for (int value = 0; value < 24; ++value)
  {
    volume.Voxels.push_back(static_cast<float>(2000 * value));
  }
  return volume;
}
}

TEST(DicomSeriesWriter, VolumeAndHeaderComeBack)
{
  test::TemporaryFolder folder;
  DicomHeader header;
  header.Identity.PatientId = "P1";
  header.Identity.StudyInstanceUid = NewDicomUid();
  header.ImageType = { "ORIGINAL", "PRIMARY", "M" };
  header.SeriesDescription = "t1_fl3d_tra";
  header.Manufacturer = "SIEMENS";
  header.ScanningSequence = { "GR" };
  header.ScanOptions = { "PFP", "SFS" };
  header.HasScanOptions = true;
  header.AcquisitionType = "3D";
  header.RepetitionTimeMs = 4.8;
  header.EchoTimeMs = 1.9;
  header.PatientPosition = "HFP";
  header.SeriesNumber = 5;
  header.TemporalPosition = 2;
  header.AcquisitionTime = "101112";
  const std::vector<std::string> paths{ folder.File("b"), folder.File("a") };
  WriteMrSeries(ObliqueVolume(), header, paths);

  const IntensityVolume volume = ReadIntensitySeries(paths);
  EXPECT_EQ(volume.Voxels, ObliqueVolume().Voxels);
  // Ten digits in the files.
  EXPECT_LT(Norm(volume.PointAt(3, 2, 1) - ObliqueVolume().PointAt(3, 2, 1)), 1e-8);
  const std::optional<DicomHeader> read = ReadDicomHeader(paths[1]);
  ASSERT_TRUE(read);
  EXPECT_THAT(read->ScanOptions, ElementsAre("PFP", "SFS"));
  EXPECT_EQ(read->SeriesDescription, header.SeriesDescription);
  EXPECT_EQ(read->Identity.PatientId, "P1");
  EXPECT_EQ(read->Identity.StudyInstanceUid, header.Identity.StudyInstanceUid);
  EXPECT_EQ(read->Modality, "MR");
  EXPECT_EQ(read->Manufacturer, "SIEMENS");
  EXPECT_EQ(read->EchoTimeMs, 1.9);
  EXPECT_EQ(read->TemporalPosition, 2);
  EXPECT_EQ(read->SeriesNumber, 5);
  EXPECT_EQ(read->InstanceNumber, 2);
  EXPECT_EQ(read->AcquisitionTime, "101112");
  EXPECT_EQ(read->PatientPosition, "HFP");
  EXPECT_NE(read->SeriesInstanceUid, "");
  test::ExpectValidDicom(paths[0]);
}

TEST(DicomSeriesWriter, RefusesWhatAFileCannotHold)
{
  test::TemporaryFolder folder;
  const std::vector<std::string> paths{ folder.File("a"), folder.File("b") };
  const auto refusal = [](const IntensityVolume& volume, const std::vector<std::string>& to)
  { return test::RefusalOf([&] { WriteMrSeries(volume, {}, to); }); };
  EXPECT_THAT(refusal(ObliqueVolume(), { paths[0] }), HasSubstr("a path for each of 2 layers"));
  IntensityVolume negative = ObliqueVolume();
  negative.Voxels[3] = -1;
  EXPECT_THAT(refusal(negative, paths), HasSubstr("0 to 65535"));
  EXPECT_THAT(refusal(ObliqueVolume(), { folder.File("no/a"), folder.File("no/b") }),
    HasSubstr("cannot be written"));
}
