// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SurfaceOverlap_h
#define mammoray_SurfaceOverlap_h

#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/TriangleTree.h"
#include "mammorayFoundationModule.h"

#include <cstdint>
#include <string>
#include <vector>

namespace mammoray
{
/// A segment of a line where the surface's labels are contradictory: it is inside several materials
/// at once, inside one material twice, or inside a material a negative number of times because
/// labels are inside out. Path lengths count such a segment twice or negatively.
struct SurfaceContradiction
{
  /// Midpoint of the segment, mm.
  Vector3 Place{ 0, 0, 0 };
  double LengthMm = 0;
  /// Materials at the segment, once per time inside, the one that the line is in for the shortest
  /// way first, which lies in the others; negative counts are omitted.
  std::vector<int> Materials;
  /// True if the segment is inside a material a negative number of times.
  bool Negative = false;
};

/// Places where a surface crosses itself or where parts of it lie inside each other although their
/// labels say air.
struct MAMMORAYFOUNDATION_EXPORT SurfaceOverlap
{
  static constexpr std::size_t MostPlaces = 20;

  /// Number of pairs of triangles that intersect each other.
  std::size_t Crossings = 0;
  /// Positions of the first MostPlaces pairs, and the material behind one of the triangles.
  std::vector<Vector3> CrossingPlaces;
  std::vector<int> CrossingMaterials;
  /// Number of parts (triangles connected by corners) where test lines met segments that are
  /// counted twice or negatively.
  std::size_t DoubledParts = 0;
  std::size_t NegativeParts = 0;
  /// The longest contradiction of each of the first MostPlaces parts.
  std::vector<SurfaceContradiction> Contradictions;
  /// Boxes, mm. The path lengths of rays that miss them all follow from the labels.
  std::vector<Box3> Regions;

  bool None() const { return this->Crossings + this->DoubledParts + this->NegativeParts == 0; }
};

/// Finds the contradictions along a line. `hits` are the results of TriangleTree::CrossLine for the
/// same line.
MAMMORAYFOUNDATION_EXPORT std::vector<SurfaceContradiction> FindContradictions(
  const SurfaceMesh& surface, const Vector3& begin, const Vector3& direction,
  const std::vector<LineHit>& hits);

/**
 * Finds intersecting triangles. The test is exact after corners are rounded to 2^-40 of the
 * surface's largest extent; edges that touch, as those of adjacent bodies do, are not
 * intersections. Also finds contradictions along lines through up to 16 triangles of every part,
 * which reveals parts that lie inside others. Parts that overlap only in common planes (boxes of
 * one grid) are also found by these lines; they can be missed if less than a sixteenth of their
 * triangles lie in the overlap.
 *
 * The lines take a fraction of the time of the search for intersecting triangles. Without
 * `alwaysCrossings`, triangles are compared only if a line meets a contradiction.
 */
MAMMORAYFOUNDATION_EXPORT SurfaceOverlap FindOverlap(const SurfaceMesh& surface,
  const TriangleTree& tree, const ProgressCallback& progress = {}, bool alwaysCrossings = true);
}

#endif
