// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SegmentationChecks_h
#define mammoray_SegmentationChecks_h

#include "mammoray/Foundation/IntensityVolume.h"
#include "mammoraySegmentationModule.h"

#include <string>

namespace mammoray
{
/// A number as short as it is.
std::string Number(double value);

/// Throws InputError unless the volume has at least 8 voxels and 30 mm along each axis and two
/// intensities.
MAMMORAYSEGMENTATION_EXPORT void CheckImage(const IntensityVolume& image);
}

#endif
