// SPDX-License-Identifier: Apache-2.0
#include "Private/MeshQuality.h"

#include <algorithm>
#include <limits>
#include <numbers>

namespace mammoray
{
double SmallestDihedralDeg(const TetrahedralMesh& mesh, std::size_t cell)
{
  Vector3 corner[4];
  for (int c = 0; c < 4; ++c)
  {
    corner[c] = mesh.Point(mesh.Cells[4 * cell + c]);
  }
  double smallest = std::numbers::pi;
  for (int a = 0; a < 4; ++a)
  {
    for (int b = a + 1; b < 4; ++b)
    {
      // Project the other two corners along the edge ab; the angle between them is the dihedral
      // angle.
      const int c = a == 0 ? (b == 1 ? 2 : 1) : 0;
      const int d = 6 - a - b - c;
      const Vector3 edge = corner[b] - corner[a];
      const Vector3 n1 = Cross(edge, corner[c] - corner[a]);
      const Vector3 n2 = Cross(edge, corner[d] - corner[a]);
      smallest = std::min(smallest, std::atan2(Norm(Cross(n1, n2)), Dot(n1, n2)));
    }
  }
  return smallest * 180.0 / std::numbers::pi;
}

double RadiusEdgeRatio(const TetrahedralMesh& mesh, std::size_t cell)
{
  const std::int32_t* ids = &mesh.Cells[4 * cell];
  const Vector3 origin = mesh.Point(ids[0]);
  const Vector3 a = mesh.Point(ids[1]) - origin;
  const Vector3 b = mesh.Point(ids[2]) - origin;
  const Vector3 c = mesh.Point(ids[3]) - origin;
  const Vector3 numerator =
    Dot(a, a) * Cross(b, c) + Dot(b, b) * Cross(c, a) + Dot(c, c) * Cross(a, b);
  const double radius = Norm(numerator) / (2 * std::abs(Dot(a, Cross(b, c))));
  const double shortest =
    std::min({ Norm(a), Norm(b), Norm(c), Norm(b - a), Norm(c - a), Norm(c - b) });
  return shortest > 0 ? radius / shortest : std::numeric_limits<double>::infinity();
}
}
