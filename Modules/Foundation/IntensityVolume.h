// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_IntensityVolume_h
#define mammoray_IntensityVolume_h

#include "mammoray/Foundation/VolumeGrid.h"

#include <optional>
#include <vector>

namespace mammoray
{
/// A scanned volume, an MRI for example, in the unit of its source.
struct MAMMORAYFOUNDATION_EXPORT IntensityVolume : VolumeGrid
{
  /// Intensities, i fastest; Size[0] * Size[1] * Size[2] values.
  std::vector<float> Voxels;

  /// Between the centres of voxels, trilinear; empty more than half a voxel outside.
  std::optional<float> ValueAt(const Vector3& point) const;
  /// Throws InputError when the grid is none or, with its place, at a value that is not finite.
  void Validate(const std::string& name) const;
};
}

#endif
