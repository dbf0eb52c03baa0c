// SPDX-License-Identifier: Apache-2.0
#include "ChildProcess.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <thread>

namespace mammoray::benchmarks
{
namespace
{
using Clock = std::chrono::steady_clock;

constexpr int NotStarted = 127;

/// In the child: never returns.
[[noreturn]] void Become(const std::string& path, std::vector<char*>& arguments,
  const std::string& logFile)
{
  prctl(PR_SET_PDEATHSIG, SIGKILL); // what it starts itself ends with it
  if (!logFile.empty())
  {
    const int log = open(logFile.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (log < 0 || dup2(log, STDOUT_FILENO) < 0 || dup2(log, STDERR_FILENO) < 0)
    {
      _exit(NotStarted);
    }
  }
  execv(path.c_str(), arguments.data());
  _exit(NotStarted);
}
}

std::string RunProgram(const std::string& path, const std::vector<std::string>& arguments,
  const ChildOptions& options)
{
  std::vector<std::string> copies{ path };
  copies.insert(copies.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& argument : copies)
  {
    pointers.push_back(argument.data());
  }
  pointers.push_back(nullptr);
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0)
  {
    Become(path, pointers, options.LogFile);
  }
  if (child < 0)
  {
    return "cannot be started";
  }
  int status = 0;
  const auto begin = Clock::now();
  bool killed = false;
  // Without a limit the wait blocks: a poll would be seen in the times that are taken here.
  while (waitpid(child, &status, options.LimitSeconds > 0 ? WNOHANG : 0) == 0)
  {
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    if (!killed && seconds > options.LimitSeconds)
    {
      kill(child, SIGKILL);
      killed = true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  if (killed)
  {
    return "killed after " + std::to_string(static_cast<int>(options.LimitSeconds)) + " s";
  }
  if (WIFSIGNALED(status))
  {
    return "signal " + std::to_string(WTERMSIG(status));
  }
  const int code = WEXITSTATUS(status);
  if (code == NotStarted)
  {
    return "cannot be started";
  }
  return code == 0 ? "" : "exit code " + std::to_string(code);
}

std::string ThisProgram()
{
  return std::filesystem::read_symlink("/proc/self/exe").string();
}
}
