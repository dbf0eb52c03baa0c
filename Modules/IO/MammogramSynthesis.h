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
/// Stored values of a synthetic mammogram For Presentation: this times the log attenuation, 0 (also
/// for less) to 65535.
inline constexpr double PresentationValuesPerLogAttenuation = 4000;
/// For Processing: this times the transmission, so that noise in the air still fits below 65535.
inline constexpr double ProcessingValuesPerTransmission = 50000;

/**
 * The detector of a mammography unit in the frame that `placed` leads to: columns run along gantry
 * +y and begin at the chest wall, rows run along -x, and the middle of the chest-wall edge is the
 * gantry's origin. `spacingMm`: distance of pixel centres along a row and along a column.
 */
MAMMORAYIO_EXPORT XRayDetector DetectorOfUnit(const VolumeFromGantry& placed, int columns, int rows,
  const std::array<double, 2>& spacingMm);

/**
 * What the header of a mammogram would say about a projection, without pixels: their number and
 * spacing, the patient directions of rows and columns, the distance of source and detector plane,
 * the positioner's angle (in the sense of BreastPose::RollDeg) and the view whose angle is nearest:
 * CC, MLO and ML with the source 0, 45 and 90 degrees medial, LMO and LM lateral, FB below; empty
 * between those. `laterality` is 'L' or 'R'; `axes` those of the frame of source and detector.
 * Throws InputError on another laterality and on a detector whose steps are not at right angles.
 */
MAMMORAYIO_EXPORT Mammogram DescribeProjection(const XRaySource& source,
  const XRayDetector& detector, const AnatomicalAxes& axes, char laterality);

/**
 * Gives a mammogram pixels of 16 bits from log attenuations (Rows * Columns values, row by row) and
 * says what they mean: For Presentation, logarithmic, bright where more is absorbed; For
 * Processing, linear in intensity, shown inverted. Throws InputError on another number of values
 * and where one is not finite.
 */
MAMMORAYIO_EXPORT void SetPixels(Mammogram& mammogram, const std::vector<float>& logAttenuation,
  Mammogram::Intent intent);

/// The same For Presentation, 12 bits, of what a unit shows: values of 0, black, to 1
/// (DisplayValues). Throws InputError on another number of them and on values out of that range.
MAMMORAYIO_EXPORT void SetDisplayPixels(Mammogram& mammogram, const std::vector<float>& values);
}

#endif
