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
 * The heel effect: photons arise below the target's surface, and those that leave at grazing angles
 * pass more of the target. Electrons meet the target at right angles to the central ray. With the
 * depth z along the electrons, the angle a between target and central ray and the unit normal n of
 * the target's surface, a ray of direction d passes z cos(a) / (d . n) of the target. No ray leaves
 * below the surface.
 */
struct MAMMORAYXRAY_EXPORT HeelEffect
{
  /// Angle between target and central ray, degrees, in (0, 90). Mammography tubes have 16 to 24,
  /// including their tilt. 0: no heel effect.
  double TargetAngleDeg = 0;
  /// Mean depth at which photons arise, mm. Not negative; 0.0005 is a quarter of the range of
  /// electrons of 28 keV in tungsten (ESTAR).
  double DepthMm = 0;
  /// Composition of the target (see FindComposition).
  std::string Target = "W";
};

/// Variation of the open beam over the detector.
struct MAMMORAYXRAY_EXPORT OpenFieldOptions
{
  /// Photons per area fall with the square of the distance from the focus and the cosine of the
  /// angle at which they meet the detector.
  bool InverseSquare = false;
  HeelEffect Heel;
};

/**
 * The detected signal by pixel, Rows * Columns values, relative to that where the ray from the
 * focus meets the detector's plane at right angles. The central ray of the heel effect is that ray;
 * the anode lies in the direction of the detector's columns (a mammography unit's: of the nipple).
 * The heel effect acts on the spectrum of the open beam. Behind tissue, the photons that it removes
 * are assumed to have the same spectrum as all others.
 *
 * Throws InputError on options out of range, on a parallel beam, and if the heel effect removes the
 * signal of every pixel.
 */
MAMMORAYXRAY_EXPORT std::vector<float> OpenField(const XRaySource& source,
  const XRayDetector& detector, const Spectrum& spectrum, const DetectorResponse& response,
  const OpenFieldOptions& options);
}

#endif
