// SPDX-License-Identifier: Apache-2.0
#include "Private/Valley.h"

#include <algorithm>
#include <vector>

namespace mammoray
{
namespace
{
double MiddleOf(const std::vector<float>& profile, std::ptrdiff_t lowest, double stepMm)
{
  constexpr float flatMm = 3.0f;
  auto low = lowest;
  auto high = lowest;
  const float limit = profile[static_cast<std::size_t>(lowest)] + flatMm;
  while (low > 0 && profile[static_cast<std::size_t>(low - 1)] <= limit)
  {
    --low;
  }
  while (high + 1 < static_cast<std::ptrdiff_t>(profile.size()) &&
    profile[static_cast<std::size_t>(high + 1)] <= limit)
  {
    ++high;
  }
  return (0.5 * static_cast<double>(low + high) + 0.5) * stepMm;
}
}

Valley DeepestValley(const HeightMap* skin, const HeightMap* wall, double cutMm)
{
  std::vector<float> profile(skin->GetLargestPossibleRegion().GetSize()[0], 0.0f);
  for (std::size_t column = 0; column < skin->GetBufferedRegion().GetNumberOfPixels(); ++column)
  {
    const float height = skin->GetBufferPointer()[column];
    if (height > wall->GetBufferPointer()[column] && height > cutMm)
    {
      float& front = profile[column % profile.size()];
      front = std::max(front, height);
    }
  }
  Valley valley;
  const auto peak = std::max_element(profile.begin(), profile.end());
  for (const int direction : { -1, 1 })
  {
    auto lowest = peak;
    for (auto at = peak;; at += direction)
    {
      lowest = *at < *lowest ? at : lowest;
      const double depth = *at - *lowest;
      if (depth > valley.DepthMm && *lowest > 0)
      {
        valley.DepthMm = depth;
        valley.MiddleMm = MiddleOf(profile, lowest - profile.begin(), skin->GetSpacing()[0]);
      }
      if (at == (direction < 0 ? profile.begin() : profile.end() - 1))
      {
        break;
      }
    }
  }
  return valley;
}
}
