// SPDX-License-Identifier: Apache-2.0
#include "OutputFiles.h"

#include "OptionList.h"
#include "ProgramOptions.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/Study/RegistrationCase.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

namespace mammoray
{
namespace fs = std::filesystem;

namespace
{
/// The files and folders that options of the running command name as inputs.
std::vector<fs::path>& Inputs()
{
  static std::vector<fs::path> paths;
  return paths;
}

bool IsWithin(const fs::path& path, const fs::path& folder)
{
  std::error_code ignored; // long names and circular links
  const fs::path inner = fs::relative(path, folder, ignored);
  return !inner.empty() && inner != "." && *inner.begin() != "..";
}

/// Throws InputError if the existing file is an input or is read as part of an input folder.
void CheckIsNoInput(const fs::path& path)
{
  const bool isReadInFolders =
    IsFileOfResult(path.filename().string()) || path.extension() == ".dcm";
  for (const fs::path& input : Inputs())
  {
    std::error_code ignored;
    if (fs::equivalent(input, path, ignored) || (isReadInFolders && IsWithin(path, input)))
    {
      throw InputError("output " + path.string() +
        ": expected a file that is not an input, found one of " + input.string());
    }
  }
}
}

void NoteInputs(const CLI::App& command)
{
  Inputs().clear();
  for (const CLI::Option* option : command.get_options({}))
  {
    const std::string type = option->get_type_name();
    if (type == FileTypeName || type == InputTypeName)
    {
      std::error_code ignored;
      std::copy_if(option->results().begin(), option->results().end(), std::back_inserter(Inputs()),
        [&](const std::string& path) { return fs::exists(path, ignored); });
    }
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
  require(!fs::is_directory(path), "expected a file name, found a folder");
  require(Program().Overwrite || !fs::exists(path), "exists already; --overwrite replaces it");
  if (fs::exists(path))
  {
    CheckIsNoInput(path);
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

void CheckPictureFile(const std::string& path)
{
  if (!path.empty())
  {
    CheckOutputFile(path, ".png", "a picture");
  }
}

void CheckNoInputWithin(const std::string& folder)
{
  for (const fs::path& input : Inputs())
  {
    if (IsWithin(input, folder))
    {
      throw InputError("output " + folder + ": holds the input " + input.string() +
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
