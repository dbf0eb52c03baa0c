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
/// A point of a triangle by its barycentric coordinates, and the part of the area it stands for.
struct FacePoint
{
  std::array<double, 3> Lambda;
  double Weight;
};

/**
 * The middles of 64 equal small triangles: where a plate's edge cuts through a face, many points
 * beat a high degree. On a round of 3 mm that is pressed 0.05 mm deep the contact is 1.1 mm wide:
 * points of an 8 mm face must not lie farther apart than that, or the body rests on a few of them
 * and catches on the edge from one to the next (16 points: twice as many Newton steps).
 */
MAMMORAYBIOMECHANICS_EXPORT const std::vector<FacePoint>& FacePoints();

/// Shape functions of the triangle with six nodes or three at a point.
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

/// A point of a boundary face, or what node values `x` make there.
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
