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

/// Throws InputError where an image's values are whole multiples (16 of them at least) of a step
/// and air ends below the first: rounded so, noise has no distribution left by which it is known.
MAMMORAYSEGMENTATION_EXPORT void CheckSteps(const IntensityVolume& image, double airThreshold);

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
