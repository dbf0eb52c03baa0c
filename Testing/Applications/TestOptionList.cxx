// SPDX-License-Identifier: Apache-2.0
// What an option's declaration promises: default and unit in the help, ranges, words, round trip.
#include "Files.h"
#include "Help.h"
#include "OptionList.h"
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <string>

using namespace mammoray;

namespace
{
enum class Wall
{
  Fixed,
  Sliding
};

struct Arguments
{
  double ThicknessMm = 50;
  std::optional<double> ForceN;
  std::vector<double> PixelSizesMm{ 3, 1.5 };
  double ShiftMm = 0;
  double Friction = 0;
  std::vector<int> Layers;
  unsigned Seed = 1;
  std::optional<std::array<double, 3>> Point;
  std::array<int, 2> Size{ 1280, 800 };
  Wall Attachment = Wall::Fixed;
  bool Quick = false;
  bool Correct = true;
  std::string Mesh;
  std::string Reference;
  std::vector<std::string> Pictures;
  std::string Output;
};

/// What the last command was run with.
Arguments given;

void Declare(const OptionList& add, Arguments& arguments)
{
  add("--thickness", arguments.ThicknessMm, Positive("mm"), "distance of the plates");
  add("--force", arguments.ForceN, Positive("N"), "of the paddle");
  add("--pixel-sizes", arguments.PixelSizesMm, Positive("mm"), "coarse to fine");
  add.Expert()("--shift", arguments.ShiftMm, "mm", "of the breast\nas a whole");
  add.CaseFile()("--friction", arguments.Friction, NonNegative(), "of the plates");
  add("--layers", arguments.Layers, "whole numbers");
  add("--seed", arguments.Seed, "of what is drawn");
  add.Numbers("--point", arguments.Point, "X Y Z", "a place");
  add.Numbers("--size", arguments.Size, "W H", "of the window");
  add.Choice<Wall>("--chest-wall", arguments.Attachment,
    { { "fixed", Wall::Fixed }, { "sliding", Wall::Sliding } }, "how it is attached");
  add.Group("Speed").Flag("--quick", arguments.Quick, "coarsely");
  add.FlagOff("--no-correction", arguments.Correct, "leave it");
  add.Input("--mesh", arguments.Mesh, "to press");
  add.File("--reference", arguments.Reference, "to compare with");
  add.Input("--picture", arguments.Pictures, "to compare with");
  add("--output", arguments.Output, "to write");
}

void Keep(Arguments& arguments)
{
  given = arguments;
}

class OptionListTest : public testing::Test
{
protected:
  OptionListTest()
    : Command(AddCommand<Arguments>(this->Application, "press", "Presses.", "press", Declare, Keep))
  {
    SetUpHelp(this->Application);
  }

  void Parse(const std::string& arguments)
  {
    given = {};
    this->Application.parse("press " + arguments);
  }

  CLI::App Application{ "test" };
  mammoray::Command* Command;
};
}

TEST_F(OptionListTest, VariablesKeepTheirValuesUnlessGiven)
{
  this->Parse("");
  EXPECT_EQ(given.ThicknessMm, 50);
  EXPECT_FALSE(given.ForceN);
  EXPECT_EQ(given.PixelSizesMm, (std::vector<double>{ 3, 1.5 }));
  EXPECT_FALSE(given.Point);
  EXPECT_EQ(given.Size, (std::array<int, 2>{ 1280, 800 }));
  EXPECT_EQ(given.Attachment, Wall::Fixed);
  EXPECT_FALSE(given.Quick);
  EXPECT_TRUE(given.Correct);
}

TEST_F(OptionListTest, VariablesTakeWhatIsGiven)
{
  this->Parse("--thickness 41.5 --force 90 --pixel-sizes 4 2 1 --point 1 -2 3.5 --size 640 480 "
              "--chest-wall sliding --quick --no-correction");
  EXPECT_EQ(given.ThicknessMm, 41.5);
  EXPECT_EQ(given.ForceN, 90);
  EXPECT_EQ(given.PixelSizesMm, (std::vector<double>{ 4, 2, 1 }));
  EXPECT_EQ(given.Point, (std::array<double, 3>{ 1, -2, 3.5 }));
  EXPECT_EQ(given.Size, (std::array<int, 2>{ 640, 480 }));
  EXPECT_EQ(given.Attachment, Wall::Sliding);
  EXPECT_TRUE(given.Quick);
  EXPECT_FALSE(given.Correct);
}

TEST_F(OptionListTest, HelpTellsUnitRangeAndDefault)
{
  const std::string help = this->Command->help();
  for (const char* line : { "  --thickness mm              distance of the plates (default 50)\n",
         "  --pixel-sizes mm ...        coarse to fine (default [3,1.5])\n",
         "  --chest-wall fixed|sliding  how it is attached (default fixed)\n",
         "  --force N                   of the paddle\n", "  --point X Y Z               a place\n",
         "Speed:\n", "Of every command:\n" })
  {
    EXPECT_THAT(help, testing::HasSubstr(line));
  }
  EXPECT_THAT(this->Command->help("", CLI::AppFormatMode::All),
    testing::HasSubstr("distance of the plates (greater than 0; default 50)"));
}

TEST_F(OptionListTest, ExpertsAndCaseFilesHaveMore)
{
  const std::string few = this->Command->help();
  EXPECT_THAT(few, testing::Not(testing::HasSubstr("--shift")));
  EXPECT_THAT(few, testing::HasSubstr("--help-all lists 6 more options"));
  const std::string all = this->Command->help("", CLI::AppFormatMode::All);
  EXPECT_THAT(all, testing::HasSubstr("--shift mm                  of the breast as a whole"));
  EXPECT_THAT(all, testing::Not(testing::HasSubstr("friction ")));
  EXPECT_THROW(CheckWords(this->Application, { "press", "--friction", "0.5" }), CLI::ParseError);
  const test::TemporaryFolder folder;
  const std::string file =
    folder.Write("press.json", R"({ "$schema": "case.schema.json", "friction": 0.5, "shift": 2 })");
  this->Parse("--shift 3 --config " + file);
  EXPECT_EQ(given.Friction, 0.5);
  EXPECT_EQ(given.ShiftMm, 3);
  EXPECT_THROW(this->Parse("--config " + folder.Write("press.json", R"({ "friction": -1 })")),
    CLI::ParseError);
}

TEST_F(OptionListTest, ConfigurationRoundTrips)
{
  this->Parse("--thickness 41.5 --point 1 -2 3.5 --chest-wall sliding --quick");
  const std::string printed = PrintedConfiguration(*this->Command);
  for (const char* entry : { "\"thickness\": 41.5", "\"chest-wall\": \"sliding\"",
         "\"quick\": true", "\"overwrite\": false", "\"no-correction\": false", "\"friction\": 0" })
  {
    EXPECT_THAT(printed, testing::HasSubstr(entry));
  }
  EXPECT_THAT(printed, testing::Not(testing::HasSubstr("force")));
}

TEST_F(OptionListTest, InputsAreFilesOrFolders)
{
  const test::TemporaryFolder folder;
  ASSERT_EQ(mkfifo(folder.File("pipe").c_str(), 0600), 0);
  const auto refusal = [&](const std::string& path)
  { return test::RefusalOf([&] { this->Parse("--picture /none --picture " + path); }); };
  EXPECT_EQ(refusal(folder.File("pipe")),
    folder.File("pipe") + ": expected a file or a folder, found a pipe");
  EXPECT_EQ(refusal("/dev/zero"), "/dev/zero: expected a file or a folder, found a device");
  const std::string pipes = folder.Write("pipes.json", R"({ "mesh": "pipe" })");
  EXPECT_EQ(test::RefusalOf([&] { this->Parse("--config " + pipes); }),
    folder.File("pipe") + ": expected a file or a folder, found a pipe");
  for (const std::string& path : { folder.File(""), pipes, folder.File("none") })
  {
    EXPECT_EQ(refusal(path), test::NotRefused);
  }
  const std::string none = folder.File("none");
  EXPECT_EQ(test::RefusalOf([&] { this->Parse("--reference " + none); }), none + ": no such file");
}

TEST_F(OptionListTest, ConfigurationNamesWhatLiesBesideIt)
{
  const test::TemporaryFolder folder;
  folder.Write("cube.vtu", "");
  folder.Write("b.png", "");
  const std::string file = folder.Write("press.json",
    R"({ "mesh": "cube.vtu", "picture": [ "/a.png", "b.png", "c.png" ], "output": "b.png" })");
  this->Application.parse("press --config " + file);
  EXPECT_EQ(given.Mesh, folder.File("cube.vtu"));
  // What is not there stays a name, for a shipped file or for one of the working folder; what is
  // written goes where the user is.
  EXPECT_THAT(given.Pictures, testing::ElementsAre("/a.png", folder.File("b.png"), "c.png"));
  EXPECT_EQ(given.Output, "b.png");
}

TEST_F(OptionListTest, ConfigurationWithAnUnknownOptionIsRefusedWithANearOne)
{
  const test::TemporaryFolder folder;
  const std::string file = folder.Write("press.json", R"({ "meshes": "cube.vtu" })");
  try
  {
    this->Application.parse("press --config " + file);
    FAIL() << "taken";
  }
  catch (const CLI::ParseError& error)
  {
    EXPECT_EQ(std::string(error.what()), file + ": unknown option 'meshes'; did you mean mesh?");
  }
}

TEST_F(OptionListTest, CommandLineNamesWhatLiesInTheWorkingFolder)
{
  const test::TemporaryFolder folder;
  folder.Write("cube.vtu", "");
  const std::string file = folder.Write("press.json", R"({ "mesh": "cube.vtu" })");
  this->Application.parse("press --config " + file + " --mesh cube.vtu");
  EXPECT_EQ(given.Mesh, "cube.vtu");
}

TEST_F(OptionListTest, RefusesWhatIsBeyondTheRange)
{
  for (const char* unusable : { "--thickness 0", "--thickness nan", "--thickness inf",
         "--pixel-sizes 3 -1", "--chest-wall loose", "--point 1 2", "--point 1 2 inf" })
  {
    EXPECT_THROW(this->Parse(unusable), CLI::ParseError) << unusable;
  }
}

TEST_F(OptionListTest, TellsWhichNumbersAreExpected)
{
  const auto refusal = [this](const std::string& arguments) -> std::string
  {
    try
    {
      this->Parse(arguments);
    }
    catch (const CLI::ParseError& error)
    {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal("--force many"), "--force: expected a number greater than 0, found many");
  EXPECT_EQ(refusal("--shift x"), "--shift: expected a number, found x");
  EXPECT_EQ(refusal("--shift=-inf"), "--shift: expected a number, found -inf");
  EXPECT_EQ(refusal("--point 1 y 2"), "--point: expected a number, found y");
  EXPECT_EQ(refusal("--layers 1 2.5"), "--layers: expected a whole number, found 2.5");
  EXPECT_EQ(refusal("--layers 3e9"),
    "--layers: expected a whole number from -2147483648 to 2147483647, found 3e9");
  EXPECT_EQ(refusal("--seed=-1"), "--seed: expected a whole number from 0 to 4294967295, found -1");
  // Never 8, and never 16.
  EXPECT_EQ(refusal("--seed 010"),
    "--seed: expected a whole number without zeros before it, found 010");
  EXPECT_EQ(refusal("--layers 1 0x10"),
    "--layers: expected a whole number without zeros before it, found 0x10");
  EXPECT_EQ(refusal("--force 0x10"), "--force: expected a number greater than 0, found 0x10");
  EXPECT_EQ(refusal("--shift=-0x1p4"), "--shift: expected a number, found -0x1p4");
  EXPECT_EQ(refusal("--seed 0 --layers -0 --shift 0.5 --force 05"), "");
  EXPECT_EQ(given.ForceN, 5);
  EXPECT_EQ(refusal("--shift=-3 --layers 1 -2 --seed 7 --size 1 2"), "");
  EXPECT_EQ(given.ShiftMm, -3);
  EXPECT_EQ(given.Layers, (std::vector<int>{ 1, -2 }));
  EXPECT_EQ(given.Seed, 7u);
}

TEST(Quantity, RangesIncludeTheirEnds)
{
  const auto refusal = [](const Quantity& quantity, const std::string& text)
  {
    std::string number = text;
    return NumberIn<double>(quantity)(number);
  };
  EXPECT_EQ(refusal(Between(-30, 30), "-30"), "");
  EXPECT_EQ(refusal(Between(-30, 30), "30"), "");
  EXPECT_EQ(refusal(Between(-30, 30), "30.5"), "expected a number from -30 to 30, found 30.5");
  EXPECT_EQ(refusal(NonNegative(), "0"), "");
  EXPECT_EQ(refusal(NonNegative(), "-1"), "expected a number not less than 0, found -1");
  EXPECT_EQ(refusal(Positive(), "0"), "expected a number greater than 0, found 0");
  EXPECT_EQ(refusal(Positive(), "nan"), "expected a number greater than 0, found nan");
}

TEST(SplitAssignment, NeedsBothSides)
{
  const std::string form = "MATERIAL=MM, for example skin=1.2";
  EXPECT_EQ(SplitAssignment("skin=1.2", "--thin", form),
    (std::pair<std::string, std::string>("skin", "1.2")));
  EXPECT_EQ(SplitAssignment("a=b=c", "--thin", form).second, "b=c");
  for (const char* text : { "skin", "=1.2", "skin=", "" })
  {
    EXPECT_THROW(SplitAssignment(text, "--thin", form), InputError) << text;
  }
}
