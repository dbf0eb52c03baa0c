// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "OptionList.h"
#include "OutputFiles.h"
#include "ProgressBar.h"
#include "SharedOptions.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/Study/Intake.h"

#include <cstdio>
#include <vector>

namespace mammoray
{
namespace
{
struct IntakeArguments
{
  std::string Folder;
  std::optional<char> Side;
  std::vector<int> Series;
  std::string Json;
};

void Declare(const OptionList& add, IntakeArguments& arguments)
{
  add("folder", arguments.Folder, "folder of a clinic's export: MRI and mammograms in any folders")
    ->required();
  AddSideOption(add, arguments.Side);
  add(Shared::Series, arguments.Series);
  add("--json", arguments.Json, "write the same there, with the names of all files (.json)");
}

void Run(IntakeArguments& arguments)
{
  if (!arguments.Json.empty())
  {
    CheckOutputFile(arguments.Json, ".json", "a listing");
  }
  const StudyChoice choice = ChooseForRegistration(ReadStudy(arguments.Folder, MakeProgressBar()),
    arguments.Side, arguments.Series);
  if (!arguments.Json.empty())
  {
    WriteAtomicFile(arguments.Json, StudyJson(choice));
  }
  std::fputs(StudyListing(choice).c_str(), stdout);
  std::fflush(stdout);
  choice.Require(); // whose line is all there is to say then
  for (const std::string& warning : choice.Warnings)
  {
    std::fprintf(stderr, "warning: %s\n", warning.c_str());
  }
}
}

void AddIntakeCommand(CLI::App& application)
{
  AddCommand<IntakeArguments>(application, "intake",
    "What a clinic's export holds, by the headers of its files, and what 'register --study' takes "
    "of "
    "it and why:\nT1-weighted series before contrast, without and with fat suppression, and CC and "
    "MLO of one side.\nExit code 1 with one line where that cannot be registered: no MRI, no "
    "mammogram of the side, two patients.",
    "intake export/ --side left", Declare, Run);
}
}
