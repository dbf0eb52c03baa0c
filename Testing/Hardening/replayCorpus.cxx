// SPDX-License-Identifier: Apache-2.0
// `replayCorpus FOLDER [COUNT [SEED]]`: gives each target of FOLDER/<target>/ its files again, and
// COUNT times each of them damaged. Ends as the target does where one is not survived, and with 1
// where a target takes none of its files: those of an older version are refused at their first
// line, and what comes after is not tried.
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
  bool good = true;
  for (const auto& [name, target] : FuzzTargets())
  {
    std::mt19937_64 random(argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1);
    std::size_t given = 0;
    bool taken = false;
    std::string refusals;
    for (const std::filesystem::path& file : FilesIn(std::filesystem::path(argv[1]) / name))
    {
      std::printf("%s\r", file.c_str());
      std::fflush(stdout);
      const std::string bytes = mammoray::test::ReadFile(file.string());
      const std::string refusal = target(bytes);
      taken = taken || refusal.empty();
      refusals += "  " + file.filename().string() + ": " + refusal + "\n";
      for (int turn = 0; turn < count; ++turn)
      {
        target(Damage(bytes, random));
      }
      given += 1 + static_cast<std::size_t>(count);
    }
    std::printf("%s: %zu inputs survived\n", name.c_str(), given);
    if (!taken)
    {
      std::fprintf(stderr, "%s: expected a file that is taken in %s/%s, found none\n%s",
        name.c_str(), argv[1], name.c_str(), refusals.c_str());
      good = false;
    }
  }
  return good ? 0 : 1;
}
