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

class EvidenceCommand : public test::CommandTest
{
protected:
  void SetUp() override
  {
    WriteLabelVolume(test::LabelledCube(48, 2, BreastLabel), this->Folder.File("breast.nrrd"));
  }

  /// The smallest that shows something: some hundred quadratic cells, and linear ones to match.
  std::string Twins(const std::string& rest) const
  {
    return "evidence --phantom ball=" + this->Folder.File("breast.nrrd") +
      " --orientation LPS --model-fineness 3 --target-fineness 8 --pixel-sizes 5 -o " + this->Json +
      " " + rest;
  }

  std::string Json = this->Folder.File("evidence.json");
};
}

TEST_F(EvidenceCommand, MeasuresTwinsAndGoesOn)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const std::string table = this->Folder.File("runs.csv");
  ASSERT_EQ(this->Run(this->Twins("--only plain --twins 1 --table " + table)), 0) << this->Errors;
  EXPECT_THAT(this->Output, testing::HasSubstr("| plain | ball | "));
  EXPECT_THAT(this->Output, testing::HasSubstr("| thickness, mm |"));
  EXPECT_THAT(ReadFile(table), testing::HasSubstr("\nball,plain,register,0,"));
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
  ASSERT_EQ(this->Run(this->Twins("--only plain,search --twins 1 --search-twins 1 --resume")), 0)
    << this->Errors;
  const nlohmann::json all = nlohmann::json::parse(ReadFile(this->Json)).at("twins");
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all.at(0), run);
  EXPECT_EQ(all.at(1).at("search"), "exact");
  EXPECT_EQ(all.at(2).at("search"), "central-differences");
  EXPECT_EQ(all.at(3).at("search"), "annealing");
  EXPECT_EQ(all.at(1).at("truth"), run.at("truth"));
  EXPECT_EQ(all.at(3).at("equilibria"), all.at(2).at("equilibria"));
  EXPECT_GT(all.at(2).at("equilibria").get<int>(), all.at(1).at("equilibria").get<int>());

  this->ExpectRefused(this->Twins("--only plain --twins 1 --seed 2 --resume"), "same settings");
  this->ExpectRefused(this->Twins("--only plain --twins 1"), "--overwrite");
}

TEST_F(EvidenceCommand, StopsWithWhatIsDone)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  // Long before a thousand twins are done; the status is the program's. Without --foreground it is
  // interrupted twice, as one is who cannot wait.
  const std::string command = "timeout --foreground --preserve-status --signal INT 6 " +
    test::MammorayExecutable() + " " + this->Twins("--only plain --twins 1000") + " >" +
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

TEST_F(EvidenceCommand, RefusesUnusableInputInOneLine)
{
  this->ExpectRefused("evidence -o " + this->Json, "folder of public test data");
  this->ExpectRefused("evidence --data /nonexistent -o " + this->Json, "/nonexistent");
  this->ExpectRefused("evidence --phantom missing --only plain -o " + this->Json, "NAME=FILE");
  this->ExpectRefused("evidence --phantom a=missing.nrrd --only plain -o " + this->Json,
    "missing.nrrd: no such file");
  this->ExpectRefused(this->Twins("--only plain --materials victer"), "did you mean victre?");
  this->Folder.Write("other.json", "{}");
  this->ExpectRefused("evidence --phantom ball=" + this->Folder.File("breast.nrrd") +
      " --only plain --resume -o " + this->Folder.File("other.json"),
    "expected what 'mammoray evidence' writes");
  EXPECT_EQ(this->Run("evidence --phantom a=b"), 2);
  EXPECT_EQ(this->Run("evidence --export out -o " + this->Json), 2);
  const std::string out = this->Folder.File("benchmark");
  this->ExpectRefused("evidence --phantom a=missing.nrrd --export " + out, "missing.nrrd: no such");
  this->ExpectRefused("evidence --phantom ball=" + this->Folder.File("breast.nrrd") +
      " --anatomy bull --export " + out,
    "did you mean ball?");
  EXPECT_FALSE(fs::exists(out));
  EXPECT_EQ(this->Run(this->Twins("--only everything")), 2);
  EXPECT_EQ(this->Run(this->Twins("--twins -1")), 2);
  EXPECT_FALSE(fs::exists(this->Json));
}
