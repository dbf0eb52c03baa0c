// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_OverlapMeasure_h
#define mammoray_OverlapMeasure_h

#include "mammoray/Foundation/SurfaceOverlap.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayXRayModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// The effect of overlapping parts of a surface on an image without ProjectorOptions::Priority.
struct MAMMORAYXRAY_EXPORT OverlapMeasure
{
  SurfaceOverlap Overlap;
  /// Number of followed rays that cross the surface.
  std::size_t Rays = 0;
  /// Number of these with segments that count twice or negatively.
  std::size_t Contradicting = 0;
  /// Mean total length of such segments along one of these rays, mm.
  double MeanMm = 0;
  /// The longest such segment.
  SurfaceContradiction Longest;

  /// A sentence with counts and places; empty if nothing overlaps. `names[m]` is the name of
  /// material m.
  std::string Warning(const std::vector<std::string>& names) const;
};

/**
 * Searches for overlaps (FindOverlap) and, if there are any, measures them along the rays of up to
 * 200 x 200 pixels spread over the detector.
 *
 * For a surface of more than 20,000 triangles it first follows these rays and lines through every
 * part (FindOverlap). Without a contradiction on them the surface counts as free of overlaps. This
 * takes about a third of the time, and can miss crossings of few triangles that cover little of the
 * picture.
 *
 * Runs on the host. Throws InputError on a degenerate detector or source.
 */
MAMMORAYXRAY_EXPORT OverlapMeasure MeasureOverlap(const SurfaceMesh& surface,
  const XRaySource& source, const XRayDetector& detector, const ProgressCallback& progress = {});
}

#endif
