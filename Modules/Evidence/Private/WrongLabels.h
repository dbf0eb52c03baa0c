// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_WrongLabels_h
#define mammoray_Private_WrongLabels_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammorayEvidenceModule.h"

#include <vector>

namespace mammoray
{
// Labels that a wrong pair is registered with. Materials that are `held` are no breast.

/// The size of a breast, mm^3.
MAMMORAYEVIDENCE_EXPORT double BreastVolume(const LabelVolume& materials,
  const std::vector<bool>& held);

/// All of it `factor` times as large in each direction, about the frame's origin.
MAMMORAYEVIDENCE_EXPORT LabelVolume Resized(LabelVolume materials, double factor);

/// Its mirror image along `axis`, a unit vector along one of the grid's directions, in its own
/// bounds.
MAMMORAYEVIDENCE_EXPORT LabelVolume Mirrored(LabelVolume materials, const Vector3& axis);

/// Without the quarter of the breast, by its length, that is farthest along `axis`, likewise.
MAMMORAYEVIDENCE_EXPORT LabelVolume WithoutQuarter(LabelVolume materials,
  const std::vector<bool>& held, const Vector3& axis);
}

#endif
