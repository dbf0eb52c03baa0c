// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_AddressLimit_h
#define mammoray_AddressLimit_h

#include <sys/resource.h>
#include <unistd.h>

#include <cstddef>
#include <fstream>

namespace mammoray::test
{
/// As ulimit -v: leaves this process, which cannot take it back, so many addresses beside those
/// that it has.
inline void LimitAddresses(rlim_t bytes)
{
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const rlim_t most = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + bytes;
  const rlimit limits{ most, most };
  setrlimit(RLIMIT_AS, &limits);
}
}

#endif
