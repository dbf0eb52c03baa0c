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
/// What overlapping parts of a surface do to an image of it, where no ProjectorOptions::Priority
/// says what counts.
struct MAMMORAYXRAY_EXPORT OverlapMeasure
{
  SurfaceOverlap Overlap;
  /// Rays that were followed and cross the surface.
  std::size_t Rays = 0;
  /// Those of them with stretches that count twice or negatively, ...
  std::size_t Contradicting = 0;
  /// ... how long these are together along one, on average, mm, ...
  double MeanMm = 0;
  /// ... and the longest of all.
  SurfaceContradiction Longest;

  /// A sentence with counts and places; empty where nothing overlaps. `names[m]` names material m.
  std::string Warning(const std::vector<std::string>& names) const;
};

/**
 * Looks for overlaps (FindOverlap), and, where there are some, along the rays of up to 200 x 200
 * pixels spread over the detector. A surface of more than 20,000 triangles counts as one without
 * overlaps, unsearched, where no contradiction lies on these rays nor on lines from the source
 * through triangles, of which every part has its equal share of 40,000 or all it has. That takes a
 * twentieth of the time or so, and can miss crossings in which few triangles and little of the
 * picture have part. It is searched where nothing can be told so: of more than 5000 parts, or with
 * the source beside it or inside. Runs on the host. Throws InputError on a degenerate detector or
 * source.
 */
MAMMORAYXRAY_EXPORT OverlapMeasure MeasureOverlap(const SurfaceMesh& surface,
  const XRaySource& source, const XRayDetector& detector, const ProgressCallback& progress = {});
}

#endif
