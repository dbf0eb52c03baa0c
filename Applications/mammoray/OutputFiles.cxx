// SPDX-License-Identifier: Apache-2.0
#include "OutputFiles.h"

#include "mammoray/Foundation/Error.h"

#include "mammoray/IO/WholeOutput.h"
#include "mammoray/Study/RegistrationCaseWriter.h"

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
/// What options were given that is a file or a folder.
std::vector<fs::path>& GivenPaths()
{
  static std::vector<fs::path> paths;
  return paths;
}

bool IsWithin(const fs::path& path, const fs::path& folder)
{
  std::error_code none;
  const fs::path inner = fs::weakly_canonical(path, none);
  const fs::path outer = fs::weakly_canonical(folder, none);
  // Of a name that is too long, or links in a circle, there is none.
  return !outer.empty() && inner != outer &&
    std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

/// Throws InputError where the file, which is there, is read, too.
void CheckIsNoInput(const fs::path& path)
{
  int times = 0;
  for (const fs::path& given : GivenPaths())
  {
    std::error_code none;
    times += fs::equivalent(given, path, none) ? 1 : 0;
    const bool isRead =
      IsFileOfResult(path.filename().string()) || path.extension().string() == ".dcm";
    if (times > 1 || (isRead && fs::is_directory(given, none) && IsWithin(path, given)))
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
    for (const std::string& given : option->results())
    {
      std::error_code none;
      if (fs::exists(given, none))
      {
        GivenPaths().emplace_back(given);
      }
    }
  }
}

const std::string& CheckInputFile(const std::string& path)
{
  if (!fs::exists(path))
  {
    throw InputError(path + ": no such file");
  }
  if (fs::is_directory(path))
  {
    throw InputError(path + ": expected a file, found a folder");
  }
  if (!std::ifstream(path))
  {
    throw InputError(path + ": cannot be opened for reading");
  }
  return path;
}

void CheckInputFileIfAny(const std::string& path)
{
  if (!path.empty())
  {
    CheckInputFile(path);
  }
}

void CheckOutputPlace(const std::string& path, bool overwrite)
{
  if (path.empty())
  {
    throw InputError("output: expected a file name, found an empty one");
  }
  const fs::path folder = fs::absolute(fs::path(path)).parent_path();
  if (!fs::is_directory(folder))
  {
    throw InputError("output " + path + ": there is no folder " + folder.string());
  }
  if (access(folder.c_str(), W_OK) != 0)
  {
    throw InputError("output " + path + ": the folder " + folder.string() + " is not writable");
  }
  if (fs::is_directory(path))
  {
    throw InputError("output " + path + ": expected a file name, found a folder");
  }
  if (fs::exists(path) && !overwrite)
  {
    throw InputError("output " + path + ": exists already; --overwrite replaces it");
  }
  if (fs::exists(path))
  {
    CheckIsNoInput(path);
  }
}

void CheckOutputFile(const std::string& path, bool overwrite)
{
  CheckOutputPlace(path, overwrite);
  if (!ClaimFile(path))
  {
    throw InputError("output " + path + ": expected another file for each output, found it twice");
  }
}

void CheckOutputBeside(const std::string& path, bool overwrite)
{
  for (const fs::path& given : GivenPaths())
  {
    std::error_code none;
    if (fs::equivalent(given, path, none))
    {
      throw InputError(
        "output " + path + ": expected a file that is not an input, found " + given.string());
    }
  }
  CheckOutputFile(path, overwrite);
}

void CheckOutputFile(const std::string& path, bool overwrite, const std::string& extension,
  const std::string& kind)
{
  CheckOutputFile(path, overwrite);
  if (fs::path(path).extension() != extension)
  {
    throw InputError(path + ": expected the extension " + extension + " for " + kind);
  }
}

void CheckPictureFile(const std::string& path, bool overwrite)
{
  if (!path.empty())
  {
    CheckOutputFile(path, overwrite, ".png", "a picture");
  }
}

void CheckNewFolder(const std::string& path)
{
  std::error_code none;
  if (path.empty() || (fs::exists(path, none) && (!fs::is_directory(path) || !fs::is_empty(path))))
  {
    throw InputError("output " + path + ": expected a new or an empty folder, found " +
      (path.empty() ? "none" : "one that holds something, or a file"));
  }
  ClaimFolder(path);
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
  fs::path path(output);
  const std::string extension = path.extension().string();
  path.replace_extension();
  return path.string() + suffix + extension;
}
}
