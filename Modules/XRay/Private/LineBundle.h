// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LineBundle_h
#define mammoray_LineBundle_h

#include "mammoray/Foundation/SurfaceMesh.h"
#include "mammoray/Foundation/TriangleTree.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayXRayModule.h"

#include <optional>
#include <vector>

namespace mammoray
{
/// The line of an X-ray through a place, mm: from the source, or back along the beam.
MAMMORAYXRAY_EXPORT CrossingLine LineThrough(const XRaySource& source, const Vector3& place);

/**
 * Triangles through which lines look into every part of a surface, ascending. A part hangs together
 * by points; each has an equal share of `wanted` or less than twice that, or all of its triangles,
 * evenly spread over their list. Nothing where that would be less than `fewest`.
 */
MAMMORAYXRAY_EXPORT std::optional<std::vector<std::uint32_t>> SampleParts(
  const SurfaceMesh& surface, std::size_t wanted, std::size_t fewest);

/**
 * Whether FindContradictions finds some along one of the lines, which are of this source
 * (LineThrough). Without a tree: each triangle is compared with the lines in its shadow, so that
 * small triangles cost little where lines are few. Nothing where the source lies beside the surface
 * or in it, for there are no shadows then.
 */
MAMMORAYXRAY_EXPORT std::optional<bool> AnyContradiction(const SurfaceMesh& surface,
  const XRaySource& source, const std::vector<CrossingLine>& lines);
}

#endif
