// SPDX-License-Identifier: Apache-2.0
#include "FileSizeLimit.h"
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/AtomicFile.h"

#include <sys/file.h>
#include <sys/ptrace.h>
#include <sys/wait.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fcntl.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <set>

using namespace mammoray;
using test::FileSizeLimit;
using test::ReadFile;
using testing::ElementsAre;
namespace fs = std::filesystem;

namespace
{
class AtomicFile : public testing::Test
{
protected:
  /// Everything in the test's folder, sorted.
  std::set<std::string> Entries() const
  {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(this->Folder.File("")))
    {
      names.insert(entry.path().lexically_relative(this->Folder.File("")).string());
    }
    return names;
  }

  /// Runs it in a process of its own, which ends without cleaning up, as by kill -9.
  template <typename Work>
  static int InAnotherProcess(const Work& work)
  {
    const pid_t child = fork();
    if (child == 0)
    {
      int status = 0;
      try
      {
        work();
      }
      catch (const InputError&)
      {
        status = 1;
      }
      _exit(status);
    }
    int status = -1;
    waitpid(child, &status, 0);
    return WEXITSTATUS(status);
  }

  test::TemporaryFolder Folder;
};

/// Runs the work in a process of its own that is killed as it enters or leaves a system call, the
/// given one counted from 1; false where it ended before.
bool KillAtCall(int stop, const std::function<void()>& work)
{
  const pid_t child = fork();
  if (child == 0)
  {
    if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) == 0)
    {
      raise(SIGSTOP);
      work();
    }
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  for (int stops = 0; WIFSTOPPED(status); ++stops)
  {
    if (stops == stop)
    {
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
      return true;
    }
    ptrace(PTRACE_SYSCALL, child, nullptr, nullptr);
    waitpid(child, &status, 0);
  }
  return false;
}
}

TEST_F(AtomicFile, ReplacesAFileByAWholeOne)
{
  const std::string path = this->Folder.Write("a.nii.gz", "an earlier, longer text");
  WriteAtomicFile(path, "new\n");
  EXPECT_EQ(ReadFile(path), "new\n");
  WriteAtomicFile(path,
    [&](const std::string& staged)
    {
      // Libraries go by it.
      EXPECT_EQ(fs::path(staged).filename(), "a.nii.gz");
      EXPECT_NE(staged, path);
      std::ofstream(staged) << "of a library";
      EXPECT_EQ(ReadFile(path), "new\n");
    });
  EXPECT_EQ(ReadFile(path), "of a library");
  EXPECT_THAT(this->Entries(), ElementsAre("a.nii.gz"));
}

TEST_F(AtomicFile, LeavesNothingWhereItCannotWrite)
{
  EXPECT_THROW(WriteAtomicFile(this->Folder.File("absent/a.txt"), "new\n"), InputError);
  EXPECT_THROW(WriteAtomicFile(this->Folder.File("a.txt"),
                 [](const std::string& staged)
                 {
                   std::ofstream(staged) << "half";
                   throw InputError("stopped");
                 }),
    InputError);
  EXPECT_THROW(WriteAtomicFile(this->Folder.File("a.txt"), [](const std::string&) {}), InputError);
  EXPECT_THROW(WriteAtomicFolder(this->Folder.File("a"),
                 [](const std::string& folder)
                 {
                   WriteAtomicFile(folder + "/b", "half");
                   throw InputError("stopped");
                 }),
    InputError);
  EXPECT_THAT(this->Entries(), ElementsAre());
  // A folder of that name cannot be replaced by a file, nor a device.
  fs::create_directories(this->Folder.File("taken/within"));
  EXPECT_THROW(WriteAtomicFile(this->Folder.File("taken"), "new\n"), InputError);
  EXPECT_THROW(WriteAtomicFile("/dev/null", "new\n"), InputError);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_THAT(this->Entries(), ElementsAre("taken", "taken/within"));
}

// As on a system that is read only, or with the TMPDIR of another machine: a result of hours would
// be lost.
TEST_F(AtomicFile, NeedsNoFolderForTemporaryFiles)
{
  const char* const before = std::getenv("TMPDIR");
  const std::string kept = before ? before : "";
  for (const std::string& none : { std::string("/nonexistent"), std::string("/proc"),
         this->Folder.Write("file", ""), std::string() })
  {
    setenv("TMPDIR", none.c_str(), 1);
    WriteAtomicFile(this->Folder.File("a.txt"),
      [](const std::string& staged) { std::ofstream(staged) << "new"; });
    EXPECT_EQ(test::ReadFile(this->Folder.File("a.txt")), "new") << none;
    fs::remove(this->Folder.File("a.txt"));
  }
  before ? setenv("TMPDIR", kept.c_str(), 1) : unsetenv("TMPDIR");
}

TEST_F(AtomicFile, SeesAFullDisk)
{
  const std::string path = this->Folder.Write("a.txt", "old");
  const std::string large(5000, 'x');
  const auto fromLibrary = [&](const std::string& staged)
  { std::ofstream(staged) << large; }; // whose errors nobody asks for
  {
    const FileSizeLimit limit(4096);
    EXPECT_THAT(test::RefusalOf([&] { WriteAtomicFile(path, large); }),
      testing::HasSubstr("too large"));
    EXPECT_THAT(test::RefusalOf([&] { WriteAtomicFile(path, fromLibrary); }),
      testing::HasSubstr("too large"));
    EXPECT_THAT(test::RefusalOf(
                  [&]
                  {
                    WriteAtomicFolder(this->Folder.File("b"),
                      [&](const std::string& folder)
                      { WriteAtomicFile(folder + "/a.txt", large); });
                  }),
      testing::HasSubstr("too large"));
  }
  EXPECT_THAT(this->Entries(), ElementsAre("a.txt"));
  EXPECT_EQ(ReadFile(path), "old");
  WriteAtomicFile(path, fromLibrary);
  EXPECT_EQ(ReadFile(path), large);
}

TEST_F(AtomicFile, FollowsALink)
{
  this->Folder.Write("a.txt", "old");
  fs::create_symlink("a.txt", this->Folder.File("link.txt"));
  fs::create_symlink("b.txt", this->Folder.File("free.txt"));
  WriteAtomicFile(this->Folder.File("link.txt"), "new");
  WriteAtomicFile(this->Folder.File("free.txt"), "first");
  EXPECT_EQ(ReadFile(this->Folder.File("a.txt")), "new");
  EXPECT_EQ(ReadFile(this->Folder.File("b.txt")), "first");
  EXPECT_TRUE(fs::is_symlink(this->Folder.File("link.txt")));
  fs::create_directory(this->Folder.File("there"));
  fs::create_directory_symlink("there", this->Folder.File("folder"));
  WriteAtomicFolder(this->Folder.File("folder/"),
    [](const std::string& folder) { WriteAtomicFile(folder + "/c", "c"); });
  EXPECT_EQ(ReadFile(this->Folder.File("there/c")), "c");
  EXPECT_TRUE(fs::is_symlink(this->Folder.File("folder")));
}

TEST_F(AtomicFile, ExchangesAFolder)
{
  const std::string path = this->Folder.File("result");
  fs::create_directory(path);
  this->Folder.Write("result/old", "old");
  WriteAtomicFolder(path,
    [&](const std::string& folder)
    {
      WriteAtomicFile(folder + "/new", "new");
      EXPECT_EQ(ReadFile(path + "/old"), "old");
    });
  EXPECT_THAT(this->Entries(), ElementsAre("result", "result/new"));
}

TEST_F(AtomicFile, ADeadRunsLeftoversAreSwept)
{
  for (const char* name : { "a", "b" })
  {
    InAnotherProcess([&] { ReserveFile(this->Folder.File(name)); });
  }
  InAnotherProcess(
    [&]
    {
      WriteAtomicFolder(this->Folder.File("c"),
        [](const std::string& folder)
        {
          WriteAtomicFile(folder + "/old", "old");
          _exit(0);
        });
    });
  EXPECT_THAT(this->Entries(), ElementsAre("a.partial", "b.partial", "c.partial", "c.partial/old"));
  WriteAtomicFile(this->Folder.File("a"), "a");
  EXPECT_TRUE(ReserveFile(this->Folder.File("b")));
  WriteAtomicFile(this->Folder.File("b"), "b");
  WriteAtomicFolder(this->Folder.File("c"),
    [](const std::string& folder) { WriteAtomicFile(folder + "/new", "new"); });
  EXPECT_THAT(this->Entries(), ElementsAre("a", "b", "c", "c/new"));
}

TEST_F(AtomicFile, HasOneWriter)
{
  const std::string file = this->Folder.File("a");
  const std::string folder = this->Folder.File("b");
  EXPECT_TRUE(ReserveFile(file));
  EXPECT_FALSE(ReserveFile(this->Folder.File("./a"))); // this process has it already
  EXPECT_TRUE(ReserveFolder(folder));
  EXPECT_EQ(InAnotherProcess([&] { WriteAtomicFile(this->Folder.File("c"), "other"); }), 0);
  // The other of this process is of the same open file, as a child's is: it must be another's.
  for (const std::string& path : { file, folder })
  {
    const int opened = open((path + ".partial").c_str(), O_RDONLY);
    EXPECT_NE(flock(opened, LOCK_EX | LOCK_NB), 0);
    close(opened);
  }
  WriteAtomicFile(file, "ours");
  WriteAtomicFolder(folder,
    [](const std::string& written) { WriteAtomicFile(written + "/d", "d"); });
  EXPECT_TRUE(ReserveFile(file));
  WriteAtomicFile(file, "ours again");
  EXPECT_EQ(ReadFile(file), "ours again");

  // Another holds it.
  const int opened = open((this->Folder.File("e.partial")).c_str(), O_RDWR | O_CREAT, 0600);
  ASSERT_EQ(flock(opened, LOCK_EX), 0);
  EXPECT_THAT(test::RefusalOf([&] { ReserveFile(this->Folder.File("e")); }),
    testing::HasSubstr("another run is writing it"));
  EXPECT_TRUE(fs::exists(this->Folder.File("e.partial")));
  close(opened);
  EXPECT_TRUE(ReserveFile(this->Folder.File("e")));
  WriteAtomicFile(this->Folder.File("e"), "e");
  EXPECT_THAT(this->Entries(), ElementsAre("a", "b", "b/d", "c", "e"));
}

TEST_F(AtomicFile, SurvivesBeingKilledAtEachSystemCall)
{
  const std::string folder = this->Folder.File("result");
  const std::string file = this->Folder.File("picture");
  const auto writeAll = [&](const std::string& text)
  {
    WriteAtomicFolder(folder,
      [&](const std::string& written)
      {
        WriteAtomicFile(written + "/a", text);
        WriteAtomicFile(written + "/b", text);
      });
    WriteAtomicFile(file, [&](const std::string& staged) { std::ofstream(staged) << text; });
  };
  writeAll("old");
  int kills = 0;
  const std::string temporary = this->Folder.File("temporary"); // what a killed one leaves there
  const auto writeNew = [&]
  {
    setenv("TMPDIR", temporary.c_str(), 1);
    writeAll("new");
  };
  while (fs::create_directory(temporary) && KillAtCall(kills + 1, writeNew))
  {
    ++kills;
    fs::remove_all(temporary);
    // Whole, and of one run.
    const std::string found = ReadFile(folder + "/a");
    ASSERT_TRUE(found == "old" || found == "new") << kills << ": " << found;
    ASSERT_EQ(ReadFile(folder + "/b"), found) << kills;
    const std::string picture = ReadFile(file);
    ASSERT_TRUE(picture == "old" || picture == "new") << kills << ": " << picture;
    writeAll("old");
    ASSERT_THAT(this->Entries(), ElementsAre("picture", "result", "result/a", "result/b")) << kills;
  }
  if (kills == 0)
  {
    GTEST_SKIP() << "tracing is not allowed";
  }
  EXPECT_EQ(ReadFile(folder + "/b"), "new");
  EXPECT_EQ(ReadFile(file), "new");
  std::cout << kills << " kills\n";
  EXPECT_GT(kills, 50);
}
