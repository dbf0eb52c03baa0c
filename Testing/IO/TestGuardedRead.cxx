// SPDX-License-Identifier: Apache-2.0
#include "FileSizeLimit.h"
#include "Files.h"
#include "Refusals.h"
#include "mammoray/IO/GuardedRead.h"

#include "SMP/Common/vtkSMPToolsAPI.h"

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <new>
#include <thread>

namespace
{
using namespace mammoray;
using test::RefusalOf;
using testing::HasSubstr;

// Enough for a reader of nothing, of which those that never end are soon seen.
constexpr ReadLimits Small{ std::uint64_t{ 64 } << 20, 1 };
constexpr ReadLimits Endless{ Small.MemoryBytes, std::numeric_limits<double>::infinity() };

std::string RefusalOfReader(const std::function<void()>& read)
{
  return RefusalOf([&] { ReadGuarded("a file", "numbers", Small, [&] { return read(), 0; }); });
}

/// One value of each kind.
struct Values
{
  std::vector<float> Numbers;
  std::vector<std::string> Names;
  std::optional<double> Given;
  std::optional<double> Absent = 1;
  std::array<int, 3> Size{};
  bool Flag = false;
};

void Exchange(Parcel& parcel, Values& values)
{
  parcel(values.Numbers, values.Names, values.Given, values.Absent, values.Size, values.Flag);
}

TEST(GuardedRead, BringsWhatWasRead)
{
  const auto read = ReadGuarded("a file", "numbers", Small,
    []
    {
      return std::vector<Values>{ Values(),
        { std::vector<float>(70000, 2.5f), { "a", "", "ccc" }, 3.5, {}, { 4, 5, 6 }, true } };
    });
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].Absent, 1);
  EXPECT_EQ(read[1].Numbers, std::vector<float>(70000, 2.5f));
  EXPECT_EQ(read[1].Names, (std::vector<std::string>{ "a", "", "ccc" }));
  EXPECT_EQ(read[1].Given, 3.5);
  EXPECT_FALSE(read[1].Absent.has_value());
  EXPECT_EQ(read[1].Size, (std::array<int, 3>{ 4, 5, 6 }));
  EXPECT_TRUE(read[1].Flag);
}

TEST(GuardedRead, VtkWorksWithoutThreadsInAReader)
{
  // With those of the asking process, which a reader does not have, it sometimes never ended.
  const auto backend = []
  { return std::string(vtk::detail::smp::vtkSMPToolsAPI::GetInstance().GetBackend()); };
  const std::string before = backend();
  EXPECT_EQ(ReadGuarded("a file", "numbers", Small, backend), "Sequential");
  EXPECT_EQ(backend(), before);
}

TEST(GuardedRead, ARefusalArrivesAsItWas)
{
  EXPECT_EQ(RefusalOfReader([] { throw InputError("a file: line 3: expected 1, found 2"); }),
    "a file: line 3: expected 1, found 2");
}

// What is read comes back through a file in memory, which the limit holds for, too.
TEST(GuardedRead, FieldsAndNotesArriveAsWell)
{
  try
  {
    ReadGuarded("a file", "numbers", Small,
      []() -> int {
        throw InputError("two", { "SizeMm", "2", { "SizeMm", "Name" }, true });
      });
    FAIL();
  }
  catch (const InputError& error)
  {
    EXPECT_STREQ(error.what(), "two; set SizeMm and Name");
    EXPECT_EQ(error.Field().Name, "SizeMm");
    EXPECT_EQ(error.Field().Remedies, (std::vector<std::string>{ "SizeMm", "Name" }));
    EXPECT_TRUE(error.Field().All);
  }
  NoteKeeper notes;
  EXPECT_EQ(ReadGuarded("a file", "numbers", Small,
              [] {
                return Note({ "a\t", "odd\n", "c" }), 7;
              }),
    7);
  EXPECT_EQ(notes.Lines(), std::vector<std::string>{ "a\\x09: odd\\x0ac" });
  testing::internal::CaptureStderr();
  std::thread(
    []
    {
      Note({ "a", "alone" }), Note({ "a", "alone" });
      NoteKeeper silent;
      NoteKeeper told(NoteKeeper::Others::Told);
      Note({ "a", "kept" });
      EXPECT_EQ(told.Lines(), std::vector<std::string>{ "a: kept" });
      EXPECT_EQ(silent.Lines(), told.Lines());
    })
    .join();
  std::thread(
    []
    {
      NoteKeeper told(NoteKeeper::Others::Told);
      Note({ "a", "told" });
      EXPECT_EQ(told.Lines(), std::vector<std::string>{ "a: told" });
    })
    .join();
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "warning: a: alone\nwarning: a: told\n");
}

TEST(GuardedRead, ALimitOfFileSizesIsCalledOne)
{
  const test::FileSizeLimit limit(100'000);
  EXPECT_EQ(
    RefusalOf([] { ReadGuarded("a file", "", Small, [] { return std::vector<float>(70000); }); }),
    "expected a limit of file sizes (ulimit -f) that holds what is read, in memory, too; found a "
    "smaller one");
}

TEST(GuardedRead, DeathIsOneLine)
{
  for (const int death : { SIGSEGV, SIGABRT, SIGFPE, SIGKILL })
  {
    EXPECT_EQ(RefusalOfReader([death] { std::raise(death); }),
      std::string(
        "a file: expected numbers, found damaged data, at which its reader ended with '") +
        strsignal(death) + "'");
  }
  // libjpeg's way, unless it is told another.
  for (const int status : { 0, 1 })
  {
    EXPECT_EQ(RefusalOfReader([status] { std::exit(status); }),
      "a file: expected numbers, found damaged data, at which its reader ended");
  }
}

// As in programs that a shell with `trap '' CHLD` began: no status of theirs is kept.
TEST(GuardedRead, WorksWhereEndsOfProcessesAreIgnored)
{
  const auto before = std::signal(SIGCHLD, SIG_IGN);
  EXPECT_EQ(RefusalOfReader([] {}), test::NotRefused);
  EXPECT_EQ(RefusalOfReader([] { throw InputError("line 3"); }), "line 3");
  EXPECT_THAT(RefusalOfReader([]() -> void { throw std::bad_alloc(); }), HasSubstr("more memory"));
  EXPECT_EQ(RefusalOfReader([] { std::raise(SIGKILL); }),
    "a file: expected numbers, found damaged data, at which its reader ended");
  std::signal(SIGCHLD, before);
}

TEST(GuardedRead, NeverEndingIsOneLine)
{
  EXPECT_THAT(RefusalOfReader(
                []
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
  const auto take = []
  {
    const std::vector<char> taken(much);
    EXPECT_EQ(taken.back(), 0);
  };
  EXPECT_THAT(RefusalOfReader(take),
    HasSubstr("more memory than a file of this size may (64 MiB)"));
  EXPECT_EQ(RefusalOfReader(
              [&]
              {
                AllowMemory(much + Small.MemoryBytes);
                take();
              }),
    test::NotRefused);
}

TEST(GuardedRead, WhatLibrariesPrintIsHeardByTheReaderOnly)
{
  const std::string said = ReadGuarded("a file", "numbers", Small,
    []
    {
      std::puts("Corrupt data");
      std::fputs("twice\n", stderr);
      return SaidByLibraries();
    });
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
        RunGuarded(
          "a file", "numbers", Small, [&](Parcel& parcel, const TellCallback&) { parcel(sent); },
          [&](Parcel& parcel) { parcel(asked); }, {});
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
  const int answer = ReadGuarded("a file", "numbers", Small,
    [] { return ReadGuarded("another", "numbers", Small, [] { return 42; }); });
  EXPECT_EQ(answer, 42);
}

/// What is asked of the work, and what is done at each text that it tells.
std::string RefusalOfWork(
  const std::function<std::vector<std::string>(const TellCallback&)>& work,
  const TellCallback& heard = [](const std::string&) {})
{
  return RefusalOf([&] { ReadGuarded("an archive", "answers", Endless, work, heard); });
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
  EXPECT_EQ(ReadGuarded("an archive", "answers", Endless, work, hear),
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
  EXPECT_THROW(ReadGuarded("an archive", "answers", Endless, work,
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
