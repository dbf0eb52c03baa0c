// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_TriangleTree_h
#define mammoray_TriangleTree_h

#include "mammoray/Foundation/SurfaceMesh.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayFoundationModule.h"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace mammoray
{
/// Where a line crosses a triangle.
struct LineHit
{
  /// Distance from the line's beginning along its direction, mm; negative behind it.
  double T = 0;
  std::uint32_t Triangle = 0;
  /// Whether the line meets the triangle's front first.
  bool FacesBeginning = true;
  /// Barycentric coordinates of the place.
  std::array<double, 3> Weights{};
};

/// The material that the line leaves at a hit, and that which it enters.
inline std::pair<int, int> MaterialsAt(const SurfaceMesh& surface, const LineHit& hit)
{
  const int front = surface.FrontMaterials[hit.Triangle];
  const int back = surface.BackMaterials[hit.Triangle];
  return hit.FacesBeginning ? std::pair{ front, back } : std::pair{ back, front };
}

/**
 * A line and what of it every triangle is compared with. A line through an edge or a corner of a
 * closed surface counts as if it ran a little beside, the same for all triangles there, so that it
 * leaves each body as often as it enters it.
 */
class MAMMORAYFOUNDATION_EXPORT CrossingLine
{
public:
  /// The whole line through `begin` (mm) along `direction` (of length 1).
  CrossingLine(const Vector3& begin, const Vector3& direction);

  const Vector3& Begin() const { return this->Origin; }
  const Vector3& Direction() const { return this->Along; }
  /// Two directions across the line; right-handed with it.
  const std::array<Vector3, 2>& Across() const { return this->Sideways; }
  /// Whether the line crosses the triangle; `hit` is set only then.
  bool Cross(const SurfaceMesh& surface, std::uint32_t triangle, LineHit& hit) const;
  /// By T, those of one place by triangle.
  static void Sort(std::vector<LineHit>& hits);

private:
  Vector3 Origin;
  Vector3 Along;
  std::array<Vector3, 2> Sideways;
};

/**
 * The triangles of a surface in a tree of boxes, on the host. What it finds does not depend on the
 * number of threads. Thread-safe once made.
 */
class MAMMORAYFOUNDATION_EXPORT TriangleTree
{
public:
  /// Of a surface that is valid and outlives the tree, and does not change.
  explicit TriangleTree(const SurfaceMesh& surface);

  /**
   * Every crossing of the whole line through `begin` (mm) along `direction` (of length 1), as by
   * CrossingLine, sorted. `hits` is cleared first.
   */
  void CrossLine(const Vector3& begin, const Vector3& direction, std::vector<LineHit>& hits) const;

  /// Pairs of triangles whose boxes touch; each pair once, the smaller number first, ascending.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ClosePairs() const;

private:
  struct Box
  {
    Vector3 Low{};
    Vector3 High{};
  };
  /// A leaf where Count is not 0: triangles Order[First] to Order[First + Count - 1]. Otherwise its
  /// halves are the next node and Nodes[First].
  struct Node
  {
    Box Bounds;
    std::uint32_t First = 0;
    std::uint32_t Count = 0;
  };

  static bool Touch(const Box& a, const Box& b);
  Box BoxOf(std::uint32_t triangle) const;
  void Build(std::uint32_t begin, std::uint32_t end, std::vector<Box>& boxes);
  /// Calls visit(triangle) for the triangles of every leaf whose box `meets`.
  template <typename Meets, typename Visit>
  void Descend(const Meets& meets, const Visit& visit) const;

  const SurfaceMesh* Surface;
  std::vector<std::uint32_t> Order;
  std::vector<Node> Nodes;
};
}

#endif
