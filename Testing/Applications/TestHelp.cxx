// SPDX-License-Identifier: Apache-2.0
#include "CommandTest.h"
#include "Help.h"
#include "OptionList.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

using namespace mammoray;
using testing::HasSubstr;

namespace
{
struct NoArguments
{
  double Gap = 1;
  double Friction = 0;
};

std::string RefusalOfWords(const std::vector<std::string>& words)
{
  CLI::App application;
  AddCommand<NoArguments>(
    application, "press", "Presses", "press",
    [](const OptionList& add, NoArguments& arguments)
    {
      add("--gap", arguments.Gap, "of the plates");
      add.CaseFile()("--friction", arguments.Friction, "of the plates");
    },
    [](NoArguments&) {});
  try
  {
    CheckWords(application, words);
  }
  catch (const CLI::ValidationError& error)
  {
    return error.what();
  }
  return "";
}

class HelpCommand : public test::CommandTest
{
};
}

TEST(Wrapped, GoesOnBelowTheSecondColumn)
{
  EXPECT_EQ(Wrapped("  --gap mm   distance of the plates\nshort\n", 24),
    "  --gap mm   distance of\n             the plates\nshort\n");
  EXPECT_EQ(Wrapped("one two three", 8), "one two\nthree\n");
  EXPECT_EQ(Wrapped("  averylongword and more", 8), "  averylongword\n  and\n  more\n");
  EXPECT_EQ(Wrapped("  one,two,three,four and so on", 12),
    "  one,two,\n  three,four\n  and so on\n");
  EXPECT_EQ(Wrapped("\n\n", 8), "\n\n");
}

TEST(CheckWords, SuggestsWhatMayHaveBeenMeant)
{
  EXPECT_EQ(RefusalOfWords({ "pres" }), "unknown command 'pres'; did you mean press?");
  EXPECT_EQ(RefusalOfWords({ "press", "--gape", "3" }),
    "unknown option '--gape'; did you mean --gap?");
  EXPECT_EQ(RefusalOfWords({ "press", "--gape=3" }),
    "unknown option '--gape'; did you mean --gap?");
  EXPECT_EQ(RefusalOfWords({ "press", "--gap", "-3", "--", "word" }), "");
  EXPECT_EQ(RefusalOfWords({ "press", "--friction", "1" }),
    "--friction: expected it in the case file (--config FILE.json), found it as an option");
  EXPECT_EQ(RefusalOfWords({ "--version" }), "");
}

TEST_F(HelpCommand, WithoutWordsListsTheCommands)
{
  EXPECT_EQ(this->Run(""), 2);
  EXPECT_THAT(this->Progress, HasSubstr("  register"));
}

TEST_F(HelpCommand, EveryCommandHasAnExampleOfItsOwnOptionsAndFitsTheWidth)
{
  ASSERT_EQ(this->Run("--help"), 0);
  std::istringstream lines(this->Output.substr(this->Output.find("Subcommands:")));
  std::string line;
  std::getline(lines, line);
  int commands = 0;
  while (std::getline(lines, line) && !line.empty())
  {
    std::string name;
    std::istringstream(line) >> name;
    if (!line.starts_with("  ") || line.starts_with("   "))
    {
      continue; // the rest of a description
    }
    ++commands;
    ASSERT_EQ(this->Run(name + " --help-all"), 0) << name;
    const std::string help = this->Output;
    const std::size_t example = help.find("Example: mammoray " + name);
    ASSERT_NE(example, std::string::npos) << name;
    std::istringstream words(help.substr(example));
    for (std::string word; words >> word;)
    {
      if (word.starts_with("-") && !std::isdigit(static_cast<unsigned char>(word[1])))
      {
        EXPECT_THAT(help.substr(0, example), HasSubstr(word)) << name;
      }
    }
    EXPECT_EQ(help.find("Option Group"), std::string::npos) << name;
    std::istringstream helpLines(help);
    bool afterOption = false;
    while (std::getline(helpLines, line))
    {
      EXPECT_LE(line.size(), 100u) << name << ": " << line;
      // What an option is for goes on in the second column.
      EXPECT_TRUE(!afterOption || line.empty() || line.starts_with("  -") ||
        line.starts_with(std::string(30, ' ')))
        << name << ": " << line;
      // A list of words may be longer than a line.
      afterOption = line.starts_with("  -") && !line.ends_with(',');
    }
  }
  EXPECT_GE(commands, 13);
}
