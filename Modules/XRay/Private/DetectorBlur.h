// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DetectorBlur_h
#define mammoray_DetectorBlur_h

#include "mammorayXRayModule.h"

#include <vector>

namespace mammoray
{
/**
 * The middle and one side of a kernel along a line of pixels whose modulation transfer is
 * exp(-ln 2 (f / half)^2) up to the pixels' Nyquist frequency: 1 at 0, 1/2 at `half` (cycles per
 * mm). Its sum, both sides counted, is 1. Values beside come in steps of `pixelMm`.
 */
MAMMORAYXRAY_EXPORT std::vector<double> BlurKernel(double half, double pixelMm);

/// Applies a kernel along the rows and one along the columns; beyond its edges the image goes on as
/// at them.
MAMMORAYXRAY_EXPORT void Blur(std::vector<double>& image, int columns, int rows,
  const std::vector<double>& alongRows, const std::vector<double>& alongColumns);
}

#endif
