// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "Manual.h"
#include "OptionList.h"
#include "mammoray/Foundation/Error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

using namespace mammoray;
using testing::HasSubstr;

namespace
{
struct PressArguments
{
  double ThicknessMm = 50;
  std::string Side = "left";
  std::string Mesh;
  double Friction = 0;
};

class ManualTest : public testing::Test
{
protected:
  ManualTest()
  {
    this->Application.description("Presses.\nLengths in mm.");
    AddCommand<PressArguments>(
      this->Application, "press", "Press a body\n.5 mm at a time",
      [](const OptionList& add, PressArguments& arguments)
      {
        add.Input("--mesh", arguments.Mesh, "to press")->required();
        add("--thickness", arguments.ThicknessMm, Positive("mm"), "distance of the plates");
        add.Group("Patient").Expert().Word("-s,--side", arguments.Side, { "left", "right" },
          "the patient's own");
        add.CaseFile()("--friction", arguments.Friction, NonNegative(), "of the plates");
      },
      [](PressArguments&) {});
  }

  CLI::App Application;
};
}

TEST_F(ManualTest, PageTellsEveryOptionAsHelpDoes)
{
  const std::string page = ManualPage(this->Application, "press");
  EXPECT_THAT(page, HasSubstr("mammoray\\-press \\- Press a body\n"));
  EXPECT_THAT(page, HasSubstr("\\fB\\-\\-mesh\\fR \\fIPATH\\fR (required)\nto press\n"));
  EXPECT_THAT(page, HasSubstr("\\fB\\-\\-thickness\\fR \\fImm"));
  EXPECT_THAT(page, HasSubstr(" (greater than 0; default 50)\ndistance of the plates"));
  EXPECT_THAT(page, HasSubstr(".SH PATIENT\n.TP\n\\fB\\-s\\fR, \\fB\\-\\-side\\fR"));
  EXPECT_THAT(page,
    HasSubstr(".SH SETTINGS OF THE CASE FILE (\\-\\-CONFIG)\n.TP\n\\fBfriction\\fR"));
  EXPECT_THAT(page, HasSubstr("\n\\&.5 mm at a time")) << "a request of roff";
}

TEST_F(ManualTest, ProgramListsItsCommands)
{
  const std::string page = ManualPage(this->Application, "");
  EXPECT_THAT(page, HasSubstr("\\fBpress\\fR\nPress a body\n"));
  EXPECT_THAT(page, HasSubstr("\\fBmammoray\\-press\\fR(1)"));
  EXPECT_THROW(ManualPage(this->Application, "pres"), InputError);
}

TEST_F(ManualTest, ShellCompletesCommandsOptionsAndWords)
{
  const test::TemporaryFolder folder;
  const std::string script = folder.Write("completion", CompletionScript(this->Application));
  const std::string answers = folder.File("answers");
  const auto complete = [&](const std::string& words)
  {
    const std::string command = "bash -c 'source " + script + "; COMP_WORDS=(mammoray " + words +
      "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _mammoray; echo \"${COMPREPLY[*]}\"' >" + answers;
    EXPECT_EQ(std::system(command.c_str()), 0);
    return test::ReadFile(answers);
  };
  EXPECT_EQ(complete("pr"), "press\n");
  EXPECT_EQ(complete("press --th"), "--thickness\n");
  EXPECT_EQ(complete("press --side ri"), "right\n");
  EXPECT_EQ(complete("press --fr"), "\n");
  EXPECT_EQ(complete("press --mesh pr"), "\n") << "files are left to the shell";
}
