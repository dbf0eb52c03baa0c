// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MissingMemory_h
#define mammoray_MissingMemory_h

namespace mammoray
{
/// What is told where an allocation fails.
inline constexpr const char MissingMemory[] =
  "expected memory for the work, found less free, or allowed (ulimit -v), than it takes";

/**
 * Where addresses are limited (ulimit -v): a signal or a terminate by which a library ends this
 * process once it has come near that limit (Mesa's threads write to what they were not given) ends
 * it with MissingMemory and exit status 1. Processes forked from it end as they would.
 */
void TellOfMissingMemory();
}

#endif
