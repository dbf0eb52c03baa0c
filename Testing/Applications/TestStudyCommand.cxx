// SPDX-License-Identifier: Apache-2.0
// From a clinic's export to the answer, on a virtual one made coarse enough for a minute.
#include "CommandTest.h"
#include "Files.h"
#include "MadeUpStudy.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/Study/LandmarkEvaluation.h"
#include "mammoray/Study/RegisteredBreast.h"
#include "mammoray/Study/StudyAnswers.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include <nlohmann/json.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <utility>

using namespace mammoray;
using test::ReadFile;
using testing::HasSubstr;
namespace fs = std::filesystem;

namespace
{
using StudyCommand = test::CommandTest;
}

TEST_F(StudyCommand, AnExportTakesThePlaceOfLabelsAndMammograms)
{
  const std::string output = " -o " + this->Folder.File("result");
  EXPECT_EQ(this->Run("register" + output), 2);
  EXPECT_THAT(this->Errors, HasSubstr("--study, or --labels, --materials and --mammogram"));
  const std::string labels = " --labels " + this->Folder.File("a.nrrd");
  const std::string mammogram = " --mammogram " + this->Folder.File("b.dcm");
  std::ofstream(this->Folder.File("a.nrrd")) << "labels";
  std::ofstream(this->Folder.File("b.dcm")) << "pixels";
  EXPECT_EQ(this->Run("register" + labels + mammogram + output), 2);
  EXPECT_EQ(this->Run("register --study a" + mammogram + output), 2);
  EXPECT_EQ(this->Run("register --study a --side up" + output), 2);
  this->ExpectRefused("register --study nowhere" + output, "found nothing there");
  fs::create_directory(this->Folder.File("empty"));
  this->ExpectRefused("register --study " + this->Folder.File("empty") + output,
    "found no file in it");
  EXPECT_FALSE(fs::exists(this->Folder.File("result")));
}

TEST_F(StudyCommand, WhatFilesTellIsRefusedBeforeAnyWork)
{
  using namespace test;
  const auto refused = [&](const MadeUpStudy& files, const std::string& message)
  {
    for (const std::string& command :
      { "register --side left -o " + this->Folder.File("result") + " --study ",
        std::string("intake --side left ") })
    {
      this->ExpectRefusedAfterListing(command + files.Folder(), message);
    }
  };
  MadeUpStudy otherPatient;
  otherPatient.AddSlices(MadeUpMr("1.2.5", "t1"));
  otherPatient.Add(MadeUpMammogram("L", "CC").Set(0x10, 0x30, "DA", "19650203"), "MG");
  refused(otherPatient, "expected the images of one patient, found those of 2");

  MadeUpStudy otherSide;
  otherSide.AddSlices(MadeUpMr("1.2.5", "t1"));
  otherSide.Add(MadeUpMammogram("R", "CC"));
  refused(otherSide, "expected a CC or MLO mammogram of the left breast, found right CC");

  MadeUpStudy noView;
  noView.AddSlices(MadeUpMr("1.2.5", "t1"));
  refused(noView, "expected a mammogram, found none");
  noView.Add(MadeUpMammogram("L", "XCCL"));
  refused(noView, "expected a CC or MLO mammogram of the left breast, found left XCCL");

  MadeUpStudy subtraction;
  subtraction.AddSlices(MadeUpMr("1.2.5", "t1_sub"));
  subtraction.Add(MadeUpMammogram("L", "CC"));
  refused(subtraction, "found only: subtraction");
}

TEST_F(StudyCommand, LeadsFromThePatientsFilesToTheAnswer)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const std::string study = this->Folder.File("study");
  const std::string mammoray = std::exchange(this->Program, this->Program + "-validate");
  ASSERT_EQ(this->Run("study --mri-pixel 2 --mri-slice 3 --mammogram-pixel 0.3 "
                      "--label-spacing 1 --anatomy-cell 8 --gravity-fineness 5 "
                      "--compression-fineness 7 -o " +
              study),
    0)
    << this->Errors;
  this->Program = mammoray;
  const std::string result = this->Folder.File("result");
  const std::string arguments = "register --study " + study +
    "/export --anatomy-cell-size 8 --simulation-cell-size 16 --pixel-sizes 3 -o " + result;
  this->ExpectRefusedAfterListing(arguments + " --side right",
    "of the right breast, found left CC, left MLO");
  // Mammograms of a breast of 0.4 of its size, as those of another patient with her header.
  const std::string other = this->Folder.File("other");
  fs::copy(study + "/export", other, fs::copy_options::recursive);
  std::size_t forged = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(other))
  {
    std::string bytes = entry.is_regular_file() ? ReadFile(entry.path()) : std::string();
    const std::string spacing = test::Element(0x18, 0x1164, "DS", "0.3\\0.3");
    if (const std::size_t at = bytes.find(spacing); at != std::string::npos)
    {
      bytes.replace(at, spacing.size(), test::Element(0x18, 0x1164, "DS", ".12\\.12"));
      std::ofstream(entry.path(), std::ios::binary) << bytes;
      ++forged;
    }
  }
  ASSERT_GE(forged, 2u);
  this->ExpectRefusedAfterListing("register --side left -o " + result + " --study " + other,
    "of another breast, or of a part of it");
  ASSERT_EQ(this->Run(arguments + " --side left"), 0) << this->Errors;
  EXPECT_THAT(this->Output, HasSubstr("taken: T1 without fat suppression"));
  EXPECT_THAT(this->Output, HasSubstr("MLO taken"));
  EXPECT_THAT(this->Output, HasSubstr("cm3 in the MRI"));
  for (const char* name :
    { "labels.seg.nrrd", "mri.nrrd", "report.html", "cc/compressed.vtu", "mlo/compressed.vtu" })
  {
    EXPECT_TRUE(fs::exists(result + "/" + name)) << name;
  }
  EXPECT_EQ(ReadLabelFile(result + "/labels.seg.nrrd").Size,
    ReadIntensityFile(result + "/mri.nrrd").Size);
  const nlohmann::json cc = nlohmann::json::parse(ReadFile(result + "/cc/result.json"));
  EXPECT_EQ(cc.at("inputs").at(0).at("role"), "MRI without fat suppression");
  EXPECT_EQ(cc.at("inputs").at(1).at("role"), "MRI with fat suppression");
  const std::string report = ReadFile(result + "/report.html");
  EXPECT_THAT(report,
    testing::AnyOf(HasSubstr("The patient&#39;s files"), HasSubstr("The patient's files")));

  // With labels, nothing is segmented and everything else is the study's.
  const std::string again = this->Folder.File("again");
  const std::string labelled = "register --study " + study + "/export --side left --labels " +
    result +
    "/labels.seg.nrrd --anatomy-cell-size 8 --simulation-cell-size 16 --pixel-sizes 6 "
    "--iterations 1 -o " +
    again;
  ASSERT_EQ(this->Run(labelled), 0) << this->Errors;
  EXPECT_THAT(this->Output, HasSubstr("MLO taken"));
  EXPECT_THAT(this->Output, HasSubstr("cm3 in the labels"));
  EXPECT_EQ(ReadLabelFile(again + "/labels.seg.nrrd").Voxels,
    ReadLabelFile(result + "/labels.seg.nrrd").Voxels);
  const nlohmann::json told = nlohmann::json::parse(ReadFile(again + "/cc/result.json"));
  EXPECT_EQ(told.at("inputs").at(2).at("role"), LabelRole);
  EXPECT_THAT(ReadFile(again + "/report.html"), HasSubstr("labels that were given: *.nrrd"));
  ASSERT_EQ(this->Run(labelled + " --print-config"), 0) << this->Errors;
  const nlohmann::json config = nlohmann::json::parse(this->Output);
  EXPECT_EQ(config.at("labels"), result + "/labels.seg.nrrd");
  EXPECT_EQ(config.at("study"), study + "/export");
  this->ExpectRefusedAfterListing(labelled + " --overwrite --resume " + result,
    "expected a result of labels, found one of a segmented MRI");

  // Mechanics, mesh, stiffness, tilt and pictures are not those of the truth; neither are they as
  // fine as for a patient, for whom 3 mm are aimed at.
  const StudyTruth truth = ReadStudyTruth(study + "/truth.json");
  for (const ResultFile& file : ReadResultFiles(result))
  {
    const AnswerScore score = ScoreResult(truth, file, ReadBreastInUnit(file));
    EXPECT_LT(Quantile(score.Imaged.InSpaceMm, 0.5), 5) << score.View;
    EXPECT_LT(file.After.MeanOutlineDistanceMm, 2) << score.View;
    EXPECT_GT(file.After.Correlation, 0.9) << score.View;
  }
  ASSERT_EQ(this->Run("evaluate --truth " + study + "/truth.json --result " + result), 0)
    << this->Errors;
  EXPECT_THAT(this->Output, HasSubstr("MLO      imaged "));
  // Three lines of somebody else's.
  const std::string answers =
    this->Folder.Write("answers.csv", "view,point,column,row\nCC,0,100,100\nCC,1,150,300\n");
  ASSERT_EQ(this->Run("evaluate --truth " + study + "/truth.json --answers " + answers), 0)
    << this->Errors;
  EXPECT_THAT(this->Output, HasSubstr("imaged points were not answered"));
  EXPECT_EQ(this->Run("evaluate --answers " + answers), 2);
  this->ExpectRefused("evaluate --truth " + study + "/truth.json --answers " +
      this->Folder.Write("odd.csv", "view,point,column,row\nCC,0,100\n"),
    "line 2: expected 4 values");
  EXPECT_EQ(this->Run("evaluate --result " + result), 2);
}
