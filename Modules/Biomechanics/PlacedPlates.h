// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PlacedPlates_h
#define mammoray_PlacedPlates_h

#include "mammoray/Biomechanics/Plates.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammorayBiomechanicsModule.h"

namespace mammoray
{
/**
 * The plates of a unit that stands at `placed` and is closed to `thicknessMm`; volume frame. The
 * support faces the source at z = SupportHeightMm of the gantry frame, the paddle faces it
 * `thicknessMm` above. With a tilt, degrees, the paddle is turned about its (unrounded) chest-wall
 * edge, where the thickness then counts; positive opens it towards the nipple.
 */
MAMMORAYBIOMECHANICS_EXPORT PlatePair PlatesOf(const VolumeFromGantry& placed,
  const MammographyUnit& unit, double thicknessMm, double paddleTiltDeg = 0);

/// m/s^2
inline constexpr double StandardGravityMPerS2 = 9.80665;

enum class PatientPosition
{
  /// Or sitting: as for a mammogram.
  Upright,
  /// Face down: the breast hangs forwards, as in most MRI.
  Prone,
  /// On the back.
  Supine
};

/// Standard gravity in the volume frame, m/s^2: downwards in that position.
MAMMORAYBIOMECHANICS_EXPORT Vector3 GravityIn(PatientPosition position, const AnatomicalAxes& axes);
}

#endif
