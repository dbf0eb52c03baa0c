// SPDX-License-Identifier: Apache-2.0
#include "AddressLimit.h"
#include "MissingMemory.h"

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <new>
#include <thread>

using namespace mammoray;

namespace
{
constexpr rlim_t MiB = rlim_t{ 1 } << 20;

/// As where a library writes to what it was not given.
void Fault()
{
  raise(SIGSEGV);
}

/// As where a thread of a library's is refused memory.
void Terminate()
{
  std::thread([] { throw std::bad_alloc(); }).join();
}

/// As a reader of files that is forked.
void FaultInChild()
{
  const pid_t child = fork();
  if (child == 0)
  {
    Fault();
  }
  int status = 0;
  waitpid(child, &status, 0);
  _exit(WIFSIGNALED(status) && WTERMSIG(status) == SIGSEGV ? 7 : 8);
}

template <typename Failure>
void FailWithRoom(rlim_t bytes, const Failure& failure)
{
  test::LimitAddresses(bytes);
  TellOfMissingMemory(); // as main does
  failure();
  _exit(0);
}
}

TEST(MissingMemory, EndsInALineNearTheLimitOnly)
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers watch signals, and need all addresses";
#endif
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto told = testing::ExitedWithCode(1);
  const char* const line = "^mammoray: expected memory for the work, .*than it takes\n$";
  EXPECT_EXIT(FailWithRoom(100 * MiB, Fault), told, line);
  EXPECT_EXIT(FailWithRoom(100 * MiB, [] { raise(SIGABRT); }), told, line);
  EXPECT_EXIT(FailWithRoom(100 * MiB, Terminate), told, line);
  const auto bySignal = testing::KilledBySignal(SIGSEGV);
  EXPECT_EXIT(FailWithRoom(2000 * MiB, Fault), bySignal, "^$");
  EXPECT_EXIT(FailWithRoom(2000 * MiB, Terminate), testing::KilledBySignal(SIGABRT), "bad_alloc");
  EXPECT_EXIT(FailWithRoom(100 * MiB, FaultInChild), testing::ExitedWithCode(7), "^$");
}
