// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Foundation/Error.h"

#include <gtest/gtest.h>

using namespace mammoray;

TEST(DicomIdentity, IsReadFromAMammogram)
{
  const DicomHeader image =
    ReadMammogramHeader(test::DataFolder() + "/victre-phantom-1/victre1_lcc_processing.dcm");
  EXPECT_EQ(image.Identity.PatientName, "PHANTOM^VICTRE ONE");
  EXPECT_EQ(image.SopClassUid, "1.2.840.10008.5.1.4.1.1.1.2.1");
  EXPECT_EQ(image.PatientOrientation, "A\\R");
  EXPECT_EQ(image.Columns, 720);
  EXPECT_EQ(image.Rows, 1080);
  EXPECT_FALSE(image.SopInstanceUid.empty());
  EXPECT_THROW(ReadMammogramHeader(test::DataFolder() + "/README.md"), InputError);
}

TEST(DicomIdentity, TextsMustFitDicom)
{
  EXPECT_NO_THROW(CheckDicomText(std::string(64, 'a'), "name"));
  EXPECT_THROW(CheckDicomText("A\\B", "name"), InputError);
  EXPECT_THROW(CheckDicomText("A\nB", "name"), InputError);
  EXPECT_THROW(CheckDicomText(std::string(65, 'a'), "name"), InputError);
}
