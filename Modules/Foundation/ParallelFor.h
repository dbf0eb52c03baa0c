// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ParallelFor_h
#define mammoray_ParallelFor_h

#include <algorithm>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace mammoray
{
/**
 * Calls work(begin, end) for contiguous ranges that cover [0, count), each on its own core, and
 * returns when all are done. A range has at least `grain` (positive) items unless it is the only
 * one. Different ranges must write to different places. If every item is computed independently,
 * the result does not depend on the number of cores. If ranges throw, the exception of the first of
 * them is rethrown after all have ended.
 */
template <typename Work>
void ParallelRanges(std::size_t count, std::size_t grain, const Work& work)
{
  const std::size_t cores = std::max(1u, std::thread::hardware_concurrency());
  const std::size_t parts = std::clamp<std::size_t>(count / grain, 1, cores);
  std::vector<std::exception_ptr> thrown(parts);
  const auto workOn = [&](std::size_t part)
  {
    try
    {
      work(count * part / parts, count * (part + 1) / parts);
    }
    catch (...)
    {
      thrown[part] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> threads;
    threads.reserve(parts - 1);
    for (std::size_t part = 1; part < parts; ++part)
    {
      threads.emplace_back(workOn, part);
    }
    workOn(0);
  }
  for (const std::exception_ptr& exception : thrown)
  {
    if (exception)
    {
      std::rethrow_exception(exception);
    }
  }
}

/// Calls body(i) in parallel for every i in [0, count); a call should take a microsecond or more.
template <typename Body>
void ParallelFor(std::size_t count, const Body& body)
{
  ParallelRanges(count, 64,
    [&body](std::size_t begin, std::size_t end)
    {
      for (std::size_t i = begin; i < end; ++i)
      {
        body(i);
      }
    });
}
}

#endif
