// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_UnitPlacement_h
#define mammoray_UnitPlacement_h

#include "mammoray/Biomechanics/PlacedPlates.h"
#include "mammoray/Foundation/PoseParameters.h"
#include "mammorayRegistrationModule.h"

#include <vector>

namespace mammoray
{
/**
 * Radius of the plates' chest-wall edges in a search, mm. It is larger than a unit's 3 mm and than
 * the 6 mm between the nodes of a patient's mechanics: tissue passes a sharper edge node by node,
 * in jumps of some mm that derivatives do not show.
 */
inline constexpr double SearchedEdgeRadiusMm = 8.0;

/// A unit that a pose places around a breast: the unit, and the frame that the pose refers to.
struct MAMMORAYREGISTRATION_EXPORT UnitPlacement
{
  AnatomicalAxes Axes;
  /// The point of the volume frame about which the unit turns (FindPoseAnchor), mm.
  Vector3 Anchor{ 0, 0, 0 };
  MammographyUnit Unit;

  VolumeFromGantry At(const BreastPose& pose) const
  {
    return PlaceUnit(this->Axes, this->Anchor, this->Unit, pose);
  }
  /// The plates in the volume frame.
  PlatePair PlatesAt(const BreastPose& pose) const;
  /// Velocities of the plates with each of PoseParameters before the stiffness, per mm or degree.
  std::vector<PlatePairVelocity> PlateVelocitiesAt(const BreastPose& pose) const;
};
}

#endif
