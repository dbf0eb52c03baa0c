// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LesionShadow_h
#define mammoray_LesionShadow_h

#include "mammoray/Foundation/Volumes.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/Study/RegisteredBreast.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayStudyModule.h"

#include <array>
#include <string>
#include <vector>

namespace mammoray
{
/// The voxels of one label of a volume of lesions: their volume, mm^3, and centre, volume frame,
/// mm.
struct Lesion
{
  int Label = 0;
  double VolumeMm3 = 0;
  Vector3 Centre{ 0, 0, 0 };
};

/// All lesions of a volume, by label; label 0 is none.
MAMMORAYSTUDY_EXPORT std::vector<Lesion> FindLesions(const LabelVolume& volume);

/// Reads a volume of lesions. Throws InputError that names the file, also where it holds none.
MAMMORAYSTUDY_EXPORT LabelVolume ReadLesions(const std::string& path,
  VolumeAxes axes = VolumeAxes::Patient);

/// Largest share of a lesion outside the tissue; a lesion may touch the skin or the chest wall.
inline constexpr double LargestShareOutside = 0.5;

/// A lesion's shadow on the mammogram.
struct LesionShadow
{
  /// Volume and centre of its voxels, volume frame, mm^3 and mm.
  double VolumeMm3 = 0;
  Vector3 Centre{ 0, 0, 0 };
  ImagedPoint ImagedCentre;
  /// Area of the part of the shadow in the image, on the receptor.
  double AreaMm2 = 0;
  /// 1 in the shadow; Rows * Columns values of the mammogram, row by row.
  std::vector<unsigned char> Shadow;
  /// Longest path of an X-ray in the lesion, mm.
  double LargestThicknessMm = 0;
  /// Share of its surface's points that are outside the breast; they move with the nearest tissue.
  double ShareOutside = 0;
  /// Closed polygons around the shadow, continuous column and row; first and last point are the
  /// same.
  std::vector<std::vector<std::array<double, 2>>> Outlines;
};

/**
 * Finds a lesion in the mammogram: turns the voxels of `lesions` (frame of the registered label
 * volume) with the label `label` into a closed surface, compresses it with the breast and projects
 * it on the mammogram's pixels. Sets that surface in the projector. Throws InputError if there is
 * no such voxel or the lesion is outside the breast, and DeviceError.
 */
MAMMORAYSTUDY_EXPORT LesionShadow ProjectLesion(const RegisteredBreast& breast,
  const LabelVolume& lesions, int label, PathLengthProjector& projector);
}

#endif
