// SPDX-License-Identifier: Apache-2.0
// Twins of a coarse half-ellipsoid: the figures hold together, and runs go on where they stopped.
#include "CommandTest.h"
#include "LabelShapes.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include <nlohmann/json.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

using namespace mammoray;
using test::ReadFile;
namespace fs = std::filesystem;

namespace
{
/// Fat with a ball of gland before muscle, which is taller than the breast; the front is -y. Labels
/// of the table victre.
int BreastLabel(const Vector3& point)
{
  if (point[1] > 16 && point[1] < 26 && std::hypot(point[0], point[2]) < 44)
  {
    return 40;
  }
  const double depth = (16 - point[1]) / 45;
  if (depth < 0 || std::hypot(point[0] / 40, depth, point[2] / 36) > 1)
  {
    return 0;
  }
  return Norm(point - Vector3{ 10, -4, 4 }) < 12 ? 29 : 1;
}

class ValidateCommand : public test::CommandTest
{
protected:
  void SetUp() override
  {
    this->Program += "-validate"; // beside it
    WriteLabelVolume(test::LabelledCube(48, 2, BreastLabel), this->Folder.File("breast.nrrd"));
  }

  /// The smallest that shows something: some hundred quadratic cells, and linear ones to match.
  std::string Twins(const std::string& verb, const std::string& rest) const
  {
    return verb + " --phantom ball=" + this->Folder.File("breast.nrrd") +
      " --orientation LPS --model-fineness 3 --target-fineness 8 --pixel-sizes 5 -o " + this->Json +
      " " + rest;
  }

  std::string Json = this->Folder.File("runs.json");
};
}

TEST_F(ValidateCommand, MeasuresTwinsAndGoesOn)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  ASSERT_EQ(this->Run(this->Twins("twins", "--kinds plain --count 1")), 0) << this->Errors;
  const nlohmann::json run = nlohmann::json::parse(ReadFile(this->Json)).at("twins").at(0);
  // 1.2 to 1.6 mm were measured on coarse meshes; 3.4 mm where the start is opened to half the
  // height of the muscle.
  EXPECT_LT(run.at("medianErrorMm").get<double>(), 2.5);
  EXPECT_GT(run.at("medianErrorMm").get<double>(), 0);
  EXPECT_GT(run.at("correlation").get<double>(), 0.9);
  EXPECT_NE(run.at("truth"), run.at("start"));
  for (const int free : { 0, 1, 2, 3, 4, 5, 7 })
  {
    EXPECT_GT(run.at("sigma").at(free).get<double>(), 0);
  }
  EXPECT_TRUE(run.at("sigma").at(6).is_null()); // vertical, fixed

  // What is done is not done again, the rest is: the searches of one problem.
  ASSERT_EQ(this->Run(this->Twins("searches", "--count 1 --resume")), 0) << this->Errors;
  const nlohmann::json all = nlohmann::json::parse(ReadFile(this->Json)).at("twins");
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all.at(0), run);
  EXPECT_EQ(all.at(1).at("search"), "exact");
  EXPECT_EQ(all.at(2).at("search"), "central-differences");
  EXPECT_EQ(all.at(3).at("search"), "annealing");
  EXPECT_EQ(all.at(1).at("truth"), run.at("truth"));
  EXPECT_EQ(all.at(3).at("equilibria"), all.at(2).at("equilibria"));
  EXPECT_GT(all.at(2).at("equilibria").get<int>(), all.at(1).at("equilibria").get<int>());

  this->ExpectRefused(this->Twins("twins", "--seed 2 --resume"), "same settings");
  this->ExpectRefused(this->Twins("twins", ""), "--overwrite");
}

TEST_F(ValidateCommand, StopsWithWhatIsDone)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  // Long before a thousand twins are done; the status is the program's. Without --foreground it is
  // interrupted twice, as one is who cannot wait.
  const std::string command = "timeout --foreground --preserve-status --signal INT 6 " +
    this->Program + " " + this->Twins("twins", "--kinds plain --count 1000") + " >" +
    this->Folder.File("out") + " 2>" + this->Folder.File("err");
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_THAT(ReadFile(this->Folder.File("err")), testing::HasSubstr("--resume goes on from"));
  if (fs::exists(this->Json))
  {
    EXPECT_FALSE(nlohmann::json::parse(ReadFile(this->Json)).at("twins").empty());
  }
  for (const auto& entry : fs::directory_iterator(this->Folder.File("")))
  {
    EXPECT_THAT(entry.path().filename().string(), testing::Not(testing::HasSubstr("partial")));
  }
}

TEST_F(ValidateCommand, RefusesUnusableInputInOneLine)
{
  const std::string to = " -o " + this->Json;
  const std::string ball = " --phantom ball=" + this->Folder.File("breast.nrrd");
  this->ExpectRefused("twins" + to, "folder of public test data");
  this->ExpectRefused("studies --data /nonexistent" + to, "/nonexistent");
  this->ExpectRefused("twins --phantom missing" + to, "NAME=FILE");
  this->ExpectRefused("twins --phantom a=missing.nrrd" + to, "missing.nrrd: no such file");
  this->ExpectRefused(this->Twins("twins", "--materials victer"), "did you mean victre?");
  const std::string other = this->Folder.Write("other.json", "{}");
  this->ExpectRefused("twins --resume -o " + other + ball, "expected a file of mammoray-validate");
  const std::string out = this->Folder.File("benchmark");
  this->ExpectRefused("benchmark --phantom a=missing.nrrd -o " + out, "missing.nrrd: no such");
  this->ExpectRefused("benchmark --anatomy bull -o " + out + ball, "did you mean ball?");
  this->ExpectRefused("study --labels nowhere.nrrd -o " + out, "nowhere.nrrd");
  EXPECT_FALSE(fs::exists(out));
  // The test's own folder holds what the program printed.
  this->ExpectRefused("study -o " + this->Folder.File(""), "expected a new or an empty folder");
  EXPECT_EQ(this->Run(""), 2);
  EXPECT_EQ(this->Run("twins --phantom a=b"), 2);
  EXPECT_EQ(this->Run(this->Twins("twins", "--kinds everything")), 2);
  EXPECT_EQ(this->Run(this->Twins("twins", "--count -1")), 2);
  EXPECT_EQ(this->Run("study --side up -o " + out), 2);
  EXPECT_FALSE(fs::exists(this->Json));
}
