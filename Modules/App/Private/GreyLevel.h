// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_GreyLevel_h
#define mammoray_GreyLevel_h

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace mammoray
{
/// Mean and standard deviation of grey values.
struct GreyLevel
{
  double Mean = 0;
  double Deviation = 1;
};

/// Of the pixels where `inside` says so.
template <typename Inside>
GreyLevel LevelOf(const std::vector<float>& values, const Inside& inside)
{
  double count = 0;
  double sum = 0;
  double squares = 0;
  for (std::size_t pixel = 0; pixel < values.size(); ++pixel)
  {
    if (inside(pixel))
    {
      count += 1;
      sum += values[pixel];
      squares += static_cast<double>(values[pixel]) * values[pixel];
    }
  }
  if (count == 0)
  {
    return {};
  }
  const double mean = sum / count;
  return { mean, std::max(std::sqrt(std::max(squares / count - mean * mean, 0.0)), 1e-6) };
}
}

#endif
