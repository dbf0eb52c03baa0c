// SPDX-License-Identifier: Apache-2.0
// `replayCorpus FOLDER [COUNT [SEED]]`: gives each target of FOLDER/<target>/ its files again, and
// COUNT times each of them damaged. Ends as the target does where one is not survived.
#include "Damage.h"
#include "Files.h"
#include "FuzzTargets.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <vector>

namespace
{
using namespace mammoray::hardening;

std::vector<std::filesystem::path> FilesIn(const std::filesystem::path& folder)
{
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
  {
    files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}
}

int main(int argc, char* argv[])
{
  if (argc < 2)
  {
    std::fputs("replayCorpus: expected the folder of the corpus\n", stderr);
    return 2;
  }
  const int count = argc > 2 ? std::atoi(argv[2]) : 0;
  for (const auto& [name, target] : FuzzTargets())
  {
    std::mt19937_64 random(argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1);
    std::size_t given = 0;
    for (const std::filesystem::path& file : FilesIn(std::filesystem::path(argv[1]) / name))
    {
      std::printf("%s\r", file.c_str());
      std::fflush(stdout);
      const std::string bytes = mammoray::testing_support::ReadFile(file.string());
      target(bytes);
      for (int turn = 0; turn < count; ++turn)
      {
        target(Damage(bytes, random));
      }
      given += 1 + static_cast<std::size_t>(count);
    }
    std::printf("%s: %zu inputs survived\n", name.c_str(), given);
    if (given == 0)
    {
      return 1;
    }
  }
  return 0;
}
