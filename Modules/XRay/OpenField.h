// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_OpenField_h
#define mammoray_OpenField_h

#include "mammoray/XRay/Beam.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayXRayModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/**
 * The heel effect: photons are made somewhat below the target's surface, and those that leave it
 * flatly have a longer way through the target. With the depth z along the electrons, which meet the
 * target at right angles to the central ray, and the angle a between target and central ray, a ray
 * of direction d passes z cos(a) / (d . n) of the target, n being its surface's normal; none leaves
 * below the surface.
 */
struct MAMMORAYXRAY_EXPORT HeelEffect
{
  /// Between target and central ray, degrees; more than 0 and less than 90; tubes in mammography:
  /// 16 to 24, their tilt included.
  double TargetAngleDeg = 0;
  /// Mean depth at which photons are made, mm. Not negative; 0.0005 is a quarter of the range of
  /// electrons of 28 keV in tungsten (ESTAR).
  double DepthMm = 0;
  /// See FindComposition.
  std::string Target = "W";
};

/// What reaches the detector's pixels where nothing is in the beam.
struct MAMMORAYXRAY_EXPORT OpenFieldOptions
{
  /// Photons per area fall with the square of the distance from the focus and the cosine of the
  /// angle at which they meet the detector.
  bool InverseSquare = false;
  /// A heel effect where its angle is not 0.
  HeelEffect Heel;
};

/**
 * The detected signal by pixel, Rows * Columns values, relative to that where the ray from the
 * focus meets the detector's plane at right angles. The central ray of the heel effect is that ray;
 * the anode lies in the direction of the detector's columns (a mammography unit's: of the nipple).
 * The spectrum of the heel effect is that of an open beam: behind tissue, the photons it removes
 * are taken to be as hard as all others.
 *
 * Throws InputError on options out of range, on a parallel beam, and where the heel leaves nothing
 * in any pixel.
 */
MAMMORAYXRAY_EXPORT std::vector<float> OpenField(const XRaySource& source,
  const XRayDetector& detector, const Spectrum& spectrum, const DetectorResponse& response,
  const OpenFieldOptions& options);
}

#endif
