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
 * Positions of source and detector in DICOM's Breast X-Ray Isocenter Reference System (PS3.3
 * C.8.31.6), mm and degrees. It is right-handed: Y points from the front of the gantry, where the
 * patient stands, to its rear, Z points up, and X points to the patient's right. The primary angle
 * turns about Y from Z towards X. The secondary angle is measured from the XZ plane towards Y.
 */
struct SourcePlace
{
  double SourceToIsocenterMm = 0;
  double SourcePrimaryDeg = 0;
  double SourceSecondaryDeg = 0;
  /// The detector turns about Y, too. Its reference point, relative to the isocenter, is the middle
  /// of the chest-wall edge of its pixels.
  double DetectorPrimaryDeg = 0;
  Vector3 Detector{ 0, 0, 0 };
  /// Centre of the first pixel and directions of increasing column and row, in the axes of the
  /// turned detector, relative to its reference point.
  Vector3 FirstPixel{ 0, 0, 0 };
  Vector3 Row{ 0, 1, 0 };
  Vector3 Column{ 1, 0, 0 };
};

/// Computes the positions for a mammogram with SourceFootPixel. The isocenter is `axisHeightMm`
/// above the middle of the chest-wall edge. Throws InputError unless rows run towards or away from
/// the chest wall, and if the source is at the isocenter.
MAMMORAYDICOM_EXPORT SourcePlace PlaceSource(const Mammogram& mammogram, double axisHeightMm);

/// Position of the source above the pixels: continuous column and row of its foot, and its height
/// above the detector, mm. The spacings are distances of neighbouring columns and rows, mm.
MAMMORAYDICOM_EXPORT Vector3 SourceOverPixels(const SourcePlace& place, double columnSpacingMm,
  double rowSpacingMm);
}

#endif
