// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SegmentationChecks_h
#define mammoray_SegmentationChecks_h

#include "mammoray/Foundation/Volumes.h"
#include "mammoraySegmentationModule.h"

namespace mammoray
{
/// Throws InputError unless the volume has at least 8 voxels and 30 mm along each axis, two
/// different intensities and, unless `acceptUnusual` is set, a voxel spacing in
/// ValidRanges::VoxelSpacing.
MAMMORAYSEGMENTATION_EXPORT void CheckImage(const IntensityVolume& image, bool acceptUnusual);

/// Throws InputError if all values of an image are multiples (at least 16 different ones) of a step
/// and air lies below the first: after such rounding the distribution of noise, by which it is
/// recognised, is lost.
MAMMORAYSEGMENTATION_EXPORT void CheckSteps(const IntensityVolume& image, double airThreshold);

/// True if the caller's gland threshold (0 for none) fits the contrast of an image: gland is darker
/// than bright fat and brighter than dark fat.
inline bool IsThresholdOf(double given, bool fatBright)
{
  return given > 0 && (given < 1) == fatBright;
}

/// Throws InputError if a threshold is given that does not fit the image's contrast.
void CheckGlandThreshold(double given, bool fatBright);
}

#endif
