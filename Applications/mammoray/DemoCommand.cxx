// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "SharedOptions.h"
#include "mammoray/IO/ShippedData.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <string>
#include <vector>

namespace mammoray
{
namespace
{
struct DemoArguments
{
  std::string Output = "demo-result";
};

void Declare(const OptionList& add, DemoArguments& arguments)
{
  add("-o,--output", arguments.Output, "folder for meshes, pictures, result.json and report.html");
}

/// Runs one of the two commands as a user would write it, and shows how.
void RunCommand(const std::vector<std::string>& words)
{
  std::string line = "mammoray";
  for (const std::string& word : words)
  {
    line += " " + word;
  }
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
  CLI::App application;
  AddRegisterCommand(application);
  AddEvaluateCommand(application);
  std::vector<std::string> lastFirst(words.rbegin(), words.rend()); // CLI11 takes them from the end
  application.parse(lastFirst);
}

void Run(DemoArguments& arguments)
{
  const std::string folder = DataDirectory() + "/victre-phantom-1";
  std::vector<std::string> words{ "register", "--config", folder + "/register.json", "--output",
    arguments.Output };
  if (const std::string& device = Program().Projector.Device; !device.empty())
  {
    words.insert(words.end(), { "--device", device });
  }
  if (Program().Overwrite)
  {
    words.emplace_back("--overwrite");
  }
  RunCommand(words);
  RunCommand({ "evaluate", "--config", folder + "/evaluate.json", "--result", arguments.Output });
  std::printf("open %s/report.html\n", arguments.Output.c_str());
}
}

void AddDemoCommand(CLI::App& application)
{
  AddCommand<DemoArguments>(application, "demo",
    "Register the shipped phantom to its mammogram, and print the error at known landmarks", "demo",
    Declare, Run);
}
}
