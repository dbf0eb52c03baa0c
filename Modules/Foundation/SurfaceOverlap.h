// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SurfaceOverlap_h
#define mammoray_SurfaceOverlap_h

#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/SurfaceMesh.h"
#include "mammoray/Foundation/TriangleTree.h"
#include "mammorayFoundationModule.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace mammoray
{
/**
 * A stretch of a line that the surface's labels do not describe: inside of several materials at
 * once, of one material twice, or of less than none, where labels are inside out. The path lengths
 * of such a ray are sums that count the stretch twice, or negatively.
 */
struct SurfaceContradiction
{
  /// In the middle of the stretch, mm.
  Vector3 Place{ 0, 0, 0 };
  double LengthMm = 0;
  /// Materials there, one entry for each time; negative ones left out.
  std::vector<int> Materials;
  /// Whether the labels say less than nothing of a material there.
  bool Negative = false;
};

/// Where a surface crosses itself, or parts of it lie in each other though their labels say air.
struct MAMMORAYFOUNDATION_EXPORT SurfaceOverlap
{
  static constexpr std::size_t MostPlaces = 20;

  /// Pairs of triangles that go through each other.
  std::size_t Crossings = 0;
  /// Where the first MostPlaces do, and the material behind one of the triangles.
  std::vector<Vector3> CrossingPlaces;
  std::vector<int> CrossingMaterials;
  /// Parts (triangles that hang together by corners) on a surface of which lines through them met
  /// contradictions.
  std::size_t DoubledParts = 0;
  std::size_t NegativeParts = 0;
  /// The longest contradiction of each of the first MostPlaces parts.
  std::vector<SurfaceContradiction> Contradictions;
  /// Boxes (low and high corner, mm) outside of which every ray's lengths are those of the labels.
  std::vector<std::array<Vector3, 2>> Regions;

  bool None() const { return this->Crossings + this->DoubledParts + this->NegativeParts == 0; }
};

/// The contradictions along a line whose crossings are `hits`, from TriangleTree::CrossLine of the
/// same line; in no box but the surface's own.
MAMMORAYFOUNDATION_EXPORT std::vector<SurfaceContradiction> FindContradictions(
  const SurfaceMesh& surface, const Vector3& begin, const Vector3& direction,
  const std::vector<LineHit>& hits);

/**
 * Looks for crossing triangles, exactly but for rounding corners to 2^-40 of the surface's largest
 * extent: edges that touch, as those of bodies side by side do, are no crossing. And for
 * contradictions along lines through up to 16 triangles of every part, which find parts wholly
 * inside others. Parts that overlap with common planes only (boxes of one grid) are found by these
 * lines, and could be missed where less than a sixteenth of their triangles lie in the overlap.
 */
MAMMORAYFOUNDATION_EXPORT SurfaceOverlap FindOverlap(const SurfaceMesh& surface,
  const TriangleTree& tree, const ProgressCallback& progress = {});
}

#endif
