// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ScratchFolder_h
#define mammoray_ScratchFolder_h

#include "mammoray/Foundation/Error.h"

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace mammoray
{
/// A new temporary folder, removed with its contents at the end. It lies below TMPDIR, TMP, TEMP or
/// TEMPDIR, or below /tmp, /var/tmp or /dev/shm if none can be made there. Throws InputError if
/// none can be made at all.
class ScratchFolder
{
public:
  ScratchFolder()
  {
    namespace fs = std::filesystem;
    std::error_code none;
    const fs::path wanted = fs::temp_directory_path(none); // empty where it is not there
    for (const fs::path& parent :
      { wanted, fs::path("/tmp"), fs::path("/var/tmp"), fs::path("/dev/shm") })
    {
      std::string name = (parent / "mammoray-XXXXXX").string();
      if (!parent.empty() && mkdtemp(name.data()))
      {
        this->Path = name;
        return;
      }
    }
    throw InputError("TMPDIR: expected a folder in which one can be made, found " +
      (wanted.empty() ? "none" : "'" + wanted.string() + "'") +
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
