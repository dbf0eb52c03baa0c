// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Testing_CommandTest_h
#define mammoray_Testing_CommandTest_h

#include "Files.h"

#include <sys/wait.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

namespace mammoray::test
{
/// Runs a program (MammorayExecutable) in a folder of the test's own.
class CommandTest : public testing::Test
{
protected:
  /// The exit status, -1 when killed; Output and Errors are kept, and the indented lines of
  /// Progress, of which there are as many as the machine is slow. `environment`: NAME=value, as for
  /// a shell.
  int Run(const std::string& arguments, const std::string& environment = "")
  {
    const std::string command = environment + " " + this->Program + " " + arguments + " >" +
      this->Folder.File("out") + " 2>" + this->Folder.File("err");
    const int status = std::system(command.c_str());
    this->Output = ReadFile(this->Folder.File("out"));
    this->Errors.clear();
    this->Progress.clear();
    std::istringstream said(ReadFile(this->Folder.File("err")));
    for (std::string line; std::getline(said, line);)
    {
      (line.starts_with(' ') ? this->Progress : this->Errors) += line + "\n";
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  /// One line that holds `text`, nothing else, and exit status 1.
  void ExpectRefused(const std::string& arguments, const std::string& text,
    const std::string& environment = "")
  {
    this->ExpectRefusedAfterListing(arguments, text, environment);
    EXPECT_EQ(this->Output, "") << arguments;
  }

  /// The same of a command that first lists what there is.
  void ExpectRefusedAfterListing(const std::string& arguments, const std::string& text,
    const std::string& environment = "")
  {
    EXPECT_EQ(this->Run(arguments, environment), 1) << arguments;
    EXPECT_THAT(this->Errors,
      testing::StartsWith(this->Program.substr(this->Program.rfind('/') + 1) + ": "));
    EXPECT_THAT(this->Errors, testing::HasSubstr(text));
    EXPECT_EQ(std::count(this->Errors.begin(), this->Errors.end(), '\n'), 1) << this->Errors;
  }

  /// The floats behind the header of a raw .mha.
  static std::vector<float> MhaValues(const std::string& path)
  {
    const std::string bytes = ReadFile(path);
    const std::string key = "ElementDataFile = LOCAL\n";
    const std::size_t start = bytes.find(key) + key.size();
    std::vector<float> values((bytes.size() - start) / sizeof(float));
    std::memcpy(values.data(), bytes.data() + start, values.size() * sizeof(float));
    return values;
  }

  std::string Program = MammorayExecutable();
  TemporaryFolder Folder;
  std::string Output;
  std::string Errors;
  std::string Progress;
};
}

#endif
