// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Study/StudyAnswers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace
{
using namespace mammoray;
using test::RefusalOf;
using test::TemporaryFolder;
using testing::HasSubstr;

/// Every member another number, none of them a default.
StudyTruth FullTruth()
{
  StudyTruth truth;
  truth.Laterality = 'R';
  truth.Seed = 4294967295u;
  truth.Scanner = "philips";
  truth.Materials = { "air", "fat", "gland" };
  truth.StiffnessFactors = { 1, 0.51, 1.97 };
  truth.YoungsModuliKPa = { 0.1, 2.3, 1.0 / 3 };
  truth.MeanHangMm = 17.25;
  truth.GlideStiffness = 0.0321;
  truth.MriPoints = { { 1.5, -2.25, 1e-17 }, { 4, 5, 6 } };
  truth.RestPoints = { { 7, 8, 9 }, { 10, 11, 12 } };
  for (const char* name : { "CC", "MLO" })
  {
    TrueView view;
    view.View = name;
    view.File = std::string("export/") + name;
    view.Pose.ThicknessMm = 51.5;
    view.Pose.RollDeg = -45;
    view.Pose.PitchDeg = 1;
    view.Pose.YawDeg = 2;
    view.Pose.LateralMm = 3;
    view.Pose.AnteriorMm = 4;
    view.Pose.VerticalMm = 5;
    view.Pose.TiltDeg = 2.5;
    view.Unit.SourceToDetectorMm = 661;
    view.Unit.SupportHeightMm = 23;
    view.HeaderThicknessMm = 53;
    view.PaddleForceN = 98.5;
    view.Gantry = { { 1, 2, 3 }, { 4, 5, 6 } };
    view.Receptor = { { 1, 2 }, { 3, 4 } };
    view.Pixels = { { 10.5, 20.5 }, { 30.5, 40.5 } };
    truth.Views.push_back(view);
  }
  return truth;
}

TEST(StudyTruth, IsReadAsItWasWrittenToTheLastBit)
{
  const TemporaryFolder folder;
  const StudyTruth truth = FullTruth();
  WriteStudyTruth(truth, folder.File("truth.json"));
  const StudyTruth read = ReadStudyTruth(folder.File("truth.json"));
  EXPECT_EQ(read.Laterality, truth.Laterality);
  EXPECT_EQ(read.Seed, truth.Seed);
  EXPECT_EQ(read.Scanner, truth.Scanner);
  EXPECT_EQ(read.Materials, truth.Materials);
  EXPECT_EQ(read.StiffnessFactors, truth.StiffnessFactors);
  EXPECT_EQ(read.YoungsModuliKPa, truth.YoungsModuliKPa);
  EXPECT_EQ(read.MeanHangMm, truth.MeanHangMm);
  EXPECT_EQ(read.GlideStiffness, truth.GlideStiffness);
  EXPECT_EQ(read.MriPoints, truth.MriPoints);
  EXPECT_EQ(read.RestPoints, truth.RestPoints);
  ASSERT_EQ(read.Views.size(), 2u);
  for (std::size_t n = 0; n < 2; ++n)
  {
    const TrueView& view = truth.Views[n];
    const TrueView& other = read.Views[n];
    EXPECT_EQ(other.View, view.View);
    EXPECT_EQ(other.File, view.File);
    EXPECT_EQ(other.Pose.ThicknessMm, view.Pose.ThicknessMm);
    EXPECT_EQ(other.Pose.RollDeg, view.Pose.RollDeg);
    EXPECT_EQ(other.Pose.PitchDeg, view.Pose.PitchDeg);
    EXPECT_EQ(other.Pose.YawDeg, view.Pose.YawDeg);
    EXPECT_EQ(other.Pose.LateralMm, view.Pose.LateralMm);
    EXPECT_EQ(other.Pose.AnteriorMm, view.Pose.AnteriorMm);
    EXPECT_EQ(other.Pose.VerticalMm, view.Pose.VerticalMm);
    EXPECT_EQ(other.Pose.TiltDeg, view.Pose.TiltDeg);
    EXPECT_EQ(other.Unit.SourceToDetectorMm, view.Unit.SourceToDetectorMm);
    EXPECT_EQ(other.Unit.SupportHeightMm, view.Unit.SupportHeightMm);
    EXPECT_EQ(other.HeaderThicknessMm, view.HeaderThicknessMm);
    EXPECT_EQ(other.PaddleForceN, view.PaddleForceN);
    EXPECT_EQ(other.Gantry, view.Gantry);
    EXPECT_EQ(other.Receptor, view.Receptor);
    EXPECT_EQ(other.Pixels, view.Pixels);
  }
}

TEST(StudyTruth, RefusesWhatIsNone)
{
  const TemporaryFolder folder;
  const auto refusalOf = [&](const std::string& text)
  {
    const std::string path = folder.Write("broken.json", text);
    return RefusalOf([&] { ReadStudyTruth(path); });
  };
  WriteStudyTruth(FullTruth(), folder.File("truth.json"));
  const std::string whole = test::ReadFile(folder.File("truth.json"));
  const auto changed = [&](const std::string& from, const std::string& to)
  {
    std::string text = whole;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos);
    return text.replace(at, from.size(), to);
  };
  EXPECT_THAT(RefusalOf([&] { ReadStudyTruth(folder.File("none.json")); }),
    HasSubstr("found no file"));
  EXPECT_THAT(refusalOf(""), HasSubstr("broken.json: expected the truth"));
  EXPECT_THAT(refusalOf("[]"), HasSubstr("expected the truth"));
  EXPECT_THAT(refusalOf(whole.substr(0, whole.size() / 2)), HasSubstr("expected the truth"));
  EXPECT_THAT(refusalOf(changed("\"truth_version\": 1", "\"truth_version\": 2")),
    HasSubstr("expected version 1 of a virtual study's truth, found 2"));
  EXPECT_THAT(refusalOf(changed("\"seed\": 4294967295", "\"seed\": \"x\"")),
    HasSubstr("expected the truth"));
  StudyTruth short1 = FullTruth();
  short1.Views[1].Gantry.pop_back();
  WriteStudyTruth(short1, folder.File("short.json"));
  EXPECT_THAT(RefusalOf([&] { ReadStudyTruth(folder.File("short.json")); }),
    HasSubstr("expected each of 2 points in each view, found 1 in MLO"));
}
}
