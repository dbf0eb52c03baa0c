// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_BreastContrast_h
#define mammoray_BreastContrast_h

#include "Private/PixelMask.h"
#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammorayRegistrationModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// A mammogram as log attenuation, and where in it the breast begins.
struct BreastContrast
{
  /// Up to scale, rising with what is absorbed; air is at 0 by its smooth level (AirLevel::At), and
  /// so is padding.
  std::vector<float> LogAttenuation;
  /// Its medians over 3 x 3 pixels, air at 0 by its local level (AirLevel::LocalAt), and so is
  /// padding; breast is above EdgeLevel.
  std::vector<float> Smooth;
  float EdgeLevel = 0;
};

/// Throws InputError where there is no breast beside air. What had to be assumed, and what the
/// header contradicts itself in, comes to the target's sentences.
MAMMORAYREGISTRATION_EXPORT BreastContrast FindBreastContrast(const Mammogram& mammogram,
  const PixelGrid& grid, const TargetOptions& options, RegistrationTarget& target);
}

#endif
