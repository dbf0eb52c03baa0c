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

/// The number in a file; a file that is missing or says "max" limits nothing.
double LimitIn(const std::filesystem::path& file)
{
  double bytes = 0;
  return std::ifstream(file) >> bytes ? bytes : Unlimited;
}

/// The least of a group's limit and those of the groups around it. A container sees its own group
/// at the hierarchy's top, under whatever path its kernel tells.
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
  // Of each hierarchy its number, its controllers (none: version 2) and this process' group.
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
