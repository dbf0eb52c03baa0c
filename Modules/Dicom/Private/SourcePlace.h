// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_SourcePlace_h
#define mammoray_Private_SourcePlace_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayDicomModule.h"

#include <array>

namespace mammoray
{
/**
 * Where source and detector of a projection stand, as DICOM's Breast X-Ray Isocenter Reference
 * System has it (PS3.3 C.8.31.6): right-handed with Y from the gantry's front, where the patient
 * is, to its rear and Z up, so that X leads to the patient's right. Angles are about Y, from Z
 * towards X (primary), and out of the plane of X and Z towards Y (secondary). mm and degrees.
 */
struct SourcePlace
{
  double SourceToIsocenterMm = 0;
  double SourcePrimaryDeg = 0;
  double SourceSecondaryDeg = 0;
  /// The detector turns about Y, too; its reference point, here the middle of the chest-wall edge
  /// of its pixels, from the isocenter.
  double DetectorPrimaryDeg = 0;
  Vector3 Detector{ 0, 0, 0 };
  /// In the detector's turned axes, from its reference point: the centre of the first pixel, and
  /// the directions of increasing column and row.
  Vector3 FirstPixel{ 0, 0, 0 };
  Vector3 Row{ 0, 1, 0 };
  Vector3 Column{ 1, 0, 0 };
};

/// Of a mammogram with a SourceFootPixel, its isocenter `axisHeightMm` above the middle of the
/// chest-wall edge. Throws InputError where rows run neither towards nor away from the chest wall,
/// and of a source at the isocenter.
MAMMORAYDICOM_EXPORT SourcePlace PlaceSource(const Mammogram& mammogram, double axisHeightMm);

/// Where the source stands over the pixels: continuous column and row of its foot, and its height
/// over the detector, mm; pixels are so far apart along a row and along a column, mm.
MAMMORAYDICOM_EXPORT Vector3 SourceOverPixels(const SourcePlace& place, double columnSpacingMm,
  double rowSpacingMm);
}

#endif
