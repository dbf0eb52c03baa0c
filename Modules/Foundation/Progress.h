// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Progress_h
#define mammoray_Progress_h

#include "mammoray/Foundation/Error.h"

#include <functional>

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
}

#endif
