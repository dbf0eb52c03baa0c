// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Validation_WrongLabels_h
#define mammoray_Validation_WrongLabels_h

#include "mammoray/Foundation/Volumes.h"

#include <vector>

namespace mammoray
{
// Labels for wrong pairs. Materials that are `held` are no breast.

/// Volume of the breast, mm^3.
double BreastVolume(const LabelVolume& materials, const std::vector<bool>& held);

/// The volume scaled by `factor` in each direction about the frame's origin.
LabelVolume Resized(LabelVolume materials, double factor);

/// The mirror image along `axis`, a unit vector along one of the grid's directions, in the same
/// bounds.
LabelVolume Mirrored(LabelVolume materials, const Vector3& axis);

/// Removes the quarter of the breast, by its length, that is farthest along `axis`.
LabelVolume WithoutQuarter(LabelVolume materials, const std::vector<bool>& held,
  const Vector3& axis);
}

#endif
