// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Report/WholeFile.h"

#include "mammoray/Foundation/Error.h"

#include <filesystem>
#include <fstream>

namespace mammoray
{
void WriteWholeFile(const std::string& content, const std::string& path)
{
  const std::string aside = path + ".part";
  std::ofstream file(aside, std::ios::binary);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.close();
  std::error_code code;
  if (file)
  {
    std::filesystem::rename(aside, path, code);
  }
  if (!file || code)
  {
    std::error_code ignored;
    std::filesystem::remove(aside, ignored);
    throw InputError(path + ": expected a file that can be written");
  }
}
}
