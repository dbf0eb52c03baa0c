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
/// An MRI as it would be had the breast lain between the plates: in the frame of the registered
/// label volume, on which compressed.vtu lies.
struct CompressedVolume
{
  /// 0 outside the breast and the given image.
  IntensityVolume Values;
  /// One flag per voxel: whether the given image has a value there.
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
 * Projects it on the mammogram's pixels along the X-rays, as for a fusion with the mammogram: point
 * arrays "Maximum" (scalars), "Mean" (per length in the breast) and "PathLength" (mm of the ray in
 * the image and the breast), float, 0 where a ray misses; steps of half a voxel; only voxels inside
 * count. The image lies where the detector is, rows and columns those of the mammogram. Throws
 * Interrupted.
 */
MAMMORAYSTUDY_EXPORT vtkSmartPointer<vtkImageData> ProjectVolume(const CompressedVolume& compressed,
  const RegisteredBreast& breast, const ProgressCallback& progress = {});

/// Which points a displacement field moves, and where to.
enum class DisplacementDirection
{
  /// Points of the compressed breast to where their tissue lay in the volume: what resamples an
  /// image of the volume into the compressed breast.
  CompressedToVolume,
  /// Points of the volume to where their tissue lies in the compressed breast: what moves points
  /// and meshes, and resamples an image of the compressed breast into the volume.
  VolumeToCompressed
};

/**
 * The deformation as a field, voxels of `spacingMm` (positive) along the axes of the volume frame,
 * around the breast that the points lie in and `marginMm` (at least 0) beyond: linear in each
 * tetrahedron, and outside the breast the displacement of the nearest tissue. Throws InputError on
 * another spacing or margin and where that is more than 100 million voxels, Interrupted.
 */
MAMMORAYSTUDY_EXPORT DisplacementField FindDisplacement(const RegisteredBreast& breast,
  DisplacementDirection direction, double spacingMm, double marginMm,
  const ProgressCallback& progress = {});
}

#endif
