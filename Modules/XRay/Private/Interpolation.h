// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Interpolation_h
#define mammoray_Interpolation_h

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace mammoray
{
/// Linear interpolation on an ascending axis: the index of the node before a value, and the weight
/// of the next node. Beyond the ends this extrapolates. An axis of one node gives {0, 0}.
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

/// Bilinear interpolation between cells that are stored row by row. `column` and `row` are whole
/// numbers at the centres of cells. Outside the outermost centres the value is constant.
template <typename Value>
double BetweenCells(const std::vector<Value>& values, int columns, int rows, double column,
  double row)
{
  const auto split = [](double place, int count)
  {
    const double within = std::clamp(place, 0.0, count - 1.0);
    const int low = std::min(static_cast<int>(within), std::max(count - 2, 0));
    return std::pair{ low, within - low };
  };
  const auto [left, right] = split(column, columns);
  const auto [top, down] = split(row, rows);
  const auto at = [&](int c, int r)
  {
    return static_cast<double>(
      values[static_cast<std::size_t>(std::min(r, rows - 1)) * static_cast<std::size_t>(columns) +
        static_cast<std::size_t>(std::min(c, columns - 1))]);
  };
  return (1 - down) * ((1 - right) * at(left, top) + right * at(left + 1, top)) +
    down * ((1 - right) * at(left, top + 1) + right * at(left + 1, top + 1));
}
}

#endif
