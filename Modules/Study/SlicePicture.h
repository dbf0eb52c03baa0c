// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SlicePicture_h
#define mammoray_SlicePicture_h

#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammoray/Study/LayeredPicture.h"
#include "mammorayStudyModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/**
 * Draws three slices each across the patient (axial), seen from the front (coronal) and from the
 * side (sagittal) of a volume, over the box of its labels, with the labels' outlines in colours and
 * a legend, and writes .png. Grey goes from 0 to the 99.5th percentile in the box. Both volumes are
 * of one grid; `names[label]` names a label. No display is needed. Throws InputError when the grids
 * differ, no label is there or the file cannot be written.
 */
MAMMORAYSTUDY_EXPORT void WriteSlicePicture(const IntensityVolume& image, const LabelVolume& labels,
  const AnatomicalAxes& axes, const std::vector<std::string>& names, const std::string& path);

/// The bytes of that picture; throws as that.
MAMMORAYSTUDY_EXPORT std::string SlicePicturePng(const IntensityVolume& image,
  const LabelVolume& labels, const AnatomicalAxes& axes, const std::vector<std::string>& names);

/// What three slices through a point show.
struct PointSlices
{
  /// In grey, from 0 to the 99.5th percentile of the labels' box; null: tissues in colour.
  const IntensityVolume* Image = nullptr;
  /// Tissue; what is shown is the box of what is not 0. Required.
  const LabelVolume* Labels = nullptr;
  AnatomicalAxes Axes;
  /// By label, for the legend of tissues in colour.
  std::vector<std::string> Names;
  /// Frame of the volumes, mm, in or near the box; marked in each slice.
  Vector3 Point{ 0, 0, 0 };
  /// Volume whose label `LesionLabel` is outlined; null: none.
  const LabelVolume* Lesions = nullptr;
  int LesionLabel = 0;
};

/**
 * Draws slices across the patient (axial), from the front (coronal) and from the patient's left
 * (sagittal) through the point, side by side to one scale, with a bar of it and letters of the
 * patient's directions. No display is needed. Throws InputError when no label is there.
 */
MAMMORAYSTUDY_EXPORT LayeredPicture DrawPointSlices(const PointSlices& slices);
}

#endif
