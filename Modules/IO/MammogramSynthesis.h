// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MammogramSynthesis_h
#define mammoray_MammogramSynthesis_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayIOModule.h"

#include <array>
#include <vector>

namespace mammoray
{
/// Factor from log attenuation to the stored values of a synthetic mammogram For Presentation,
/// which are limited to [0, 65535].
inline constexpr double PresentationValuesPerLogAttenuation = 4000;
/// Factor from transmission to stored values For Processing; noise in air still fits below 65535.
inline constexpr double ProcessingValuesPerTransmission = 50000;

/**
 * Returns the detector of a mammography unit in the frame that `placed` leads to: columns run along
 * gantry +y and begin at the chest wall, rows run along -x, and the middle of the chest-wall edge
 * is the gantry's origin. `spacingMm`: distance of pixel centres along a row and along a column.
 */
MAMMORAYIO_EXPORT XRayDetector DetectorOfUnit(const VolumeFromGantry& placed, int columns, int rows,
  const std::array<double, 2>& spacingMm);

/**
 * Returns what the header of a mammogram would state about a projection, without pixels: their
 * number and spacing, the patient directions of rows and columns, the distance from source to
 * detector plane, the positioner's angle (as BreastPose::RollDeg) and the view of the nearest
 * angle: CC, MLO and ML with the source 0, 45 and 90 degrees medial, LMO and LM lateral, FB below;
 * empty between those. `laterality` is 'L' or 'R'; `axes` those of the frame of source and
 * detector. Throws InputError on another laterality and on a detector whose steps are not at right
 * angles.
 */
MAMMORAYIO_EXPORT Mammogram DescribeProjection(const XRaySource& source,
  const XRayDetector& detector, const AnatomicalAxes& axes, char laterality);

/**
 * Sets a mammogram's pixels, 16 bits, from log attenuations (Rows * Columns values, row by row),
 * and their meaning. For Presentation they are logarithmic, bright where more is absorbed; For
 * Processing they are linear in intensity and shown inverted. Throws InputError on another number
 * of values and on one that is not finite.
 */
MAMMORAYIO_EXPORT void SetPixels(Mammogram& mammogram, const std::vector<float>& logAttenuation,
  Mammogram::Intent intent);

/// Sets pixels For Presentation, 12 bits, from the values that a unit displays, 0 (black) to 1
/// (DisplayValues). Throws InputError on another number of values and on values out of range.
MAMMORAYIO_EXPORT void SetDisplayPixels(Mammogram& mammogram, const std::vector<float>& values);
}

#endif
