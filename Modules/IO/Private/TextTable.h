// SPDX-License-Identifier: Apache-2.0
// What the readers of tables in text files share.
#ifndef mammoray_Private_TextTable_h
#define mammoray_Private_TextTable_h

#include "mammoray/Foundation/Error.h"

#include <filesystem>
#include <fstream>
#include <string>

namespace mammoray
{
/// "path: line n", for messages.
inline std::string LineName(const std::string& path, std::size_t line)
{
  return path + ": line " + std::to_string(line);
}

/// The file, open; throws InputError when it cannot be read.
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
