// SPDX-License-Identifier: Apache-2.0
// What is written is read again, stands in docs/reference/commands/result-keys.md, and is refused
// in one line where it is damaged.
#include "Files.h"
#include "Refusals.h"
#include "TestResults.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/PoseParameters.h"
#include "mammoray/Study/Private/Checkpoint.h"
#include "mammoray/Study/ResultFile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <regex>
#include <set>

using mammoray::test::RefusalOf;
using namespace mammoray;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Json = nlohmann::ordered_json;

namespace
{
/// Names of all fields as in the docs: `placement.x`, `parameters[].name`, `versions.NAME`.
void CollectFields(const Json& json, const std::string& prefix, std::set<std::string>& names)
{
  for (const auto& [key, value] : json.items())
  {
    const std::string name = prefix == "versions." ? "versions.NAME" : prefix + key;
    names.insert(name);
    if (value.is_object())
    {
      CollectFields(value, name + ".", names);
    }
    if (value.is_array() && !value.empty() && value.front().is_object())
    {
      CollectFields(value.front(), name + "[].", names);
    }
  }
}

/// The first cells of the tables below a heading of docs/reference/commands/result-keys.md.
std::set<std::string> DocumentedFields(const std::string& heading)
{
  std::string text =
    test::ReadFile(test::DataFolder() + "/../docs/reference/commands/result-keys.md");
  const std::size_t begin = text.find("\n## " + heading + "\n");
  EXPECT_NE(begin, std::string::npos) << heading;
  text = text.substr(begin + 1);
  text = text.substr(0, text.find("\n## "));
  std::set<std::string> names;
  const std::regex row("\n\\| `([^`]+)`");
  for (std::sregex_iterator match(text.begin(), text.end(), row), end; match != end; ++match)
  {
    names.insert((*match)[1]);
  }
  return names;
}

Json ReadJson(const test::TemporaryFolder& folder)
{
  return Json::parse(test::ReadFile(folder.File("result.json")));
}

/// Every object in the file: damages each of its fields in turn, once by taking it away and once by
/// another type, and expects to be told of it.
void ExpectEveryFieldNeeded(const test::TemporaryFolder& folder, const Json& whole,
  const Json::json_pointer& at, const std::string& prefix, const std::function<void()>& read)
{
  for (const auto& [key, value] : whole.at(at).items())
  {
    const std::string name = prefix + key;
    const bool texts = prefix == "versions."; // any names may stand here, and none
    for (const bool absent : { true, false })
    {
      if (absent && (texts || name == "notes")) // which older files lack
      {
        continue;
      }
      Json damaged = whole;
      if (absent)
      {
        damaged.at(at).erase(key);
      }
      else
      {
        damaged.at(at)[key] = value.is_boolean() ? Json("no") : Json(true);
      }
      folder.Write("result.json", damaged.dump());
      const std::string message = RefusalOf(read);
      EXPECT_THAT(message,
        AllOf(StartsWith(folder.File("result.json") + ": field '" + name + "': expected "),
          HasSubstr(absent         ? ", found none"
              : value.is_boolean() ? ", found \"no\""
                                   : ", found true"),
          Not(HasSubstr("\n"))));
    }
    if (value.is_object())
    {
      ExpectEveryFieldNeeded(folder, whole, at / key, name + ".", read);
    }
    if (value.is_array() && !value.empty() && value.front().is_object())
    {
      ExpectEveryFieldNeeded(folder, whole, at / key / 0, name + "[0].", read);
    }
  }
}
}

TEST(ResultFile, ReadsWhatWasWritten)
{
  const test::TemporaryFolder folder;
  const ResultFile written = test::MakeResultFile();
  WriteResultFile(written, folder.File(""));
  const ResultFile read = ReadResultFile(folder.File(""));
  EXPECT_EQ(read.Folder, folder.File(""));
  EXPECT_EQ(read.Trust.Level, Trust::Doubtful);
  EXPECT_EQ(read.Trust.Reasons, written.Trust.Reasons);
  EXPECT_EQ(read.Axes.Anterior, written.Axes.Anterior);
  EXPECT_EQ(ValuesOf(read.Pose), ValuesOf(written.Pose));
  EXPECT_TRUE(std::isnan(read.Parameters[1].StandardDeviation));
  EXPECT_TRUE(std::isnan(read.After.LargestOutlineDistanceMm));
  EXPECT_EQ(read.Iterations[1].Parameters, written.Iterations[1].Parameters);
  EXPECT_EQ(read.Mammogram.Laterality, 'L');
  EXPECT_FALSE(read.Mammogram.SourceToDetectorMm.has_value());
  EXPECT_EQ(read.Versions, written.Versions);
  // Whatever was not looked at above: it is written as it was.
  const std::string bytes = test::ReadFile(folder.File("result.json"));
  WriteResultFile(read, folder.File(""));
  EXPECT_EQ(test::ReadFile(folder.File("result.json")), bytes);
}

TEST(ResultFile, WithoutNotesIsOneThatHasNone)
{
  const test::TemporaryFolder folder;
  WriteResultFile(test::MakeResultFile(), folder.File(""));
  EXPECT_THAT(ReadResultFile(folder.File("")).Notes,
    testing::ElementsAre("*.nii: one of two was taken"));
  Json older = ReadJson(folder);
  EXPECT_EQ(older.erase("notes"), 1u);
  folder.Write("result.json", older.dump());
  EXPECT_THAT(ReadResultFile(folder.File("")).Notes, testing::IsEmpty());
}

TEST(ResultFile, KeepsEveryDigit)
{
  const test::TemporaryFolder folder;
  ResultFile result = test::MakeResultFile();
  result.Placed.Origin = { 0.1 + 0.2, 1.0 / 3.0, -1e-17 };
  WriteResultFile(result, folder.File(""));
  EXPECT_EQ(ReadResultFile(folder.File("")).Placed.Origin, result.Placed.Origin);
}

TEST(ResultFile, ReadsAJointResultThatWasWritten)
{
  const test::TemporaryFolder folder;
  WriteResultFile(test::MakeJointResultFile(), folder.File(""));
  const JointResultFile read = ReadJointResultFile(folder.File(""));
  ASSERT_EQ(read.Mammograms.size(), 2u);
  EXPECT_EQ(read.Mammograms[1].Level, Trust::None);
  EXPECT_EQ(read.Unknowns[0].Folder, "cc");
  EXPECT_FALSE(read.Unknowns[1].Folder.has_value());
  const std::string bytes = test::ReadFile(folder.File("result.json"));
  WriteResultFile(read, folder.File(""));
  EXPECT_EQ(test::ReadFile(folder.File("result.json")), bytes);
}

TEST(ResultFile, AFolderHasTheResultsOfAllItsMammograms)
{
  const test::TemporaryFolder folder;
  const std::string joint = folder.File("joint");
  for (const char* name : { "joint/cc", "joint/mlo" })
  {
    std::filesystem::create_directories(folder.File(name));
    ResultFile result = test::MakeResultFile();
    result.Mammogram.View = name;
    WriteResultFile(result, folder.File(name));
  }
  WriteResultFile(test::MakeJointResultFile(), joint);
  const std::vector<ResultFile> results = ReadResultFiles(joint);
  ASSERT_EQ(results.size(), 2u);
  EXPECT_EQ(results[0].Folder, joint + "/cc");
  EXPECT_EQ(results[1].Mammogram.View, "joint/mlo");
  ASSERT_EQ(ReadResultFiles(joint + "/cc").size(), 1u);
  EXPECT_EQ(RefusalOf([&] { ReadResultFile(joint); }),
    joint +
      ": expected the result of one mammogram, found one of 2; give one of its folders, such as " +
      joint + "/cc");
  EXPECT_THAT(RefusalOf([&] { ReadJointResultFile(joint + "/cc"); }),
    HasSubstr("expected the result of several mammograms, found that of one"));
}

TEST(ResultFile, DocumentationHasEveryFieldAndNoOther)
{
  const test::TemporaryFolder folder;
  std::set<std::string> names;
  WriteResultFile(test::MakeResultFile(), folder.File(""));
  CollectFields(ReadJson(folder), "", names);
  EXPECT_EQ(names, DocumentedFields("One mammogram"));
  names.clear();
  WriteResultFile(test::MakeJointResultFile(), folder.File(""));
  CollectFields(ReadJson(folder), "", names);
  EXPECT_EQ(names, DocumentedFields("Several mammograms"));
}

TEST(ResultFile, RefusesADamagedFieldInOneLine)
{
  const test::TemporaryFolder folder;
  WriteResultFile(test::MakeResultFile(), folder.File(""));
  ExpectEveryFieldNeeded(folder, ReadJson(folder), Json::json_pointer(), "",
    [&] { ReadResultFile(folder.File("")); });
  WriteResultFile(test::MakeJointResultFile(), folder.File(""));
  ExpectEveryFieldNeeded(folder, ReadJson(folder), Json::json_pointer(), "",
    [&] { ReadJointResultFile(folder.File("")); });
}

TEST(ResultFile, RefusesAnotherFileInOneLine)
{
  const test::TemporaryFolder folder;
  const std::string path = folder.File("result.json");
  const auto refusal = [&] { return RefusalOf([&] { ReadResultFiles(folder.File("")); }); };
  EXPECT_EQ(refusal(), path + ": no such file");
  folder.Write("result.json", "{ \"format\": ");
  EXPECT_THAT(refusal(),
    AllOf(StartsWith(path + ": expected the result of"), Not(HasSubstr("\n"))));
  folder.Write("result.json", "[]");
  EXPECT_THAT(refusal(), HasSubstr("found no JSON object"));
  WriteResultFile(test::MakeResultFile(), folder.File(""));
  const Json whole = ReadJson(folder);
  const auto damaged = [&](const Json::json_pointer& at, const Json& value)
  {
    Json json = whole;
    json[at] = value;
    folder.Write("result.json", json.dump());
    return refusal();
  };
  EXPECT_EQ(damaged("/formatVersion"_json_pointer, 1),
    path + ": field 'formatVersion': expected 5, found 1");
  EXPECT_EQ(damaged("/format"_json_pointer, "recipe"),
    path +
      ": field 'format': expected 'mammoray-registration-result' or "
      "'mammoray-joint-registration-result', found \"recipe\"");
  EXPECT_EQ(damaged("/trust/level"_json_pointer, "some"),
    path + ": field 'trust.level': expected good, doubtful or none, found \"some\"");
  EXPECT_EQ(damaged("/grid/originMm"_json_pointer, { 1, 2, 3 }),
    path + ": field 'grid.originMm': expected 2 numbers, found [1,2,3]");
  EXPECT_EQ(damaged("/placement/x/1"_json_pointer, nullptr),
    path + ": field 'placement.x[1]': expected a number, found null");
  EXPECT_EQ(damaged("/covariance"_json_pointer, { 1, 2, 3 }),
    path + ": field 'covariance': expected 81 numbers, found 3");
  EXPECT_EQ(damaged("/parameters/1/name"_json_pointer, "rool"),
    path + ": field 'parameters': expected " + PoseParameterNames() +
      ", found 9, of which 1 are as expected");
  EXPECT_EQ(damaged("/grid/columns"_json_pointer, 1.5),
    path + ": field 'grid.columns': expected a whole number, found 1.5");
}

// With which a point of the volume would still be "found" somewhere in the mammogram.
TEST(ResultFile, RefusesGeometryThatNoRegistrationWrites)
{
  const test::TemporaryFolder folder;
  WriteResultFile(test::MakeResultFile(), folder.File(""));
  const Json whole = ReadJson(folder);
  const auto refusal = [&](const char* at, const Json& value)
  {
    Json json = whole;
    json[Json::json_pointer(at)] = value;
    folder.Write("result.json", json.dump());
    const std::string told = RefusalOf([&] { ReadResultFiles(folder.File("")); });
    return told.substr(std::min(told.find("field"), told.size()));
  };
  EXPECT_EQ(refusal("/grid/columns", -5), "field 'grid.columns': expected 1 to 65535, found -5");
  EXPECT_THAT(refusal("/grid/rows", 2147483647), StartsWith("field 'grid.rows': expected 1 to"));
  EXPECT_THAT(refusal("/grid/columnStepMm", { 0, 0 }), StartsWith("field 'grid.columnStepMm'"));
  EXPECT_EQ(refusal("/grid/rowStepMm", { -2, 1 }),
    "field 'grid.rowStepMm': expected a step at a right angle to columnStepMm, found -2, 1");
  const std::string axes = "expected unit vectors at right angles to each other, found others";
  EXPECT_EQ(refusal("/placement/x", { 0, 0, 0 }), "field 'placement': " + axes);
  EXPECT_EQ(refusal("/placement/y", { 0, 0.9, 0.1 }), "field 'placement': " + axes);
  EXPECT_EQ(refusal("/axes/left", { 1e308, 0, 0 }), "field 'axes': " + axes);
  EXPECT_THAT(refusal("/placement/originMm", { 1e308, 1e308, 0 }),
    StartsWith("field 'placement.originMm'"));
  EXPECT_EQ(refusal("/unit/sourceToDetectorMm", -650),
    "field 'unit.sourceToDetectorMm': expected 1 to 100000, found -650");
  EXPECT_EQ(refusal("/covariance/10", -0.5),
    "field 'covariance': expected variances of at least 0, found -0.5");
  EXPECT_THAT(refusal("/parameters/0/value", 0), HasSubstr("of the thickness"));
  EXPECT_THAT(refusal("/parameters/3/value", 1e308), StartsWith("field 'parameters[].value'"));
}

// A checkpoint is given to `--resume`, as a result is. What is shown of a field would be printed by
// recursion.
TEST(ResultFile, RefusesBracketsThatNoStackHolds)
{
  const test::TemporaryFolder folder;
  const std::size_t depth = 300'000;
  const std::string nested =
    R"({"format":)" + std::string(depth, '[') + std::string(depth, ']') + "}";
  const std::string refusal = ": expected JSON, found it nested deeper than 64";
  const std::string result = folder.Write("result.json", nested);
  EXPECT_EQ(RefusalOf([&] { ReadResultFiles(folder.File("")); }), result + refusal);
  const std::string checkpoint = folder.Write("checkpoint.json", nested);
  EXPECT_EQ(RefusalOf([&] { ReadSearchPoints(checkpoint); }), checkpoint + refusal);
}

TEST(ResultFile, RefusesAFolderThatCannotBeWritten)
{
  EXPECT_THROW(WriteResultFile(test::MakeResultFile(), "/nonexistent/folder"), InputError);
}
