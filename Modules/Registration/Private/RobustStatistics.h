// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RobustStatistics_h
#define mammoray_RobustStatistics_h

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace mammoray
{
/// The median of values, at least one, whose order is changed; the larger of the middle two.
template <typename Value>
Value Median(std::vector<Value>& values)
{
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The standard deviation of a normal distribution by the median of the values' distances from
/// `middle`.
template <typename Value>
Value RobustSigma(std::vector<Value> values, Value middle)
{
  constexpr double SigmaOfMedian = 1.4826; // 1 / Phi^-1(3/4)
  for (Value& value : values)
  {
    value = std::abs(value - middle);
  }
  return static_cast<Value>(SigmaOfMedian * Median(values));
}
}

#endif
