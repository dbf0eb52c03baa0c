// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Parallel_h
#define mammoray_Parallel_h

#include <algorithm>
#include <cstddef>
#include <thread>
#include <vector>

namespace mammoray
{
/**
 * Calls body(i) for i in [0, count) on all cores, in contiguous ranges. The body must not throw and
 * must write to places of its own; sums are then formed in a fixed order, so results do not depend
 * on the number of cores.
 */
template <typename Body>
void ParallelFor(std::size_t count, const Body& body)
{
  const std::size_t threadCount =
    std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, 1 + count / 64);
  const auto range = [&](std::size_t t)
  {
    const std::size_t end = count * (t + 1) / threadCount;
    for (std::size_t i = count * t / threadCount; i < end; ++i)
    {
      body(i);
    }
  };
  std::vector<std::jthread> threads;
  for (std::size_t t = 1; t < threadCount; ++t)
  {
    threads.emplace_back(range, t);
  }
  range(0);
}
}

#endif
