// SPDX-License-Identifier: Apache-2.0
// Label volumes by formula, and what tests of meshers ask of results.
#ifndef mammoray_LabelShapes_h
#define mammoray_LabelShapes_h

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Volumes.h"

#include <algorithm>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace mammoray::test
{
/// n^3 voxels whose label is a function of the position (mm) relative to the middle.
inline LabelVolume LabelledCube(int n, double spacing,
  const std::function<int(const Vector3&)>& label)
{
  LabelVolume volume;
  volume.Size = { n, n, n };
  volume.Spacing = { spacing, spacing, spacing };
  const double start = -0.5 * (n - 1) * spacing;
  volume.Origin = { start, start, start };
  for (int k = 0; k < n; ++k)
  {
    for (int j = 0; j < n; ++j)
    {
      for (int i = 0; i < n; ++i)
      {
        volume.Voxels.push_back(static_cast<std::uint16_t>(label(volume.PointAt(i, j, k))));
      }
    }
  }
  return volume;
}

/// Each voxel takes the label of the nearest of `count` random places, labels 0 to labels - 1.
inline LabelVolume Mosaic(int n, double spacing, double halfWidth, int count, int labels,
  unsigned seed)
{
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> coordinate(-halfWidth, halfWidth);
  std::vector<std::pair<Vector3, int>> centres;
  for (int centre = 0; centre < count; ++centre)
  {
    const double x = coordinate(generator);
    const double y = coordinate(generator);
    const double z = coordinate(generator);
    centres.push_back({ { x, y, z }, centre % labels });
  }
  return LabelledCube(n, spacing,
    [&](const Vector3& p)
    {
      return std::min_element(centres.begin(), centres.end(),
        [&](const auto& a, const auto& b) { return Norm(a.first - p) < Norm(b.first - p); })
        ->second;
    });
}

/// Volume of a material in a list of reports or qualities; -1 where it is absent.
template <typename List, typename Member>
double VolumeIn(const List& list, int material, Member member)
{
  for (const auto& entry : list)
  {
    if (entry.Material == material)
    {
      return entry.*member;
    }
  }
  return -1;
}
}

#endif
