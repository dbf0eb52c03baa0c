// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_BiasField_h
#define mammoray_BiasField_h

#include "Private/ItkImages.h"
#include "mammoray/Foundation/Progress.h"

namespace mammoray
{
/**
 * The image divided by the smooth field that N4 (Tustison et al. 2010) finds in the mask, on blocks
 * of 5 mm. Away from the mask the field tends to 1. Intensities must not be negative.
 */
FloatImage::Pointer CorrectBias(const FloatImage* image, const MaskImage* mask,
  const ProgressCallback& progress);
}

#endif
