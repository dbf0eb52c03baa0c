// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Outline_h
#define mammoray_Outline_h

#include "Private/ItkImages.h"
#include "mammoraySegmentationModule.h"

namespace mammoray
{
/// Where the body is, on cubes of a few mm.
struct Outline
{
  /// What air does not reach from the front.
  MaskImage::Pointer Body;
  /// Brighter than air and noise.
  MaskImage::Pointer Tissue;
  /// The intensity between air and tissue at each voxel, and its value where air is darkest.
  FloatImage::Pointer Threshold;
  double AirThreshold = 0;
  /// Median intensity of the body over that of the air before it.
  double Contrast = 0;
};

/**
 * Air and body of an image in patient order.
 *
 * Otsu's threshold (1979) of the logarithm of the smoothed image splits air from tissue. A scanner
 * that evens out its coil's sensitivity makes noise as bright as suppressed fat, away from the
 * coil. What is noise shows in itself: the mean of a magnitude image of nothing but noise is 1.91
 * times its deviation, however amplified (Rayleigh; more where neighbours are correlated, which the
 * darkest blocks tell). The threshold is nowhere less than 1.8 times the mean of the noise nearby.
 * `given`: the intensity to use instead; 0: none.
 *
 * @param image  as scanned, patient order
 * @param work   the same on cubes
 */
MAMMORAYSEGMENTATION_EXPORT Outline FindOutline(const FloatImage* image, const FloatImage* work,
  double given);

/**
 * The intensity at which a voxel is half full of skin, from the mean of the outer 4 mm of the body
 * nearby, which are skin and fat: 0.55 of it where fat is dark, as skin is brighter than the mean;
 * 0.25 where it is bright, as skin, like muscle, has 0.35 of fat. No less than the outline's
 * threshold; on cubes.
 */
MAMMORAYSEGMENTATION_EXPORT FloatImage::Pointer SkinThreshold(const Outline& outline,
  const FloatImage* work, bool fatBright);
}

#endif
