// SPDX-License-Identifier: Apache-2.0
// DICOM series and segmentations as label volumes.
#include "DicomBytes.h"
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

using namespace mammoray;
using testing::HasSubstr;
using namespace mammoray::test;

namespace
{
const std::string SharedData = test::SharedDataFolder();

// The oblique grid of the tests.
const Vector3 AlongRow{ 0.8, 0.6, 0 };
const Vector3 AlongColumn{ 0, 0, -1 };
const Vector3 Normal = Cross(AlongRow, AlongColumn);
const Vector3 First{ 10, -20, 30 };
constexpr double SliceSpacing = 2.5;

std::string Position(double slice)
{
  const Vector3 at = First + slice * SliceSpacing * Normal;
  return Element(0x20, 0x32, "DS", Join({ at[0], at[1], at[2] }));
}

const std::string Orientation = Element(0x20, 0x37, "DS", Join({ 0.8, 0.6, 0, 0, 0, -1 }));

/// Rows 0.5 mm and columns 0.75 mm apart.
const std::string Spacing = Element(0x28, 0x30, "DS", "0.5\\0.75");

std::string Bits(int bits)
{
  return Element(0x28, 0x100, "US", Us(bits)) + Element(0x28, 0x101, "US", Us(bits)) +
    Element(0x28, 0x102, "US", Us(bits - 1)) + Element(0x28, 0x103, "US", Us(0));
}

int LabelOf(int i, int j, int k)
{
  return 300 * (k + 1) + 5 * j + i; // beyond 8 bits
}

/// Four columns and three rows.
std::string SliceFile(int k, double place, const std::string& series = "1.2.3")
{
  const std::string instance = std::string("1.2.3.").append(std::to_string(k + 1));
  std::string pixels;
  for (int j = 0; j < 3; ++j)
  {
    for (int i = 0; i < 4; ++i)
    {
      pixels += Us(LabelOf(i, j, k));
    }
  }
  return DicomBytes("1.2.840.10008.5.1.4.1.1.4", instance,
    Element(8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.4") + Element(8, 0x18, "UI", instance) +
      Element(8, 0x60, "CS", "MR") + Element(0x18, 0x50, "DS", "2") +
      Element(0x20, 0xe, "UI", series) + Position(place) + Orientation +
      Element(0x28, 2, "US", Us(1)) + Element(0x28, 4, "CS", "MONOCHROME2") +
      Element(0x28, 0x10, "US", Us(3)) + Element(0x28, 0x11, "US", Us(4)) + Spacing + Bits(16) +
      Element(0x7fe0, 0x10, "OW", pixels));
}

struct Frame
{
  double Place;
  int Segment;
  std::vector<int> Values; // 4 x 3
};

/// `names`: those of the segments from 1 on.
std::string SegmentationFile(const std::vector<Frame>& frames, int bits,
  const std::vector<std::string>& names = {})
{
  std::vector<std::string> described;
  for (const std::string& name : names)
  {
    described.push_back(Element(0x62, 4, "US", Us(static_cast<int>(described.size()) + 1)) +
      Element(0x62, 5, "LO", name));
  }
  std::vector<std::string> groups;
  std::string pixels;
  std::size_t count = 0;
  for (const Frame& frame : frames)
  {
    groups.push_back(Sequence(0x20, 0x9113, { Position(frame.Place) }) +
      Sequence(0x62, 0xa, { Element(0x62, 0xb, "US", Us(frame.Segment)) }));
    for (const int value : frame.Values)
    {
      if (bits == 8)
      {
        pixels.push_back(static_cast<char>(value));
      }
      else
      {
        pixels.resize(count / 8 + 1, '\0');
        pixels.back() = static_cast<char>(pixels.back() | value << count % 8);
        ++count;
      }
    }
  }
  const std::string shared = Sequence(0x20, 0x9116, { Orientation }) +
    Sequence(0x28, 0x9110, { Element(0x18, 0x88, "DS", "2.5") + Spacing });
  return DicomBytes("1.2.840.10008.5.1.4.1.1.66.4", "1.2.4",
    Element(8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.66.4") + Element(8, 0x18, "UI", "1.2.4") +
      Element(8, 0x60, "CS", "SEG") + Element(0x28, 2, "US", Us(1)) +
      Element(0x28, 4, "CS", "MONOCHROME2") +
      Element(0x28, 8, "IS", std::to_string(frames.size())) + Element(0x28, 0x10, "US", Us(3)) +
      Element(0x28, 0x11, "US", Us(4)) + Bits(bits) +
      (names.empty() ? "" : Sequence(0x62, 2, described)) +
      (bits == 8 ? Element(0x62, 0xe, "US", Us(200)) : "") + Sequence(0x5200, 0x9229, { shared }) +
      Sequence(0x5200, 0x9230, groups) + Element(0x7fe0, 0x10, "OB", pixels));
}

void ExpectGeometry(const LabelVolume& volume, int slices)
{
  EXPECT_EQ(volume.Size, (std::array<int, 3>{ 4, 3, slices }));
  // Ten digits in the files.
  for (const auto& [i, j, k] :
    { std::array<int, 3>{ 0, 0, 0 }, { 3, 0, 0 }, { 0, 2, 0 }, { 3, 2, slices - 1 } })
  {
    const Vector3 expected =
      First + i * 0.75 * AlongRow + j * 0.5 * AlongColumn + k * SliceSpacing * Normal;
    EXPECT_LT(Norm(volume.PointAt(i, j, k) - expected), 1e-8) << i << ' ' << j << ' ' << k;
  }
}

std::string LabelsRefusal(const std::string& path)
{
  return RefusalOf([&] { ReadLabelVolume(path); });
}
}

TEST(DicomLabels, SeriesKeepsItsObliqueGrid)
{
  TemporaryFolder folder;
  // Names in another order than places, and a file that is no DICOM.
  folder.Write("a.dcm", SliceFile(2, 2));
  folder.Write("b.dcm", SliceFile(0, 0));
  folder.Write("c.dcm", SliceFile(1, 1));
  folder.Write("notes.txt", "no slice");
  const LabelVolume volume = ReadLabelVolume(folder.File(""));
  ExpectGeometry(volume, 3);
  for (int k = 0; k < 3; ++k)
  {
    for (int j = 0; j < 3; ++j)
    {
      for (int i = 0; i < 4; ++i)
      {
        EXPECT_EQ(volume.Voxels[volume.Index(i, j, k)], LabelOf(i, j, k));
      }
    }
  }
  folder.Write("d.dcm", SliceFile(3, 4));
  EXPECT_THAT(LabelsRefusal(folder.File("")), HasSubstr("even distances"));
  folder.Write("d.dcm", SliceFile(3, 2));
  EXPECT_THAT(LabelsRefusal(folder.File("")), HasSubstr("found two at one"));
  folder.Write("d.dcm", SliceFile(3, 3, "1.2.9"));
  EXPECT_THAT(LabelsRefusal(folder.File("")), HasSubstr("one series"));
  const std::string whole = SliceFile(3, 3);
  folder.Write("d.dcm", whole.substr(0, whole.size() - 5));
  EXPECT_THAT(LabelsRefusal(folder.File("")), HasSubstr("cut short or damaged"));
  EXPECT_THAT(LabelsRefusal(folder.File("a.dcm")), HasSubstr("is read from its folder"));
  std::filesystem::create_directory(folder.File("empty"));
  EXPECT_THAT(LabelsRefusal(folder.File("empty")), HasSubstr("found none"));
}

TEST(DicomSeries, IsReadFromItsFilesWhateverLiesBeside)
{
  TemporaryFolder folder;
  std::vector<std::string> files;
  for (const int k : { 2, 0, 1 })
  {
    files.push_back(folder.Write("IM" + std::to_string(k), SliceFile(k, k)));
  }
  folder.Write("other", SliceFile(7, 7, "1.2.9"));
  const IntensityVolume volume = ReadIntensitySeries(files);
  EXPECT_EQ(volume.Size, (std::array<int, 3>{ 4, 3, 3 }));
  EXPECT_EQ(volume.Voxels[volume.Index(1, 2, 1)], LabelOf(1, 2, 1));
  files.push_back(folder.File("other"));
  EXPECT_THROW(ReadIntensitySeries(files), InputError);
  EXPECT_THROW(ReadIntensitySeries({}), InputError);
  EXPECT_THROW(ReadIntensitySeries({ files[0] }, [](double, const char*) { return false; }),
    Interrupted);
}

TEST(DicomSeries, DecimalsThatWereRoundedDoNotAddUp)
{
  // A spacing of 3.3333 mm whose places are written with two decimals: 0.003 mm each, and no more.
  TemporaryFolder folder;
  std::vector<std::string> files;
  for (int k = 0; k < 24; ++k)
  {
    const double place = std::round(100 * k * 10.0 / 3) / 100 / SliceSpacing;
    files.push_back(folder.Write(std::to_string(k), SliceFile(k, place)));
  }
  const IntensityVolume volume = ReadIntensitySeries(files);
  EXPECT_EQ(volume.Size[2], 24);
  EXPECT_NEAR(volume.Spacing[2], 10.0 / 3, 1e-3);
}

TEST(DicomLabels, BinarySegmentsWithEmptySlicesLeftOut)
{
  TemporaryFolder folder;
  const std::vector<int> one{ 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1 };
  const std::vector<int> two{ 0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0 };
  const std::vector<Frame> frames{ { 0, 7, one }, { 3, 7, two }, { 0, 1, two } };
  const LabelVolume volume = ReadLabelVolume(folder.Write("seg.dcm", SegmentationFile(frames, 1)));
  ExpectGeometry(volume, 4);
  std::vector<std::uint16_t> expected(48, 0);
  for (const auto& [voxel, label] :
    { std::pair{ 0, 7 }, { 1, 7 }, { 11, 7 }, { 2, 1 }, { 3, 1 }, { 38, 7 }, { 39, 7 } })
  {
    expected[static_cast<std::size_t>(voxel)] = static_cast<std::uint16_t>(label);
  }
  EXPECT_EQ(volume.Voxels, expected);
}

TEST(DicomLabels, SegmentsAtUnevenDistancesAreRefused)
{
  const TemporaryFolder folder;
  const std::vector<int> one{ 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1 };
  // On a grid of a fifth of the distance there would be air between all slices.
  EXPECT_THAT(LabelsRefusal(folder.Write("seg.dcm",
                SegmentationFile({ { 0, 1, one }, { 1, 1, one }, { 2.2, 1, one } }, 1))),
    testing::HasSubstr("expected slices at even distances"));
}

TEST(DicomLabels, FractionsCountFromAHalf)
{
  TemporaryFolder folder;
  const std::vector<int> values{ 0, 99, 100, 200, 0, 0, 0, 0, 0, 0, 0, 150 };
  const LabelVolume volume = ReadLabelVolume(
    folder.Write("seg.dcm", SegmentationFile({ { 0, 2, values }, { 1, 2, values } }, 8)));
  ExpectGeometry(volume, 2);
  EXPECT_EQ(volume.CountLabels().at(2), 6u);
  EXPECT_EQ(volume.Voxels[1], 0);
  EXPECT_EQ(volume.Voxels[2], 2);
}

TEST(DicomLabels, FractionsNeedTheirMaximum)
{
  TemporaryFolder folder;
  const std::vector<int> values{ 0, 99, 100, 200, 0, 0, 0, 0, 0, 0, 0, 150 };
  const std::string whole = SegmentationFile({ { 0, 2, values }, { 1, 2, values } }, 8);
  const std::string maximum = Element(0x62, 0xe, "US", Us(200));
  const auto with = [&](const std::string& other)
  {
    std::string changed = whole;
    changed.replace(changed.find(maximum), maximum.size(), other);
    return LabelsRefusal(folder.Write("seg.dcm", changed));
  };
  EXPECT_THAT(with(""),
    HasSubstr("expected Maximum Fractional Value (0062,000E) of fractions up to "
              "200, found none"));
  EXPECT_THAT(with(Element(0x62, 0xe, "US", Us(100))), HasSubstr("up to 200, found 100"));
  EXPECT_THAT(with(Element(0x62, 0xe, "US", Us(1000))),
    HasSubstr("half of the Maximum Fractional Value 1000, the largest is 200 (flags"));
  const std::vector<int> ones{ 0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0 };
  NoteKeeper notes;
  ReadLabelVolume(folder.Write("seg.dcm", SegmentationFile({ { 0, 2, ones }, { 1, 2, ones } }, 8)));
  EXPECT_THAT(notes.Lines(), testing::ElementsAre(HasSubstr("the largest is 1 (flags in place")));
  // Bits that are stored as bytes.
  std::string binary = SegmentationFile({ { 0, 2, ones }, { 1, 2, ones } }, 8);
  binary.replace(binary.find(maximum), maximum.size(), "");
  EXPECT_EQ(ReadLabelVolume(folder.Write("seg.dcm", binary)).CountLabels().at(2), 4u);
}

TEST(DicomLabels, SegmentsWithoutAnyFractionOfAHalfAreNoted)
{
  TemporaryFolder folder;
  const std::vector<Frame> frames{ { 0, 1, std::vector<int>(12, 120) },
    { 0, 2, std::vector<int>(12, 80) }, { 1, 1, std::vector<int>(12, 30) },
    { 1, 2, std::vector<int>(12, 30) }, { 1, 3, std::vector<int>(12, 0) } };
  NoteKeeper notes;
  const LabelVolume volume = ReadLabelVolume(
    folder.Write("seg.dcm", SegmentationFile(frames, 8, { "fat", "gland", "skin" })));
  EXPECT_EQ(volume.CountLabels().count(2), 0u);
  // Not of segment 1, which reaches it somewhere, nor of 3, which is empty.
  EXPECT_THAT(notes.Lines(),
    testing::ElementsAre(HasSubstr(
      "no fraction of segment 2 reaches half of 200, the largest is 80: nothing is inside "
      "(of 'gland')")));
}

TEST(DicomLabels, FramesOfSegmentsThatAreNotDescribedAreRefused)
{
  TemporaryFolder folder;
  const std::vector<int> values{ 0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1 };
  const std::vector<Frame> frames{ { 0, 1, values }, { 1, 5, values } };
  EXPECT_THAT(
    LabelsRefusal(folder.Write("seg.dcm", SegmentationFile(frames, 1, { "fat", "gland" }))),
    HasSubstr("frame 2: expected a segment that the file describes (1 'fat', 2 'gland'), found "
              "number 5"));
}

TEST(DicomLabels, LabelMapsHoldTheNumbersOfSegments)
{
  TemporaryFolder folder;
  const std::vector<int> values{ 0, 1, 2, 200, 0, 0, 0, 0, 0, 0, 0, 1 };
  std::string map = SegmentationFile({ { 0, 0, values }, { 1, 0, values } }, 8);
  const std::string maximum = Element(0x62, 0xe, "US", Us(200));
  map.replace(map.find(maximum), maximum.size(),
    Element(0x62, 1, "CS", "LABELMAP") +
      Sequence(0x62, 2,
        { Element(0x62, 4, "US", Us(1)) + Element(0x62, 5, "LO", "Fat"),
          Element(0x62, 4, "US", Us(200)) + Element(0x62, 5, "LO", "Gland") }));
  const LabelVolume volume = ReadLabelVolume(folder.Write("seg.dcm", map));
  EXPECT_EQ(volume.CountLabels().at(1), 4u);
  EXPECT_EQ(volume.CountLabels().at(2), 2u);
  EXPECT_EQ(volume.CountLabels().at(200), 2u);
  EXPECT_EQ(volume.Names, (std::map<int, std::string>{ { 1, "Fat" }, { 200, "Gland" } }));
}

TEST(DicomLabels, SegmentationOfRealBreastWithUndefinedLengths)
{
  const std::string path = SharedData + "/ispy1-breast-voi-seg/ispy1_1001_breast_voi_seg.dcm";
  if (!std::filesystem::exists(path))
  {
    GTEST_SKIP() << "absent: " << path;
  }
  const LabelVolume volume = ReadLabelVolume(path);
  // What the data's own description says.
  EXPECT_EQ(volume.Size, (std::array<int, 3>{ 256, 256, 27 }));
  EXPECT_EQ(volume.Spacing, (Vector3{ 0.78125, 0.78125, 2 }));
  EXPECT_EQ(volume.CountLabels().at(1), 45993u);
  EXPECT_EQ(volume.Direction[0], (Vector3{ 0, 1, 0 }));
  EXPECT_EQ(volume.Direction[1], (Vector3{ 0, 0, -1 }));
}

TEST(DicomLabels, SegmentationOfSeveralSegments)
{
  const std::string path = SharedData + "/duke-breast-mri-153-CC-BY-NC-4.0/seg_fgt_fat.dcm";
  if (!std::filesystem::exists(path))
  {
    GTEST_SKIP() << "absent: " << path;
  }
  const LabelVolume volume = ReadLabelVolume(path);
  EXPECT_EQ(volume.Size[0], 448);
  EXPECT_EQ(volume.Size[1], 448);
  EXPECT_NEAR(volume.Spacing[0], 0.758929, 1e-6);
  // From z = -96.706 to 34.194. The file tells 1 mm, but its slices lie on multiples of 1.1 mm.

  EXPECT_EQ(volume.Size[2], 120);
  EXPECT_NEAR(volume.Spacing[2], 1.1, 1e-6);
  std::map<int, std::size_t> counts = volume.CountLabels();
  // What the data's own description says. Segments 2 and 5, gland and fat, share a slice, and what
  // both claim belongs to the smaller one.
  EXPECT_EQ(counts[1], 3605u);
  EXPECT_EQ(counts[2], 4099u);
  EXPECT_EQ(counts[3], 23588u);
  EXPECT_EQ(counts[4], 20967u);
  EXPECT_LE(counts[5], 64296u);
  EXPECT_GE(counts[5], 64296u - 4099u);
}

TEST(DicomLabels, RefusesASegmentationOfOtherSizesThanItsPixels)
{
  TemporaryFolder folder;
  const std::vector<int> values{ 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0 };
  const std::string whole =
    SegmentationFile({ { 0, 1, values }, { 1, 1, values }, { 2, 1, values }, { 3, 1, values } }, 8);
  const auto with = [&](const std::string& was, const std::string& is)
  {
    std::string changed = whole;
    changed.replace(changed.find(was), was.size(), is);
    return folder.Write("seg.dcm", changed);
  };
  const std::string columns = Element(0x28, 0x11, "US", Us(4));
  EXPECT_EQ(LabelsRefusal(with(columns, columns)), test::NotRefused);
  EXPECT_THAT(LabelsRefusal(with(columns, Element(0x28, 0x11, "US", Us(2)))),
    HasSubstr("expected 24 bytes of uncompressed pixels, found 48"));
  EXPECT_THAT(LabelsRefusal(with(Element(0x28, 8, "IS", "4"), Element(0x28, 8, "IS", "8"))),
    HasSubstr("expected functional groups for each of 8 frames, found 4"));
}
