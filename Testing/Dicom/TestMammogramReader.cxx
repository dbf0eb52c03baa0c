// SPDX-License-Identifier: Apache-2.0
#include "DicomBytes.h"
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <unistd.h>

using namespace mammoray;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

namespace
{
const std::string Shared = test::SharedDataFolder();
const std::string VictreMammogram =
  test::DataFolder() + "/victre-phantom-1/victre1_lcc_processing.dcm";

#define SKIP_WITHOUT(path)                                                                         \
  if (!std::filesystem::exists(path))                                                              \
  GTEST_SKIP() << "absent: " << (path)

std::vector<char> Bytes(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  return { std::istreambuf_iterator<char>(file), {} };
}

/// A file of this test alone, removed at the end.
class TemporaryFile
{
public:
  explicit TemporaryFile(const std::vector<char>& content)
    : Path(::testing::TempDir() + "mammoray-io-" + std::to_string(::getpid()) + "-" +
        ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".dcm")
  {
    std::ofstream(this->Path, std::ios::binary)
      .write(content.data(), static_cast<std::streamsize>(content.size()));
  }
  ~TemporaryFile() { std::filesystem::remove(this->Path); }
  const std::string Path;
};

/// Pixels of a binary 16 bit PGM, most significant byte first.
std::vector<float> ReadPgm(const std::string& path)
{
  const std::vector<char> bytes = Bytes(path);
  constexpr std::size_t Count = 335 * 307;
  std::vector<float> pixels(Count);
  const auto* data =
    reinterpret_cast<const unsigned char*>(bytes.data() + bytes.size() - 2 * Count);
  for (std::size_t i = 0; i < Count; ++i)
  {
    pixels[i] = static_cast<float>(256 * data[2 * i] + data[2 * i + 1]);
  }
  return pixels;
}

/// Refused with one line that names the file and says `what`; nothing else is printed.
void ExpectRefusal(const std::string& path, const std::string& what)
{
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  std::string message;
  try
  {
    ReadMammogram(path);
  }
  catch (const InputError& error)
  {
    message = error.what();
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_THAT(message, AllOf(HasSubstr(path), HasSubstr(what), Not(HasSubstr("\n"))));
}

/// Replaces every occurrence; both of the same length, so that the file stays well formed.
std::vector<char> Replaced(std::vector<char> bytes, const std::string& from, const std::string& to)
{
  EXPECT_EQ(from.size(), to.size());
  int count = 0;
  for (auto at = bytes.begin();
       (at = std::search(at, bytes.end(), from.begin(), from.end())) != bytes.end(); ++count)
  {
    at = std::copy(to.begin(), to.end(), at);
  }
  EXPECT_GT(count, 0) << "nothing to replace";
  return bytes;
}

class TransferSyntax : public ::testing::TestWithParam<const char*>
{
};
}

TEST_P(TransferSyntax, DecodesToTheKnownPixels)
{
  const std::string folder = Shared + "/digibreast/";
  SKIP_WITHOUT(folder);
  const std::vector<float> expected = ReadPgm(folder + "mammogram_cc_1mm.pgm");
  const Mammogram mammogram =
    ReadMammogram(folder + "dicom/mg_presentation_mono2_" + GetParam() + ".dcm");
  ASSERT_EQ(mammogram.Rows, 335);
  ASSERT_EQ(mammogram.Columns, 307);
  EXPECT_TRUE(mammogram.Pixels == expected); // lossless: equal to the last bit
  EXPECT_EQ(std::accumulate(mammogram.Pixels.begin(), mammogram.Pixels.end(), 0.0), 26539219.0);
  EXPECT_EQ(mammogram.PresentationIntent, Mammogram::Intent::ForPresentation);
  EXPECT_FALSE(mammogram.InvertedForDisplay);
}

INSTANTIATE_TEST_SUITE_P(DicomMammogram, TransferSyntax,
  ::testing::Values("explicitLE", "implicitLE", "explicitBE", "deflated", "jpeg_lossless_sv1",
    "jpeg_lossless_p14_dcmtk", "jpegls_lossless", "j2k_lossless", "rle"));

TEST(DicomMammogram, ReadsAForProcessingImageAsStored)
{
  const std::string folder = Shared + "/digibreast/";
  SKIP_WITHOUT(folder);
  const std::vector<float> pgm = ReadPgm(folder + "mammogram_cc_1mm.pgm");
  const Mammogram mammogram = ReadMammogram(folder + "dicom/mg_processing_mono1_explicitLE.dcm");
  ASSERT_EQ(mammogram.Pixels.size(), pgm.size());
  for (std::size_t i = 0; i < pgm.size(); ++i)
  {
    ASSERT_EQ(mammogram.Pixels[i], 4095 - pgm[i]) << "pixel " << i;
  }
  EXPECT_TRUE(mammogram.InvertedForDisplay);
  EXPECT_EQ(mammogram.PresentationIntent, Mammogram::Intent::ForProcessing);
  EXPECT_EQ(mammogram.IntensityRelationship, Mammogram::Relationship::Logarithmic);
  EXPECT_EQ(mammogram.BitsStored, 12);
  EXPECT_EQ(mammogram.BodyPartThicknessMm, 30.0);
  EXPECT_EQ(mammogram.View, "CC");
  EXPECT_EQ(mammogram.Laterality, '?');
  EXPECT_EQ(mammogram.RowDirection, "");
  EXPECT_FALSE(mammogram.SourceToDetectorMm);
}

TEST(DicomMammogram, ReadsTheHeaderOfThePhantomsMammogram)
{
  SKIP_WITHOUT(VictreMammogram);
  const Mammogram mammogram = ReadMammogram(VictreMammogram);
  EXPECT_EQ(mammogram.Rows, 1080);
  EXPECT_EQ(mammogram.Columns, 720);
  EXPECT_EQ(mammogram.Pixels[0], 0x2e3e); // the first two bytes of the file's pixel data
  EXPECT_EQ(mammogram.Pixels[1], 0x2f2d);
  EXPECT_EQ(mammogram.RowSpacingMm, 0.1);
  EXPECT_EQ(mammogram.ColumnSpacingMm, 0.1);
  EXPECT_EQ(mammogram.View, "CC");
  EXPECT_EQ(mammogram.Laterality, 'L');
  EXPECT_EQ(mammogram.RowDirection, "A");
  EXPECT_EQ(mammogram.ColumnDirection, "R");
  EXPECT_EQ(mammogram.BodyPartThicknessMm, 50.0);
  EXPECT_EQ(mammogram.PositionerPrimaryAngleDeg, 0.0);
  EXPECT_EQ(mammogram.SourceToDetectorMm, 650.0);
  EXPECT_FALSE(mammogram.SourceToPatientMm);
  EXPECT_EQ(mammogram.PeakKilovoltage, 28.0);
  EXPECT_EQ(mammogram.AnodeMaterial, "TUNGSTEN");
  EXPECT_EQ(mammogram.FilterMaterial, "RHODIUM");
  EXPECT_TRUE(mammogram.InvertedForDisplay);
  EXPECT_EQ(mammogram.PresentationIntent, Mammogram::Intent::ForProcessing);
  EXPECT_EQ(mammogram.IntensityRelationship, Mammogram::Relationship::Linear);
  EXPECT_EQ(mammogram.IntensitySign, 1);
  EXPECT_EQ(mammogram.BitsStored, 14);
}

TEST(DicomMammogram, RefusesWhatIsNoMammogram)
{
  ExpectRefusal("/nonexistent/mammogram.dcm", "no file that can be read");
  ExpectRefusal(::testing::TempDir(), "no file that can be read");
  const std::string text = "This is a letter, not a picture.\n";
  ExpectRefusal(TemporaryFile({ text.begin(), text.end() }).Path, "no DICOM header");
  ExpectRefusal(TemporaryFile({}).Path, "no DICOM header");
}

TEST(DicomMammogram, RefusesAnotherModality)
{
  const std::string slice = Shared + "/duke-breast-mri-153-CC-BY-NC-4.0/t1_tse/1-01.dcm";
  SKIP_WITHOUT(slice);
  ExpectRefusal(slice, "found modality 'MR'");
}

TEST(DicomMammogram, RefusesAFileCutShortAnywhere)
{
  SKIP_WITHOUT(VictreMammogram);
  const std::vector<char> whole = Bytes(VictreMammogram);
  for (const std::size_t length : { std::size_t{ 100 }, std::size_t{ 140 }, std::size_t{ 600 },
         std::size_t{ 1200 }, std::size_t{ 2000 }, whole.size() / 2, whole.size() - 2 })
  {
    const TemporaryFile cut({ whole.begin(), whole.begin() + static_cast<long>(length) });
    ExpectRefusal(cut.Path, "expected");
  }
}

TEST(DicomMammogram, RefusesCompressedPixelsCutShort)
{
  const std::string folder = Shared + "/digibreast/dicom/mg_presentation_mono2_";
  SKIP_WITHOUT(folder + "rle.dcm");
  for (const char* syntax : { "deflated", "jpeg_lossless_sv1", "jpeg_lossless_p14_dcmtk",
         "jpegls_lossless", "j2k_lossless", "rle" })
  {
    SCOPED_TRACE(syntax);
    const std::vector<char> whole = Bytes(folder + syntax + ".dcm");
    const TemporaryFile cut({ whole.begin(), whole.begin() + static_cast<long>(whole.size() / 2) });
    ExpectRefusal(cut.Path, "expected");
  }
}

TEST(DicomMammogram, RefusesWhatItWouldHaveToGuess)
{
  SKIP_WITHOUT(VictreMammogram);
  const std::vector<char> whole = Bytes(VictreMammogram);
  using namespace std::string_literals;
  // Imager Pixel Spacing made a private-looking neighbour: (0018,1164) -> (0018,1165).
  ExpectRefusal(TemporaryFile(Replaced(whole, "\x18\x00\x64\x11"s, "\x18\x00\x65\x11"s)).Path,
    "the size of a pixel is not known");
  ExpectRefusal(TemporaryFile(Replaced(whole, "0.1\\0.1 ", "0.0\\0.1 ")).Path,
    "found 0 x 0.1 as Imager Pixel Spacing: the size of a pixel is not known");
  ExpectRefusal(TemporaryFile(Replaced(whole, "MONOCHROME1 ", "RGB         ")).Path, "found 'RGB'");
  // Rescale Slope, (0028,1053).
  ExpectRefusal(TemporaryFile(Replaced(whole,
                                "\x28\x00\x53\x10"
                                "DS\x02\x00"
                                "1 "s,
                                "\x28\x00\x53\x10"
                                "DS\x02\x00"
                                "1x"s))
                  .Path,
    "found '1x'");
}

TEST(DicomMammogram, RefusesHeadersThatContradictThemselves)
{
  SKIP_WITHOUT(VictreMammogram);
  const std::vector<char> whole = Bytes(VictreMammogram);
  ExpectRefusal(TemporaryFile(Replaced(whole, "FOR PROCESSING", "FOR PRESENTATI")).Path,
    "expected");
  using namespace std::string_literals;
  // Half as many columns: the rest would be taken for nothing.
  const std::string columns = "\x28\x00\x11\x00US\x02\x00"s;
  const auto at = std::search(whole.begin(), whole.end(), columns.begin(), columns.end());
  ASSERT_NE(at, whole.end());
  std::vector<char> halved = whole;
  auto* const count = &halved[static_cast<std::size_t>(at - whole.begin()) + columns.size()];
  const int found =
    static_cast<unsigned char>(count[0]) + 256 * static_cast<unsigned char>(count[1]);
  count[0] = static_cast<char>(found / 2 & 0xff);
  count[1] = static_cast<char>(found / 2 >> 8);
  ExpectRefusal(TemporaryFile(halved).Path, "bytes), found ");
}

TEST(DicomMammogram, TakesTheSpacingAtTheReceptorFromTheMagnification)
{
  SKIP_WITHOUT(VictreMammogram);
  using namespace std::string_literals;
  // Distance Source to Detector (0018,1110) renamed Estimated Radiographic Magnification
  // (0018,1114): Imager Pixel Spacing is preferred as long as it is there.
  std::vector<char> bytes = Replaced(Bytes(VictreMammogram),
    "\x18\x00\x10\x11"s + "DS\x04\x00"s + "650 ", "\x18\x00\x14\x11"s + "DS\x04\x00"s + "1.25");
  EXPECT_EQ(ReadMammogram(TemporaryFile(bytes).Path).ColumnSpacingMm, 0.1);
  // Renamed Pixel Spacing (0028,0030), a distance in the breast, it grows by the magnification.
  bytes = Replaced(bytes, "\x18\x00\x64\x11"s, "\x28\x00\x30\x00"s);
  EXPECT_DOUBLE_EQ(ReadMammogram(TemporaryFile(bytes).Path).ColumnSpacingMm, 0.125);
}

/// 5 x 3 pixels of a byte, as an odd number of them, of which nothing else is said but `more`, up
/// to group 20, and `code`, after group 28.
std::vector<char> DigitisedFilm(const std::string& more = "", const std::string& code = "")
{
  using namespace test;
  const std::string film = "1.2.840.10008.5.1.4.1.1.7";
  std::string pixels;
  for (char value = 1; value <= 15; ++value)
  {
    pixels.push_back(value);
  }
  const std::string bytes = DicomBytes(film, "1.2.3",
    Element(8, 0x16, "UI", film) + Element(8, 0x18, "UI", "1.2.3") + Element(8, 0x60, "CS", "MG") +
      more + Element(0x28, 2, "US", Us(1)) + Element(0x28, 4, "CS", "MONOCHROME2") +
      Element(0x28, 0x10, "US", Us(5)) + Element(0x28, 0x11, "US", Us(3)) +
      Element(0x28, 0x100, "US", Us(8)) + Element(0x28, 0x101, "US", Us(8)) +
      Element(0x28, 0x102, "US", Us(7)) + Element(0x28, 0x103, "US", Us(0)) + code +
      Element(0x7fe0, 0x10, "OB", pixels));
  return { bytes.begin(), bytes.end() };
}

TEST(DicomMammogram, ContradictingViewsAndSidesAreNoted)
{
  using namespace test;
  const auto notes = [](const char* view, const char* code, const char* series, const char* image)
  {
    const TemporaryFile film(
      DigitisedFilm(Element(0x18, 0x1164, "DS", "0.1\\0.1") + Element(0x18, 0x5101, "CS", view) +
          Element(0x20, 0x60, "CS", series) + Element(0x20, 0x62, "CS", image),
        Sequence(0x54, 0x220,
          { Element(8, 0x100, "SH", code) + Element(8, 0x102, "SH", "SRT") +
            Element(8, 0x104, "LO", "a view") })));
    NoteKeeper kept;
    const Mammogram read = ReadMammogram(film.Path);
    EXPECT_EQ(read.View, view);
    EXPECT_EQ(read.Laterality, image[0]);
    const std::vector<std::string> once = kept.Lines();
    EXPECT_TRUE(ReadDicomHeader(film.Path)); // says the same
    EXPECT_EQ(kept.Lines().size(), 2 * once.size());
    return once;
  };
  EXPECT_THAT(notes("MLO", "R-10226", "L", "L"), ::testing::IsEmpty());
  EXPECT_THAT(notes("MLO", "R-99999", "", "L"), ::testing::IsEmpty());
  EXPECT_THAT(notes("MLO", "R-10242", "", "L"),
    ::testing::ElementsAre(HasSubstr("its View Position (0018,5101) says MLO, its View Code "
                                     "Sequence (0054,0220) CC (cranio-caudal); MLO is taken")));
  EXPECT_THAT(notes("CC", "399162004", "R", "L"),
    ::testing::ElementsAre(HasSubstr("its Image Laterality (0020,0062) says L, its Laterality "
                                     "(0020,0060) R; L is taken")));
}

TEST(DicomMammogram, WhatIsGivenTakesThePlaceOfWhatADigitisedFilmLacks)
{
  const TemporaryFile film(DigitisedFilm());
  const std::string refusal = test::RefusalOf([&] { ReadMammogram(film.Path); });
  EXPECT_THAT(refusal,
    HasSubstr("the size of a pixel is not known; missing, too: the view (0018,5101), the side "
              "(0020,0062), the thickness (0018,11A0); set PixelSpacingMm and View and Laterality "
              "and ThicknessMm"));
  EXPECT_THAT(test::RefusalOf(
                [&] {
                  ReadMammogram(film.Path, { {}, "CC", 'R', 50 });
                }),
    ::testing::EndsWith("the size of a pixel is not known; set PixelSpacingMm"));
  const Mammogram read = ReadMammogram(film.Path, { 0.05, "MLO", 'R' });
  EXPECT_EQ(read.ColumnSpacingMm, 0.05);
  EXPECT_EQ(read.RowSpacingMm, 0.05);
  EXPECT_EQ(read.View, "MLO");
  EXPECT_EQ(read.Laterality, 'R');
  EXPECT_EQ(read.Columns, 3);
  EXPECT_EQ(read.Pixels[14], 15);
  // What a digitiser says of the film.
  const TemporaryFile scanned(DigitisedFilm(test::Element(0x18, 0x2010, "DS", "0.05\\0.06")));
  const Mammogram told = ReadMammogram(scanned.Path, { {}, "CC", 'R', 50 });
  EXPECT_EQ(told.RowSpacingMm, 0.05);
  EXPECT_EQ(told.ColumnSpacingMm, 0.06);
  // What the header says stays.
  const TemporaryFile said(DigitisedFilm(
    test::Element(0x18, 0x1164, "DS", "0.2\\0.1") + test::Element(0x18, 0x5101, "CS", "CC")));
  EXPECT_EQ(ReadMammogram(said.Path, { 0.05, "MLO", 'R' }).RowSpacingMm, 0.2);
  EXPECT_EQ(ReadMammogram(said.Path, { 0.05, "MLO", 'R' }).View, "CC");
  const TemporaryFile half(DigitisedFilm(test::Element(0x18, 0x1164, "DS", "0.2")));
  EXPECT_THAT(test::RefusalOf([&] { ReadMammogram(half.Path); }),
    HasSubstr("found 0.2 alone as Imager Pixel Spacing: the size of a pixel is not known"));
}

TEST(DicomMammogram, DeclaredPaddingBecomesNan)
{
  SKIP_WITHOUT(VictreMammogram);
  using namespace std::string_literals;
  // Pixel Intensity Relationship Sign (28,1041) SS 1 becomes Pixel Padding Value (28,0120) US
  // 0x2f2d, the value of the second pixel; elements keep their order of reading.
  const TemporaryFile padded(Replaced(Bytes(VictreMammogram), "\x28\x00\x41\x10SS\x02\x00\x01\x00"s,
    "\x28\x00\x20\x01US\x02\x00\x2d\x2f"s));
  const Mammogram mammogram = ReadMammogram(padded.Path);
  EXPECT_EQ(mammogram.Pixels[0], 0x2e3e);
  EXPECT_TRUE(std::isnan(mammogram.Pixels[1]));
}
