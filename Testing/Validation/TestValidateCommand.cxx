// SPDX-License-Identifier: Apache-2.0
// Twins of a coarse half-ellipsoid: the figures hold together, and runs go on where they stopped. A
// patient of half a ball, as the verb patients sees it.
#include "CommandTest.h"
#include "LabelShapes.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include <nlohmann/json.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <sstream>

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
  for (const int free : { 0, 1, 2, 3, 4, 5, 6, 7 })
  {
    EXPECT_GT(run.at("sigma").at(free).get<double>(), 0);
  }
  EXPECT_TRUE(run.at("sigma").at(8).is_null()); // stiffness, fixed

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

namespace
{
/// Half a ball of fat with a ball of gland before muscle; the front is -y. LPS, voxels of 2 mm.
IntensityVolume HalfBallMri()
{
  IntensityVolume image;
  image.Size = { 60, 50, 50 };
  image.Spacing = { 2, 2, 2 };
  image.Origin = { -59, -50, -49 };
  image.Voxels.resize(150000);
  image.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      const Vector3 point = image.PointAt(i, j, k);
      const float noise = static_cast<float>((7 * i + 11 * j + 13 * k) % 10);
      image.Voxels[voxel] = noise +
        (point[1] > 21                                                ? 350.0F
            : Norm(point - Vector3{ 0, -10, 0 }) < 12                 ? 400.0F
            : point[1] > 11 || Norm(point - Vector3{ 0, 18, 0 }) < 46 ? 1000.0F
                                                                      : 0.0F);
    });
  return image;
}

void WriteSeries(const IntensityVolume& image, const std::string& folder)
{
  fs::create_directories(folder);
  std::vector<std::string> paths;
  for (int slice = 0; slice < image.Size[2]; ++slice)
  {
    paths.push_back(folder);
    paths.back().append("/").append(std::to_string(slice)).append(".dcm");
  }
  DicomHeader header;
  header.PatientPosition = "HFP";
  WriteMrSeries(image, header, paths);
}

/// The axial slice through the middle, drawn as it is.
std::string HalfBallDrawn()
{
  nlohmann::json outline{ { -58, 11 } };
  nlohmann::json gland = nlohmann::json::array();
  for (int degree = 0; degree <= 360; degree += 5)
  {
    const double angle = degree * std::numbers::pi / 180;
    const double y = 18 - 46 * std::sin(angle);
    if (y < 11)
    {
      outline.push_back({ -46 * std::cos(angle), y });
    }
    gland.push_back({ 12 * std::cos(angle), -10 + 12 * std::sin(angle) });
  }
  outline.push_back({ 58, 11 });
  const nlohmann::json slice{ { "plane", "axial" }, { "position", 0.5 },
    { "judged", { -42, 42, -45, 30 } }, { "outline", { outline } }, { "gland", { gland } },
    { "chestWall", nlohmann::json::array({ { { -58, 21 }, { 58, 21 } } }) } };
  return nlohmann::json{ { "slices", { slice } } }.dump();
}
}

TEST_F(ValidateCommand, ComparesPatientsWithWhatWasDrawn)
{
  const std::string data = this->Folder.File("data");
  const std::string mri = data + "/uta11-breast-mri-CC-BY-SA-4.0/";
  WriteSeries(HalfBallMri(), mri + "y/t1-fat-suppressed");
  IntensityVolume even = HalfBallMri();
  even.Voxels.assign(even.Voxels.size(), 100);
  WriteSeries(even, mri + "x/t1-fat-suppressed");
  fs::create_directories(mri + "z/subtraction");
  fs::create_directories(this->Folder.File("drawn"));
  this->Folder.Write("drawn/uta11-y.json", HalfBallDrawn());
  const std::string out = this->Folder.File("patients");
  const std::string command =
    "patients --data " + data + " --truth " + this->Folder.File("drawn") + " -o " + out;
  ASSERT_EQ(this->Run(command), 0) << this->Errors;

  std::istringstream csv(ReadFile(out + "/patients.csv"));
  std::vector<std::string> rows;
  for (std::string row; std::getline(csv, row);)
  {
    rows.push_back(row);
    EXPECT_THAT(this->Output, testing::HasSubstr(row));
  }
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_THAT(rows[1], testing::MatchesRegex("uta11-x,[0-9.]+,,,,,,,,,,,,\"refused: .+\""));
  std::istringstream cells(rows[2]);
  std::vector<std::string> values;
  for (std::string cell; std::getline(cells, cell, ',');)
  {
    values.push_back(cell);
  }
  ASSERT_GE(values.size(), 13u);
  EXPECT_EQ(values[0], "uta11-y");
  // The cap of the ball above the slab and 10 mm of slab below it, cut 60 mm from the middle.
  EXPECT_NEAR(std::stod(values[2]), 276, 30);
  EXPECT_NEAR(std::stod(values[3]), 100 * 7.2 / 276, 0.8);
  // Half a voxel of 2 mm all over the surface costs 1 mm.
  EXPECT_GT(std::stod(values[7]), 0.96);
  EXPECT_GT(std::stod(values[8]), 0.85);
  EXPECT_LT(std::stod(values[9]), 1.2);
  EXPECT_LT(std::stod(values[11]), 1.5);
  for (const int part : { 4, 5, 6 }) // of wall and skin that show
  {
    EXPECT_GE(std::stod(values[static_cast<std::size_t>(part)]), 0);
    EXPECT_LE(std::stod(values[static_cast<std::size_t>(part)]), 1);
  }
  EXPECT_THAT(ReadFile(out + "/patients.png"), testing::StartsWith("\x89PNG"));
  EXPECT_TRUE(fs::exists(out + "/uta11-y.nrrd"));
  EXPECT_FALSE(fs::exists(out + "/uta11-x.nrrd"));

  this->ExpectRefused(command, "expected a new or an empty folder");
  this->Folder.Write("drawn/uta11-y.json", "{}");
  const std::string other = this->Folder.File("other");
  this->ExpectRefused("patients --data " + data + " --truth " + this->Folder.File("drawn") +
      " -o " + other,
    "y.json: not a file of drawn slices");
  this->ExpectRefused("patients --data /nonexistent -o " + other, "with MRI of patients");
  EXPECT_FALSE(fs::exists(other));
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
