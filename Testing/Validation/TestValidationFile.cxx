// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "Refusals.h"
#include "ValidationFile.h"
#include "ValidationRuns.h"
#include "mammoray/Foundation/Error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

using namespace mammoray;
using nlohmann::json;

namespace
{
class ValidationFiles : public testing::Test
{
protected:
  test::TemporaryFolder Folder;
  std::string Path = this->Folder.File("runs.json");
  json Settings{ { "seed", 1 } };
  json Run{ { "phantom", "ball" }, { "kind", "plain" }, { "number", 3 },
    { "medianErrorMm", 1.0 / 3 } };
};
}

TEST_F(ValidationFiles, AreResumedWithWhatTheyHold)
{
  ValidationFile file(this->Path, this->Settings, false);
  EXPECT_FALSE(std::filesystem::exists(this->Path));
  file.Add("twins", this->Run);
  json failed = this->Run;
  failed["number"] = 4;
  failed["medianErrorMm"] = std::numeric_limits<double>::quiet_NaN();
  file.Add("twins", failed);
  file.Add("studies", { { "phantom", "ball" }, { "seed", 4 }, { "failure", "no \xff breast" } });
  const std::string text = test::ReadFile(this->Path);

  const ValidationFile read(this->Path, this->Settings, true);
  EXPECT_EQ(read.NumberOfRuns(), 3u);
  const json* run = read.Find("twins", { { "phantom", "ball" }, { "number", 3 } });
  ASSERT_NE(run, nullptr);
  EXPECT_EQ(*run, this->Run); // to the last bit
  run = read.Find("twins", { { "phantom", "ball" }, { "number", 4 } });
  ASSERT_NE(run, nullptr);
  EXPECT_TRUE(run->at("medianErrorMm").is_null());
  EXPECT_EQ(read.Find("twins", { { "phantom", "box" }, { "number", 3 } }), nullptr);
  EXPECT_EQ(read.Find("twins", { { "phantom", "ball" }, { "search", "exact" } }), nullptr);
  EXPECT_EQ(read.Find("mammograms", { { "phantom", "ball" } }), nullptr);
  // Nothing is written before a run is added.
  EXPECT_EQ(test::ReadFile(this->Path), text);
  const json content = json::parse(text);
  EXPECT_EQ(content.at("settings"), this->Settings);
  EXPECT_EQ(content.at("tissueCorrelationLimits").size(), 2u);
}

TEST_F(ValidationFiles, WithoutResumeBeginAnew)
{
  ValidationFile(this->Path, this->Settings, false).Add("twins", this->Run);
  ValidationFile file(this->Path, this->Settings, false);
  EXPECT_EQ(file.NumberOfRuns(), 0u);
  file.Add("landmarks", { { "name", "ball" } });
  EXPECT_TRUE(json::parse(test::ReadFile(this->Path)).at("twins").empty());
}

TEST_F(ValidationFiles, RefuseOtherSettingsAndOtherFiles)
{
  ValidationFile(this->Path, this->Settings, false).Add("twins", this->Run);
  EXPECT_THAT(test::RefusalOf(
                [&] {
                  ValidationFile(this->Path, { { "seed", 2 } }, true);
                }),
    testing::HasSubstr("same settings"));
  for (const char* text : { "{", "{}", "[]", R"({"settings":{"seed":1},"twins":[]})",
         R"({"settings":{"seed":1},"twins":[1],"landmarks":[],"mammograms":[],"studies":[]})" })
  {
    const std::string path = this->Folder.Write("other.json", text);
    EXPECT_THROW(ValidationFile(path, this->Settings, true), InputError) << text;
  }
}

TEST_F(ValidationFiles, HaveTheSettingsThatTwinsMustShare)
{
  TwinPlan plan;
  Phantom& phantom = plan.Phantoms.emplace_back();
  phantom.Name = "ball";
  phantom.Labels.Path = this->Folder.Write("ball.nrrd", "labels");
  const json settings = SettingsOf(plan);
  EXPECT_EQ(SettingsOf(plan), settings);
  // How much is asked for is no setting: more may be added.
  plan.Count += 1;
  plan.Kinds.pop_back();
  EXPECT_EQ(SettingsOf(plan), settings);
  plan.Options.Seed += 1;
  EXPECT_NE(SettingsOf(plan), settings);
  plan.Options.Seed -= 1;
  this->Folder.Write("ball.nrrd", "other labels");
  EXPECT_NE(SettingsOf(plan), settings);
}
