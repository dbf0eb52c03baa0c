// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MemoryLimit_h
#define mammoray_MemoryLimit_h

#include "mammorayFoundationModule.h"

#include <string>

namespace mammoray
{
/**
 * How much memory this process may have, bytes: the least of what the machine has, of its addresses
 * (RLIMIT_AS, ulimit -v) and of the limits of its control groups, a container's among them (memory
 * controller of versions 1 and 2; cgroups(7)). `root`: where the machine's /proc and /sys are.
 */
MAMMORAYFOUNDATION_EXPORT double MemoryLimitBytes(const std::string& root = "");
}

#endif
