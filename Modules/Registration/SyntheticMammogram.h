// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SyntheticMammogram_h
#define mammoray_SyntheticMammogram_h

#include "mammoray/Registration/PosedBreast.h"
#include "mammorayRegistrationModule.h"

#include <cstddef>
#include <vector>

namespace mammoray
{
/// A synthetic mammogram on a grid of the receptor.
struct SyntheticMammogram
{
  /// -ln(I / I0) of each pixel.
  std::vector<float> LogAttenuation;
  /// Outer silhouette on the receptor, gantry x, y, mm; from +x to -x around the nipple.
  std::vector<ReceptorPoint> Outline;
  /// Number of rays that crossed a surface which does not close.
  std::size_t InconsistentRays = 0;
};

/// X-rays a compressed breast, with `samples` rays along each side of a pixel. The silhouette is
/// looked for along rays from `centre`, a point of its shadow at the chest wall (ChestWallCentre).
MAMMORAYREGISTRATION_EXPORT SyntheticMammogram Synthesize(PosedBreast& breast,
  const ReceptorGrid& grid, const ReceptorPoint& centre, int samples);

/// How alike a synthetic and a real mammogram are.
struct Similarity
{
  /// Normalised cross-correlation of log attenuation inside both outlines, [-1, 1].
  double Correlation = 0;
  /**
   * Distances from the real outline, where it is compared (OutlineAlong), to the synthetic one, mm.
   * Not the other way: what an MRI holds of the body beside the breast need not be in the picture.
   */
  double MeanOutlineDistanceMm = 0;
  double LargestOutlineDistanceMm = 0;
  /**
   * Correlation of the tissue alone: in pixels of 1.5 mm, of what stands out of its surroundings (3
   * mm) where a breast is as thick as the plates are apart, 20 mm and more from its outline, in one
   * that is smaller over half of the largest distance. Breasts of one size and shape have all else
   * in common. NaN where that is less than 1 cm^2.
   */
  double TissueCorrelation = 0;
};

/// NaN where there is no outline to compare. Throws InputError on an empty mask.
MAMMORAYREGISTRATION_EXPORT Similarity Compare(const SyntheticMammogram& synthetic,
  const RegistrationTarget& target);
}

#endif
