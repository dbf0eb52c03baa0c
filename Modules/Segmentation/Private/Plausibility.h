// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Plausibility_h
#define mammoray_Plausibility_h

#include "mammoray/Segmentation/BreastSegmentation.h"

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

/// Numbers of columns through a breast, and of those that show its borders; see BreastQuality.
struct ColumnCounts
{
  std::size_t All = 0;
  std::size_t Seen = 0;
  std::size_t Agreeing = 0;
  std::size_t Clear = 0;
};

/// The fractions of the columns, with a doubt where they are smaller than in good segmentations, or
/// where the image does not tell bright fat from dark.
MAMMORAYSEGMENTATION_EXPORT BreastQuality QualityOf(BreastSide side, const ColumnCounts& columns,
  bool contrastIsClear);

/// Computes the volumes of the labels and the level of gland relative to muscle in the corrected
/// image.
MAMMORAYSEGMENTATION_EXPORT void Measure(SegmentationResult& result);

/**
 * Throws InputError, with the value, on results that no breast has: less than 15 or more than 5000
 * cm3 per breast, more than 300 mm of depth, more than 0.9 of gland. Warns of doubtful qualities
 * and of rare results: less than 60 or more than 3000 cm3, gland below 0.005 or above 0.6, skin
 * above a third, gland more than twice or less than half as bright as muscle (not T1-weighted, or
 * contrast medium). `breasts` is the number of breasts in the result; `glandGiven` is true if the
 * caller chose gland's threshold.
 */
MAMMORAYSEGMENTATION_EXPORT void Judge(SegmentationResult& result, int breasts, bool glandGiven);
}

#endif
