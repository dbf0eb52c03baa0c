// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MammogramSynthesis_h
#define mammoray_MammogramSynthesis_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammoray/XRay/Scene.h"
#include "mammorayIOModule.h"

#include <array>
#include <optional>
#include <string>
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

/// A picture of a scene as a mammogram: what the scene does not tell.
struct SceneMammogram
{
  /// Directions of the scene's frame in the patient.
  AnatomicalAxes Axes;
  /// 'L' or 'R'.
  char Laterality = 'L';
  /// "CC", "MLO", ...; empty: that of the unit's angle (DescribeProjection).
  std::string View;
  /// Thickness of the breast, and the distance from the source to it; absent: not stated.
  std::optional<double> ThicknessMm;
  std::optional<double> SourceToPatientMm;
  /// Transmissions, linear, in place of a picture For Presentation; or what a unit displays.
  bool ForProcessing = false;
  bool Display = false;
};

/// The mammogram without pixels. Throws InputError without a view, and where a mammogram cannot
/// have the scene's geometry.
MAMMORAYIO_EXPORT Mammogram DescribeMammogram(const Scene& scene, const SceneMammogram& of);
/// The same with the pixels of a picture.
MAMMORAYIO_EXPORT Mammogram MakeMammogram(const Exposure& exposure, const Scene& scene,
  const SceneMammogram& of);
/// How a synthetic image of `what` was computed and what its values mean, for its header.
MAMMORAYIO_EXPORT std::string SyntheticDerivation(bool forProcessing, const std::string& what);

/// Sets pixels For Presentation, 12 bits, from the values that a unit displays, 0 (black) to 1
/// (DisplayValues). Throws InputError on another number of values and on values out of range.
MAMMORAYIO_EXPORT void SetDisplayPixels(Mammogram& mammogram, const std::vector<float>& values);
}

#endif
