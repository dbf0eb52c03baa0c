// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Outline_h
#define mammoray_Outline_h

#include "Private/ItkImages.h"
#include "mammoraySegmentationModule.h"

namespace mammoray
{
/// Outline of the body on cubic voxels of a few millimetres.
struct Outline
{
  /// Voxels that air does not reach from the front.
  MaskImage::Pointer Body;
  /// Voxels brighter than air and noise.
  MaskImage::Pointer Tissue;
  /// The threshold between air and tissue at each voxel, and its value where air is darkest.
  FloatImage::Pointer Threshold;
  double AirThreshold = 0;
  /// Level of the tissue nearby as a multiple of the noise.
  FloatImage::Pointer Clarity;
  /// First and last axial plane whose tissue stands out from the noise. In the planes beyond, the
  /// body repeats them.
  std::array<int, 2> Planes{ 0, 0 };
  /// Median intensity of the body divided by that of the air in front of it.
  double Contrast = 0;
};

/**
 * Separates air and body in an image in patient order.
 *
 * Otsu's threshold (1979) of the smoothed image's logarithm separates air from tissue. A scanner
 * that compensates its coil's sensitivity makes noise far from the coil as bright as suppressed
 * fat. Noise is recognised by its own statistics: the mean of a magnitude image of pure noise is
 * 1.91 times its deviation, whatever the amplification (Rayleigh; more if neighbours are
 * correlated, which the darkest blocks reveal). The threshold is at least 1.8 times the mean of the
 * noise nearby.
 *
 * Where the signal falls off, that threshold tears the outline. It is therefore only the start of a
 * Markov random field of air and body (mean-field approximation: Zhang, IEEE Trans. Signal Process.
 * 40, 1992): each voxel's evidence is the ratio of its probabilities in noise and in tissue of the
 * level nearby, and neighbours within a few millimetres pull it to their side. A smooth surface
 * results where the evidence is weak. Axial planes at either end in which a quarter of the front of
 * the body is less than twice as bright as noise are left out.
 *
 * @param image  scanned image in patient order
 * @param work   the same image on cubic voxels
 * @param given  intensity to use instead; 0 for none
 */
MAMMORAYSEGMENTATION_EXPORT Outline FindOutline(const FloatImage* image, const FloatImage* work,
  double given);

/**
 * The intensity of a voxel half filled with skin, on cubic voxels, from the mean over the outer 4
 * mm of the body nearby, which are skin and fat. It is 0.55 of the mean if fat is dark, as skin is
 * brighter than the mean, and 0.25 if fat is bright, as skin, like muscle, has 0.35 of fat's
 * intensity. It is at least the outline's threshold.
 */
MAMMORAYSEGMENTATION_EXPORT FloatImage::Pointer SkinThreshold(const Outline& outline,
  const FloatImage* work, bool fatBright);
}

#endif
