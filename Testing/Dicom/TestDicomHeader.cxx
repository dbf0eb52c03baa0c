// SPDX-License-Identifier: Apache-2.0
// Headers up to the pixels, and the order of slices that they give.
#include "DicomBytes.h"
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Dicom/Private/DicomFile.h"
#include "mammoray/Foundation/Error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <malloc.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <vector>

using namespace mammoray;
using namespace mammoray::test;
using testing::AnyOf;
using testing::ElementsAre;
using testing::HasSubstr;

namespace
{
constexpr const char* MrClass = "1.2.840.10008.5.1.4.1.1.4";

std::string Slice(double height)
{
  return DicomBytes(MrClass, "1.2.3.4",
    Element(8, 8, "CS", "ORIGINAL\\PRIMARY\\M\\NORM") + Element(8, 0x16, "UI", MrClass) +
      Element(8, 0x18, "UI", "1.2.3.4") + Element(8, 0x60, "CS", "MR") +
      Element(8, 0x103e, "LO", "t1_fl3d_tra_spair") + Element(0x10, 0x20, "LO", "P1") +
      Element(0x18, 0x20, "CS", "GR") + Element(0x18, 0x22, "CS", "PFP\\SFS") +
      Element(0x18, 0x50, "DS", "1.2") + Element(0x18, 0x80, "DS", "4.3") +
      Element(0x18, 0x81, "DS", "1.73") + Element(0x18, 0x5100, "CS", "HFP") +
      Element(0x20, 0xe, "UI", "1.2.3") + Element(0x20, 0x12, "IS", "2") +
      Element(0x20, 0x32, "DS", Join({ -10, -20, height })) +
      Element(0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0") + Element(0x28, 2, "US", Us(1)) +
      Element(0x28, 0x10, "US", Us(3)) + Element(0x28, 0x11, "US", Us(4)) +
      Element(0x28, 0x30, "DS", "0.5\\0.75") + Element(0x28, 0x100, "US", Us(16)) +
      Element(0x7fe0, 0x10, "OW", std::string(24, '\7')));
}

DicomHeader Read(const std::string& path)
{
  const std::optional<DicomHeader> header = ReadDicomHeader(path);
  EXPECT_TRUE(header) << path;
  return header.value_or(DicomHeader{});
}

std::string RefusalOfHeader(const std::string& path)
{
  return RefusalOf([&] { ReadDicomHeader(path); });
}

TEST(DicomHeader, TellsOfASlice)
{
  TemporaryFolder folder;
  const DicomHeader header = Read(folder.Write("I0001", Slice(30)));
  EXPECT_EQ(header.Modality, "MR");
  EXPECT_EQ(header.SopClassUid, MrClass);
  EXPECT_EQ(header.SeriesInstanceUid, "1.2.3");
  EXPECT_EQ(header.Identity.PatientId, "P1");
  EXPECT_THAT(header.ImageType, ElementsAre("ORIGINAL", "PRIMARY", "M", "NORM"));
  EXPECT_THAT(header.ScanOptions, ElementsAre("PFP", "SFS"));
  EXPECT_TRUE(header.HasScanOptions);
  EXPECT_EQ(header.EchoTimeMs, 1.73);
  EXPECT_EQ(header.AcquisitionNumber, 2);
  EXPECT_FALSE(header.TemporalPosition);
  EXPECT_EQ(header.PatientPosition, "HFP");
  EXPECT_EQ(header.Position, (Vector3{ -10, -20, 30 }));
  EXPECT_EQ(header.RowSpacingMm, 0.5);
  EXPECT_EQ(header.ColumnSpacingMm, 0.75);
  EXPECT_EQ(header.SliceSpacingMm, 1.2);
  EXPECT_EQ(header.Columns, 4);
  EXPECT_EQ(header.Laterality, '?');
}

TEST(DicomHeader, TellsOfAMammogramsViewByItsCodes)
{
  TemporaryFolder folder;
  const auto code = [](const std::string& value, const std::string& meaning)
  { return Element(8, 0x100, "SH", value) + Element(8, 0x104, "LO", meaning); };
  const std::string view = code("R-10226", "medio-lateral oblique") +
    Sequence(0x54, 0x222, { code("399163009", ""), code("X", "Of another kind") });
  const DicomHeader header = Read(folder.Write("mg",
    DicomBytes("1.2.840.10008.5.1.4.1.1.1.2.1", "1.2.9",
      Element(8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.1.2.1") + Element(8, 0x60, "CS", "MG") +
        Element(0x18, 0x11a0, "DS", "52") + Element(0x20, 0x62, "CS", "R") +
        Sequence(0x54, 0x220, { view }))));
  EXPECT_EQ(header.View, "MLO");
  EXPECT_THAT(header.ViewModifiers, ElementsAre("Magnification", "Of another kind"));
  EXPECT_EQ(header.Laterality, 'R');
  EXPECT_EQ(header.PresentationIntent, Mammogram::Intent::ForProcessing);
  EXPECT_EQ(header.BodyPartThicknessMm, 52);
}

TEST(DicomHeader, DamageIsNamedAndOtherFilesAreNone)
{
  TemporaryFolder folder;
  EXPECT_FALSE(ReadDicomHeader(folder.Write("report.pdf", "%PDF-1.4")));
  EXPECT_FALSE(ReadDicomHeader(folder.Write("empty", "")));
  const std::string whole = Slice(0);
  for (const std::size_t kept : { std::size_t{ 140 }, std::size_t{ 300 } })
  {
    const std::string path = folder.Write("cut", whole.substr(0, kept));
    try
    {
      ReadDicomHeader(path);
      FAIL() << kept;
    }
    catch (const InputError& error)
    {
      EXPECT_THAT(error.what(), HasSubstr(path));
      EXPECT_THAT(error.what(), HasSubstr("cut short"));
    }
  }
  // The header is whole, but it promises more pixels than a file of this size can hold.
  std::string promising = whole;
  const std::string rows = Element(0x28, 0x10, "US", Us(3));
  promising.replace(promising.find(rows), rows.size(), Element(0x28, 0x10, "US", Us(3000)));
  EXPECT_THROW(ReadDicomHeader(folder.Write("promising", promising)), InputError);
}

TEST(DicomHeader, AHoleOfGigabytesIsNoHeader)
{
  TemporaryFolder folder;
  const std::string whole = Slice(0);
  const std::string path =
    folder.Write("hole", whole.substr(0, whole.size() - 24 - 12)); // without its pixels
  std::filesystem::resize_file(path, std::uintmax_t{ 1 } << 33);
  // DCMTK 3.6.9 sees itself that elements of zeros are none.
  EXPECT_THAT(RefusalOfHeader(path),
    AnyOf(HasSubstr("a header of more than 8 MiB"), HasSubstr("damaged")));
}

// DCMTK reads a sequence in a sequence by recursion.
TEST(DicomHeader, SequencesThatNoStackHoldsAreNoHeader)
{
  TemporaryFolder folder;
  const auto nested = [&folder](std::size_t depth, std::uint32_t group)
  {
    const std::string undefined = Little(0xffffffff, 4);
    const std::string opened = Little(group, 2) + Little(0x1140, 2) + "SQ" + Little(0, 2) +
      undefined + Little(0xfffe, 2) + Little(0xe000, 2) + undefined;
    const std::string closed = Little(0xfffe, 2) + Little(0xe00d, 2) + Little(0, 4) +
      Little(0xfffe, 2) + Little(0xe0dd, 2) + Little(0, 4);
    std::string data = Element(8, 0x60, "CS", "MR");
    data += group > 8 ? Element(0x7fe0, 0x10, "OW", std::string(24, '\7')) : "";
    for (std::size_t level = 0; level < depth; ++level)
    {
      data += opened;
    }
    for (std::size_t level = 0; level < depth; ++level)
    {
      data += closed;
    }
    return folder.Write("nested", DicomBytes(MrClass, "1.2.3.4", data));
  };
  constexpr std::uint32_t before = 8;
  constexpr std::uint32_t after = 0x7fe1; // the pixels, where no header reaches
  const std::string refusal = "found sequences nested too deep";
  EXPECT_EQ(Read(nested(20, before)).Modality, "MR");
  CheckDicomElements(nested(20, after));
  for (const std::size_t depth : { 20'000, 400'000 })
  {
    EXPECT_THAT(RefusalOfHeader(nested(depth, before)), HasSubstr(refusal));
    const std::string path = nested(depth, after);
    EXPECT_EQ(Read(path).Modality, "MR");
    EXPECT_THAT(RefusalOf([&] { CheckDicomElements(path); }), HasSubstr(refusal));
  }
}

/// The most memory that an action had taken at a time beyond what there was, in MiB.
std::size_t MemoryOf(const std::function<void()>& action)
{
  const auto status = [](const std::string& name)
  {
    std::ifstream file("/proc/self/status");
    std::string word;
    while (file >> word && word != name)
    {
    }
    std::size_t kilobytes = 0;
    file >> kilobytes;
    return kilobytes >> 10;
  };
  std::ofstream("/proc/self/clear_refs") << "5"; // the most from now on: proc(5)
  const std::size_t before = status("VmRSS:");
#ifdef __GLIBC__
  mallopt(M_PERTURB, 0); // glibc would fill, and so take, what is only asked for
#endif
  action();
  return std::max(status("VmHWM:"), before) - before;
}

TEST(DicomHeader, ADeflatedValueThatIsALongOneIsNoHeader)
{
  TemporaryFolder folder;
  std::string file = DicomBytes(MrClass, "1.2.3.4", "");
  const std::string syntax = Element(2, 0x10, "UI", "1.2.840.10008.1.2.1");
  const std::string deflated = Element(2, 0x10, "UI", "1.2.840.10008.1.2.1.99");
  file.replace(file.find(syntax), syntax.size(), deflated);
  const std::size_t group = file.find(Element(2, 1, "OB", std::string("\0\1", 2))) - 4;
  file.replace(group, 4, Little(static_cast<std::uint32_t>(file.size() - group - 4), 4));
  z_stream stream{};
  ASSERT_EQ(deflateInit2(&stream, 1, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::vector<unsigned char> output(1 << 16);
  const auto put = [&](std::string bytes, int flush)
  {
    stream.next_in = reinterpret_cast<unsigned char*>(bytes.data());
    stream.avail_in = static_cast<unsigned int>(bytes.size());
    do
    {
      stream.next_out = output.data();
      stream.avail_out = static_cast<unsigned int>(output.size());
      deflate(&stream, flush);
      file.append(output.begin(), output.end() - stream.avail_out);
    } while (stream.avail_out == 0);
  };
  constexpr std::uint32_t length = 256 << 20;
  put(Element(8, 0x60, "CS", "MR") + Little(0x11, 2) + Little(0x10, 2) + "UN" + Little(0, 2) +
      Little(length, 4),
    Z_NO_FLUSH);
  for (std::uint32_t part = 0; part < length >> 20; ++part)
  {
    put(std::string(1 << 20, '\0'), Z_NO_FLUSH);
  }
  put("", Z_FINISH);
  deflateEnd(&stream);
  const std::string path = folder.Write("deflated", file);
  ASSERT_LT(file.size(), 4u << 20);
  std::string refusal;
  EXPECT_LT(MemoryOf([&] { refusal = RefusalOfHeader(path); }), 64u);
  EXPECT_THAT(refusal, HasSubstr("found a header of more than 8 MiB"));
}

TEST(DicomHeader, PlacesThatLeadBesideTheirStackAreRefused)
{
  TemporaryFolder folder;
  const auto refusal = [&](const std::string& orientation, double step)
  {
    std::vector<DicomHeader> slices;
    for (int number = 0; number < 3; ++number)
    {
      std::string bytes = Slice(number * step);
      const std::string axes = Element(0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0");
      bytes.replace(bytes.find(axes), axes.size(), Element(0x20, 0x37, "DS", orientation));
      slices.push_back(Read(folder.Write(std::to_string(number), bytes)));
    }
    return RefusalOf([&] { FindSliceOrder(slices); });
  };
  EXPECT_EQ(refusal("1\\0\\0\\0\\1\\0", 2), NotRefused);
  // Heights of a tenth: the third slice would be the twentieth.
  EXPECT_THAT(refusal("0.1\\0\\0\\0\\1\\0", 0.02), HasSubstr("found others"));
  EXPECT_THAT(refusal("0\\0\\0\\0\\0\\0", 2), HasSubstr("found others"));
  EXPECT_THAT(refusal("1\\0\\0\\1\\0\\0", 2), HasSubstr("found others"));
  EXPECT_THAT(refusal("1e200\\0\\0\\0\\1\\0", 2), HasSubstr("found others"));
  EXPECT_THAT(refusal("1\\0\\0\\0\\1\\0", 1e300), HasSubstr("found others"));
}

TEST(DicomHeader, SlicesAreOrderedAlongTheirNormal)
{
  TemporaryFolder folder;
  std::vector<DicomHeader> slices;
  for (const double height : { 12.0, 8.0, 10.0 })
  {
    slices.push_back(Read(folder.Write(std::to_string(height), Slice(height))));
  }
  const SliceOrder order = FindSliceOrder(slices);
  EXPECT_THAT(order.Order, ElementsAre(1, 2, 0));
  EXPECT_EQ(order.Grid.Size, (std::array<int, 3>{ 4, 3, 3 }));
  EXPECT_EQ(order.Grid.Spacing, (Vector3{ 0.75, 0.5, 2 }));
  EXPECT_EQ(order.Grid.Origin, (Vector3{ -10, -20, 8 }));
  slices.push_back(Read(folder.Write("far", Slice(16))));
  EXPECT_THROW(FindSliceOrder(slices), InputError);
  slices.back().Position.reset();
  EXPECT_THROW(FindSliceOrder(slices), InputError);
}
}
