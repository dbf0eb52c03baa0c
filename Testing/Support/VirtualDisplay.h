// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Testing_VirtualDisplay_h
#define mammoray_Testing_VirtualDisplay_h

#include <csignal>
#include <cstdlib>
#include <string>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace mammoray::test
{
/**
 * An X server of the process's own (Xvfb), named by DISPLAY; XvfbPath is its path. One for all
 * tests: OpenGL drivers do not expect their display to go.
 */
class VirtualDisplay
{
public:
  static const VirtualDisplay& Instance()
  {
    static const VirtualDisplay display;
    setenv("DISPLAY", display.Name.c_str(), 1);
    return display;
  }
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;

  bool Works() const { return !this->Name.empty(); }

private:
  VirtualDisplay()
  {
    int ends[2];
    if (pipe(ends) != 0)
    {
      return;
    }
    this->Server = fork();
    if (this->Server == 0)
    {
      close(ends[0]);
      prctl(PR_SET_PDEATHSIG, SIGTERM); // also where the test is killed
      const std::string end = std::to_string(ends[1]);
      const int nowhere = open("/dev/null", O_WRONLY);
      dup2(nowhere, STDOUT_FILENO);
      dup2(nowhere, STDERR_FILENO);
      execl(XvfbPath().c_str(), XvfbPath().c_str(), "-displayfd", end.c_str(), "-screen", "0",
        "1400x1000x24", "-noreset", "-nolisten", "tcp", static_cast<char*>(nullptr));
      _exit(127);
    }
    close(ends[1]);
    // The server writes its number once it listens; nothing comes where it could not start.
    std::string number;
    for (char digit = 0; read(ends[0], &digit, 1) == 1 && digit != '\n';)
    {
      number += digit;
    }
    close(ends[0]);
    if (!number.empty())
    {
      this->Name = ":" + number;
    }
  }
  ~VirtualDisplay()
  {
    if (this->Server > 0)
    {
      kill(this->Server, SIGTERM);
      waitpid(this->Server, nullptr, 0);
    }
  }
  pid_t Server = -1;
  std::string Name;
};
}

#endif
