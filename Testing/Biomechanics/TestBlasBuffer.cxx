// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Biomechanics/Private/Factors/BlasBuffer.h"
#include "mammoray/Biomechanics/Private/Factors/SparseCholesky.h"

#include <gtest/gtest.h>

#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <new>
#include <vector>

extern "C" void* blas_memory_alloc(int) __attribute__((weak));

using namespace mammoray;

namespace
{
/// In a process of its own: how a factor's making ends with so much room for addresses.
[[noreturn]] void FactorWithRoom(rlim_t bytes)
{
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const rlim_t limit = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + bytes;
  const rlimit limits{ limit, limit };
  if (setrlimit(RLIMIT_AS, &limits) != 0)
  {
    std::_Exit(1);
  }
  try
  {
    const std::vector<int> starts{ 0, 1 };
    const std::vector<int> rows{ 0 };
    SparseCholesky factor(starts, rows);
    std::vector<double> column{ 8 };
    const bool made = factor.Factorize({ 4 });
    factor.Solve(column);
    std::_Exit(made && column[0] == 2 ? 0 : 1);
  }
  catch (const std::bad_alloc&)
  {
    std::_Exit(2);
  }
}
}

TEST(BlasBuffer, WhereThereIsNoRoomIsNotWaitedFor)
{
  if (!blas_memory_alloc)
  {
    GTEST_SKIP() << "another BLAS than OpenBLAS";
  }
  GTEST_FLAG_SET(death_test_style, "threadsafe"); // a process that has not taken the buffer
  EXPECT_EXIT(FactorWithRoom(rlim_t{ 64 } << 20), testing::ExitedWithCode(2), "");
  EXPECT_EXIT(FactorWithRoom(rlim_t{ 400 } << 20), testing::ExitedWithCode(0), "");
}
