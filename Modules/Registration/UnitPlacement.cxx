// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/UnitPlacement.h"

namespace mammoray
{
PlatePair UnitPlacement::PlatesAt(const BreastPose& pose) const
{
  return PlatesOf(this->At(pose), this->Unit, pose.ThicknessMm, pose.TiltDeg);
}

std::vector<PlatePairVelocity> UnitPlacement::PlateVelocitiesAt(const BreastPose& pose) const
{
  const PlatePair plates = this->PlatesAt(pose);
  std::vector<PlatePairVelocity> velocities;
  for (const UnitVelocity& unit : UnitVelocities(this->Axes, this->Anchor, this->Unit, pose))
  {
    const auto carried = [&](const Plate& plate) {
      return PlateVelocity{ unit.Shift + Cross(unit.Turn, plate.Edge - this->Anchor), unit.Turn };
    };
    PlatePairVelocity pair{ carried(plates.Support), carried(plates.Paddle) };
    pair.Paddle.Linear = pair.Paddle.Linear + unit.PaddleShift;
    pair.Paddle.Angular = pair.Paddle.Angular + unit.PaddleTurn;
    velocities.push_back(pair);
  }
  velocities.resize(StiffnessParameter);
  return velocities;
}
}
