// SPDX-License-Identifier: Apache-2.0
#include "OutputFiles.h"

#include "ProgramOptions.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/Study/RegistrationCase.h"

#include <CLI/CLI.hpp>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <vector>

namespace mammoray
{
namespace fs = std::filesystem;

namespace
{
/// The files and folders that options of the running command name.
std::vector<fs::path>& GivenPaths()
{
  static std::vector<fs::path> paths;
  return paths;
}

bool IsWithin(const fs::path& path, const fs::path& folder)
{
  std::error_code ignored; // long names and circular links
  const fs::path inner = fs::weakly_canonical(path, ignored);
  const fs::path outer = fs::weakly_canonical(folder, ignored);
  return !outer.empty() && inner != outer &&
    std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

/// Throws InputError if the existing file is given more than `times` times, or is read as part of a
/// given folder.
void CheckIsNoInput(const fs::path& path, int times)
{
  const bool isReadInFolders =
    IsFileOfResult(path.filename().string()) || path.extension() == ".dcm";
  for (const fs::path& given : GivenPaths())
  {
    std::error_code ignored;
    times -= fs::equivalent(given, path, ignored) ? 1 : 0;
    if (times < 0 || (isReadInFolders && fs::is_directory(given, ignored) && IsWithin(path, given)))
    {
      throw InputError("output " + path.string() +
        ": expected a file that is not an input, found one of " + given.string());
    }
  }
}
}

void NoteGiven(const CLI::App& command)
{
  GivenPaths().clear();
  for (const CLI::Option* option : command.get_options({}))
  {
    std::error_code ignored;
    std::copy_if(option->results().begin(), option->results().end(),
      std::back_inserter(GivenPaths()),
      [&](const std::string& given) { return fs::exists(given, ignored); });
  }
}

void CheckInputFile(const std::string& path)
{
  const char* const problem = !fs::exists(path) ? ": no such file"
    : fs::is_directory(path)                    ? ": expected a file, found a folder"
    : !std::ifstream(path)                      ? ": cannot be opened for reading"
                                                : nullptr;
  if (problem)
  {
    throw InputError(path + problem);
  }
}

void CheckOutputPlace(const std::string& path)
{
  const auto require = [&](bool condition, const std::string& otherwise)
  {
    if (!condition)
    {
      throw InputError("output " + path + ": " + otherwise);
    }
  };
  require(!path.empty(), "expected a file name, found an empty one");
  const fs::path folder = fs::absolute(path).parent_path();
  require(fs::is_directory(folder), "there is no folder " + folder.string());
  require(access(folder.c_str(), W_OK) == 0, "the folder " + folder.string() + " is not writable");
  require(!fs::is_directory(path), "expected a file name, found a folder");
  require(Program().Overwrite || !fs::exists(path), "exists already; --overwrite replaces it");
  if (fs::exists(path))
  {
    CheckIsNoInput(path, 1); // the option of the output itself
  }
}

void CheckOutputFile(const std::string& path, const std::string& extension, const std::string& kind)
{
  CheckOutputPlace(path);
  if (!extension.empty() && fs::path(path).extension() != extension)
  {
    throw InputError(path + ": expected the extension " + extension + " for " + kind);
  }
  if (!ReserveFile(path))
  {
    throw InputError("output " + path + ": expected another file for each output, found it twice");
  }
}

void CheckOutputFileIfAny(const std::string& path)
{
  if (!path.empty())
  {
    CheckOutputFile(path);
  }
}

void CheckOutputBeside(const std::string& path)
{
  if (fs::exists(path))
  {
    CheckIsNoInput(path, 0);
  }
  CheckOutputFile(path);
}

void CheckPictureFile(const std::string& path)
{
  if (!path.empty())
  {
    CheckOutputFile(path, ".png", "a picture");
  }
}

void CheckNewFolder(const std::string& path)
{
  if (path.empty())
  {
    throw InputError("output: expected a new or an empty folder, found no name");
  }
  ReserveEmptyFolder(path);
}

void CheckNoInputWithin(const std::string& folder)
{
  for (const fs::path& given : GivenPaths())
  {
    if (IsWithin(given, folder))
    {
      throw InputError("output " + folder + ": holds the input " + given.string() +
        ", which would be replaced with it");
    }
  }
}

std::string BesideOutput(const std::string& output, const std::string& suffix)
{
  const fs::path path(output);
  return (path.parent_path() / path.stem()).string() + suffix + path.extension().string();
}
}
