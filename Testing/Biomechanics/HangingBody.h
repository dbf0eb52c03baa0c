// SPDX-License-Identifier: Apache-2.0
// What tests of gravity and unloading ask of bodies that hang free.
#ifndef mammoray_Testing_HangingBody_h
#define mammoray_Testing_HangingBody_h

#include "mammoray/Biomechanics/Plates.h"
#include "mammoray/Foundation/Meshes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace mammoray::test
{
/// Plates that touch nothing.
inline PlatePair OpenPlates()
{
  PlatePair plates;
  plates.Support.Edge = { 0, -500, -500 };
  plates.Paddle.Edge = { 0, -500, 500 };
  plates.Paddle.Normal = { 0, 0, -1 };
  return plates;
}

/// The first coordinates, those of the mesh's points.
inline std::vector<double> CornersOf(const std::vector<double>& positions,
  const TetrahedralMesh& mesh)
{
  return { positions.begin(), positions.begin() + static_cast<std::ptrdiff_t>(mesh.Points.size()) };
}

/// Over the coordinates of `b`.
inline double LargestDifference(const std::vector<double>& a, const std::vector<double>& b)
{
  double largest = 0;
  for (std::size_t c = 0; c < b.size(); ++c)
  {
    largest = std::max(largest, std::abs(a[c] - b[c]));
  }
  return largest;
}
}

#endif
