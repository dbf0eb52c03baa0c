// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "OutputFiles.h"
#include "SharedOptions.h"
#include "mammoray/Foundation/Error.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

namespace mammoray
{
namespace
{
/// The program of the desktop application; it alone needs Qt. Beside this one where both were
/// built, elsewhere where they were installed. Empty: there is none.
std::filesystem::path FindDesktopProgram()
{
  const std::filesystem::path own = ProgramFolder();
  for (const std::filesystem::path& folder : { own, own.parent_path() / MAMMORAY_LIBEXEC })
  {
    if (std::filesystem::exists(folder / "mammoray-app"))
    {
      return folder / "mammoray-app";
    }
  }
  return {};
}

struct AppArguments
{
  std::string Path;
  std::vector<std::string> Mammograms;
  bool Benchmark = false;
};

void Declare(const OptionList& add, AppArguments& arguments)
{
  add.Input("path", arguments.Path, "a result, a study or a scene to begin with");
  add.File("--mammogram", arguments.Mammograms,
    "the mammograms of a result, which it does not keep");
  add.Expert().Flag("--benchmark", arguments.Benchmark,
    "print how fast the views of the result are, and stop");
}

void Run(AppArguments& arguments)
{
  if (!arguments.Path.empty() && !std::filesystem::exists(arguments.Path))
  {
    throw InputError(arguments.Path + ": no such file or folder");
  }
  for (const std::string& file : arguments.Mammograms)
  {
    CheckInputFile(file);
  }
  const std::filesystem::path program = FindDesktopProgram();
  if (program.empty())
  {
    throw InputError("app: expected the desktop application, found none; the package mammoray-app "
                     "has it, and builds that find Qt and VTK's module for it (libvtk9-qt-dev)");
  }
  std::vector<std::string> words{ program.string() };
  for (const std::string& file : arguments.Mammograms)
  {
    words.insert(words.end(), { "--mammogram", file });
  }
  if (arguments.Benchmark)
  {
    words.emplace_back("--benchmark");
  }
  if (!arguments.Path.empty())
  {
    words.insert(words.end(), { "--", arguments.Path });
  }
  const std::string& device = Program().Projector.Device;
  if (!device.empty())
  {
    setenv("MAMMORAY_DEVICE", device.c_str(), 1);
  }
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words)
  {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);
  execv(program.c_str(), pointers.data());
  throw Error("app: " + program.string() + " cannot be started (" + std::strerror(errno) + ")");
}
}

void AddAppCommand(CLI::App& application)
{
  AddCommand<AppArguments>(application, "app",
    "The desktop application: studies, results and scenes in a window", "app result", Declare, Run);
}
}
