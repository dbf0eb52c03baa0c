// SPDX-License-Identifier: Apache-2.0
#include "FileSizeLimit.h"
#include "Files.h"
#include "Refusals.h"
#include "mammoray/IO/GuardedRead.h"

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <new>
#include <thread>

namespace
{
using namespace mammoray;
using test::RefusalOf;
using testing::HasSubstr;

// Enough for a reader of nothing, of which those that never end are soon seen.
constexpr ReadLimits Small{ std::uint64_t{ 64 } << 20, 1 };

std::string RefusalOfReader(const std::function<void(ParcelWriter&)>& read)
{
  return RefusalOf([&] { ReadGuarded("a file", "numbers", Small, read, [](ParcelReader&) {}); });
}

TEST(GuardedRead, BringsWhatWasRead)
{
  std::vector<float> numbers(100000, 1.5f);
  std::vector<std::string> names;
  std::optional<double> given;
  std::optional<double> absent = 1;
  std::array<int, 3> size{};
  bool flag = false;
  ReadGuarded(
    "a file", "numbers", Small,
    [](ParcelWriter& parcel)
    {
      parcel(std::vector<float>(70000, 2.5f), std::vector<std::string>{ "a", "", "ccc" },
        std::optional<double>(3.5), std::optional<double>(), std::array<int, 3>{ 4, 5, 6 }, true);
    },
    [&](ParcelReader& parcel) { parcel(numbers, names, given, absent, size, flag); });
  EXPECT_EQ(numbers, std::vector<float>(70000, 2.5f));
  EXPECT_EQ(names, (std::vector<std::string>{ "a", "", "ccc" }));
  EXPECT_EQ(given, 3.5);
  EXPECT_FALSE(absent.has_value());
  EXPECT_EQ(size, (std::array<int, 3>{ 4, 5, 6 }));
  EXPECT_TRUE(flag);
}

TEST(GuardedRead, ARefusalArrivesAsItWas)
{
  EXPECT_EQ(RefusalOfReader(
              [](ParcelWriter& parcel)
              {
                parcel(std::vector<float>(70000, 1.0f));
                throw InputError("a file: line 3: expected 1, found 2");
              }),
    "a file: line 3: expected 1, found 2");
}

// What is read comes back through a file in memory, which the limit holds for, too.
TEST(GuardedRead, ALimitOfFileSizesIsCalledOne)
{
  const test::FileSizeLimit limit(100'000);
  EXPECT_EQ(RefusalOfReader([](ParcelWriter& parcel) { parcel(std::vector<float>(70000)); }),
    "expected a limit of file sizes (ulimit -f) that holds what is read, in memory, too; found a "
    "smaller one");
}

TEST(GuardedRead, DeathIsOneLine)
{
  for (const int death : { SIGSEGV, SIGABRT, SIGFPE, SIGKILL })
  {
    EXPECT_EQ(RefusalOfReader([death](ParcelWriter&) { std::raise(death); }),
      std::string(
        "a file: expected numbers, found damaged data, at which its reader ended with '") +
        strsignal(death) + "'");
  }
  // libjpeg's way, unless it is told another.
  for (const int status : { 0, 1 })
  {
    EXPECT_EQ(RefusalOfReader([status](ParcelWriter&) { std::exit(status); }),
      "a file: expected numbers, found damaged data, at which its reader ended");
  }
}

// As in programs that a shell with `trap '' CHLD` began: no status of theirs is kept.
TEST(GuardedRead, WorksWhereEndsOfProcessesAreIgnored)
{
  const auto before = std::signal(SIGCHLD, SIG_IGN);
  EXPECT_EQ(RefusalOfReader([](ParcelWriter& parcel) { parcel(1); }), test::NotRefused);
  EXPECT_EQ(RefusalOfReader([](ParcelWriter&) { throw InputError("line 3"); }), "line 3");
  EXPECT_THAT(RefusalOfReader([](ParcelWriter&) -> void { throw std::bad_alloc(); }),
    HasSubstr("more memory"));
  EXPECT_EQ(RefusalOfReader([](ParcelWriter&) { std::raise(SIGKILL); }),
    "a file: expected numbers, found damaged data, at which its reader ended");
  std::signal(SIGCHLD, before);
}

TEST(GuardedRead, NeverEndingIsOneLine)
{
  EXPECT_THAT(RefusalOfReader(
                [](ParcelWriter&)
                {
                  while (true)
                  {
                    std::atomic_signal_fence(std::memory_order_seq_cst);
                  }
                }),
    HasSubstr("longer to read than a file of this size may (1 s)"));
}

TEST(GuardedRead, MemoryIsLimitedUntilItIsAllowed)
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers take more addresses than any limit";
#endif
  constexpr std::size_t much = std::size_t{ 200 } << 20;
  const auto take = [](ParcelWriter& parcel)
  {
    const std::vector<char> taken(much);
    parcel(taken.size());
  };
  EXPECT_THAT(RefusalOfReader(take),
    HasSubstr("more memory than a file of this size may (64 MiB)"));
  EXPECT_EQ(RefusalOfReader(
              [&](ParcelWriter& parcel)
              {
                AllowMemory(much + Small.MemoryBytes);
                take(parcel);
              }),
    test::NotRefused);
}

TEST(GuardedRead, WhatLibrariesPrintIsHeardByTheReaderOnly)
{
  std::string said;
  ReadGuarded(
    "a file", "numbers", Small,
    [](ParcelWriter& parcel)
    {
      std::puts("Corrupt data");
      std::fputs("twice\n", stderr);
      parcel(SaidByLibraries());
    },
    [&](ParcelReader& parcel) { parcel(said); });
  EXPECT_THAT(said, testing::AnyOf("Corrupt data", "twice"));
  EXPECT_EQ(SaidByLibraries(), "");
}

TEST(GuardedRead, AnAnswerIsBelievedAsFarAsItGoes)
{
  const auto refusalOfAnswer = [](auto sent, auto asked)
  {
    return RefusalOf(
      [&]
      {
        ReadGuarded(
          "a file", "numbers", Small, [&](ParcelWriter& parcel) { parcel(sent); },
          [&](ParcelReader& parcel) { parcel(asked); });
      });
  };
  const std::string cut =
    "a file: expected a whole answer of its reader, found one that is cut short";
  EXPECT_EQ(refusalOfAnswer(std::uint8_t{ 1 }, std::uint32_t{}), cut);
  // Lengths that nothing follows.
  for (const std::uint64_t length : { std::uint64_t{ 1 }, ~std::uint64_t{ 0 } })
  {
    EXPECT_EQ(refusalOfAnswer(length, std::string()), cut);
    EXPECT_EQ(refusalOfAnswer(length, std::vector<double>()), cut);
    EXPECT_EQ(refusalOfAnswer(length, std::vector<std::string>()), cut);
  }
}

TEST(GuardedRead, ReadersInReadersReadWhereTheyAre)
{
  int answer = 0;
  ReadGuarded(
    "a file", "numbers", Small,
    [](ParcelWriter& outer)
    {
      int inner = 0;
      ReadGuarded(
        "another", "numbers", Small, [](ParcelWriter& parcel) { parcel(42); },
        [&](ParcelReader& parcel) { parcel(inner); });
      outer(inner);
    },
    [&](ParcelReader& parcel) { parcel(answer); });
  EXPECT_EQ(answer, 42);
}

/// What is asked of the work, and what is done at each text that it tells.
std::string RefusalOfWork(
  const std::function<std::vector<std::string>(const TellCallback&)>& work,
  const TellCallback& heard = [](const std::string&) {})
{
  return RefusalOf([&] { WorkGuarded("an archive", "answers", Small.MemoryBytes, work, heard); });
}

TEST(GuardedWork, IsHeardWhileItGoesOnAndGivesAnAnswer)
{
  std::vector<std::string> heard;
  int idle = 0;
  const auto work = [](const TellCallback& tell) -> std::vector<std::string>
  {
    tell("a");
    tell(std::string(100'000, 'b'));
    std::this_thread::sleep_for(std::chrono::seconds(1));
    tell(std::string("c\0d", 3));
    return { "done", "" };
  };
  const auto hear = [&](const std::string& text)
  {
    idle += text.empty() ? 1 : 0;
    if (!text.empty())
    {
      heard.push_back(text);
    }
  };
  EXPECT_EQ(WorkGuarded("an archive", "answers", Small.MemoryBytes, work, hear),
    (std::vector<std::string>{ "done", "" }));
  EXPECT_EQ(heard,
    (std::vector<std::string>{ "a", std::string(100'000, 'b'), std::string("c\0d", 3) }));
  EXPECT_GE(idle, 1) << "a second without a word";
}

TEST(GuardedWork, WhatIsThrownWhereItIsHeardEndsIt)
{
  const test::TemporaryFolder folder;
  const std::string path = folder.File("after");
  const auto work = [&](const TellCallback& tell) -> std::vector<std::string>
  {
    tell("stop me");
    std::ofstream(path) << "not stopped";
    return {};
  };
  EXPECT_THROW(WorkGuarded("an archive", "answers", Small.MemoryBytes, work,
                 [](const std::string& text)
                 {
                   if (!text.empty())
                   {
                     throw Interrupted();
                   }
                 }),
    Interrupted);
  EXPECT_FALSE(std::filesystem::exists(path)) << "the work went on";
}

TEST(GuardedWork, ItsRefusalAndItsDeathAreOneLine)
{
  EXPECT_EQ(RefusalOfWork([](const TellCallback&) -> std::vector<std::string>
              { throw InputError("a file: expected 1, found 2"); }),
    "a file: expected 1, found 2");
  EXPECT_EQ(RefusalOfWork(
              [](const TellCallback& tell) -> std::vector<std::string>
              {
                tell("soon");
                std::raise(SIGSEGV);
                return {};
              }),
    std::string("an archive: expected answers, found damaged data, at which its reader ended "
                "with '") +
      strsignal(SIGSEGV) + "'");
}
}
