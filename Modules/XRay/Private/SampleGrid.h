// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SampleGrid_h
#define mammoray_SampleGrid_h

#include <array>
#include <vector>

namespace mammoray
{
/// Offsets of a centred grid of n points on an edge.
inline std::vector<double> GridOffsets(int n, double edge)
{
  std::vector<double> offsets;
  offsets.reserve(n);
  for (int index = 0; index < n; ++index)
  {
    offsets.push_back(((index + 0.5) / n - 0.5) * edge);
  }
  return offsets;
}

/// The n x n samples of a pixel, (column, row) from its centre, row by row; pixels.
inline std::vector<std::array<double, 2>> SampleOffsets(int n)
{
  std::vector<std::array<double, 2>> samples;
  for (const double row : GridOffsets(n, 1))
  {
    for (const double column : GridOffsets(n, 1))
    {
      samples.push_back({ column, row });
    }
  }
  return samples;
}
}

#endif
