// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Report/WholeFile.h"

#include <gtest/gtest.h>

#include <filesystem>

using namespace mammoray;

TEST(WholeFile, ReplacesAFileByAWholeOne)
{
  const testing_support::TemporaryFolder folder;
  const std::string path = folder.Write("a.txt", "an earlier, longer text");
  WriteWholeFile("new\n", path);
  EXPECT_EQ(testing_support::ReadFile(path), "new\n");
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));
}

TEST(WholeFile, LeavesNothingWhereItCannotWrite)
{
  const testing_support::TemporaryFolder folder;
  EXPECT_THROW(WriteWholeFile("new\n", folder.File("absent/a.txt")), InputError);
  // A folder of that name cannot be replaced.
  std::filesystem::create_directories(folder.File("taken/within"));
  EXPECT_THROW(WriteWholeFile("new\n", folder.File("taken")), InputError);
  EXPECT_FALSE(std::filesystem::exists(folder.File("taken.part")));
}
