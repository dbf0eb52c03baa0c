// SPDX-License-Identifier: Apache-2.0
// What tables of evidence are made of.
#ifndef mammoray_Private_TableText_h
#define mammoray_Private_TableText_h

#include "mammoray/Evidence/LandmarkEvaluation.h"
#include "mammoray/Evidence/TwinExperiment.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

namespace mammoray
{
/// One line of text.
__attribute__((format(printf, 1, 2))) inline std::string Line(const char* format, ...)
{
  char text[1000];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

inline double Median(const std::vector<double>& values)
{
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : Summarise(values).Median;
}

inline double Largest(const std::vector<double>& values)
{
  return values.empty() ? std::numeric_limits<double>::quiet_NaN()
                        : *std::max_element(values.begin(), values.end());
}

inline int Percent(double part, double whole)
{
  return whole > 0 ? static_cast<int>(std::lround(100 * part / whole)) : 0;
}

/// A twin of the breast that was pictured, as it is.
inline bool IsRight(const TwinRun& run)
{
  return std::any_of(RightTwins.begin(), RightTwins.end(),
    [&](TwinKind kind) { return run.Kind == NameOf(kind); });
}
}

#endif
