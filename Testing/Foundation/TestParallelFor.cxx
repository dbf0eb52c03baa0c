// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/ParallelFor.h"

#include <gtest/gtest.h>

#include <mutex>
#include <set>
#include <utility>

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
}
