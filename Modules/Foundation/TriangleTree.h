// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_TriangleTree_h
#define mammoray_TriangleTree_h

#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayFoundationModule.h"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace mammoray
{
/// An intersection of a line with a triangle.
struct LineHit
{
  /// Distance from the line's origin along its direction, mm; negative behind the origin.
  double T = 0;
  std::uint32_t Triangle = 0;
  /// True if the line meets the triangle's front.
  bool FacesBeginning = true;
  /// Barycentric coordinates of the intersection.
  std::array<double, 3> Weights{};
};

/// The materials before and behind a hit, in the line's direction.
inline std::pair<int, int> MaterialsAt(const SurfaceMesh& surface, const LineHit& hit)
{
  const int front = surface.FrontMaterials[hit.Triangle];
  const int back = surface.BackMaterials[hit.Triangle];
  return hit.FacesBeginning ? std::pair{ front, back } : std::pair{ back, front };
}

/// A bounding volume hierarchy of a surface's triangles on the CPU. Results do not depend on the
/// number of threads. Const methods are thread-safe.
class MAMMORAYFOUNDATION_EXPORT TriangleTree
{
public:
  /// The surface must be valid, must not change and must outlive the tree.
  explicit TriangleTree(const SurfaceMesh& surface);

  /// Finds all intersections of the infinite line through `begin` (mm) along the unit vector
  /// `direction`, sorted by T. `hits` is cleared first. A line through an edge or a corner of a
  /// closed surface is treated as if it were shifted by an infinitesimal amount, the same for all
  /// triangles there, so that it leaves each body as often as it enters it.
  void CrossLine(const Vector3& begin, const Vector3& direction, std::vector<LineHit>& hits) const;

  /// Pairs of triangles with overlapping boxes; each pair once, the smaller index first, ascending.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ClosePairs() const;

private:
  /// A leaf if Count is not 0: triangles Order[First] to Order[First + Count - 1]. Otherwise its
  /// children are the next node and Nodes[First].
  struct Node
  {
    Box3 Bounds;
    std::uint32_t First = 0;
    std::uint32_t Count = 0;
  };

  static bool Touch(const Box3& a, const Box3& b);
  Box3 BoxOf(std::uint32_t triangle) const;
  void Build(std::uint32_t begin, std::uint32_t end, std::vector<Box3>& boxes);
  /// Calls visit(triangle) for the triangles of every leaf whose box `meets` accepts.
  template <typename Meets, typename Visit>
  void Descend(const Meets& meets, const Visit& visit) const;

  const SurfaceMesh* Surface;
  std::vector<std::uint32_t> Order;
  std::vector<Node> Nodes;
};
}

#endif
