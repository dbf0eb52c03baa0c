// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/LabelVolumeIO.h"

#include <zlib.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>

using mammoray::test::NotRefused;
using mammoray::test::RefusalOf;
using namespace mammoray;
using test::ReadFile;
using test::TemporaryFolder;

namespace
{
std::string ReadMessage(const std::string& path)
{
  return RefusalOf([&] { ReadLabelFile(path); });
}

LabelVolume Oblique(double handedness = 1)
{
  LabelVolume volume;
  volume.Size = { 3, 4, 2 };
  volume.Origin = { 10.5, -20.25, 30 };
  volume.Spacing = { 0.5, 1.5, 2.0 };
  volume.Direction = { { { 0.6, 0.8, 0 }, { -0.8, 0.6, 0 }, { 0, 0, handedness } } };
  for (int voxel = 0; voxel < 24; ++voxel)
  {
    volume.Voxels.push_back(static_cast<std::uint16_t>(10 * voxel));
  }
  return volume;
}

void ExpectSame(const LabelVolume& a, const LabelVolume& b)
{
  EXPECT_EQ(a.Size, b.Size);
  EXPECT_EQ(a.Voxels, b.Voxels);
  for (int d = 0; d < 3; ++d)
  {
    // 1e-7 relative: NIfTI keeps floats.
    EXPECT_NEAR(a.Origin[d], b.Origin[d], 1e-7 * 100);
    EXPECT_NEAR(a.Spacing[d], b.Spacing[d], 1e-7 * 10);
    for (int c = 0; c < 3; ++c)
    {
      EXPECT_NEAR(a.Direction[d][c], b.Direction[d][c], 1e-7) << "axis " << d << ", " << c;
    }
  }
}

template <typename T>
void Put(std::string& bytes, std::size_t offset, T value)
{
  std::memcpy(bytes.data() + offset, &value, sizeof(T));
}

/// NIfTI-1 of bytes (little-endian host), all 0 and in no frame yet; spacings in mm.
std::string EmptyNifti(std::int16_t columns, std::int16_t rows, std::int16_t slices,
  const std::array<float, 3>& spacing)
{
  std::string bytes(352 + static_cast<std::size_t>(columns) * rows * slices, '\0');
  Put<std::int32_t>(bytes, 0, 348);
  const std::int16_t dim[4] = { 3, columns, rows, slices };
  std::memcpy(bytes.data() + 40, dim, sizeof(dim));
  Put<std::int16_t>(bytes, 70, 2);
  const float pixdim[4] = { 1, spacing[0], spacing[1], spacing[2] };
  std::memcpy(bytes.data() + 76, pixdim, sizeof(pixdim));
  Put<float>(bytes, 108, 352);
  bytes[123] = 2;
  std::memcpy(bytes.data() + 344, "n+1", 4);
  return bytes;
}

/// The oblique volume as NIfTI, its LPS frame written as RAS.
std::string ObliqueNifti(bool sform, bool qform)
{
  const LabelVolume volume = Oblique();
  std::string bytes = EmptyNifti(3, 4, 2, { 0.5f, 1.5f, 2.0f });
  const double sign[3] = { -1, -1, 1 };
  if (sform)
  {
    Put<std::int16_t>(bytes, 254, 1);
    for (int c = 0; c < 3; ++c)
    {
      for (int a = 0; a < 3; ++a)
      {
        Put<float>(bytes, 280 + 16 * c + 4 * a,
          static_cast<float>(sign[c] * volume.Spacing[a] * volume.Direction[a][c]));
      }
      Put<float>(bytes, 280 + 16 * c + 12, static_cast<float>(sign[c] * volume.Origin[c]));
    }
  }
  if (qform)
  {
    // Columns (-0.6, -0.8, 0), (0.8, -0.6, 0), (0, 0, 1): a turn about z by atan2(-0.8, -0.6).
    const double half = 0.5 * std::atan2(-0.8, -0.6);
    const double side = std::cos(half) < 0 ? -1 : 1; // the header leaves a >= 0 out
    Put<std::int16_t>(bytes, 252, 1);
    Put<float>(bytes, 264, static_cast<float>(side * std::sin(half)));
    for (int c = 0; c < 3; ++c)
    {
      Put<float>(bytes, 268 + 4 * c, static_cast<float>(sign[c] * volume.Origin[c]));
    }
  }
  for (std::size_t voxel = 0; voxel < volume.Voxels.size(); ++voxel)
  {
    bytes[352 + voxel] = static_cast<char>(volume.Voxels[voxel]);
  }
  return bytes;
}

std::string Gzip(const std::string& path, const std::string& bytes)
{
  gzFile file = gzopen(path.c_str(), "wb");
  gzwrite(file, bytes.data(), static_cast<unsigned>(bytes.size()));
  gzclose(file);
  return path;
}

/// A raw NRRD of 2 x 1 x 1 voxels. The space must come before what is told in it.
std::string Nrrd(const std::string& type, const std::string& data, const std::string& more = "",
  const std::string& space = "space dimension: 3")
{
  return "NRRD0004\ntype: " + type + "\ndimension: 3\n" + space +
    "\nsizes: 2 1 1\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nendian: little\nencoding: raw\n" +
    more + "\n" + data;
}

template <typename T>
std::string Bytes(std::initializer_list<T> values)
{
  return { reinterpret_cast<const char*>(values.begin()), sizeof(T) * values.size() };
}
}

TEST(LabelVolumeIO, WrittenVolumesComeBack)
{
  const TemporaryFolder folder;
  for (const double handedness : { 1.0, -1.0 })
  {
    LabelVolume volume = Oblique(handedness);
    for (const char* name : { "v.nrrd", "v.mha", "v.nii.gz" })
    {
      WriteLabelVolume(volume, folder.File(name));
      ExpectSame(ReadLabelFile(folder.File(name)), volume);
    }
    volume.Voxels[7] = 60000; // 16 bits
    for (const char* name : { "v.nrrd", "v.mha", "v.nii.gz" })
    {
      WriteLabelVolume(volume, folder.File(name));
      ExpectSame(ReadLabelFile(folder.File(name)), volume);
    }
  }
  EXPECT_THAT(RefusalOf([&] { WriteLabelVolume(Oblique(), folder.File("v.nii")); }),
    testing::HasSubstr(".nrrd, .mha or .nii.gz"));
  LabelVolume longer;
  longer.Size = { 40000, 1, 1 };
  longer.Voxels.assign(40000, 1);
  EXPECT_THAT(RefusalOf([&] { WriteLabelVolume(longer, folder.File("v.nii.gz")); }),
    testing::HasSubstr("at most 32767 voxels"));
}

TEST(LabelVolumeIO, IntensitiesKeepSignFractionAndScale)
{
  const TemporaryFolder folder;
  const std::string header = "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 1 2\nencoding: raw\n"
                             "endian: little\nspacings: 1 2 3\n\n";
  const IntensityVolume volume = ReadIntensityFile(
    folder.Write("v.nrrd", header + Bytes<float>({ -1.5f, 0.25f, 70000.0f, 3.0f })));
  EXPECT_THAT(volume.Voxels, testing::ElementsAre(-1.5f, 0.25f, 70000.0f, 3.0f));
  EXPECT_EQ(volume.Spacing, (Vector3{ 1, 2, 3 }));
  EXPECT_THAT(RefusalOf(
                [&] {
                  ReadIntensityFile(
                    folder.Write("n.nrrd", header + Bytes<float>({ 1, 2, 3, std::nanf("") })));
                }),
    testing::HasSubstr("voxel (1, 0, 1) holds nan"));
  // One grid for both readers, whatever the format.
  WriteLabelVolume(Oblique(), folder.File("v.nii.gz"));
  const IntensityVolume oblique = ReadIntensityFile(folder.File("v.nii.gz"));
  const LabelVolume labels = ReadLabelFile(folder.File("v.nii.gz"));
  EXPECT_EQ(oblique.Origin, labels.Origin);
  EXPECT_EQ(oblique.Direction, labels.Direction);
  EXPECT_TRUE(std::equal(labels.Voxels.begin(), labels.Voxels.end(), oblique.Voxels.begin()));
}

TEST(LabelVolumeIO, NiftiTurnsRasIntoLps)
{
  const TemporaryFolder folder;
  ExpectSame(ReadLabelFile(folder.Write("s.nii", ObliqueNifti(true, false))), Oblique());
  ExpectSame(ReadLabelFile(folder.Write("q.nii", ObliqueNifti(false, true))), Oblique());
  ExpectSame(ReadLabelFile(Gzip(folder.File("s.nii.gz"), ObliqueNifti(true, false))), Oblique());
  // In micrometres, and in an unknown unit.
  std::string micro = ObliqueNifti(true, false);
  for (std::size_t number = 0; number < 12; ++number)
  {
    float value = 0;
    std::memcpy(&value, micro.data() + 280 + 4 * number, sizeof value);
    Put<float>(micro, 280 + 4 * number, 1000 * value);
  }
  for (const std::size_t axis : { 0, 1, 2 })
  {
    float value = 0;
    std::memcpy(&value, micro.data() + 80 + 4 * axis, sizeof value);
    Put<float>(micro, 80 + 4 * axis, 1000 * value);
  }
  micro[123] = 3;
  NoteKeeper notes;
  ExpectSame(ReadLabelFile(folder.Write("u.nii", micro)), Oblique());
  EXPECT_THAT(notes.Lines(), testing::IsEmpty());
  micro[123] = 5;
  EXPECT_THAT(ReadMessage(folder.Write("u.nii", micro)), testing::HasSubstr("found 5"));
  const LabelVolume given = ReadLabelFile(folder.File("s.nii"), VolumeAxes::AsGiven);
  EXPECT_EQ(given.Origin[0], -10.5);
  EXPECT_EQ(given.Origin[2], 30);
  // Neither form: spacing alone, nothing to convert.
  notes.Notes.clear();
  const LabelVolume plain = ReadLabelFile(folder.Write("p.nii", ObliqueNifti(false, false)));
  EXPECT_EQ(plain.Direction[0], (Vector3{ 1, 0, 0 }));
  EXPECT_EQ(plain.Spacing, (Vector3{ 0.5, 1.5, 2 }));
  const auto says = testing::AllOf(testing::HasSubstr("qform_code and sform_code are 0"),
    testing::HasSubstr("taken as LPS unless an orientation is set"));
  EXPECT_THAT(notes.Lines(), testing::ElementsAre(says));
  ReadIntensityFile(folder.File("p.nii"));
  EXPECT_THAT(notes.Lines(), testing::ElementsAre(says, says));
}

TEST(LabelVolumeIO, QformsAndSformsThatContradictEachOther)
{
  const TemporaryFolder folder;
  const std::string both = ObliqueNifti(true, true);
  NoteKeeper notes;
  ExpectSame(ReadLabelFile(folder.Write("b.nii", both)), Oblique());
  EXPECT_THAT(notes.Lines(), testing::IsEmpty());
  // The sform mirrors left and right.
  std::string mirrored = both;
  for (const std::size_t axis : { 0, 1, 2 })
  {
    float step = 0;
    std::memcpy(&step, mirrored.data() + 280 + 4 * axis, sizeof step);
    Put<float>(mirrored, 280 + 4 * axis, -step);
  }
  EXPECT_THAT(ReadMessage(folder.Write("m.nii", mirrored)),
    testing::HasSubstr("the mirror image of the other: left and right are not known"));
  // Elsewhere by the sform, which counts if its code is that of the scanner.
  std::string moved = both;
  Put<float>(moved, 280 + 12, -20.5f);
  EXPECT_EQ(ReadLabelFile(folder.Write("s.nii", moved)).Origin[0], 20.5);
  EXPECT_THAT(notes.Lines(),
    testing::ElementsAre(testing::HasSubstr("its qform places the volume up to 10.000 mm from "
                                            "where its sform does; the sform is taken")));
  notes.Notes.clear();
  Put<std::int16_t>(moved, 254, 4);
  EXPECT_EQ(ReadLabelFile(folder.Write("q.nii", moved)).Origin[0], 10.5);
  EXPECT_THAT(notes.Lines(), testing::ElementsAre(testing::HasSubstr("the qform is taken")));
  notes.Notes.clear();
  // Voxels of another size than pixdim says.
  std::string larger = ObliqueNifti(true, false);
  Put<float>(larger, 80, 0.25f);
  EXPECT_NEAR(ReadLabelFile(folder.Write("p.nii", larger)).Spacing[0], 0.5, 1e-6);
  EXPECT_THAT(notes.Lines(),
    testing::ElementsAre(testing::HasSubstr("its pixdim says voxels of 0.25 x 1.5 x 2 mm")));
}

TEST(LabelVolumeIO, SmallShearsAreResampled)
{
  const TemporaryFolder folder;
  // 21 x 21 x 3 voxels of 1 mm, whose j axis leans towards i by 0.1; a block in their middle.
  std::string bytes = EmptyNifti(21, 21, 3, { 1, 1, 1 });
  Put<std::int16_t>(bytes, 254, 1);
  const float rows[12] = { 1, 0.1f, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0 };
  std::memcpy(bytes.data() + 280, rows, sizeof(rows));
  for (int j = 5; j < 16; ++j)
  {
    for (int i = 5; i < 16; ++i)
    {
      bytes[static_cast<std::size_t>(352 + 441 + 21 * j + i)] = 7;
    }
  }
  NoteKeeper notes;
  const LabelVolume volume = ReadLabelFile(folder.Write("s.nii", bytes));
  EXPECT_THAT(notes.Lines(),
    testing::ElementsAre(testing::HasSubstr("its axes are up to 5.71 degrees off right angles")));
  // The middle and points beside the leaning edges, LPS: (-(i + 0.1 j), -j, k).
  EXPECT_EQ(volume.LabelAt({ -11, -10, 1 }), 7);
  EXPECT_EQ(volume.LabelAt({ -11, -10, 0 }), 0);
  for (const double j : { 6.0, 14.0 })
  {
    EXPECT_EQ(volume.LabelAt({ -(6.5 + 0.1 * j), -j, 1 }), 7) << j;
    EXPECT_EQ(volume.LabelAt({ -(14.0 + 0.1 * j), -j, 1 }), 7) << j;
    EXPECT_EQ(volume.LabelAt({ -(3.5 + 0.1 * j), -j, 1 }), 0) << j;
    EXPECT_EQ(volume.LabelAt({ -(17.0 + 0.1 * j), -j, 1 }), 0) << j;
  }
  // The block's volume, to the voxels of its edge.
  EXPECT_NEAR(static_cast<double>(volume.CountLabels().at(7)), 121, 12);
  // Intensities keep a linear field.
  for (int j = 0; j < 21; ++j)
  {
    for (int voxel = 0; voxel < 63; ++voxel)
    {
      bytes[static_cast<std::size_t>(352 + 441 * (voxel / 21) + 21 * j + voxel % 21)] =
        static_cast<char>(voxel % 21 + 3 * j);
    }
  }
  const IntensityVolume image = ReadIntensityFile(folder.Write("i.nii", bytes));
  EXPECT_NEAR(image.ValueAt({ -(10 + 0.1 * 8), -8, 1 }).value_or(0), 10 + 3 * 8, 1e-3);
}

TEST(LabelVolumeIO, LayersOfSegmentsBecomeOneVolume)
{
  const TemporaryFolder folder;
  const auto layered = [](const std::string& pairs, const std::string& voxels)
  {
    return "NRRD0004\ntype: uint8\ndimension: 4\nspace: left-posterior-superior\nsizes: 2 4 1 1\n"
           "space directions: none (1,0,0) (0,1,0) (0,0,1)\nkinds: list domain domain domain\n"
           "encoding: raw\nspace origin: (0,0,0)\n" +
      pairs + "\n" + voxels;
  };
  // fat in layer 0, gland and a cyst in layer 1: the smaller one counts where they meet.
  const std::string pairs = "Segment0_Name:=fat\nSegment0_LabelValue:=1\nSegment0_Layer:=0\n"
                            "Segment1_Name:=gland\nSegment1_LabelValue:=1\nSegment1_Layer:=1\n"
                            "Segment2_Name:=cyst\nSegment2_LabelValue:=2\nSegment2_Layer:=1\n";
  NoteKeeper notes;
  const LabelVolume volume =
    ReadLabelFile(folder.Write("l.seg.nrrd", layered(pairs, std::string("\1\0\1\1\1\2\0\1", 8))));
  EXPECT_THAT(volume.Voxels, testing::ElementsAre(1, 2, 3, 2));
  EXPECT_EQ(volume.Names,
    (std::map<int, std::string>{ { 1, "fat" }, { 2, "gland" }, { 3, "cyst" } }));
  EXPECT_THAT(notes.Lines(),
    testing::ElementsAre(testing::HasSubstr("its segments overlap in 2 voxels, which are given to "
                                            "the smaller segment")));
  EXPECT_THAT(
    ReadMessage(folder.Write("l.seg.nrrd", layered(pairs, std::string("\1\0\1\1\1\3\0\1", 8)))),
    testing::HasSubstr("voxel (2, 0, 0) of layer 1 holds 3, which no segment of the header has"));
  EXPECT_THAT(ReadMessage(folder.Write("l.seg.nrrd", layered("", std::string(8, '\1')))),
    testing::HasSubstr("expected one label per voxel, found 2 and no segments"));
  EXPECT_THAT(ReadMessage(folder.Write("l.seg.nrrd",
                layered("Segment0_Name:=fat\nSegment0_LabelValue:=1\nSegment0_Layer:=5\n",
                  std::string(8, '\1')))),
    testing::HasSubstr("expected a layer from 0 to 1 for segment 'fat', found 5"));
  // As 3D Slicer wrote them before it had layers; labels that differ are kept.
  const LabelVolume old = ReadLabelFile(folder.Write("o.seg.nrrd",
    layered("Segment0_Name:=fat\nSegment1_Name:=gland\n", std::string("\1\0\0\1\0\0\0\0", 8))));
  EXPECT_THAT(old.Voxels, testing::ElementsAre(1, 2, 0, 0));
  const LabelVolume own = ReadLabelFile(folder.Write("w.seg.nrrd",
    layered("Segment0_Name:=fat\nSegment0_LabelValue:=4\nSegment0_Layer:=0\n"
            "Segment1_Name:=gland\nSegment1_LabelValue:=9\nSegment1_Layer:=1\n",
      std::string("\4\0\0\x9\0\0\0\0", 8))));
  EXPECT_THAT(own.Voxels, testing::ElementsAre(4, 9, 0, 0));
}

TEST(LabelVolumeIO, NrrdSpaces)
{
  const TemporaryFolder folder;
  const auto originOf = [&](const std::string& space)
  {
    return ReadLabelFile(
      folder.Write("v.nrrd", Nrrd("uint8", "\1\2", "space origin: (1,2,3)\n", "space: " + space)));
  };
  EXPECT_EQ(originOf("left-posterior-superior").Origin, (Vector3{ 1, 2, 3 }));
  EXPECT_EQ(originOf("RAS").Origin, (Vector3{ -1, -2, 3 }));
  EXPECT_EQ(originOf("RAS").Direction[0][0], -1);
  EXPECT_EQ(originOf("left-anterior-superior").Origin, (Vector3{ 1, -2, 3 }));
  EXPECT_EQ(originOf("left-anterior-superior").Direction[1][1], -1);
  for (const char* space : { "RAS", "left-anterior-superior" })
  {
    originOf(space);
    const LabelVolume given = ReadLabelFile(folder.File("v.nrrd"), VolumeAxes::AsGiven);
    EXPECT_EQ(given.Origin, (Vector3{ 1, 2, 3 })) << space;
    EXPECT_EQ(given.Direction[0], (Vector3{ 1, 0, 0 })) << space;
  }
  for (const char* space : { "RSP", "3D-left-handed" })
  {
    EXPECT_THAT(RefusalOf([&] { originOf(space); }), testing::HasSubstr("space: expected"));
  }
  {
    NoteKeeper scanner;
    EXPECT_EQ(originOf("scanner-xyz").Origin, (Vector3{ 1, 2, 3 }));
    EXPECT_THAT(scanner.Lines(), testing::ElementsAre(testing::HasSubstr("is scanner-xyz: ")));
  }
  NoteKeeper notes;
  originOf("3D-right-handed"); // as our phantoms, whose axes an orientation tells
  EXPECT_THAT(notes.Lines(), testing::IsEmpty());
  const std::string silent = folder.Write("v.nrrd", Nrrd("uint8", "\1\2"));
  ReadLabelFile(silent, VolumeAxes::AsGiven);
  EXPECT_THAT(notes.Lines(), testing::IsEmpty());
  ReadLabelFile(silent);
  EXPECT_THAT(notes.Lines(),
    testing::ElementsAre(silent +
      ": its field 'space' is missing: it does not say where the patient's left, back and head "
      "are; "
      "its axes are taken as LPS unless an orientation is set"));
}

TEST(LabelVolumeIO, EveryScalarTypeAndByteOrder)
{
  const TemporaryFolder folder;
  const auto voxels = [&](const std::string& type, const std::string& data)
  { return ReadLabelFile(folder.Write("v.nrrd", Nrrd(type, data))).Voxels; };
  EXPECT_THAT(voxels("int8", Bytes<std::int8_t>({ 3, 127 })), testing::ElementsAre(3, 127));
  EXPECT_THAT(voxels("short", Bytes<std::int16_t>({ 3, 300 })), testing::ElementsAre(3, 300));
  EXPECT_THAT(voxels("unsigned short", Bytes<std::uint16_t>({ 3, 65535 })),
    testing::ElementsAre(3, 65535));
  EXPECT_THAT(voxels("int", Bytes<std::int32_t>({ 3, 300 })), testing::ElementsAre(3, 300));
  EXPECT_THAT(voxels("uint64", Bytes<std::uint64_t>({ 3, 300 })), testing::ElementsAre(3, 300));
  EXPECT_THAT(voxels("float", Bytes<float>({ 3, 300 })), testing::ElementsAre(3, 300));
  EXPECT_THAT(voxels("double", Bytes<double>({ 3, 300 })), testing::ElementsAre(3, 300));
  std::string big = Nrrd("uint16", std::string("\1\2\0\3", 4));
  big.replace(big.find("little"), 6, "big");
  EXPECT_THAT(ReadLabelFile(folder.Write("b.nrrd", big)).Voxels, testing::ElementsAre(258, 3));
}

TEST(LabelVolumeIO, ValuesThatAreNoLabelsAreNamedWithTheirPlace)
{
  using testing::HasSubstr;
  const TemporaryFolder folder;
  const auto message = [&](const std::string& type, const std::string& data)
  { return ReadMessage(folder.Write("v.nrrd", Nrrd(type, data))); };
  EXPECT_THAT(message("int16", Bytes<std::int16_t>({ 3, -2 })),
    HasSubstr("voxel (1, 0, 0) holds -2"));
  EXPECT_THAT(message("int32", Bytes<std::int32_t>({ 70000, 1 })),
    HasSubstr("(0, 0, 0) holds 70000"));
  EXPECT_THAT(message("float", Bytes<float>({ 1, 0.5f })), HasSubstr("holds 0.5"));
  EXPECT_THAT(message("float", Bytes<float>({ 1, NAN })), HasSubstr("nan"));
  EXPECT_THAT(message("double", Bytes<double>({ 1, INFINITY })), HasSubstr("inf"));
}

TEST(LabelVolumeIO, DamagedFilesAreRefusedInOneLine)
{
  using testing::HasSubstr;
  const TemporaryFolder folder;
  EXPECT_THAT(ReadMessage(folder.File("absent.nrrd")), HasSubstr("no such file"));
  EXPECT_THAT(ReadMessage(folder.Write("v.png", "x")), HasSubstr("found the extension '.png'"));
  for (const char* name : { "v.nrrd", "v.nhdr", "v.mha", "v.mhd", "v.nii", "v.nii.gz" })
  {
    EXPECT_THAT(ReadMessage(folder.Write(name, "")), HasSubstr("found an empty file")) << name;
    EXPECT_THAT(ReadMessage(folder.Write(name, "garbage \xff\xfe garbage")), HasSubstr("expected"));
    EXPECT_THAT(ReadMessage(folder.Write(name, std::string(100000, '\xa5'))),
      HasSubstr("expected"));
  }
  // 10^9 voxels in the header, two bytes in the file.
  std::string huge = Nrrd("uint8", "\1\2");
  huge.replace(huge.find("2 1 1"), 5, "1000 1000 1000");
  EXPECT_THAT(ReadMessage(folder.Write("huge.nrrd", huge)),
    HasSubstr("expected 1000000000 voxels"));
  huge.replace(huge.find("raw"), 3, "gzip");
  EXPECT_THAT(ReadMessage(folder.Write("huge.nrrd", huge)), HasSubstr("too short"));
  huge.replace(huge.find("1000 1000 1000"), 14, "2000000000 2000000000 2000000000");
  EXPECT_THAT(ReadMessage(folder.Write("huge.nrrd", huge)), HasSubstr("more voxels"));

  for (const char* name : { "whole.nrrd", "whole.mha", "whole.nii.gz" })
  {
    WriteLabelVolume(Oblique(), folder.File(name));
    const std::string whole = ReadFile(folder.File(name));
    for (std::size_t cut = 1; cut < whole.size(); cut += 7)
    {
      EXPECT_NE(ReadMessage(folder.Write(name, whole.substr(0, cut))), NotRefused)
        << name << " cut at " << cut;
    }
    // Any damaged byte is refused or harmless; it never crashes.
    for (std::size_t place = 0; place < whole.size(); ++place)
    {
      std::string damaged = whole;
      damaged[place] = static_cast<char>(damaged[place] ^ 0x15);
      ReadMessage(folder.Write(name, damaged));
    }
  }
  // What ends early, in the header and in the voxels, packed or not.
  const std::string nifti = ObliqueNifti(true, false);
  EXPECT_THAT(ReadMessage(folder.Write("cut.nii", nifti.substr(0, 200))),
    HasSubstr("cut.nii: expected NIfTI-1 with a header of 348 bytes, found 200 bytes"));
  const std::string packed = ReadFile(Gzip(folder.File("packed.nii.gz"), nifti));
  for (const std::size_t size : { std::size_t{ 30 }, packed.size() / 2, packed.size() - 9 })
  {
    EXPECT_THAT(ReadMessage(folder.Write("cut.nii.gz", packed.substr(0, size))),
      HasSubstr("found compressed data that is too short or damaged"))
      << size;
  }
  ExpectSame(ReadLabelFile(folder.Write("plain.nii.gz", nifti)), Oblique());
  EXPECT_THAT(ReadMessage(folder.Write("cut.nii", nifti.substr(0, nifti.size() - 1))),
    HasSubstr("expected 24 voxels of 1 bytes, found 23 bytes"));
  const std::string mha = "ObjectType = Image\nNDims = 3\nDimSize = 2 1 1\nElementType = MET_SHORT"
                          "\nElementSpacing = 1 1 1\nElementDataFile = LOCAL\n";
  EXPECT_THAT(ReadLabelFile(folder.Write("cut.mha", mha + Bytes<std::int16_t>({ 5, 6 }))).Voxels,
    testing::ElementsAre(5, 6));
  EXPECT_THAT(ReadMessage(folder.Write("cut.mha", mha + "123")),
    HasSubstr("expected 2 voxels of 2 bytes, found 3 bytes"));
  std::string unsized = mha;
  unsized.insert(unsized.find("ElementDataFile"), "CompressedData = True\n");
  EXPECT_THAT(ReadMessage(folder.Write("unsized.mha", unsized + "123")),
    HasSubstr("compresseddatasize: expected the number of bytes"));
  std::string colours = nifti; // RGB24: three bytes of a voxel
  colours[70] = '\x80';
  colours[71] = '\0';
  colours[72] = 24;
  EXPECT_THAT(ReadMessage(folder.Write("rgb.nii", colours + std::string(48, '\1'))),
    HasSubstr("expected one label per voxel, found 3"));

  std::string sheared = Nrrd("uint8", "\1\2");
  sheared.replace(sheared.find("(0,1,0)"), 7, "(1,1,0)");
  EXPECT_THAT(ReadMessage(folder.Write("s.nrrd", sheared)), HasSubstr("orthonormal"));
  // Of lengths whose squares are infinite ITK makes spacings of 1.
  for (const char* length : { "1e308", "nan", "inf", "-1e200" })
  {
    std::string endless = Nrrd("uint8", "\1\2");
    endless.replace(endless.find("(0,1,0)"), 7, "(0," + std::string(length) + ",0)");
    EXPECT_THAT(ReadMessage(folder.Write("e.nrrd", endless)),
      HasSubstr("spacedirections: expected numbers of mm up to 1e6"));
    std::string meta = mha + Bytes<std::int16_t>({ 5, 6 });
    meta.replace(meta.find("1 1 1\nElementDataFile"), 5, "1 " + std::string(length) + " 1");
    EXPECT_THAT(ReadMessage(folder.Write("e.mha", meta)),
      HasSubstr("elementspacing: expected numbers of mm up to 1e6"));
  }
  EXPECT_THAT(ReadMessage(folder.Write("d.nhdr", Nrrd("uint8", "", "data file: no.raw\n"))),
    HasSubstr("no.raw is missing"));
}

TEST(LabelVolumeIO, DetachedHeaders)
{
  const TemporaryFolder folder;
  folder.Write("d.raw", "xyz\1\2");
  const std::string header =
    folder.Write("d.nhdr", Nrrd("uint8", "", "data file: d.raw\nbyte skip: 3\n"));
  EXPECT_THAT(ReadLabelFile(header).Voxels, testing::ElementsAre(1, 2));
  folder.Write("e.nhdr", Nrrd("uint8", "", "data file: d.raw\nbyte skip: -1\n"));
  EXPECT_THAT(ReadLabelFile(folder.File("e.nhdr")).Voxels, testing::ElementsAre(1, 2));
  const std::string mhd = folder.Write("d.mhd",
    "ObjectType = Image\nNDims = 3\nDimSize = 2 1 1\nElementType = MET_UCHAR\nElementSpacing = 1 1 "
    "1\nHeaderSize = 3\nElementDataFile = d.raw\n");
  EXPECT_THAT(ReadLabelFile(mhd).Voxels, testing::ElementsAre(1, 2));
}

namespace
{
LabelVolume Named()
{
  LabelVolume volume = Oblique();
  for (std::uint16_t& voxel : volume.Voxels)
  {
    voxel = static_cast<std::uint16_t>(voxel / 10 % 5);
  }
  volume.Names = { { 1, "fat" }, { 2, "gland" }, { 3, "skin" }, { 4, "chest-wall" } };
  return volume;
}

/// The header of a .seg.nrrd of two voxels, with pairs of segments.
std::string SegmentFile(const std::string& pairs)
{
  return "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 1 1\n"
         "space directions: (1,0,0) (0,1,0) (0,0,1)\nkinds: domain domain domain\n"
         "encoding: raw\nspace origin: (0,0,0)\n" +
    pairs + "\n\1\2";
}
}

TEST(LabelVolumeIO, SegmentsOfSlicerComeBack)
{
  const TemporaryFolder folder;
  const LabelVolume volume = Named();
  const std::string path = folder.File("labels.seg.nrrd");
  WriteLabelVolume(volume, path);
  const LabelVolume read = ReadLabelFile(path);
  ExpectSame(read, volume);
  EXPECT_EQ(read.Names, volume.Names);
  // All that 3D Slicer needs to show them (Slicer's developer guide, .seg.nrrd).
  const std::string bytes = ReadFile(path);
  for (const char* pair : { "Segment1_ID:=Segment_2", "Segment1_Name:=gland",
         "Segment1_LabelValue:=2", "Segment1_Layer:=0", "Segment1_Extent:=0 2 0 3 0 1",
         "Segment1_Color:=0.337255 0.705882 0.913725", "~SCT^82038008^Skin of breast~",
         "Segmentation_ContainedRepresentationNames:=Binary labelmap|" })
  {
    EXPECT_THAT(bytes, testing::HasSubstr(pair));
  }
  EXPECT_FALSE(std::filesystem::exists(folder.File("labels.txt")));
}

TEST(LabelVolumeIO, LabelDescriptionsOfItkSnapComeBack)
{
  const TemporaryFolder folder;
  const LabelVolume volume = Named();
  for (const char* name : { "a.nii.gz", "b.mha", "c.nrrd" })
  {
    const std::string path = folder.File(name);
    WriteLabelVolume(volume, path);
    EXPECT_EQ(ReadLabelFile(path).Names, volume.Names) << name;
    EXPECT_EQ(LabelDescriptionOf(path), folder.File(std::string(1, name[0]) + ".txt"));
  }
  const std::string description = ReadFile(folder.File("a.txt"));
  EXPECT_THAT(description, testing::HasSubstr("# ITK-SnAP Label Description File"));
  EXPECT_THAT(description,
    testing::HasSubstr("    2    86  180  233        1  1  1    \"gland\"\n"));
  // As ITK-SNAP writes it, with labels of its own, and by a program with other ends of lines.
  folder.Write("a.txt",
    "################################################\r\n# ITK-SnAP Label Description File\r\n"
    "    0     0    0    0        0  0  0    \"Clear Label\"\r\n"
    "    1   255    0    0        1  1  1    \"skin\"\r\n\r\n"
    "    7     0  255    0     0.50  1  0    \"Label 7\"\r\n");
  EXPECT_THAT(ReadLabelFile(folder.File("a.nii.gz")).Names,
    testing::ElementsAre(testing::Pair(1, "skin"), testing::Pair(7, "Label 7")));
  folder.Write("a.txt",
    "# ITK-SnAP Label Description File\r    1 9 9 9 1 1 1 \"fat\"\r\r"
    "    2 9 9 9 1 1 1 \"gland\"");
  EXPECT_THAT(ReadLabelFile(folder.File("a.nii.gz")).Names,
    testing::ElementsAre(testing::Pair(1, "fat"), testing::Pair(2, "gland")));
  // Another text is none of its business.
  folder.Write("a.txt", "1 how this was made\n");
  EXPECT_THAT(ReadLabelFile(folder.File("a.nii.gz")).Names, testing::IsEmpty());
}

TEST(LabelVolumeIO, NamesAreThoseOfSegmentsInWhateverOrder)
{
  const TemporaryFolder folder;
  const auto names = [&folder](const std::string& pairs)
  { return ReadLabelFile(folder.Write("a.seg.nrrd", SegmentFile(pairs))).Names; };
  EXPECT_THAT(names("Segment0_ID:=b\nSegment0_LabelValue:=2\nSegment0_Layer:=0\n"
                    "Segment0_Name:=fat\nSegment1_LabelValue:=1\nSegment1_Name:=gland\n"),
    testing::ElementsAre(testing::Pair(1, "gland"), testing::Pair(2, "fat")));
  EXPECT_THAT(names("Segment0_ID:=Segment_3\nSegment0_LabelValue:=2\n"),
    testing::ElementsAre(testing::Pair(2, "Segment_3")));
  EXPECT_THAT(names("Segmentation_SourceRepresentation:=Binary labelmap\nAuthor:=nobody\n"),
    testing::IsEmpty());
}

TEST(LabelVolumeIO, ContradictoryNamesAreRefused)
{
  const TemporaryFolder folder;
  const auto refusal = [&folder](const std::string& pairs)
  { return ReadMessage(folder.Write("a.seg.nrrd", SegmentFile(pairs))); };
  const std::string fat = "Segment0_Name:=fat\nSegment0_LabelValue:=1\n";
  EXPECT_THAT(refusal(fat + "Segment1_Name:=gland\nSegment1_LabelValue:=1\n"),
    testing::HasSubstr("a.seg.nrrd: expected one name for label 1, found 'fat' and 'gland'"));
  EXPECT_THAT(refusal("Segment0_Name:=fat\nSegment0_LabelValue:=one\n"),
    testing::HasSubstr(
      "Segment0_LabelValue: expected a whole number from 1 to 65535, found 'one'"));
  const std::string mark = "# ITK-SnAP Label Description File\n";
  folder.Write("a.txt", mark + "1 255 0 0 1 1 1 \"gland\"\n");
  EXPECT_THAT(refusal(fat),
    testing::AllOf(testing::HasSubstr("found 'fat' in it and 'gland' in"),
      testing::HasSubstr("a.txt beside it")));
  folder.Write("a.txt", mark + "1 255 0 0 1 1 1 \"fat\"\n");
  EXPECT_EQ(refusal(fat), NotRefused);
  for (const char* line : { "1 255 0 0 1 1 \"fat\"", "1 255 0 0 1 1 1 fat",
         "x 255 0 0 1 1 1 \"fat\"", "1 255 0 0 1 1 1 1 \"fat\"", "1.5 255 0 0 1 1 1 \"fat\"" })
  {
    folder.Write("a.txt", mark + line + "\n");
    EXPECT_THAT(refusal(fat), testing::HasSubstr("a.txt: line 2: expected a label, its colour"))
      << line;
  }
}

TEST(LabelVolumeIO, TheThreeFormatsOfThePhantomsAreOneVolume)
{
  const std::string folder = test::SharedDataFolder() + "/breastphantom-hetero-2002/";
  if (!std::filesystem::exists(folder))
  {
    GTEST_SKIP() << "shared data are absent";
  }
  const LabelVolume nrrd = ReadLabelFile(folder + "labels.nrrd");
  EXPECT_EQ(nrrd.Size, (std::array<int, 3>{ 150, 180, 180 }));
  EXPECT_EQ(nrrd.Origin, (Vector3{ -9.25, -53.4013, -44.9684 }));
  EXPECT_EQ(nrrd.CountLabels().at(29), 591310u);
  EXPECT_EQ(nrrd.CountLabels().at(225), 9702u);
  // Its NIfTI calls the phantom's own axes RAS, so they are taken as given.
  for (const LabelVolume& other : { ReadLabelFile(folder + "labels.mha"),
         ReadLabelFile(folder + "labels.nii.gz", VolumeAxes::AsGiven) })
  {
    EXPECT_EQ(other.Size, nrrd.Size);
    EXPECT_EQ(other.Origin, nrrd.Origin);
    EXPECT_EQ(other.Spacing, nrrd.Spacing);
    EXPECT_EQ(other.Direction, nrrd.Direction);
    EXPECT_TRUE(other.Voxels == nrrd.Voxels);
  }
}
