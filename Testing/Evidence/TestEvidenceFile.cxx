// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "MadeUpEvidence.h"
#include "mammoray/Evidence/EvidenceFile.h"
#include "mammoray/Foundation/Error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

using namespace mammoray;

namespace
{
class EvidenceFile : public testing::Test
{
protected:
  std::string Write(const RegistrationEvidence& evidence, const std::string& settings) const
  {
    return this->Folder.Write("evidence.json", EvidenceJson(evidence, settings));
  }

  test::TemporaryFolder Folder;
  std::string Settings = R"({"seed": 1})";
};
}

TEST_F(EvidenceFile, ReadsBackWhatItHolds)
{
  RegistrationEvidence evidence;
  evidence.Twins.push_back(
    test::MadeUpRun("ball", TwinKind::Plain, TwinSearch::Register, 3, 1.25, 0.5));
  evidence.Twins.push_back(
    test::MadeUpRun("ball", TwinKind::WrongStart, TwinSearch::Exact, 0, test::Nothing, 0));
  evidence.Twins.back().Reasons = { "The breast glides by 40 mm." };
  evidence.Landmarks.push_back(
    { "ball, CC", { { "identity", { 12, 9.2, 9.3, 14 }, { 12, 5, 6, 7 } } }, 0.6, test::Nothing,
      "good", 1.5, { "Far from the start." }, 14, 25, 30.5 });
  evidence.Mammograms.push_back({ "real", 2.5, 7, 0.8, 0.4, "doubtful", { "It glides." }, 12, "" });
  evidence.Mammograms.push_back({ "other", 0, 0, 0, 0, "", {}, 0, "no equilibrium" });
  evidence.Studies.push_back(test::MadeUpStudyRun("ball", 4, { 1, 2, 6 }));
  evidence.Studies.back().CcAlone = { evidence.Studies.back().Views[0] };
  evidence.Studies.back().Swept = { evidence.Studies.back().Views[0] };
  StudyRun& refused = evidence.Studies.emplace_back();
  refused.Phantom = "cube";
  refused.Failure = "no breast";
  const RegistrationEvidence read =
    ReadEvidence(this->Write(evidence, this->Settings), this->Settings);

  ASSERT_EQ(read.Studies.size(), 2u);
  EXPECT_EQ(read.Studies[0].Seed, 4u);
  EXPECT_EQ(read.Studies[0].Laterality, 'R');
  EXPECT_EQ(read.Studies[0].Views.at(1).View, "MLO");
  EXPECT_EQ(read.Studies[0].Views.at(1).Imaged.InSpaceMm, (std::vector<double>{ 1, 2, 6 }));
  EXPECT_EQ(read.Studies[0].Views.at(1).Behind.OnReceptorMm, std::vector<double>{ 10 });
  EXPECT_EQ(read.Studies[0].CcAlone.at(0).Imaged.AlongBeamMm,
    (std::vector<double>{ 0.25, 0.5, 1.5 }));
  EXPECT_EQ(read.Studies[0].Swept.at(0).View, "CC");
  EXPECT_EQ(read.Studies[1].Failure, "no breast");
  ASSERT_EQ(read.Twins.size(), 2u);
  const TwinRun& run = read.Twins[0];
  EXPECT_EQ(run.Phantom, "ball");
  EXPECT_EQ(run.Kind, "plain");
  EXPECT_EQ(run.Search, "register");
  EXPECT_EQ(run.Number, 3);
  EXPECT_EQ(run.Names, evidence.Twins[0].Names);
  EXPECT_EQ(run.Found, evidence.Twins[0].Found);
  EXPECT_EQ(run.IterationCosts, evidence.Twins[0].IterationCosts);
  EXPECT_EQ(run.MedianErrorMm, 1.25);
  EXPECT_TRUE(run.Converged);
  // What is not a number stays none.
  EXPECT_EQ(run.Sigma[1], 1);
  EXPECT_TRUE(std::isnan(run.Sigma[2]));
  EXPECT_TRUE(std::isnan(read.Twins[1].MedianErrorMm));
  EXPECT_EQ(read.Twins[1].Reasons, evidence.Twins[1].Reasons);
  ASSERT_EQ(read.Landmarks.size(), 1u);
  EXPECT_EQ(read.Landmarks[0].Name, "ball, CC");
  EXPECT_EQ(read.Landmarks[0].Rows.at(0).Method, "identity");
  EXPECT_EQ(read.Landmarks[0].Rows.at(0).InSpace.Median, 9.2);
  EXPECT_EQ(read.Landmarks[0].Rows.at(0).OnReceptor.Largest, 7);
  EXPECT_TRUE(std::isnan(read.Landmarks[0].GlandDiceAtRest));
  EXPECT_EQ(read.Landmarks[0].ExpectedMedianMm, 1.5);
  EXPECT_EQ(read.Landmarks[0].Reasons, evidence.Landmarks[0].Reasons);
  ASSERT_EQ(read.Mammograms.size(), 2u);
  EXPECT_EQ(read.Mammograms[0].Trust, "doubtful");
  EXPECT_EQ(read.Mammograms[0].Reasons, evidence.Mammograms[0].Reasons);
  EXPECT_EQ(read.Mammograms[0].TissueCorrelation, 0.4);
  EXPECT_EQ(read.Mammograms[1].Failure, "no equilibrium");
  // And the same again.
  EXPECT_EQ(EvidenceJson(read, this->Settings), EvidenceJson(evidence, this->Settings));
}

TEST_F(EvidenceFile, FindsARunByWhatItIs)
{
  RegistrationEvidence evidence;
  evidence.Twins.push_back(
    test::MadeUpRun("ball", TwinKind::Plain, TwinSearch::Register, 3, 1.25, 0.5));
  EXPECT_EQ(evidence.Find("ball", "plain", "register", 3), &evidence.Twins[0]);
  EXPECT_EQ(evidence.Find("box", "plain", "register", 3), nullptr);
  EXPECT_EQ(evidence.Find("ball", "wrong-start", "register", 3), nullptr);
  EXPECT_EQ(evidence.Find("ball", "plain", "exact", 3), nullptr);
  EXPECT_EQ(evidence.Find("ball", "plain", "register", 2), nullptr);
}

TEST_F(EvidenceFile, RefusesOtherSettingsAndOtherFiles)
{
  EXPECT_THROW(ReadEvidence(this->Write({}, this->Settings), R"({"seed": 2})"), InputError);
  EXPECT_THROW(ReadEvidence(this->Folder.Write("no.json", "{"), this->Settings), InputError);
  EXPECT_THROW(ReadEvidence(this->Folder.Write("other.json", "{}"), this->Settings), InputError);
  EXPECT_THROW(ReadEvidence(this->Folder.File("none.json"), this->Settings), InputError);
}

TEST_F(EvidenceFile, RefusesListsOfDifferentLengths)
{
  for (std::vector<double> TwinRun::*list : { &TwinRun::Truth, &TwinRun::Start, &TwinRun::Found,
         &TwinRun::Sigma, &TwinRun::IterationSeconds })
  {
    RegistrationEvidence evidence;
    evidence.Twins.push_back(
      test::MadeUpRun("ball", TwinKind::Plain, TwinSearch::Register, 3, 1.25, 0.5));
    std::vector<double>& values = evidence.Twins[0].*list;
    values.push_back(0);
    EXPECT_THROW(ReadEvidence(this->Write(evidence, this->Settings), this->Settings), InputError);
    values.clear();
    EXPECT_THROW(ReadEvidence(this->Write(evidence, this->Settings), this->Settings), InputError);
  }
}

TEST_F(EvidenceFile, TextsAreOfLettersOnly)
{
  RegistrationEvidence evidence;
  evidence.Mammograms.push_back(
    { "\x1b[2J", 2.5, 7, 0.8, 0.4, "none", { "a\nb" }, 12, "no\nmammogram" });
  const RegistrationEvidence read =
    ReadEvidence(this->Write(evidence, this->Settings), this->Settings);
  EXPECT_EQ(read.Mammograms.at(0).Name, "\\x1b[2J");
  EXPECT_EQ(read.Mammograms.at(0).Reasons, std::vector<std::string>{ "a\\x0ab" });
  EXPECT_EQ(read.Mammograms.at(0).Failure, "no\\x0amammogram");
}

TEST_F(EvidenceFile, SettingsTellWhatTwoRunsMustShare)
{
  EvidenceOptions options;
  EvidencePhantom phantom;
  phantom.Name = "ball";
  phantom.Labels.Path = this->Folder.Write("ball.nrrd", "labels");
  options.Phantoms.push_back(phantom);
  const std::string settings = EvidenceSettings(options);
  EXPECT_EQ(EvidenceSettings(options), settings);
  // How much is asked for is no setting: more may be added.
  options.Twins += 1;
  EXPECT_EQ(EvidenceSettings(options), settings);
  options.Twin.Seed += 1;
  EXPECT_NE(EvidenceSettings(options), settings);
  options.Twin.Seed -= 1;
  this->Folder.Write("ball.nrrd", "other labels");
  EXPECT_NE(EvidenceSettings(options), settings);
}
