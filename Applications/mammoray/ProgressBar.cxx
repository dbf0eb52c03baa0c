// SPDX-License-Identifier: Apache-2.0
#include "ProgressBar.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <memory>
#include <string>

namespace mammoray
{
namespace
{
volatile std::sig_atomic_t interruptCount = 0;
volatile std::sig_atomic_t interruptSignal = 0;

/// Work that does not poll InterruptRequested, because it waits for a pipe or a library, is ended
/// after this time. Longer than the longest work between two polls.
constexpr unsigned int SecondsUntilHeard = 120;

void OnAlarm(int)
{
  std::signal(interruptSignal, SIG_DFL);
  std::raise(interruptSignal);
}

void OnInterrupt(int signal)
{
  interruptCount = interruptCount + 1;
  interruptSignal = signal;
  alarm(SecondsUntilHeard);
  if (interruptCount > 1)
  {
    // The second Ctrl-C does what the user is used to.
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
}

/**
 * What is told of long work on stderr: a line for each part that took a second or more, with its
 * time; within a part a bar where there is a terminal, else a line every ten seconds.
 */
class ProgressLines
{
public:
  ProgressLines() = default;
  ProgressLines(const ProgressLines&) = delete;
  ProgressLines& operator=(const ProgressLines&) = delete;
  ~ProgressLines() { this->ClearBar(); }

  void Tell(double fraction, const std::string& stage)
  {
    const std::string part = stage.substr(0, stage.find(StageSeparator));
    if (part != this->Part)
    {
      this->Finish();
      this->Part = part;
      this->PartBegin = Clock::now();
      this->LastLine = this->PartBegin;
    }
    if (this->Terminal)
    {
      this->DrawBar(fraction, stage);
    }
    else if (SecondsSince(this->LastLine) > SecondsBetweenLines)
    {
      this->LastLine = Clock::now();
      std::fprintf(stderr, "%9.1f s  ... %s, %d %%%s\n", SecondsSince(this->Begin), stage.c_str(),
        static_cast<int>(100 * fraction), this->Remaining(fraction).c_str());
    }
    if (fraction >= 1)
    {
      this->Finish();
      this->Part.clear();
      this->Begin = Clock::now();
    }
  }

private:
  using Clock = std::chrono::steady_clock;
  static constexpr double LeastSecondsOfPart = 1;
  static constexpr double SecondsBetweenLines = 10;
  /// Before that nothing is said of the time that is left.
  static constexpr double LeastFraction = 0.05;

  static double SecondsSince(Clock::time_point begin)
  {
    return std::chrono::duration<double>(Clock::now() - begin).count();
  }

  /// ", about 12 s left", or nothing while it is unknown.
  std::string Remaining(double fraction) const
  {
    const double passed = SecondsSince(this->Begin);
    if (fraction < LeastFraction || fraction >= 1 || passed < LeastSecondsOfPart)
    {
      return "";
    }
    return ", about " +
      std::to_string(static_cast<int>(std::ceil(passed * (1 - fraction) / fraction))) + " s left";
  }

  void DrawBar(double fraction, const std::string& stage)
  {
    const int percent = static_cast<int>(100 * fraction);
    if (percent == this->LastPercent && stage == this->LastStage)
    {
      return;
    }
    const std::string bar(static_cast<std::size_t>(percent / 4), '#');
    std::fprintf(stderr, "\r\033[K%-40.40s [%-25s] %3d %%%s", stage.c_str(), bar.c_str(), percent,
      this->Remaining(fraction).c_str());
    std::fflush(stderr);
    this->LastPercent = percent;
    this->LastStage = stage;
  }

  void ClearBar()
  {
    if (this->LastPercent >= 0)
    {
      std::fputs("\r\033[K", stderr);
      std::fflush(stderr);
      this->LastPercent = -1;
    }
  }

  void Finish()
  {
    this->ClearBar();
    const double seconds = SecondsSince(this->PartBegin);
    if (!this->Part.empty() && seconds >= LeastSecondsOfPart)
    {
      std::fprintf(stderr, "%9.1f s  %s\n", seconds, this->Part.c_str());
    }
  }

  const bool Terminal = isatty(STDERR_FILENO) != 0;
  Clock::time_point Begin = Clock::now();
  Clock::time_point PartBegin = Begin;
  Clock::time_point LastLine = Begin;
  std::string Part;
  std::string LastStage;
  int LastPercent = -1;
};
}

bool InterruptRequested()
{
  static const bool installed = []
  {
    for (const int signal : { SIGINT, SIGTERM, SIGHUP })
    {
      if (std::signal(signal, OnInterrupt) == SIG_IGN)
      {
        std::signal(signal, SIG_IGN); // as nohup wants it
      }
    }
    std::signal(SIGALRM, OnAlarm);
    return true;
  }();
  if (!installed || interruptCount == 0)
  {
    return false;
  }
  alarm(0); // heard
  return true;
}

ProgressCallback MakeProgressBar()
{
  InterruptRequested(); // from now on, not from the first report on
  auto lines = std::make_shared<ProgressLines>();
  return [lines](double fraction, const char* stage)
  {
    lines->Tell(std::clamp(fraction, 0.0, 1.0), stage);
    return !InterruptRequested();
  };
}
}
