// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Benchmarks_ChildProcess_h
#define mammoray_Benchmarks_ChildProcess_h

#include <string>
#include <vector>

namespace mammoray::benchmarks
{
/// Where and how long a program runs.
struct ChildOptions
{
  /// A file that takes its standard output and error; empty: where this program's go.
  std::string LogFile;
  /// It is killed after so many seconds; 0: never.
  double LimitSeconds = 0;
};

/// Runs a program and waits for it. "" where it answered 0, else what became of it: "exit code 1",
/// "signal 11", "killed after 600 s", "cannot be started".
std::string RunProgram(const std::string& path, const std::vector<std::string>& arguments,
  const ChildOptions& options = {});

/// The file of this program.
std::string ThisProgram();
}

#endif
