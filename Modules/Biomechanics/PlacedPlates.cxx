// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Biomechanics/PlacedPlates.h"

#include <cmath>
#include <numbers>

namespace mammoray
{
PlatePair PlatesOf(const VolumeFromGantry& placed, const MammographyUnit& unit, double thicknessMm,
  double paddleTiltDeg)
{
  PlatePair plates;
  plates.Support.Edge = placed.Point({ 0, unit.SupportEdgeMm, unit.SupportHeightMm });
  plates.Support.Normal = placed.Z;
  plates.Support.Inward = placed.Y;
  plates.Support.EdgeRadiusMm = unit.EdgeRadiusMm;
  plates.Paddle.Edge = placed.Point({ 0, unit.PaddleEdgeMm, unit.SupportHeightMm + thicknessMm });
  const double tilt = paddleTiltDeg * std::numbers::pi / 180;
  plates.Paddle.Normal = std::sin(tilt) * placed.Y - std::cos(tilt) * placed.Z;
  plates.Paddle.Inward = std::cos(tilt) * placed.Y + std::sin(tilt) * placed.Z;
  plates.Paddle.EdgeRadiusMm = unit.EdgeRadiusMm;
  return plates;
}

Vector3 GravityIn(PatientPosition position, const AnatomicalAxes& axes)
{
  constexpr double g = StandardGravityMPerS2;
  switch (position)
  {
    case PatientPosition::Prone:
      return g * axes.Anterior;
    case PatientPosition::Supine:
      return -g * axes.Anterior;
    default:
      return -g * axes.Superior;
  }
}
}
