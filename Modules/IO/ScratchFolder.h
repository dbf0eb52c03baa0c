// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ScratchFolder_h
#define mammoray_ScratchFolder_h

#include "mammoray/Foundation/Error.h"

#include <cstdlib>
#include <filesystem>
#include <string>

namespace mammoray
{
/// A new folder below the system's for temporary files, removed at the end with all that is in it.
/// Throws InputError where it cannot be made.
class ScratchFolder
{
public:
  ScratchFolder()
  {
    std::string name = (std::filesystem::temp_directory_path() / "mammoray-XXXXXX").string();
    if (!mkdtemp(name.data()))
    {
      throw InputError(name + ": expected a folder that can be made");
    }
    this->Path = name;
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder()
  {
    std::error_code ignored;
    std::filesystem::remove_all(this->Path, ignored);
  }
  std::string File(const std::string& name) const { return (this->Path / name).string(); }

private:
  std::filesystem::path Path;
};
}

#endif
