// SPDX-License-Identifier: Apache-2.0
// Mammograms that are written: read back by GDCM, and looked at by dciodvfy where it is installed.
#include "DescribedProjection.h"
#include "DicomTesting.h"
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/Foundation/Error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <gdcmImageReader.h>

#include <cmath>

using mammoray::test::RefusalOf;
using namespace mammoray;
using test::Describe;
using test::DicomTextOf;
using test::ExpectValidDicom;
using test::TemporaryFolder;
using ::testing::HasSubstr;

namespace
{
const std::string Victre = test::DataFolder() + "/victre-phantom-1/victre1_lcc_processing.dcm";

/// From 0 to 3.4.
std::vector<float> Ramp()
{
  std::vector<float> values;
  for (int pixel = 0; pixel < 35; ++pixel)
  {
    values.push_back(0.1f * static_cast<float>(pixel));
  }
  return values;
}

Mammogram Written(const Mammogram& mammogram, const std::string& path)
{
  WriteMammogram(mammogram, { .Derivation = "Synthetic" }, path);
  return ReadMammogram(path);
}

void ExpectSame(const Mammogram& read, const Mammogram& written)
{
  EXPECT_EQ(read.Columns, written.Columns);
  EXPECT_EQ(read.Rows, written.Rows);
  EXPECT_EQ(read.Pixels, written.Pixels);
  EXPECT_EQ(read.InvertedForDisplay, written.InvertedForDisplay);
  EXPECT_EQ(read.PresentationIntent, written.PresentationIntent);
  EXPECT_EQ(read.IntensityRelationship, written.IntensityRelationship);
  EXPECT_EQ(read.IntensitySign, written.IntensitySign);
  EXPECT_EQ(read.BitsStored, written.BitsStored);
  // Decimal strings have ten digits.
  EXPECT_NEAR(read.ColumnSpacingMm, written.ColumnSpacingMm, 1e-9);
  EXPECT_NEAR(read.RowSpacingMm, written.RowSpacingMm, 1e-9);
  EXPECT_EQ(read.View, written.View);
  EXPECT_EQ(read.Laterality, written.Laterality);
  EXPECT_EQ(read.RowDirection, written.RowDirection);
  EXPECT_EQ(read.ColumnDirection, written.ColumnDirection);
  EXPECT_EQ(read.BodyPartThicknessMm, written.BodyPartThicknessMm);
  EXPECT_NEAR(*read.PositionerPrimaryAngleDeg, *written.PositionerPrimaryAngleDeg, 1e-7);
  EXPECT_NEAR(*read.SourceToDetectorMm, *written.SourceToDetectorMm, 1e-6);
  EXPECT_EQ(read.SourceToPatientMm, written.SourceToPatientMm);
  EXPECT_EQ(read.PeakKilovoltage, written.PeakKilovoltage);
}
}

TEST(DicomMammogramWriter, PresentationIsReadBackAndValid)
{
  const TemporaryFolder folder;
  Mammogram mammogram = Describe(-47.25, 'L');
  mammogram.BodyPartThicknessMm = 53.125;
  mammogram.SourceToPatientMm = 640;
  mammogram.PeakKilovoltage = 28;
  SetPixels(mammogram, Ramp(), Mammogram::Intent::ForPresentation);
  EXPECT_EQ(mammogram.Pixels[34], 13600); // 4000 times 3.4
  const std::string path = folder.File("presentation.dcm");
  ExpectSame(Written(mammogram, path), mammogram);
  ExpectValidDicom(path);
  EXPECT_EQ(DicomTextOf(path, 0x0008, 0x0016), "1.2.840.10008.5.1.4.1.1.1.2");
  EXPECT_EQ(DicomTextOf(path, 0x2050, 0x0020), "IDENTITY");
  // Of 35 pixels, white is the last but one: log attenuation 3.3.
  EXPECT_EQ(DicomTextOf(path, 0x0028, 0x1051), "13200");
  EXPECT_EQ(DicomTextOf(path, 0x0028, 0x1050), "6600");
  EXPECT_THAT(DicomTextOf(path, 0x0008, 0x0008), testing::StartsWith("DERIVED\\PRIMARY"));

  // Another reader than our own.
  gdcm::ImageReader reader;
  reader.SetFileName(path.c_str());
  ASSERT_TRUE(reader.Read());
  std::vector<char> buffer(reader.GetImage().GetBufferLength());
  ASSERT_EQ(buffer.size(), 70u);
  ASSERT_TRUE(reader.GetImage().GetBuffer(buffer.data()));
  EXPECT_EQ(static_cast<unsigned char>(buffer[68]) + 256 * static_cast<unsigned char>(buffer[69]),
    13600);
}

TEST(DicomMammogramWriter, ASignThatIsNotGivenIsThatOfTheDisplay)
{
  const TemporaryFolder folder;
  Mammogram mammogram = Describe(0, 'L');
  SetPixels(mammogram, Ramp(), Mammogram::Intent::ForPresentation);
  for (const bool inverted : { false, true })
  {
    mammogram.IntensitySign = 0;
    mammogram.InvertedForDisplay = inverted;
    EXPECT_EQ(Written(mammogram, folder.File("image.dcm")).IntensitySign, inverted ? 1 : -1);
  }
}

TEST(DicomMammogramWriter, ProcessingIsLinearAndInverse)
{
  const TemporaryFolder folder;
  Mammogram mammogram = Describe(0, 'R');
  std::vector<float> values = Ramp();
  values[0] = -1; // noise in the air: clipped at the largest number
  SetPixels(mammogram, values, Mammogram::Intent::ForProcessing);
  EXPECT_EQ(mammogram.Pixels[0], 65535);
  EXPECT_EQ(mammogram.Pixels[20], std::round(50000 * std::exp(-2.0)));
  const std::string path = folder.File("processing.dcm");
  ExpectSame(Written(mammogram, path), mammogram);
  ExpectValidDicom(path);
  EXPECT_EQ(DicomTextOf(path, 0x0008, 0x0016), "1.2.840.10008.5.1.4.1.1.1.2.1");
  EXPECT_EQ(DicomTextOf(path, 0x0028, 0x0004), "MONOCHROME1");
  EXPECT_EQ(DicomTextOf(path, 0x0028, 0x1051), "");
}

TEST(DicomMammogramWriter, CopiesNothingOfThePatientUnlessTold)
{
  const TemporaryFolder folder;
  Mammogram mammogram = Describe(0, 'L');
  SetPixels(mammogram, Ramp(), Mammogram::Intent::ForPresentation);
  const std::string path = folder.File("image.dcm");
  Written(mammogram, path);
  EXPECT_EQ(DicomTextOf(path, 0x0010, 0x0010), "");
  EXPECT_EQ(DicomTextOf(path, 0x0010, 0x0020), "");
  const std::string study = DicomTextOf(path, 0x0020, 0x000d);
  const std::string instance = DicomTextOf(path, 0x0008, 0x0018);
  Written(mammogram, path);
  EXPECT_NE(DicomTextOf(path, 0x0020, 0x000d), study);
  EXPECT_NE(DicomTextOf(path, 0x0008, 0x0018), instance);

  const DicomHeader real = ReadMammogramHeader(Victre);
  WriteMammogram(mammogram, { real.Identity, real, "Synthetic" }, path);
  EXPECT_EQ(DicomTextOf(path, 0x0010, 0x0010), "PHANTOM^VICTRE ONE");
  EXPECT_EQ(DicomTextOf(path, 0x0020, 0x000d), DicomTextOf(Victre, 0x0020, 0x000d));
  EXPECT_NE(DicomTextOf(path, 0x0020, 0x000e), DicomTextOf(Victre, 0x0020, 0x000e));
  EXPECT_THAT(test::ReadFile(path), HasSubstr(real.SopInstanceUid));
  ExpectValidDicom(path);
}

TEST(DicomMammogramWriter, RefusesWhatAMammogramMustSay)
{
  const TemporaryFolder folder;
  Mammogram whole = Describe(0, 'L');
  SetPixels(whole, Ramp(), Mammogram::Intent::ForPresentation);
  const auto refused = [&](auto&& change, const std::string& text)
  {
    Mammogram mammogram = whole;
    change(mammogram);
    EXPECT_THAT(RefusalOf([&] { WriteMammogram(mammogram, {}, folder.File("image.dcm")); }),
      HasSubstr(text));
  };
  refused([](Mammogram& m) { m.Laterality = '?'; }, "laterality L or R");
  refused([](Mammogram& m) { m.View = "spot"; }, "found 'spot'");
  refused([](Mammogram& m) { m.RowDirection.clear(); }, "patient directions");
  refused([](Mammogram& m) { m.Pixels[4] = 0.5; }, "whole numbers");
  refused([](Mammogram& m) { m.Pixels.pop_back(); }, "34 pixels");
  refused([](Mammogram& m) { m.RowSpacingMm = 0; }, "positive pixel spacings");
  EXPECT_THROW(WriteMammogram(whole, {}, "/nonexistent/image.dcm"), InputError);
}
