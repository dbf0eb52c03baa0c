// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_TriangleCrossing_h
#define mammoray_TriangleCrossing_h

#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/Vector3.h"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace mammoray
{
/// The corners of a surface on a grid with 2^40 steps along its largest extent. Orientation tests
/// on it are exact (their determinants have at most 125 bits). Corners at the same grid point are
/// one corner.
class SurfaceOnGrid
{
public:
  explicit SurfaceOnGrid(const SurfaceMesh& surface);

  /// Grid points of a triangle's corners.
  std::array<std::uint32_t, 3> Corners(std::uint32_t triangle) const;
  std::size_t NumberOfPlaces() const { return this->Places.size(); }
  std::size_t NumberOfTriangles() const { return this->PlaceOf.size() / 3; }

  /**
   * Returns the given pairs of triangles that intersect, in order. A pair intersects if an edge of
   * one triangle has its ends on either side of the other and passes through its interior, or
   * through one of its edges and so through both triangles of that edge. Contact is not an
   * intersection: corners or edges in a triangle's plane, triangles with a common edge.
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
