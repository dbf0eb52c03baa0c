// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Progress_h
#define mammoray_Progress_h

#include "mammoray/Foundation/Error.h"

#include <functional>
#include <string>
#include <utility>

namespace mammoray
{
/**
 * Told of the progress of long work: a fraction in [0, 1] and the name of the stage. Returns false
 * to stop, upon which the work throws Interrupted. Called from the thread that started the work
 * only. An empty function is allowed.
 */
using ProgressCallback = std::function<bool(double fraction, const char* stage)>;

/// Tells the callback, if there is one; throws Interrupted when it answers false.
inline void ReportProgress(const ProgressCallback& progress, double fraction, const char* stage)
{
  if (progress && !progress(fraction, stage))
  {
    throw Interrupted();
  }
}

/// Stands between a part of long work and the stage within it: "register: equilibrium".
inline constexpr const char* StageSeparator = ": ";

/// The callback of work that is told as `from` to `to` of a whole, its stages as its own.
inline ProgressCallback ShareOf(const ProgressCallback& progress, double from, double to)
{
  if (!progress)
  {
    return {};
  }
  return [progress, from, to](double fraction, const char* stage)
  { return progress(from + fraction * (to - from), stage); };
}

/**
 * The callback of one part of long work: what the part tells of itself, from 0 to 1, is told as
 * `from` to `to` of the whole, its stages as those of `part`. Begins with `from`; throws
 * Interrupted when it is answered false then.
 */
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
