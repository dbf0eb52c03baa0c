// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_GridMatrix_h
#define mammoray_GridMatrix_h

#include "mammoray/Biomechanics/Private/Objective.h"

#include <vector>

namespace mammoray
{
/// Pattern of second differences on a grid of side^3. From 44 on its factor is an expensive one.
inline SparsePattern GridPattern(int side)
{
  SparsePattern pattern;
  for (int c = 0; c < side * side * side; ++c)
  {
    pattern.Rows.push_back(c);
    const auto link = [&](bool inside, int step)
    {
      if (inside)
      {
        pattern.Rows.push_back(c + step);
      }
    };
    link(c % side + 1 < side, 1);
    link(c / side % side + 1 < side, side);
    link(c / side / side + 1 < side, side * side);
    pattern.Starts.push_back(static_cast<int>(pattern.Rows.size()));
  }
  return pattern;
}

/// Second differences with `more` on the diagonal: their condition is at most 12 / more + 1.
inline std::vector<double> GridMatrix(const SparsePattern& pattern, double more)
{
  std::vector<double> values(pattern.Rows.size(), -1.0);
  for (std::size_t c = 0; c + 1 < pattern.Starts.size(); ++c)
  {
    values[pattern.Starts[c]] = 6 + more;
  }
  return values;
}
}

#endif
