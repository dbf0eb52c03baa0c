// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ScratchFolder_h
#define mammoray_ScratchFolder_h

#include "mammoray/Foundation/Error.h"

#include <cstdlib>
#include <filesystem>
#include <string>

namespace mammoray
{
/// A new folder below TMPDIR, or below the system's for temporary files where none can be made
/// there, removed at the end with all that is in it. Throws InputError where none can be made at
/// all.
class ScratchFolder
{
public:
  ScratchFolder()
  {
    const char* const wanted = std::getenv("TMPDIR");
    for (const char* const parent : { wanted, "/tmp", "/var/tmp", "/dev/shm" })
    {
      std::string name = parent && *parent ? std::string(parent) + "/mammoray-XXXXXX" : "";
      if (!name.empty() && mkdtemp(name.data()))
      {
        this->Path = name;
        return;
      }
    }
    throw InputError("TMPDIR: expected a folder in which one can be made, found " +
      (wanted ? "'" + std::string(wanted) + "'" : "none") +
      ", and none in /tmp, /var/tmp and /dev/shm");
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
