// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Validation_OutlineBaseline_h
#define mammoray_Validation_OutlineBaseline_h

#include "mammoray/Foundation/Volumes.h"
#include "mammoray/Registration/BreastModel.h"
#include "mammoray/Registration/RegistrationTarget.h"

#include <vector>

namespace mammoray
{
/// How a breast is moved to a mammogram without mechanics.
enum class OutlineMotion
{
  Rigid, ///< moved until tip and middle of its shadow meet those of the mammogram's breast
  Affine ///< also scaled: to the same width and depth, and to the height between the plates
};

/**
 * Moves a breast to a mammogram by its outline alone: a baseline for registrations. The breast of
 * the MRI, as it hangs there, is put into the unit where the header says (`pose`; its thickness for
 * the height) and moved, by OutlineMotion::Affine also stretched along the unit's axes, until its
 * shadow covers the mammogram's breast: the middle and the width across of what lies more than a
 * third of the depth in front of the chest wall, and the tip.
 *
 * `breast`: material indices, `held[m]` whether a material is the chest wall. Returns the `points`
 * (volume frame, mm) in the gantry frame, mm. Throws InputError if volume or mammogram has no
 * breast in front of the receptor's edge.
 */
std::vector<Vector3> MoveByOutline(const std::vector<Vector3>& points, const LabelVolume& breast,
  const std::vector<bool>& held, const UnitPlacement& placement, const BreastPose& pose,
  const RegistrationTarget& target, OutlineMotion motion);
}

#endif
