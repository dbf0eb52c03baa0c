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
}

#endif
