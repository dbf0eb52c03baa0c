// SPDX-License-Identifier: Apache-2.0
#include "PlacedPlates.h"

namespace mammoray
{
PlatePair PlatesOf(const VolumeFromGantry& placed, const MammographyUnit& unit, double thicknessMm)
{
  PlatePair plates;
  plates.Support.Edge = placed.Point({ 0, unit.SupportEdgeMm, unit.SupportHeightMm });
  plates.Support.Normal = placed.Z;
  plates.Support.Inward = placed.Y;
  plates.Support.EdgeRadiusMm = unit.EdgeRadiusMm;
  plates.Paddle.Edge = placed.Point({ 0, unit.PaddleEdgeMm, unit.SupportHeightMm + thicknessMm });
  plates.Paddle.Normal = -1.0 * placed.Z;
  plates.Paddle.Inward = placed.Y;
  plates.Paddle.EdgeRadiusMm = unit.EdgeRadiusMm;
  return plates;
}
}
