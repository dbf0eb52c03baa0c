// SPDX-License-Identifier: Apache-2.0
#include "OutputFiles.h"

#include "mammoray/Foundation/Error.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace mammoray
{
namespace fs = std::filesystem;

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

void CheckOutputFile(const std::string& path, bool overwrite)
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

void WriteComplete(const std::string& path,
  const std::function<void(const std::string& temporary)>& write)
{
  const fs::path target(path);
  // The writer goes by the extension, .nii.gz as one.
  std::string stem = target.stem().string();
  std::string extension = target.extension().string();
  if (extension == ".gz")
  {
    extension = fs::path(stem).extension().string() + extension;
    stem = fs::path(stem).stem().string();
  }
  const fs::path temporary = fs::absolute(target).parent_path() /
    (stem + ".partial-" + std::to_string(getpid()) + extension);
  try
  {
    write(temporary.string());
    fs::rename(temporary, target);
  }
  catch (...)
  {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw;
  }
}

void WriteTextFile(const std::string& path, const std::string& text)
{
  WriteComplete(path,
    [&](const std::string& temporary)
    {
      std::ofstream file(temporary);
      file << text;
      file.close();
      if (!file)
      {
        throw InputError(path + ": cannot be written");
      }
    });
}
}
