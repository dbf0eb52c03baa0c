// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Display_h
#define mammoray_Display_h

#include "mammoray/XRay/Exposure.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayXRayModule.h"

#include <vector>

namespace mammoray
{
/// How a mammogram is made For Presentation, in the way that units do it in common (as Byng et al.,
/// Med. Phys. 24, 1997, for the rim; DICOM PS3.3 C.11.2.1.3.1 for the sigmoid).
struct MAMMORAYXRAY_EXPORT DisplayOptions
{
  /// Width over which log attenuations are averaged to tell thin tissue at the rim, mm, and the
  /// share of what it lacks of the breast's that is added. 0.5 to 50; 0 to 1.
  double RimMm = 8;
  double RimShare = 0.85;
  /// Differences from the mean over this width are made larger by the share. 0.1 to 20 mm; 0 to 5.
  double DetailMm = 1.5;
  double DetailShare = 0.5;
  /// Window of the sigmoid, in standard deviations of what it shows of the breast; 1 to 100.
  double WindowDeviations = 5;
};

/// Values of 0, black, to 1 by pixel, bright where much is absorbed; the breast is where path
/// lengths say that there is material. Air stays below its place on the sigmoid. Throws InputError
/// on options out of range and where nothing is in the beam.
MAMMORAYXRAY_EXPORT std::vector<float> DisplayValues(const Exposure& exposure,
  const XRayDetector& detector, const DisplayOptions& options = {});
}

#endif
