// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_FacePoints_h
#define mammoray_FacePoints_h

#include "Private/ElasticBody.h"
#include "Private/Energy.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayBiomechanicsModule.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace mammoray
{
/// A quadrature point of a triangle in barycentric coordinates, and the fraction of the area that
/// it represents.
struct FacePoint
{
  std::array<double, 3> Lambda;
  double Weight;
};

/**
 * The centroids of 64 equal small triangles. Where a plate's edge cuts through a face, many points
 * are better than a rule of high degree: on an edge of 3 mm radius that is pressed in by 0.05 mm
 * the contact is 1.1 mm wide. If the points of an 8 mm face lay farther apart, the body would rest
 * on a few of them and snag from one to the next (with 16 points, twice as many Newton steps).
 */
MAMMORAYBIOMECHANICS_EXPORT const std::vector<FacePoint>& FacePoints();

/// Shape functions of the triangle with six or three nodes at a point.
inline std::array<double, 6> FaceShape(const FacePoint& point, int nodes)
{
  const std::array<double, 3>& l = point.Lambda;
  if (nodes == 3)
  {
    return { l[0], l[1], l[2], 0, 0, 0 };
  }
  return { l[0] * (2 * l[0] - 1), l[1] * (2 * l[1] - 1), l[2] * (2 * l[2] - 1), 4 * l[0] * l[1],
    4 * l[1] * l[2], 4 * l[2] * l[0] };
}

/// Interpolates the node values `x` at a point of a boundary face.
inline Vector3 FacePosition(const ElasticBody& body, const ElasticBody::BoundaryFace& face,
  const std::array<double, 6>& shape, const std::vector<double>& x)
{
  const std::span<const std::int32_t> nodes = body.NodesOf(face.Element);
  Vector3 position{ 0, 0, 0 };
  for (int a = 0; a < body.NodesPerFace(); ++a)
  {
    position = position + shape[a] * NodePosition(x, nodes[face.LocalNodes[a]]);
  }
  return position;
}
}

#endif
