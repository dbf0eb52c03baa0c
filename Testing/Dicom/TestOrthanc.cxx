// SPDX-License-Identifier: Apache-2.0
#include "ArchivedFiles.h"
#include "SqueezedBox.h"

#include <sys/wait.h>

#include <gtest/gtest.h>

#include <cstdlib>

using namespace mammoray;

namespace
{
using OrthancOf = test::ArchivedFiles<test::SqueezedBox>;

/// See askOrthanc.py, which says what it expects and found.
TEST_F(OrthancOf, TakesShowsAndGivesTheObjects)
{
  std::string command = MAMMORAY_ORTHANC_TEST;
  command.append(" ").append(test::MammorayExecutable());
  command.append(" ").append(this->Folder.File(""));
  const int status = std::system(command.c_str());
  if (WIFEXITED(status) && WEXITSTATUS(status) == 125)
  {
    GTEST_SKIP() << "no Orthanc";
  }
  EXPECT_EQ(status, 0);
}
}
