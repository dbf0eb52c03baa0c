// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Display_h
#define mammoray_Display_h

#include "mammoray/XRay/Exposure.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayXRayModule.h"

#include <vector>

namespace mammoray
{
/// How a mammogram becomes For Presentation, as most units do it: peripheral equalisation (as Byng
/// et al., Med. Phys. 24, 1997), detail enhancement and a sigmoid (DICOM PS3.3 C.11.2.1.3.1).
struct MAMMORAYXRAY_EXPORT DisplayOptions
{
  /// Thin tissue at the rim is found by averaging log attenuations over a width, 0.5 to 50 mm. This
  /// share of its difference to the breast's is added, 0 to 1.
  double RimMm = 8;
  double RimShare = 0.85;
  /// Differences from the mean over a width, 0.1 to 20 mm, grow by this share, 0 to 5.
  double DetailMm = 1.5;
  double DetailShare = 0.5;
  /// Window of the sigmoid, in standard deviations of the breast's values; 1 to 100.
  double WindowDeviations = 5;
};

/// Display values from 0 (black) to 1, bright where much is absorbed; Rows * Columns values. The
/// breast is where path lengths are positive. Air stays below its place on the sigmoid. Throws
/// InputError on options out of range and if nothing is in the beam.
MAMMORAYXRAY_EXPORT std::vector<float> DisplayValues(const Exposure& exposure,
  const XRayDetector& detector, const DisplayOptions& options = {});
}

#endif
