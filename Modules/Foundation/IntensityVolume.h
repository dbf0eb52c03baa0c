// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_IntensityVolume_h
#define mammoray_IntensityVolume_h

#include "mammoray/Foundation/VolumeGrid.h"

#include <optional>
#include <vector>

namespace mammoray
{
/// A scanned volume, for example an MRI, in the unit of its source.
struct MAMMORAYFOUNDATION_EXPORT IntensityVolume : VolumeGrid
{
  /// Intensities, i fastest; Size[0] * Size[1] * Size[2] values.
  std::vector<float> Voxels;

  /// Trilinear interpolation between voxel centres at a position (mm, volume frame); no value more
  /// than half a voxel outside the grid.
  std::optional<float> ValueAt(const Vector3& point) const;
  /// Throws InputError if the grid is invalid, or if a value is not finite; the message contains
  /// its voxel.
  void Validate(const std::string& name) const;
};
}

#endif
