// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PixelFilters_h
#define mammoray_PixelFilters_h

#include "Private/PixelMask.h"
#include "mammorayRegistrationModule.h"

#include <vector>

namespace mammoray
{
/// The median of each pixel and its neighbours. `values` are only read.
MAMMORAYREGISTRATION_EXPORT std::vector<float> Median3x3(const PixelGrid& grid,
  std::vector<float>& values);

/// The picture between its pixels: `factor` (odd) times as fine, by linear interpolation. `values`
/// are only read.
MAMMORAYREGISTRATION_EXPORT std::vector<float> Refine(const PixelGrid& grid,
  std::vector<float>& values, const PixelGrid& fine, int factor);

/// Details of a picture: each pixel of `mask` less the mean around it, by a Gaussian of `sigmaMm`
/// over the pixels of the mask; 0 elsewhere.
MAMMORAYREGISTRATION_EXPORT std::vector<float> Details(const PixelGrid& grid,
  const std::vector<float>& values, const PixelMask& mask, double sigmaMm);

/// How the noise of a picture goes with attenuation.
enum class NoiseTrend
{
  Unknown, ///< no noise to measure, or much the same everywhere
  Falls,   ///< as the square root of the quanta does: values follow intensity linearly
  Rises    ///< as that of their logarithm does, and of what is made to be looked at
};

/**
 * The trend of `values`, one for each pixel, which are larger where more is absorbed: noise of the
 * air beside the breast, or where the detector was saturated there, of the breast's quarter of
 * least attenuation, against that of its densest half. Fourth differences along the rows, which see
 * no gradient or bulge, in blocks of 8 x 8 pixels, by medians. A breast of 50 mm lets a twentieth
 * through, so the noise of quanta differs by 4, that of their logarithm by a quarter; within the
 * breast by 1.5 and its inverse. 2 (within the breast 1.35) and 1/1.5 are the limits.
 * `signedDistanceMm`: to the breast's outline, negative inside; what lies within 5 mm of it is not
 * looked at.
 */
MAMMORAYREGISTRATION_EXPORT NoiseTrend FindNoiseTrend(const PixelGrid& grid,
  const std::vector<float>& values, const std::vector<float>& signedDistanceMm);
}

#endif
