// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_FatLevel_h
#define mammoray_FatLevel_h

#include "Private/ItkImages.h"
#include "mammoraySegmentationModule.h"

namespace mammoray
{
/**
 * The intensity that fat has, or would have, at every voxel: the sensitivity of the coil.
 *
 * Fat has one brightness and is everywhere in a breast, below the skin and before the chest wall at
 * least, so its intensity shows the sensitivity, which is smooth. It begins as the 90th percentile
 * of the region's intensities in cubes of 24 mm (fat bright) or the 25th (fat dark); then voxels
 * within about a third of the level, which are fat, are averaged with a Gaussian of 18 mm, later
 * 12 mm (on the logarithm), six times. Away from the region the level nearest to it continues.
 *
 * @param mask  where fat is looked for: the inside of the breasts, without skin
 * @param even  one level everywhere
 * @return null where there is hardly a voxel
 */
MAMMORAYSEGMENTATION_EXPORT FloatImage::Pointer FindFatLevel(const FloatImage* image,
  const MaskImage* mask, bool fatBright, bool even);
/// One image over the other, voxel by voxel.
MAMMORAYSEGMENTATION_EXPORT FloatImage::Pointer Divide(const FloatImage* image,
  const FloatImage* level);

/// 1 in fat and 0 in muscle and beyond, and in lung and air; intensities are fractions of fat's.
MAMMORAYSEGMENTATION_EXPORT FloatImage::Pointer Fatness(const FloatImage* image,
  const MaskImage* tissue, double muscleLevel, bool fatBright);

/// Muscle may have this fraction of bright fat's intensity, and that of dark fat's; between them
/// the two are not told apart.
constexpr double BrightestMuscle = 0.8;
constexpr double DarkestMuscle = 1.2;
}

#endif
