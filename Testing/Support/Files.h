// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Testing_Files_h
#define mammoray_Testing_Files_h

#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace mammoray::test
{
/// The project's Data folder.
std::string DataFolder();
/// The folder of real inputs that are not part of the project and may be absent; tests skip then.
std::string SharedDataFolder();
/// The command line program; empty where it is not built.
std::string MammorayExecutable();
/// The X server without a screen; empty where there is none.
std::string XvfbPath();

/// A folder of its own for a test, removed at the end.
class TemporaryFolder
{
public:
  TemporaryFolder()
    : Path(std::filesystem::path(testing::TempDir()) /
        ("mammoray-" + std::to_string(getpid()) + "-" +
          testing::UnitTest::GetInstance()->current_test_info()->name()))
  {
    std::filesystem::create_directories(this->Path);
  }
  ~TemporaryFolder()
  {
    std::error_code ignored;
    std::filesystem::remove_all(this->Path, ignored);
  }
  std::string File(const std::string& name) const { return (this->Path / name).string(); }
  /// Writes a file and returns its path.
  std::string Write(const std::string& name, const std::string& bytes) const
  {
    std::ofstream(this->File(name), std::ios::binary) << bytes;
    return this->File(name);
  }

private:
  std::filesystem::path Path;
};

inline std::string ReadFile(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  return { std::istreambuf_iterator<char>(file), {} };
}
}

#endif
