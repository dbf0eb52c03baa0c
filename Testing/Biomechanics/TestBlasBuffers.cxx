// SPDX-License-Identifier: Apache-2.0
#include "AddressLimit.h"
#include "mammoray/Biomechanics/Private/BlasBuffers.h"
#include "mammoray/Biomechanics/Private/SparseCholesky.h"

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <new>
#include <vector>

extern "C" void* blas_memory_alloc(int) __attribute__((weak));
extern "C" void sgemm_(const char* transposeA, const char* transposeB, const int* rows,
  const int* columns, const int* depth, const float* alpha, const float* a, const int* strideA,
  const float* b, const int* strideB, const float* beta, float* c, const int* strideC)
  __attribute__((weak));

using namespace mammoray;
using test::LimitAddresses;

namespace
{
void MultiplyByAllThreads()
{
  const int size = 512;
  const float one = 1;
  const std::vector<float> matrix(512 * 512, 1.0f);
  std::vector<float> product = matrix;
  sgemm_("N", "N", &size, &size, &size, &one, matrix.data(), &size, matrix.data(), &size, &one,
    product.data(), &size);
}

/// In a process of its own: how the use of BLAS ends with so much room for a factor's making.
[[noreturn]] void FactorWithRoom(rlim_t bytes)
{
  // As a guarded reader is; OpenBLAS's threads end.
  if (const pid_t child = fork(); child == 0)
  {
    std::_Exit(0);
  }
  wait(nullptr);
  alarm(60); // a thread that asks for ever
  LimitAddresses(bytes);
  try
  {
    const std::vector<int> starts{ 0, 1 };
    const std::vector<int> rows{ 0 };
    SparseCholesky factor(starts, rows);
    LimitAddresses(rlim_t{ 64 } << 20);
    std::vector<double> column{ 8 };
    const bool made = factor.Factorize({ 4 });
    factor.Solve(column);
    MultiplyByAllThreads();
    std::_Exit(made && column[0] == 2 ? 0 : 1);
  }
  catch (const std::bad_alloc&)
  {
    std::_Exit(2);
  }
}
}

TEST(BlasBuffers, WhereThereIsNoRoomIsNotWaitedFor)
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need addresses of their own";
#endif
  if (!blas_memory_alloc)
  {
    GTEST_SKIP() << "another BLAS than OpenBLAS";
  }
  GTEST_FLAG_SET(death_test_style, "threadsafe"); // a process that has not taken the buffer
  EXPECT_EXIT(FactorWithRoom(rlim_t{ 64 } << 20), testing::ExitedWithCode(2), "");
  EXPECT_EXIT(FactorWithRoom(rlim_t{ 200 } << 20), testing::ExitedWithCode(0), "");
}
