// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_VolumeGrid_h
#define mammoray_VolumeGrid_h

#include "mammoray/Foundation/Vector3.h"
#include "mammorayFoundationModule.h"

#include <array>
#include <cstddef>
#include <string>

namespace mammoray
{
/// A regular, possibly oblique grid of voxels. The *volume frame* (mm) is the frame of Origin and
/// Direction: DICOM LPS for patient data.
struct MAMMORAYFOUNDATION_EXPORT VolumeGrid
{
  /// Number of voxels along i, j, k; each at least 1.
  std::array<int, 3> Size{ 0, 0, 0 };
  /// Centre of voxel (0, 0, 0), mm.
  Vector3 Origin{ 0, 0, 0 };
  /// Distance of neighbouring voxel centres along i, j, k, mm; positive.
  Vector3 Spacing{ 1, 1, 1 };
  /// Unit vectors of the i, j and k axes in the volume frame (Direction[0] is the i axis).
  std::array<Vector3, 3> Direction{ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } };

  /// Array index of a voxel, i fastest.
  std::size_t Index(int i, int j, int k) const
  {
    return (static_cast<std::size_t>(k) * this->Size[1] + j) * this->Size[0] + i;
  }
  /// Calls visit(i, j, k, array index) for every voxel, in the order of the array.
  template <typename Visit>
  void ForEachVoxel(const Visit& visit) const
  {
    std::size_t index = 0;
    for (int k = 0; k < this->Size[2]; ++k)
    {
      for (int j = 0; j < this->Size[1]; ++j)
      {
        for (int i = 0; i < this->Size[0]; ++i)
        {
          visit(i, j, k, index++);
        }
      }
    }
  }
  /// "voxel (i, j, k)" for an array index, for messages.
  std::string VoxelName(std::size_t index) const;
  /// Volume of a voxel, mm^3.
  double VoxelVolume() const { return this->Spacing[0] * this->Spacing[1] * this->Spacing[2]; }
  /// Position (mm, volume frame) of a continuous index; voxel centres at whole numbers.
  Vector3 PointAt(double i, double j, double k) const;
  /// Continuous index of a position (mm, volume frame).
  Vector3 ContinuousIndex(const Vector3& point) const;
  /// Index (0, 1 or 2) of the axis that is most nearly parallel or antiparallel to a direction.
  std::size_t AxisAlong(const Vector3& direction) const;
  /// Throws InputError unless sizes, spacing, origin and direction form a grid of `voxelCount`
  /// voxels.
  void ValidateGrid(const std::string& name, std::size_t voxelCount) const;
};
}

#endif
