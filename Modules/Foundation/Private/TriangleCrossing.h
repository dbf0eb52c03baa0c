// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_TriangleCrossing_h
#define mammoray_TriangleCrossing_h

#include "mammoray/Foundation/SurfaceMesh.h"
#include "mammoray/Foundation/Vector3.h"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace mammoray
{
/**
 * The corners of a surface on a grid of 2^40 steps along its largest extent, where what lies on
 * which side of what is decided without rounding (their determinants have at most 125 bits).
 * Corners of one place are one corner there, whatever points they were.
 */
class SurfaceOnGrid
{
public:
  explicit SurfaceOnGrid(const SurfaceMesh& surface);

  /// Which places a triangle's corners are.
  std::array<std::uint32_t, 3> Corners(std::uint32_t triangle) const;
  std::size_t NumberOfPlaces() const { return this->Places.size(); }
  std::size_t NumberOfTriangles() const { return this->PlaceOf.size() / 3; }

  /**
   * Those of the given pairs of triangles that go through each other, in their order. A pair
   * counts where an edge of the one has its ends on either side of the other and passes through
   * its inside; through an edge of it, where it so passes through both triangles of that edge.
   * Touching is no crossing: corners or edges that lie in a triangle's plane, triangles with a
   * common edge.
   */
  std::vector<std::pair<std::uint32_t, std::uint32_t>> Crossings(
    const std::vector<std::pair<std::uint32_t, std::uint32_t>>& close) const;

private:
  using Place = std::array<std::int64_t, 3>;
  struct EdgePass;

  int Side(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const;
  bool Passes(std::uint32_t from, std::uint32_t to, const std::array<std::uint32_t, 3>& corners,
    std::size_t pair, std::vector<EdgePass>& throughEdges) const;

  std::vector<Place> Places;
  std::vector<std::uint32_t> PlaceOf;
};
}

#endif
