// SPDX-License-Identifier: Apache-2.0
#include "Private/FacePoints.h"

namespace mammoray
{
const std::vector<FacePoint>& FacePoints()
{
  static const std::vector<FacePoint> points = []
  {
    constexpr int n = 8;
    std::vector<FacePoint> made;
    for (int i = 0; i < n; ++i)
    {
      for (int j = 0; i + j < n; ++j)
      {
        // Small triangles of both orientations.
        for (int down = 0; down < (i + j + 1 < n ? 2 : 1); ++down)
        {
          const double shift = down ? 2 / 3.0 : 1 / 3.0;
          const double a = (i + shift) / n;
          const double b = (j + shift) / n;
          made.push_back({ { a, b, 1 - a - b }, 1.0 / (n * n) });
        }
      }
    }
    return made;
  }();
  return points;
}
}
