// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_AxisPlace_h
#define mammoray_AxisPlace_h

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace mammoray
{
/// The node of an ascending axis before a value, and the share of the next; beyond its ends the
/// line goes on. Of an axis of one node: that one alone.
inline std::pair<std::size_t, double> PlaceOn(const std::vector<double>& axis, double value)
{
  if (axis.size() == 1)
  {
    return { 0, 0.0 };
  }
  const auto above = std::upper_bound(axis.begin() + 1, axis.end() - 1, value);
  const auto index = static_cast<std::size_t>(above - axis.begin()) - 1;
  return { index, (value - axis[index]) / (axis[index + 1] - axis[index]) };
}
}

#endif
