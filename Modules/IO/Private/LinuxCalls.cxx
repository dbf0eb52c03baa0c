// SPDX-License-Identifier: Apache-2.0
#include "LinuxCalls.h"

#include <fcntl.h>
#include <stdio_ext.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <string>

namespace mammoray::linuxCalls
{
int OpenInMemory(const char* name)
{
  return memfd_create(name, MFD_CLOEXEC);
}

std::filesystem::path PathOf(int descriptor)
{
  return "/proc/self/fd/" + std::to_string(descriptor);
}

bool IsMountPoint(const std::filesystem::path& folder)
{
  struct statx found = {};
  return statx(AT_FDCWD, folder.c_str(), 0, STATX_BASIC_STATS, &found) == 0 &&
    (found.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0;
}

bool Exchange(const std::filesystem::path& one, const std::filesystem::path& other)
{
  return renameat2(AT_FDCWD, one.c_str(), AT_FDCWD, other.c_str(), RENAME_EXCHANGE) == 0;
}

void EndWithParent()
{
  prctl(PR_SET_PDEATHSIG, SIGKILL);
}

std::uint64_t AddressesInUse()
{
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

void Purge(std::FILE* file)
{
  __fpurge(file);
}
}
