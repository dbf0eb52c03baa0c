// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/MemoryLimit.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

namespace mammoray
{
namespace
{
constexpr double Unlimited = std::numeric_limits<double>::infinity();

/// The number in a file; no limit if the file is missing or contains "max".
double LimitIn(const std::filesystem::path& file)
{
  double bytes = 0;
  return std::ifstream(file) >> bytes ? bytes : Unlimited;
}

/// The least limit of a group and of its ancestors. A container sees its own group at the root of
/// the hierarchy, whatever path the kernel reports.
double LimitOfGroup(const std::filesystem::path& hierarchy, const std::string& group,
  const char* file)
{
  double least = LimitIn(hierarchy / file);
  std::filesystem::path folder = hierarchy;
  for (const std::filesystem::path& part : std::filesystem::path(group).relative_path())
  {
    folder /= part;
    least = std::min(least, LimitIn(folder / file));
  }
  return least;
}
}

double MemoryLimitBytes(const std::string& root)
{
  double least = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * sysconf(_SC_PAGESIZE);
  rlimit addresses{};
  if (getrlimit(RLIMIT_AS, &addresses) == 0 && addresses.rlim_cur != RLIM_INFINITY)
  {
    least = std::min(least, static_cast<double>(addresses.rlim_cur));
  }
  // Lines of the form number:controllers:group; the controllers are empty in version 2.
  std::ifstream groups(root + "/proc/self/cgroup");
  const std::string hierarchies = root + "/sys/fs/cgroup";
  for (std::string line; std::getline(groups, line);)
  {
    std::istringstream words(line);
    std::string number, controllers, group;
    std::getline(words, number, ':');
    std::getline(words, controllers, ':');
    std::getline(words, group);
    if (controllers.empty())
    {
      least = std::min(least, LimitOfGroup(hierarchies, group, "memory.max"));
    }
    else if ((',' + controllers + ',').find(",memory,") != std::string::npos)
    {
      least =
        std::min(least, LimitOfGroup(hierarchies + "/memory", group, "memory.limit_in_bytes"));
    }
  }
  return least;
}
}
