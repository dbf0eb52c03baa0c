// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/ParallelFor.h"

#include <gtest/gtest.h>

#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace
{
using namespace mammoray;

TEST(ParallelFor, VisitsEveryItemOnce)
{
  for (const std::size_t count : { 0, 1, 63, 64, 65, 129, 1000, 12345 })
  {
    std::vector<int> visits(count, 0);
    ParallelFor(count, [&](std::size_t i) { ++visits[i]; });
    EXPECT_EQ(visits, std::vector<int>(count, 1)) << count;
  }
}

TEST(ParallelFor, RangesFollowOneAnotherAndAreNotSmallerThanTheGrain)
{
  for (const std::size_t count : { 0, 7, 99, 100, 101, 250, 100000 })
  {
    std::mutex guard;
    std::set<std::pair<std::size_t, std::size_t>> ranges;
    ParallelRanges(count, 50,
      [&](std::size_t begin, std::size_t end)
      {
        const std::lock_guard lock(guard);
        ranges.emplace(begin, end);
      });
    std::size_t next = 0;
    for (const auto& [begin, end] : ranges)
    {
      EXPECT_EQ(begin, next);
      EXPECT_TRUE(end - begin >= 50 || ranges.size() == 1) << count;
      next = end;
    }
    EXPECT_EQ(next, count);
    EXPECT_LE(ranges.size(), std::max(1u, std::thread::hardware_concurrency()));
  }
}

TEST(ParallelFor, PassesOnWhatTheFirstRangeThrows)
{
  // In no thread of its own, which would end the process: a want of memory, above all.
  for (const std::size_t last : { 0, 999 })
  {
    std::vector<int> visits(1000, 0);
    try
    {
      ParallelFor(visits.size(),
        [&](std::size_t i)
        {
          ++visits[i];
          if (i == last || i == 999)
          {
            throw std::out_of_range(std::to_string(i));
          }
        });
      ADD_FAILURE() << "expected it to throw";
    }
    catch (const std::out_of_range& thrown)
    {
      EXPECT_EQ(thrown.what(), std::to_string(last));
    }
    EXPECT_EQ(visits[999], last == 999 || std::thread::hardware_concurrency() > 1 ? 1 : 0);
  }
}
}
