// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "MadeUpStudy.h"
#include "Refusals.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Study/Private/Checkpoint.h"
#include "mammoray/Study/StudyCase.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

using namespace mammoray;
using namespace mammoray::test;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using testing::StartsWith;

namespace
{
/// The left breast's export with a subtraction and the other breast among it.
class MadeUpExport : public MadeUpStudy
{
public:
  MadeUpExport()
  {
    this->AddSlices(MadeUpMr("1.2.5", "t1_fl3d_tra_spair_pre"));
    MadeUpHeader subtraction = MadeUpMr("1.2.6", "t1_fl3d_tra_SUB");
    subtraction.Set(8, 8, "CS", "DERIVED\\SECONDARY\\M\\SUB");
    this->AddSlices(subtraction);
    this->Add(MadeUpMammogram("L", "MLO"));
    this->Add(MadeUpMammogram("L", "CC"));
    this->Add(MadeUpMammogram("R", "CC"));
  }
};

/// Fat with gland in its middle before muscle, 1 mm voxels: half a ball of radius 40.
StudyTissue Ball()
{
  StudyTissue tissue;
  tissue.Labels = test::LabelledCube(90, 1,
    [](const Vector3& p)
    {
      const double r = Norm(p);
      return p[1] > 0 ? (p[1] < 10 && std::hypot(p[0], p[2]) < 40 ? 4 : 0)
        : r > 40      ? 0
        : r < 15      ? 2
                      : 1;
    });
  tissue.Breast = tissue.Labels;
  tissue.Mri.Size = tissue.Labels.Size;
  tissue.Mri.Spacing = tissue.Labels.Spacing;
  tissue.Mri.Origin = tissue.Labels.Origin;
  tissue.Mri.Voxels.assign(tissue.Labels.Voxels.begin(), tissue.Labels.Voxels.end());
  tissue.BreastCm3 = 134; // 2/3 pi 40^3
  tissue.GlandFraction = 0.05;
  tissue.DepthMm = 40;
  tissue.Warnings = { "The gland is dark." };
  return tissue;
}
}

TEST(StudyCase, IsFilledFromTheExport)
{
  const MadeUpExport study;
  RegistrationCase input;
  input.Mammograms = { "another.dcm" };
  TakeStudy(study.Folder(), 'L', input);
  ASSERT_EQ(input.Mammograms.size(), 2u);
  EXPECT_EQ(input.Mammograms[0], input.Study->Cc->Header.Path);
  EXPECT_EQ(input.Mammograms[1], input.Study->Mlo->Header.Path);
  EXPECT_EQ(input.Laterality, "L");
  EXPECT_EQ(input.Materials, "segment");
  EXPECT_EQ(input.ImagePosition, PatientPosition::Prone);
  EXPECT_EQ(input.ChestWall, ChestWallMode::Sliding);
  EXPECT_EQ(input.Targets.ChestWallMarginMm, StudyChestWallMarginMm);
  EXPECT_EQ(input.RollSigmaDeg, StudyRollSigmaDeg);

  const std::vector<ResultInput> inputs = InputsOf(input, input.Mammograms[0]);
  ASSERT_EQ(inputs.size(), 3u);
  EXPECT_EQ(inputs[0].Role, "MRI with fat suppression");
  // What somebody wrote into the header is not written anywhere unless it is asked for.
  EXPECT_EQ(inputs[0].File, "series 5");
  EXPECT_EQ(inputs[0].Sha256.size(), 64u);
  EXPECT_EQ(inputs[1].File, "segment.json");
  EXPECT_EQ(inputs[2].Role, "Mammogram");
  EXPECT_THAT(inputs[2].File, testing::StartsWith("*"));
  RegistrationCase naming;
  naming.NameInputs = true;
  TakeStudy(study.Folder(), 'L', naming);
  const std::vector<ResultInput> named = InputsOf(naming, naming.Mammograms[0]);
  EXPECT_EQ(named[0].File, "t1_fl3d_tra_spair_pre");
  EXPECT_EQ(named[2].File, std::filesystem::path(naming.Mammograms[0]).filename().string());

  // A table of the user's own stays.
  input.Materials = "mine.json";
  TakeStudy(study.Folder(), 'L', input);
  EXPECT_EQ(input.Materials, "mine.json");
}

TEST(StudyCase, TakesAStudyThatWasCorrected)
{
  const MadeUpExport files;
  Study study = ReadStudy(files.Folder());
  for (StudyMammogram& image : study.Mammograms)
  {
    if (image.Header.View == "MLO")
    {
      image.LeftOut = "by hand";
    }
  }
  RegistrationCase input;
  TakeStudy(std::move(study), 'L', input);
  ASSERT_EQ(input.Mammograms.size(), 1u);
  EXPECT_EQ(input.Mammograms[0], input.Study->Cc->Header.Path);
  EXPECT_FALSE(input.Study->Mlo);
  EXPECT_EQ(input.Study->Plain ? input.Study->Plain->Description.find("t1_fl3d")
                               : std::string::npos,
    std::string::npos)
    << "names are hidden as of a folder";
}

TEST(StudyCase, NamesNoSeriesInItsReasonsUnlessAsked)
{
  MadeUpStudy study;
  study.AddSlices(MadeUpMr("1.2.4", "ax 3d dyn of Zqxmark"));
  study.AddSlices(MadeUpMr("1.2.5", "Ph1/ax 3d dyn of Zqxmark"));
  study.AddSlices(MadeUpMr("1.2.6", "Ph2/ax 3d dyn of Zqxmark"));
  study.Add(MadeUpMammogram("L", "CC"));
  for (const bool named : { false, true })
  {
    RegistrationCase input;
    input.NameInputs = named;
    TakeStudy(study.Folder(), 'L', input);
    std::string told;
    for (const StudySeries& series : input.Study->Found.Series)
    {
      told += series.Description + ": " + series.ContrastEvidence + ", " + series.Reason + "\n";
    }
    EXPECT_EQ(told.find("Zqxmark") != std::string::npos, named) << told;
    EXPECT_THAT(told, HasSubstr("of its protocol"));
  }
}

TEST(StudyCase, RefusesWhatCannotBeRegistered)
{
  const MadeUpExport study;
  RegistrationCase input;
  const auto refusal = [&](const MadeUpStudy& folder, std::optional<char> side)
  { return RefusalOf([&] { TakeStudy(folder.Folder(), side, input); }); };
  EXPECT_THAT(refusal(study, {}), HasSubstr("left CC, left MLO, right CC"));
  EXPECT_EQ(input.Study, nullptr);
  EXPECT_THAT(input.Mammograms, IsEmpty());

  MadeUpStudy other;
  other.AddSlices(MadeUpMr("1.2.5", "t1_fl3d_tra_spair_pre"));
  other.Add(MadeUpMammogram("L", "CC"));
  EXPECT_THAT(refusal(other, 'R'), HasSubstr("of the right breast, found left CC"));
  TakeStudy(other.Folder(), {}, input);
  EXPECT_THAT(input.Study->Warnings, Contains(HasSubstr("no MLO of the left breast")));

  MadeUpHeader stranger = MadeUpMammogram("L", "MLO");
  stranger.Set(0x10, 0x20, "LO", "P2").Set(0x10, 0x30, "DA", "19510203");
  stranger.Set(0x10, 0x10, "PN", "Roe^Mary");
  other.Add(stranger);
  EXPECT_THAT(refusal(other, 'L'),
    HasSubstr("expected the images of one patient, found those of 2"));
}

TEST(StudyCase, IsToldInTheReport)
{
  const MadeUpExport study;
  RegistrationCase input;
  TakeStudy(study.Folder(), 'L', input);
  const ReportSection section = StudySection(*input.Study, Ball());
  EXPECT_THAT(section.Rows,
    Contains(Pair("MRI: series 5", StartsWith("taken: T1 with fat suppression"))));
  EXPECT_THAT(section.Rows, Contains(Pair("MRI: series 6", StartsWith("left out: subtraction"))));
  EXPECT_THAT(section.Rows,
    Contains(Pair("Mammogram: right CC, For Presentation", "left out: the right breast")));
  EXPECT_THAT(section.Rows, Contains(Pair("Patient in the MRI", "prone")));
  EXPECT_THAT(section.Rows, Contains(Pair("Breast in the MRI", "134 cm3")));
  EXPECT_THAT(section.Picture.Png, StartsWith("\x89PNG"));
  EXPECT_THAT(section.Notes, Contains("The gland is dark."));
}
