// SPDX-License-Identifier: Apache-2.0
// The forms in which scanners and archives store one volume: enhanced objects of many frames, files
// without preamble.
#include "DicomBytes.h"
#include "Files.h"
#include "MadeUpFrames.h"
#include "MadeUpStudy.h"
#include "Refusals.h"
#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Dicom/DicomReader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using namespace mammoray;
using namespace mammoray::test;
using testing::HasSubstr;

namespace
{
/// Two phases of three slices, 3 mm apart, of 3 x 4 pixels; heights in no order.
MadeUpObject TwoPhases()
{
  MadeUpObject object;
  object.Rows = 3;
  object.Columns = 4;
  for (const int phase : { 1, 2 })
  {
    for (const int slice : { 2, 0, 1 })
    {
      object.Frames.push_back(
        { 3.0 * slice, phase, 100 * phase + slice, 0.5 * phase, -10.0 * slice });
    }
  }
  return object;
}

/// Bytes without the preamble and the meta information.
std::string DataSetAlone(const std::string& file)
{
  // Of group 2, whose length is the value of its first element (UL).
  const auto* length = reinterpret_cast<const unsigned char*>(file.data()) + 132 + 8;
  return file.substr(132 + 12 + length[0] + 256u * length[1]);
}
}

TEST(DicomFrames, EachSaysWhatItsFunctionalGroupsSay)
{
  TemporaryFolder folder;
  const std::string path = folder.Write("enhanced", EnhancedMr(TwoPhases()));
  const std::vector<DicomHeader> frames = ReadDicomHeaders(path);
  ASSERT_EQ(frames.size(), 6u);
  const DicomHeader& fourth = frames[3];
  EXPECT_EQ(fourth.Frame, 4);
  EXPECT_EQ(fourth.Position, (Vector3{ -175, -100, 6 }));
  EXPECT_EQ(fourth.RowSpacingMm, 5);
  EXPECT_EQ(fourth.SliceSpacingMm, 3);
  EXPECT_EQ(fourth.TemporalPosition, 2);
  EXPECT_EQ(fourth.EchoTimeMs, 1.7);
  EXPECT_EQ(fourth.RepetitionTimeMs, 4.3);
  EXPECT_EQ(fourth.SpectralSuppression, "FAT");
  EXPECT_THAT(fourth.ScanningSequence, testing::ElementsAre("GR"));
  EXPECT_THAT(fourth.ImageType, testing::ElementsAre("ORIGINAL", "PRIMARY", "M", "NONE"));
  EXPECT_EQ(fourth.AcquisitionDate, "20260110");
  EXPECT_EQ(fourth.AcquisitionTime, "101512");
  EXPECT_EQ(fourth.PatientPosition, "HFP");
  EXPECT_EQ(fourth.Identity.PatientId, "P1");
  EXPECT_EQ(fourth.Frames, 1);
  // The object as a whole.
  EXPECT_EQ(ReadDicomHeader(path)->Frames, 6);
  EXPECT_EQ(ReadDicomHeader(path)->Frame, 0);
}

TEST(DicomFrames, MakeAVolumeEachAfterItsOwnRescaling)
{
  TemporaryFolder folder;
  const std::string path = folder.Write("enhanced.dcm", EnhancedMr(TwoPhases()));
  const IntensityVolume second = ReadIntensitySlices({ { path, 5 }, { path, 4 }, { path, 6 } });
  EXPECT_EQ(second.Size, (std::array<int, 3>{ 4, 3, 3 }));
  EXPECT_EQ(second.Spacing, (Vector3{ 5, 5, 3 }));
  for (int slice = 0; slice < 3; ++slice)
  {
    EXPECT_EQ(second.Voxels[second.Index(3, 2, slice)], 200 + slice - 10 * slice);
  }
  const auto refusal = [&](const std::vector<DicomSlice>& slices)
  { return RefusalOf([&] { ReadIntensitySlices(slices); }); };
  EXPECT_THAT(refusal({ { path, 7 } }), HasSubstr("expected frames 1 to 6, found number 7"));
  EXPECT_THAT(refusal({ { path, 1 }, { path, 4 } }), HasSubstr("found two at one"));
  // All frames of a file are one volume, or none.
  EXPECT_THAT(RefusalOf([&] { ReadIntensityVolume(path); }), HasSubstr("found two at one"));
  MadeUpObject one = TwoPhases();
  one.Frames.resize(3);
  EXPECT_EQ(ReadIntensityVolume(folder.Write("one.dcm", EnhancedMr(one))).Size[2], 3);
  one.Said = 4;
  EXPECT_THAT(RefusalOf([&] { ReadDicomHeaders(folder.Write("less.dcm", EnhancedMr(one))); }),
    HasSubstr("of 4 frames, found 3"));
  const std::string whole = EnhancedMr(TwoPhases());
  const std::string cut = folder.Write("cut.dcm", whole.substr(0, whole.size() - 30));
  EXPECT_THAT(refusal({ { cut, 4 } }), HasSubstr("cut.dcm"));
}

TEST(DicomForms, ADataSetWithoutPreambleIsDicom)
{
  TemporaryFolder folder;
  std::vector<std::string> files;
  for (int slice = 0; slice < 3; ++slice)
  {
    MadeUpHeader header = MadeUpMr("1.2.5", "t1");
    header.Set(0x20, 0x32, "DS", Join({ -175, -100, 3.0 * slice }));
    const std::string number = std::to_string(slice);
    files.push_back(folder.Write(number, DataSetAlone(header.Bytes(number))));
  }
  EXPECT_EQ(ReadDicomHeader(files[1])->SeriesDescription, "t1");
  const IntensityVolume volume = ReadIntensitySeries(files);
  EXPECT_EQ(volume.Size, (std::array<int, 3>{ 70, 40, 3 }));
  EXPECT_EQ(volume.Voxels[5], 257);
  // What only begins like one is none.
  std::string other("\x08\0\0\0\x04\0\0\0", 8);
  other.append(300, 'x');
  EXPECT_FALSE(ReadDicomHeader(folder.Write("other", other)));
}

TEST(DicomForms, RefusalsNameAllThatIsMissing)
{
  MadeUpStudy files;
  files.Add(MadeUpMr("1.2.5", "t1").Remove(0x20, 0x37).Remove(0x28, 0x30), "MR");
  EXPECT_THAT(RefusalOf([&] { ReadIntensityVolume(files.File("MR")); }),
    HasSubstr("found no Image Position (0020,0032), Image Orientation (0020,0037), Pixel Spacing "
              "(0028,0030)"));
  files.Add(MadeUpMammogram("L", "CC"), "MG");
  EXPECT_THAT(RefusalOf([&] { ReadMammogramHeader(files.File("MG/IM2")); }),
    HasSubstr("found none of its Study Instance UID (0020,000D)"));
}
