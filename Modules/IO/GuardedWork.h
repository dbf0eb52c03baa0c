// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_GuardedWork_h
#define mammoray_GuardedWork_h

#include "mammorayIOModule.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace mammoray
{
/// Tells the asking process something while the work goes on; comes back when it has been heard.
/// At most 100,000 bytes.
using TellCallback = std::function<void(const std::string& text)>;

/**
 * Does long work on foreign bytes in a process of its own, a fork of this one, and gives its
 * answer. `heard` is called here, on the thread that asks, with each text that the work tells, and
 * with an empty one every 200 ms at least; what it throws ends the work at once and is thrown on.
 *
 * An InputError of `work` arrives as it was thrown, other exceptions as an InputError of their
 * text. The work's death, or more memory than `memoryBytes` beyond what this process has when it
 * begins, is an InputError of one line: "what: expected content, found ...". Time is not limited:
 * `heard` may end it. What libraries print there reaches nobody. `work` must not wait for another
 * thread, nor use a device: a fork has only the thread that asks.
 */
MAMMORAYIO_EXPORT std::vector<std::string> WorkGuarded(const std::string& what,
  const std::string& content, std::uint64_t memoryBytes,
  const std::function<std::vector<std::string>(const TellCallback& tell)>& work,
  const TellCallback& heard);
}

#endif
