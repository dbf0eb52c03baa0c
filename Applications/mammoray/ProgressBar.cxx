// SPDX-License-Identifier: Apache-2.0
#include "ProgressBar.h"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <memory>
#include <string>

namespace mammoray
{
namespace
{
volatile std::sig_atomic_t interruptCount = 0;

void OnInterrupt(int)
{
  interruptCount = interruptCount + 1;
  if (interruptCount > 1)
  {
    // The second Ctrl-C does what the user is used to.
    std::signal(SIGINT, SIG_DFL);
    std::raise(SIGINT);
  }
}
}

bool InterruptRequested()
{
  static const bool installed = []
  {
    std::signal(SIGINT, OnInterrupt);
    return true;
  }();
  return installed && interruptCount > 0;
}

ProgressCallback MakeProgressBar()
{
  InterruptRequested(); // from now on, not from the first report on
  const bool terminal = isatty(STDERR_FILENO) != 0;
  auto lastPercent = std::make_shared<int>(-1);
  auto lastStage = std::make_shared<std::string>();
  return [=](double fraction, const char* stage)
  {
    const int percent = std::clamp(static_cast<int>(100 * fraction), 0, 100);
    if (terminal && (percent != *lastPercent || *lastStage != stage))
    {
      const std::string bar(percent / 4, '#');
      std::fprintf(stderr, "\r\033[K%-32s [%-25s] %3d %%", stage, bar.c_str(), percent);
      if (percent == 100)
      {
        std::fputs("\r\033[K", stderr);
      }
      std::fflush(stderr);
      *lastPercent = percent;
      *lastStage = stage;
    }
    return !InterruptRequested();
  };
}
}
