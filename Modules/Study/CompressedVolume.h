// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_CompressedVolume_h
#define mammoray_CompressedVolume_h

#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/Study/RegisteredBreast.h"
#include "mammorayStudyModule.h"

#include "vtkSmartPointer.h"

#include <vector>

class vtkImageData;

namespace mammoray
{
/// An MRI deformed into the compressed breast, in the frame of the registered label volume.
struct CompressedVolume
{
  /// 0 outside the breast and the given image.
  IntensityVolume Values;
  /// One flag per voxel: 1 if the given image has a value there.
  std::vector<unsigned char> Inside;
};

/**
 * Resamples `image` (frame of the registered label volume) into the compressed breast: voxels of
 * `spacingMm` (positive) along the image's axes around the breast, each with the value at the place
 * in the uncompressed breast that came to lie there (linear in each tetrahedron, trilinear in the
 * image). Throws InputError when no part of the breast lies in the image, and Interrupted.
 */
MAMMORAYSTUDY_EXPORT CompressedVolume CompressVolume(const IntensityVolume& image,
  const RegisteredBreast& breast, double spacingMm, const ProgressCallback& progress = {});

/**
 * Projects a compressed volume along the X-rays on the mammogram's pixels, for fusion with the
 * mammogram. Float point arrays: "Maximum" (scalars), "Mean" (per length in the breast) and
 * "PathLength" (mm of the ray in the image and the breast), 0 if a ray misses. Rays advance by half
 * a voxel, and only voxels inside count. The image lies on the detector and has the rows and
 * columns of the mammogram. Throws Interrupted.
 */
MAMMORAYSTUDY_EXPORT vtkSmartPointer<vtkImageData> ProjectVolume(const CompressedVolume& compressed,
  const RegisteredBreast& breast, const ProgressCallback& progress = {});

/// Direction of a displacement field.
enum class DisplacementDirection
{
  /// Moves points of the compressed breast to where their tissue is in the volume; resamples an
  /// image of the volume into the compressed breast.
  CompressedToVolume,
  /// Moves points and meshes of the volume into the compressed breast; resamples an image of the
  /// compressed breast into the volume.
  VolumeToCompressed
};

/**
 * Samples the deformation on voxels of `spacingMm` (positive) along the axes of the volume frame,
 * around the breast whose points move and `marginMm` (at least 0) beyond. The displacement is
 * linear in each tetrahedron, and that of the nearest tissue outside the breast. Throws InputError
 * for another spacing or margin or more than 100 million voxels, and Interrupted.
 */
MAMMORAYSTUDY_EXPORT DisplacementField FindDisplacement(const RegisteredBreast& breast,
  DisplacementDirection direction, double spacingMm, double marginMm,
  const ProgressCallback& progress = {});
}

#endif
