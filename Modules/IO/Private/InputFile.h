// SPDX-License-Identifier: Apache-2.0
// Checks and names that the readers of files share.
#ifndef mammoray_Private_InputFile_h
#define mammoray_Private_InputFile_h

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <string>

namespace mammoray
{
/// Throws InputError unless the path is a regular file that can be read and is not empty. `what` is
/// the expected content, for messages.
inline void CheckReadable(const std::string& path, const std::string& what)
{
  namespace fs = std::filesystem;
  std::error_code problem;
  if (!fs::exists(path, problem))
  {
    throw InputError(path + ": no such file");
  }
  if (!fs::is_regular_file(path) || !std::ifstream(path))
  {
    throw InputError(path + ": expected " + what + ", found something that cannot be read");
  }
  if (fs::file_size(path) == 0)
  {
    throw InputError(path + ": expected " + what + ", found an empty file");
  }
}

/// Returns the extension in lower case, with its dot; ".nii.gz" counts as one.
inline std::string ExtensionOf(const std::string& path)
{
  std::string name = std::filesystem::path(path).filename().string();
  std::transform(name.begin(), name.end(), name.begin(),
    [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name.ends_with(".nii.gz") ? ".nii.gz" : std::filesystem::path(name).extension().string();
}

/// "path: line n", for messages.
inline std::string LineName(const std::string& path, std::size_t line)
{
  return path + ": line " + std::to_string(line);
}

/// Opens a text file. Throws InputError if it cannot be read.
inline std::ifstream OpenText(const std::string& path)
{
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path))
  {
    throw InputError(path + ": cannot be opened for reading");
  }
  return file;
}
}

#endif
