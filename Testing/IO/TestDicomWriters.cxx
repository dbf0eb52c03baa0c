// SPDX-License-Identifier: Apache-2.0
// DICOM that is written: read back by GDCM, and looked at by dciodvfy where it is installed.
#include "DicomTesting.h"
#include "Files.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/DicomMammogramWriter.h"
#include "mammoray/IO/DicomSegmentationWriter.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/MammogramIO.h"
#include "mammoray/IO/MammogramSynthesis.h"
#include "mammoray/IO/Private/QuietGdcm.h"
#include "mammoray/Registration/MammogramTarget.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <gdcmImageReader.h>

#include <cmath>

using namespace mammoray;
using ::testing::HasSubstr;
using testing_support::DicomTextOf;
using testing_support::ExpectValidDicom;
using testing_support::TemporaryFolder;

namespace
{
const std::string Victre =
  testing_support::DataFolder() + "/victre-phantom-1/victre1_lcc_processing.dcm";

/// A unit at this roll around a breast in LPS; columns of 0.2 mm and rows of 0.3 mm.
Mammogram Describe(double rollDeg, char laterality, int columns = 7, int rows = 5)
{
  const AnatomicalAxes axes;
  const VolumeFromGantry gantry =
    PlaceUnit(axes, { 10, -20, 30 }, { .SourceToDetectorMm = 660 }, { .RollDeg = rollDeg });
  XRaySource source;
  source.Position = gantry.Point({ 0, 0, 660 });
  XRayDetector detector;
  detector.Columns = columns;
  detector.Rows = rows;
  detector.Origin = gantry.Point({ 40, 1, 0 });
  detector.ColumnStep = 0.2 * gantry.Y;
  detector.RowStep = -0.3 * gantry.X;
  return DescribeProjection(source, detector, axes, laterality);
}

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

TEST(MammogramSynthesis, SaysViewAndSidesOfEveryRoll)
{
  const Mammogram cc = Describe(0, 'L');
  EXPECT_EQ(cc.View, "CC");
  EXPECT_EQ(cc.RowDirection, "A");
  EXPECT_EQ(cc.ColumnDirection, "R");
  EXPECT_EQ(*cc.PositionerPrimaryAngleDeg, 0);
  EXPECT_NEAR(*cc.SourceToDetectorMm, 660, 1e-9); // rounding
  EXPECT_NEAR(cc.ColumnSpacingMm, 0.2, 1e-12);
  EXPECT_NEAR(cc.RowSpacingMm, 0.3, 1e-12);
  // The source medial is a negative roll of the left breast.
  for (const auto& [roll, view] : { std::pair{ -45.0, "MLO" }, { -90.0, "ML" }, { 90.0, "LM" },
         { 45.0, "LMO" }, { 179.0, "FB" }, { -10.0, "CC" }, { 135.0, "" } })
  {
    EXPECT_EQ(Describe(roll, 'L').View, view) << roll;
    EXPECT_EQ(Describe(-roll, 'R').View, view) << roll;
    EXPECT_NEAR(*Describe(roll, 'L').PositionerPrimaryAngleDeg, roll, 1e-9);
  }
  // Rows run along -x of the gantry, which points to the patient's left in CC and turns down with
  // the source going left.
  EXPECT_EQ(Describe(90, 'R').ColumnDirection, "H");
  EXPECT_EQ(Describe(-90, 'L').ColumnDirection, "F");
  EXPECT_EQ(Describe(-60, 'L').ColumnDirection, "FR");
  EXPECT_THROW(Describe(0, '?'), InputError);
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

  values[3] = std::nanf("");
  EXPECT_THROW(SetPixels(mammogram, values, Mammogram::Intent::ForProcessing), InputError);
  values.pop_back();
  EXPECT_THROW(SetPixels(mammogram, values, Mammogram::Intent::ForProcessing), InputError);
}

TEST(DicomMammogramWriter, RegistrationFindsTheGantryAgain)
{
  // Half a disc at the chest wall, 20 mm in radius, in air.
  const TemporaryFolder folder;
  constexpr int Columns = 150;
  constexpr int Rows = 200;
  std::vector<float> values;
  for (int row = 0; row < Rows; ++row)
  {
    for (int column = 0; column < Columns; ++column)
    {
      values.push_back(std::hypot(0.2 * column, 0.3 * (row - 100)) < 20 ? 2.0f : 0.0f);
    }
  }
  for (const auto& [roll, side] :
    { std::pair{ 0.0, 'L' }, { 0.0, 'R' }, { -50.0, 'L' }, { 50.0, 'R' }, { 90.0, 'R' } })
  {
    for (const auto intent :
      { Mammogram::Intent::ForPresentation, Mammogram::Intent::ForProcessing })
    {
      Mammogram mammogram = Describe(roll, side, Columns, Rows);
      SetPixels(mammogram, values, intent);
      const RegistrationTarget target = PrepareTarget(Written(mammogram, folder.File("image.dcm")));
      // The columns run along the gantry's y, the rows against its x, as Describe has them.
      EXPECT_THAT(target.ColumnStep, testing::Pointwise(testing::DoubleNear(1e-9), { 0.0, 0.2 }))
        << roll << side;
      EXPECT_THAT(target.RowStep, testing::Pointwise(testing::DoubleNear(1e-9), { -0.3, 0.0 }))
        << roll << side;
      EXPECT_EQ(target.Warnings, std::vector<std::string>{}) << roll << side;
    }
  }
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

  const DicomReference real = ReadDicomReference(Victre);
  WriteMammogram(mammogram, { real.Identity, real, "Synthetic" }, path);
  EXPECT_EQ(DicomTextOf(path, 0x0010, 0x0010), "PHANTOM^VICTRE ONE");
  EXPECT_EQ(DicomTextOf(path, 0x0020, 0x000d), DicomTextOf(Victre, 0x0020, 0x000d));
  EXPECT_NE(DicomTextOf(path, 0x0020, 0x000e), DicomTextOf(Victre, 0x0020, 0x000e));
  EXPECT_THAT(testing_support::ReadFile(path), HasSubstr(real.SopInstanceUid));
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
    try
    {
      WriteMammogram(mammogram, {}, folder.File("image.dcm"));
      ADD_FAILURE() << "not refused: " << text;
    }
    catch (const InputError& error)
    {
      EXPECT_THAT(error.what(), HasSubstr(text));
    }
  };
  refused([](Mammogram& m) { m.Laterality = '?'; }, "laterality L or R");
  refused([](Mammogram& m) { m.View = "spot"; }, "found 'spot'");
  refused([](Mammogram& m) { m.RowDirection.clear(); }, "patient directions");
  refused([](Mammogram& m) { m.Pixels[4] = 0.5; }, "whole numbers");
  refused([](Mammogram& m) { m.Pixels.pop_back(); }, "34 pixels");
  refused([](Mammogram& m) { m.RowSpacingMm = 0; }, "positive pixel spacings");
  EXPECT_THROW(WriteMammogram(whole, {}, "/nonexistent/image.dcm"), InputError);
  EXPECT_THROW(CheckDicomText("A\\B", "name"), InputError);
  EXPECT_THROW(CheckDicomText(std::string(65, 'a'), "name"), InputError);
  EXPECT_THROW(ReadDicomReference(testing_support::DataFolder() + "/README.md"), InputError);
}

TEST(DicomSegmentationWriter, LiesOnTheImageItRefersTo)
{
  const TemporaryFolder folder;
  const DicomReference image = ReadDicomReference(Victre);
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
  const std::string bytes = testing_support::ReadFile(path);
  EXPECT_THAT(bytes, HasSubstr(image.SopInstanceUid));
  EXPECT_THAT(bytes, HasSubstr(image.SeriesInstanceUid));

  const QuietGdcm quiet; // it misses the place in space, which a projection has not
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

  EXPECT_THROW(ReadDicomReference(path), InputError); // no mammogram
  try
  {
    ReadLabelVolume(path);
    FAIL() << "a projection is no volume";
  }
  catch (const InputError& error)
  {
    EXPECT_THAT(error.what(), HasSubstr("as on a projection"));
  }

  // In another study the reference names the image's study.
  WriteSegmentation(segments, image, {}, path);
  ExpectValidDicom(path);
  EXPECT_THAT(testing_support::ReadFile(path), HasSubstr(image.Identity.StudyInstanceUid));

  EXPECT_THROW(WriteSegmentation({}, image, identity, path), InputError);
  segments[0].Mask.pop_back();
  EXPECT_THROW(WriteSegmentation(segments, image, identity, path), InputError);
}
