// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_OutlineBaseline_h
#define mammoray_OutlineBaseline_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammoray/Registration/UnitPlacement.h"
#include "mammorayEvidenceModule.h"

#include <vector>

namespace mammoray
{
/// How a breast is brought to a mammogram by nobody's mechanics.
enum class OutlineMotion
{
  Rigid, ///< moved until the shadow's tip and middle are those of the mammogram's breast
  Affine ///< and scaled: as wide and as deep as there, as high as the plates stand apart
};

/**
 * A breast brought to a mammogram by its outline alone: what a registration has to beat. The breast
 * of the MRI, as it hangs there, is put into the unit where the header says (`pose`; its thickness
 * for the height) and moved, by OutlineMotion::Affine stretched along the unit's axes, too, until
 * its shadow is where the mammogram's breast is: the middle across and the width of what is a third
 * of the depth and more in front of the chest wall, and the tip.
 *
 * `breast`: material indices, `held[m]` whether a material is the chest wall. Returns the `points`
 * (volume frame, mm) in the gantry frame, mm. Throws InputError where volume or mammogram shows no
 * breast in front of the receptor's edge.
 */
MAMMORAYEVIDENCE_EXPORT std::vector<Vector3> MoveByOutline(const std::vector<Vector3>& points,
  const LabelVolume& breast, const std::vector<bool>& held, const UnitPlacement& placement,
  const BreastPose& pose, const RegistrationTarget& target, OutlineMotion motion);
}

#endif
