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
  /// Area of the shadow, and of what of it falls on the detector's pixels, in pixels. Where parts
  /// of the surface lie over each other, each counts.
  double AreaPixels = 0;
  double SeenPixels = 0;
  /// The shadow's range, pixels from the centre of column 0 and row 0. Empty without a shadow.
  Extent Columns;
  Extent Rows;
  /// Around the surface, mm.
  Box3 Box;
  /// Whether triangles have different materials on their sides.
  bool HasMaterial = false;
  /// Whether some of these lie in front of the source, and between source and detector.
  bool IsBeforeSource = false;
  bool IsBeforeDetector = false;
  /// Whether some lie behind the source, and behind the detector; whether Box holds the source.
  bool IsBehindSource = false;
  bool IsBehindDetector = false;
  bool HoldsSource = false;

  /// What of the shadow falls on the pixels, 0 to 1.
  double Share() const;
  /// The larger of its two extents, pixels. 0 without a shadow.
  double WidthPixels() const;
  /// Joins the shadow of another surface.
  void Add(const Shadow& other);
  /// Why nothing, or not all, of the surface is seen, with a guess at another unit of its file. The
  /// sentence begins with `subject`.
  std::string Reason(const XRayDetector& detector, const std::string& subject = "the object") const;
};

MAMMORAYXRAY_EXPORT Shadow MeasureShadow(const SurfaceMesh& surface, const XRaySource& source,
  const XRayDetector& detector);

/**
 * What is wrong with where the shadows of the samples fall; empty if nothing is. A line for each
 * sample of several of which nothing is seen, a sentence where no ray of a picture has met
 * anything, and, where `wantsAll`, where part of a shadow falls beside the detector, which is no
 * single line, or a sample is smaller than a pixel.
 */
MAMMORAYXRAY_EXPORT std::string ShadowWarning(const Scene& scene, const Exposure& exposure,
  bool wantsAll = false);
}

#endif
