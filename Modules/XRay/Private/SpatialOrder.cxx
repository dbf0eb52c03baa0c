// SPDX-License-Identifier: Apache-2.0
#include "Private/SpatialOrder.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

namespace mammoray
{
std::vector<std::uint32_t> SpatialOrder(const SurfaceMesh& surface)
{
  const std::size_t count = surface.NumberOfTriangles();
  std::vector<std::array<float, 3>> middles(count);
  std::vector<std::uint32_t> order(count);
  for (std::size_t triangle = 0; triangle < count; ++triangle)
  {
    order[triangle] = static_cast<std::uint32_t>(triangle);
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      double sum = 0;
      for (std::size_t corner = 0; corner < 3; ++corner)
      {
        sum += surface.Points[3 * surface.Triangles[3 * triangle + corner] + axis];
      }
      middles[triangle][axis] = static_cast<float>(sum / 3);
    }
  }
  std::vector<std::pair<std::size_t, std::size_t>> ranges{ { 0, count } };
  while (!ranges.empty())
  {
    const auto [begin, end] = ranges.back();
    ranges.pop_back();
    if (end - begin < 3)
    {
      continue;
    }
    std::array<float, 3> low = middles[order[begin]];
    std::array<float, 3> high = low;
    for (std::size_t index = begin + 1; index < end; ++index)
    {
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        low[axis] = std::min(low[axis], middles[order[index]][axis]);
        high[axis] = std::max(high[axis], middles[order[index]][axis]);
      }
    }
    std::size_t longest = 0;
    for (std::size_t axis = 1; axis < 3; ++axis)
    {
      longest = high[axis] - low[axis] > high[longest] - low[longest] ? axis : longest;
    }
    const std::size_t half = begin + (end - begin) / 2;
    std::nth_element(order.begin() + static_cast<std::ptrdiff_t>(begin),
      order.begin() + static_cast<std::ptrdiff_t>(half),
      order.begin() + static_cast<std::ptrdiff_t>(end),
      [&](std::uint32_t a, std::uint32_t b)
      { return std::tie(middles[a][longest], a) < std::tie(middles[b][longest], b); });
    ranges.emplace_back(begin, half);
    ranges.emplace_back(half, end);
  }
  return order;
}
}
