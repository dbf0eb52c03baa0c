// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelVolume_h
#define mammoray_LabelVolume_h

#include "mammoray/Foundation/VolumeGrid.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace mammoray
{
/// A segmented volume.
struct MAMMORAYFOUNDATION_EXPORT LabelVolume : VolumeGrid
{
  /// Labels, i fastest; Size[0] * Size[1] * Size[2] values.
  std::vector<std::uint16_t> Voxels;

  std::size_t NumberOfVoxels() const { return this->Voxels.size(); }
  /// Label of the voxel that contains the position (mm, volume frame); 0 outside the volume.
  std::uint16_t LabelAt(const Vector3& point) const;
  /// Number of voxels of every label that occurs.
  std::map<int, std::size_t> CountLabels() const;
  /// Throws InputError if sizes, spacing, direction and number of voxels do not form a volume.
  void Validate(const std::string& name) const;
};
}

#endif
