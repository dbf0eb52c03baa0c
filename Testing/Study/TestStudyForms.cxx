// SPDX-License-Identifier: Apache-2.0
// The forms in which hospitals export one and the same study: what is taken of it must not depend
// on them.
#include "MadeUpFrames.h"
#include "MadeUpStudy.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Study/Intake.h"

#include <nlohmann/json.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using namespace mammoray;
using namespace mammoray::test;
using testing::HasSubstr;

namespace
{
/// Thirty axial slices, 3 mm apart, of each phase.
MadeUpObject Dynamic(int phases)
{
  MadeUpObject object;
  for (int phase = 1; phase <= phases; ++phase)
  {
    for (int slice = 0; slice < 30; ++slice)
    {
      object.Frames.push_back({ 3.0 * slice, phase, 100 * phase + slice });
    }
  }
  return object;
}

void AddBothViews(MadeUpStudy& files)
{
  files.Add(MadeUpMammogram("L", "CC"), "MG");
  files.Add(MadeUpMammogram("L", "MLO"), "MG");
}

/// Sagittal slices, 3 mm apart, from `left` mm (LPS) on; 200 x 200 mm.
void AddSagittal(MadeUpStudy& files, MadeUpHeader header, double left, int count)
{
  header.SetSize(40, 40).Set(0x20, 0x37, "DS", "0\\1\\0\\0\\0\\-1");
  for (int slice = 0; slice < count; ++slice)
  {
    header.Set(0x20, 0x32, "DS", Join({ left + 3 * slice, -150, 100 }));
    files.Add(header);
  }
}
}

TEST(StudyForms, PhasesOfOneEnhancedObject)
{
  MadeUpStudy files;
  files.Write("DICOM/enhanced", EnhancedMr(Dynamic(3)));
  AddBothViews(files);
  const Study study = ReadStudy(files.Folder());
  ASSERT_EQ(study.Series.size(), 3u);
  const StudyChoice choice = ChooseForRegistration(study);
  EXPECT_EQ(choice.Refusal, "");
  ASSERT_TRUE(choice.FatSuppressed);
  EXPECT_EQ(choice.FatSuppressed->Contrast, ContrastPhase::Before);
  EXPECT_EQ(choice.FatSuppressed->FatEvidence, "Spectrally Selected Suppression FAT");
  EXPECT_EQ(choice.FatSuppressed->Files.size(), 1u);
  ASSERT_EQ(choice.FatSuppressed->Slices.size(), 30u);
  EXPECT_EQ(choice.Position, PatientPosition::Prone);
  const IntensityVolume volume = ReadIntensitySlices(choice.FatSuppressed->Slices);
  EXPECT_EQ(volume.Origin, choice.FatSuppressed->Grid->Origin);
  EXPECT_EQ(volume.Voxels[volume.Index(1, 2, 17)], 117);
  const auto json = nlohmann::json::parse(StudyJson(choice));
  EXPECT_EQ(json["series"][0]["frames"].size(), 30u);
  EXPECT_EQ(json["series"][1]["frames"][0], 31);
}

TEST(StudyForms, WaterAndFatOfOneEnhancedObject)
{
  MadeUpObject dixon = Dynamic(2);
  dixon.Suppression = "NONE";
  for (MadeUpFrame& frame : dixon.Frames)
  {
    frame.Type =
      frame.Phase == 1 ? "DERIVED\\PRIMARY\\DIXON\\WATER" : "DERIVED\\PRIMARY\\DIXON\\FAT";
    frame.Phase = 1;
  }
  MadeUpStudy files;
  files.Write("one", EnhancedMr(dixon));
  // The same object, stored twice.
  files.Write("two/copy", EnhancedMr(dixon));
  AddBothViews(files);
  const Study study = ReadStudy(files.Folder());
  ASSERT_EQ(study.Series.size(), 2u);
  EXPECT_EQ(study.Copies, 1u);
  const StudyChoice choice = ChooseForRegistration(study);
  ASSERT_TRUE(choice.FatSuppressed);
  EXPECT_FALSE(choice.Plain);
  EXPECT_EQ(choice.FatSuppressed->Slices.back().Frame, 30);
  EXPECT_THAT(ReasonsOf(choice.Found.Series), testing::Contains(HasSubstr("fat alone")));
}

TEST(StudyForms, ASeriesInSeveralFoldersAndWithItsSlicesInterleaved)
{
  MadeUpStudy files;
  MadeUpHeader header = MadeUpMr("1.2.5", "t1");
  for (const int first : { 1, 0 })
  {
    for (int slice = first; slice < 40; slice += 2)
    {
      header.Set(0x20, 0x32, "DS", Join({ -175, -100, 3.0 * slice }));
      files.Add(header, first == 0 ? "A" : "B/deep");
    }
  }
  AddBothViews(files);
  const StudyChoice choice = ChooseForRegistration(ReadStudy(files.Folder()));
  ASSERT_TRUE(choice.Plain);
  EXPECT_EQ(choice.Plain->Grid->Size[2], 40);
  EXPECT_EQ(ReadIntensitySlices(choice.Plain->Slices).Size[2], 40);
}

TEST(StudyForms, SagittalSlabsOfBothBreastsInOneSeries)
{
  MadeUpStudy files;
  const MadeUpHeader header = MadeUpMr("1.2.5", "Sag T1 3D");
  AddSagittal(files, header, -160, 35);
  AddSagittal(files, header, 50, 35);
  AddBothViews(files);
  const Study study = ReadStudy(files.Folder());
  ASSERT_EQ(study.Series.size(), 2u);
  const StudyChoice choice = ChooseForRegistration(study);
  EXPECT_EQ(choice.Refusal, "");
  ASSERT_TRUE(choice.Plain);
  EXPECT_EQ(choice.Plain->Side, 'L');
  EXPECT_EQ(choice.Plain->Plane, "sagittal");
  // Their normal leads to the right, so that the first layer is the outermost one.
  EXPECT_NEAR(choice.Plain->Grid->Origin[0], 50 + 3 * 34, 1e-9);
  EXPECT_THAT(ReasonsOf(choice.Found.Series),
    testing::Contains(HasSubstr("shows the right breast only")));

  // A breast in the middle of the magnet is the one that is named.
  for (const auto& [description, side] :
    { std::pair{ "Sag T1 RT", 'R' }, { "Sag T1 left", 'L' }, { "Sag T1", '?' } })
  {
    MadeUpStudy one;
    AddSagittal(one, MadeUpMr("1.2.5", description), -50, 35);
    EXPECT_EQ(ReadStudy(one.Folder()).Series.front().Side, side) << description;
  }
}

TEST(StudyForms, MissingSlicesAreCountedAndAnotherSeriesIsTaken)
{
  MadeUpStudy files;
  files.AddSlices(MadeUpMr("1.2.5", "t1_pre"), 20);
  files.AddSlices(MadeUpMr("1.2.5", "t1_pre"), 19, 3); // from -60 to -3, then 3 to 57
  AddBothViews(files);
  Study study = ReadStudy(files.Folder());
  EXPECT_THAT(ChooseForRegistration(study).Refusal, HasSubstr("found only: missing slices"));
  EXPECT_THAT(study.Series.front().LeftOut, HasSubstr("39 slices, 3.08 mm apart"));
  files.AddSlices(MadeUpMr("1.2.6", "t1_post"));
  const StudyChoice choice = ChooseForRegistration(ReadStudy(files.Folder()));
  EXPECT_EQ(choice.Refusal, "");
  EXPECT_EQ(choice.Plain->Header.SeriesInstanceUid, "1.2.6");
}

TEST(StudyForms, SidesThatOnlyDescriptionsName)
{
  MadeUpStudy files;
  files.AddSlices(MadeUpMr("1.2.5", "t1"));
  files.Add(MadeUpMammogram("", "CC").Set(8, 0x103e, "LO", "L CC"), "MG");
  files.Add(MadeUpMammogram("", "CC").Set(8, 0x103e, "LO", "R-CC"), "MG");
  files.Add(MadeUpMammogram("", "CC").Set(8, 0x103e, "LO", "LCC ID"), "MG");
  const Study study = ReadStudy(files.Folder());
  EXPECT_EQ(ChooseForRegistration(study, 'R').Cc->Header.Laterality, 'R');
  EXPECT_EQ(ChooseForRegistration(study, 'L').Cc->Header.Laterality, 'L');
  EXPECT_THAT(ReasonsOf(ChooseForRegistration(study, 'L').Found.Mammograms),
    testing::Contains("left out: implant displaced view"));
}
