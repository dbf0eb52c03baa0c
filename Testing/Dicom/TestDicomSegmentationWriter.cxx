// SPDX-License-Identifier: Apache-2.0
// Segmentations that are written: read back by GDCM, and looked at by dciodvfy where it is
// installed.
#include "DicomTesting.h"
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/Foundation/Error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <gdcmImageReader.h>
#include <gdcmTrace.h>

using mammoray::test::RefusalOf;
using namespace mammoray;
using test::DicomTextOf;
using test::ExpectValidDicom;
using test::TemporaryFolder;
using ::testing::HasSubstr;

namespace
{
const std::string VictreReference =
  test::DataFolder() + "/victre-phantom-1/victre1_lcc_processing.dcm";
}

TEST(DicomSegmentationWriter, LiesOnTheImageItRefersTo)
{
  const TemporaryFolder folder;
  const DicomHeader image = ReadMammogramHeader(VictreReference);
  ASSERT_EQ(image.Columns, 720);
  ASSERT_EQ(image.Rows, 1080);
  std::vector<DicomSegment> segments(2);
  segments[0] = { "Lesion 3", std::vector<unsigned char>(720 * 1080, 0) };
  segments[1] = { "Lesion 7", segments[0].Mask };
  segments[0].Mask[720 * 10 + 3] = 1;
  segments[0].Mask[720 * 1079 + 719] = 1;
  segments[1].Mask[5] = 1;
  DicomIdentity identity;
  identity.StudyInstanceUid = image.Identity.StudyInstanceUid;
  const std::string path = folder.File("lesions.dcm");
  WriteSegmentation(segments, image, identity, path);
  ExpectValidDicom(path);
  EXPECT_EQ(DicomTextOf(path, 0x0010, 0x0010), "");
  const std::string bytes = test::ReadFile(path);
  EXPECT_THAT(bytes, HasSubstr(image.SopInstanceUid));
  EXPECT_THAT(bytes, HasSubstr(image.SeriesInstanceUid));

  gdcm::Trace::ErrorOff(); // GDCM misses the place in space, which a projection has not
  gdcm::ImageReader reader;
  reader.SetFileName(path.c_str());
  ASSERT_TRUE(reader.Read());
  EXPECT_EQ(reader.GetImage().GetDimension(0), 720u);
  EXPECT_EQ(reader.GetImage().GetDimension(1), 1080u);
  EXPECT_EQ(reader.GetImage().GetDimension(2), 2u);
  const gdcm::ByteValue* bits =
    reader.GetFile().GetDataSet().GetDataElement(gdcm::Tag(0x7fe0, 0x0010)).GetByteValue();
  ASSERT_EQ(bits->GetLength(), 2u * 720 * 1080 / 8);
  for (std::size_t pixel = 0; pixel < 2u * 720 * 1080; ++pixel)
  {
    const bool set = (bits->GetPointer()[pixel / 8] >> pixel % 8 & 1) != 0;
    const std::size_t within = pixel % (720 * 1080);
    ASSERT_EQ(set, segments[pixel / (720 * 1080)].Mask[within] != 0) << pixel;
  }

  EXPECT_THROW(ReadMammogramHeader(path), InputError); // no mammogram
  EXPECT_THAT(RefusalOf([&] { ReadLabelVolume(path); }), HasSubstr("as on a projection"));

  // In another study the reference names the image's study.
  WriteSegmentation(segments, image, {}, path);
  ExpectValidDicom(path);
  EXPECT_THAT(test::ReadFile(path), HasSubstr(image.Identity.StudyInstanceUid));

  EXPECT_THROW(WriteSegmentation({}, image, identity, path), InputError);
  segments[0].Mask.pop_back();
  EXPECT_THROW(WriteSegmentation(segments, image, identity, path), InputError);
}
