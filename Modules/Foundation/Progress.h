// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Progress_h
#define mammoray_Progress_h

#include "mammoray/Foundation/Error.h"

#include <functional>
#include <string>
#include <utility>

namespace mammoray
{
/// Receives the progress of long work: a fraction in [0, 1] and the name of the stage. Returns
/// false to stop the work, which then throws Interrupted. It is called only from the thread that
/// started the work. An empty function is allowed.
using ProgressCallback = std::function<bool(double fraction, const char* stage)>;

/// Calls the callback, if there is one; throws Interrupted if it returns false.
inline void ReportProgress(const ProgressCallback& progress, double fraction, const char* stage)
{
  if (progress && !progress(fraction, stage))
  {
    throw Interrupted();
  }
}

/// Separates the name of a part from the stage within it: "register: equilibrium".
inline constexpr const char* StageSeparator = ": ";

/// A callback that maps the progress of a part to [from, to] of the whole and keeps the names of
/// its stages.
inline ProgressCallback ShareOf(const ProgressCallback& progress, double from, double to)
{
  if (!progress)
  {
    return {};
  }
  return [progress, from, to](double fraction, const char* stage)
  { return progress(from + fraction * (to - from), stage); };
}

/// A callback for one part of long work: it maps the part's progress to [from, to] of the whole and
/// prefixes its stages with `part`. Reports `from` at once, and throws Interrupted if that returns
/// false.
inline ProgressCallback PartOf(const ProgressCallback& progress, double from, double to,
  const std::string& part)
{
  if (!progress)
  {
    return {};
  }
  ReportProgress(progress, from, part.c_str());
  return [progress, from, to, part](double fraction, const char* stage)
  { return progress(from + fraction * (to - from), (part + StageSeparator + stage).c_str()); };
}
}

#endif
