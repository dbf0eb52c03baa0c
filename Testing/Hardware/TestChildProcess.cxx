// SPDX-License-Identifier: Apache-2.0
#include "ChildProcess.h"
#include "Files.h"

#include <gtest/gtest.h>

using mammoray::benchmarks::RunProgram;
using mammoray::test::ReadFile;
using mammoray::test::TemporaryFolder;

TEST(ChildProcess, SaysWhatBecameOfIt)
{
  const TemporaryFolder folder;
  const std::string log = folder.File("log");
  EXPECT_EQ(RunProgram("/bin/sh", { "-c", "echo here; echo there >&2" }, { log, 30 }), "");
  EXPECT_EQ(ReadFile(log), "here\nthere\n");
  EXPECT_EQ(RunProgram("/bin/sh", { "-c", "exit 3" }), "exit code 3");
  EXPECT_EQ(RunProgram("/bin/sh", { "-c", "kill -11 $$" }, { log, 0 }), "signal 11");
  EXPECT_EQ(RunProgram("/no/such/program", {}), "cannot be started");
}

TEST(ChildProcess, IsKilledAtItsLimit)
{
  EXPECT_EQ(RunProgram("/bin/sleep", { "1000" }, { "", 1 }), "killed after 1 s");
}
