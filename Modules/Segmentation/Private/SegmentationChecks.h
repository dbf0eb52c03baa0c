// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SegmentationChecks_h
#define mammoray_SegmentationChecks_h

#include "mammoray/Foundation/IntensityVolume.h"
#include "mammoraySegmentationModule.h"

namespace mammoray
{
/// Throws InputError unless the volume has at least 8 voxels and 30 mm along each axis, two
/// intensities and, unless all is accepted, voxels of a plausible spacing.
MAMMORAYSEGMENTATION_EXPORT void CheckImage(const IntensityVolume& image, bool acceptUnusual);

/// Whether the caller's gland threshold (0: none) is an image's: gland is darker than bright fat,
/// and brighter than dark.
inline bool IsThresholdOf(double given, bool fatBright)
{
  return given > 0 && (given < 1) == fatBright;
}

/// Throws InputError where a threshold is given and not this image's.
void CheckGlandThreshold(double given, bool fatBright);
}

#endif
