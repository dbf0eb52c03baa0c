// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Shadow_h
#define mammoray_Shadow_h

#include "mammoray/Foundation/Meshes.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayXRayModule.h"

#include <string>

namespace mammoray
{
struct Exposure;
struct Scene;

/// Where the shadow of a surface falls in the plane of a detector.
struct MAMMORAYXRAY_EXPORT Shadow
{
  /// What of its area falls on the detector's pixels, 0 to 1. Where parts of the surface lie over
  /// each other, each counts.
  double Share = 0;
  /// The shadow's range, pixels from the centre of column 0 and row 0. Empty without a shadow.
  Extent Columns;
  Extent Rows;
  /// The surface's extent along x, y and z, the largest, mm.
  double WidthMm = 0;
  /// Whether triangles have different materials on their sides, and whether some of these lie in
  /// front of the source, and between source and detector.
  bool HasMaterial = false;
  bool IsBeforeSource = false;
  bool IsBeforeDetector = false;

  /// Why nothing, or not all, of the surface is seen, with a guess at another unit of its file.
  std::string Reason(const XRayDetector& detector) const;
};

MAMMORAYXRAY_EXPORT Shadow MeasureShadow(const SurfaceMesh& surface, const XRaySource& source,
  const XRayDetector& detector);

/// A sentence where no ray of a picture has met anything, or where `wantsAll` and part of the
/// scene's shadow falls beside the detector, which is no single line. Empty otherwise.
MAMMORAYXRAY_EXPORT std::string ShadowWarning(const Scene& scene, const Exposure& exposure,
  bool wantsAll = false);
}

#endif
