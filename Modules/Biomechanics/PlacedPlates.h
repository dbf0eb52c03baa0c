// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PlacedPlates_h
#define mammoray_PlacedPlates_h

#include "mammoray/Biomechanics/Plates.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammorayBiomechanicsModule.h"

namespace mammoray
{
/**
 * The plates of a unit with this placement, in the volume frame. The support's face lies at z =
 * SupportHeightMm of the gantry frame; the paddle's face lies `thicknessMm` above it.
 * `paddleTiltDeg` turns the paddle about its (unrounded) chest-wall edge, where the thickness is
 * measured; a positive tilt opens the paddle towards the nipple.
 */
MAMMORAYBIOMECHANICS_EXPORT PlatePair PlatesOf(const VolumeFromGantry& placed,
  const MammographyUnit& unit, double thicknessMm, double paddleTiltDeg = 0);

/// Standard gravity, m/s^2.
inline constexpr double StandardGravityMPerS2 = 9.80665;

enum class PatientPosition
{
  /// Standing or sitting, as for a mammogram.
  Upright,
  /// Face down, as for most breast MRI: the breast hangs forwards.
  Prone,
  /// Lying on the back.
  Supine
};

/// Vector of standard gravity in the volume frame for a patient in this position, m/s^2.
MAMMORAYBIOMECHANICS_EXPORT Vector3 GravityIn(PatientPosition position, const AnatomicalAxes& axes);
}

#endif
