// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_FatLevel_h
#define mammoray_FatLevel_h

#include "Private/ItkImages.h"
#include "mammoraySegmentationModule.h"

namespace mammoray
{
/**
 * Estimates the intensity that fat has, or would have, at every voxel: the sensitivity of the coil.
 *
 * Fat has a uniform brightness and is present everywhere in a breast, at least below the skin and
 * in front of the chest wall. Its intensity therefore shows the sensitivity, which is smooth. The
 * estimate starts as the 90th percentile of the region's intensities in cubes of 24 mm (fat
 * bright), or the 25th (fat dark). Then voxels within about a third of the level, which are fat,
 * are averaged with a Gaussian of 18 mm, later 12 mm (on the logarithm), six times. Outside the
 * region the nearest level continues.
 *
 * Compact gland, wider than these, would be taken for fat. If gland's level is known, each voxel
 * counts as fat or as gland by its distance from both, so that class and sensitivity are estimated
 * together (Wells et al., IEEE Trans. Med. Imaging 15, 1996), and the start is averaged over 40 mm.
 *
 * @param mask  region in which fat is searched: the inside of the breasts without skin
 * @param even  true for one level everywhere
 * @param gland intensity of gland as a fraction of fat's; 0 if unknown
 * @return null if there are almost no voxels
 */
MAMMORAYSEGMENTATION_EXPORT FloatImage::Pointer FindFatLevel(const FloatImage* image,
  const MaskImage* mask, bool fatBright, bool even, double gland);
/// Divides one image by the other, voxel by voxel.
MAMMORAYSEGMENTATION_EXPORT FloatImage::Pointer Divide(const FloatImage* image,
  const FloatImage* level);

/// 1 in fat and 0 in muscle, lung and air; intensities are fractions of fat's.
MAMMORAYSEGMENTATION_EXPORT FloatImage::Pointer Fatness(const FloatImage* image,
  const MaskImage* tissue, double muscleLevel, bool fatBright);

/// Largest intensity of muscle relative to bright fat, and smallest relative to dark fat; between
/// these limits the two cannot be distinguished.
constexpr double BrightestMuscle = 0.8;
constexpr double DarkestMuscle = 1.2;
}

#endif
