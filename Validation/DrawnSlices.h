// SPDX-License-Identifier: Apache-2.0
// What a person drew in slices of an MRI, and how a segmentation agrees with it.
#ifndef mammoray_Validation_DrawnSlices_h
#define mammoray_Validation_DrawnSlices_h

#include "mammoray/Foundation/Volumes.h"

#include <array>
#include <limits>
#include <string>
#include <vector>

namespace mammoray
{
/// Points in a slice, mm; the coordinates are those of DICOM LPS without the slice's normal.
using DrawnPoint = std::array<double, 2>;
using DrawnLine = std::vector<DrawnPoint>;

struct DrawnSlice
{
  /// Axis of DICOM LPS along the normal: 0 sagittal, 1 coronal, 2 axial.
  std::size_t Normal = 2;
  /// Position along the normal, mm.
  double PositionMm = 0;
  /// What is compared: from and to along the first axis, from and to along the second one, mm.
  std::array<double, 4> Judged{ 0, 0, 0, 0 };
  /// The skin's outer face: one line in front of the chest wall, or closed lines without ChestWall.
  std::vector<DrawnLine> Outline;
  /// At most one line: the front of muscle, ribs and sternum, in the direction of the outline.
  std::vector<DrawnLine> ChestWall;
  /// Closed lines; empty if gland was not drawn.
  std::vector<DrawnLine> Gland;
  /// Pieces of the lines that the image hardly shows; no distance is measured from them.
  std::vector<DrawnLine> OutlineUncertain;
  std::vector<DrawnLine> ChestWallUncertain;
};

/// Reads a file of Validation/data (README.md there). Throws InputError if it is not such a file.
std::vector<DrawnSlice> ReadDrawnSlices(const std::string& path);

/// Distances of two lines, from points of each to the nearest of the other, mm. Infinite if the
/// labels have no such border; NaN if none was drawn.
struct LineDistance
{
  double MeanMm = std::numeric_limits<double>::quiet_NaN();
  double Quantile95Mm = std::numeric_limits<double>::quiet_NaN();
};

struct DrawnAgreement
{
  /// Dice coefficients over all slices; NaN if it was not drawn.
  double BreastDice = std::numeric_limits<double>::quiet_NaN();
  double GlandDice = std::numeric_limits<double>::quiet_NaN();
  LineDistance Outline;
  LineDistance ChestWall;
};

/**
 * Compares labels (TissueLabel, DICOM LPS) with drawn slices, on a grid of 0.5 mm. The breast is
 * fat, gland and skin; drawn, it is what outline and chest wall enclose. The outline is compared in
 * front of the drawn chest wall only.
 */
DrawnAgreement CompareWithDrawn(const LabelVolume& labels, const std::vector<DrawnSlice>& slices);
}

#endif
