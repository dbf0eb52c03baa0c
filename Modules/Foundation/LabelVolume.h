// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelVolume_h
#define mammoray_LabelVolume_h

#include "Vector3.h"
#include "mammorayFoundationModule.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace mammoray
{
/**
 * A segmented volume on a regular, possibly oblique grid. The *volume frame* (mm) is the frame in
 * which Origin and Direction are given: DICOM LPS for patient data.
 */
struct MAMMORAYFOUNDATION_EXPORT LabelVolume
{
  /// Number of voxels along i, j, k; each at least 1.
  std::array<int, 3> Size{ 0, 0, 0 };
  /// Centre of voxel (0, 0, 0), mm.
  Vector3 Origin{ 0, 0, 0 };
  /// Distance of neighbouring voxel centres along i, j, k, mm; positive.
  Vector3 Spacing{ 1, 1, 1 };
  /// Unit vectors of the i, j and k axes in the volume frame (Direction[0] is the i axis).
  std::array<Vector3, 3> Direction{ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } };
  /// Labels, i fastest; Size[0] * Size[1] * Size[2] values.
  std::vector<std::uint16_t> Voxels;

  std::size_t NumberOfVoxels() const { return this->Voxels.size(); }
  std::size_t Index(int i, int j, int k) const
  {
    return (static_cast<std::size_t>(k) * this->Size[1] + j) * this->Size[0] + i;
  }
  /// Volume of a voxel, mm^3.
  double VoxelVolume() const { return this->Spacing[0] * this->Spacing[1] * this->Spacing[2]; }
  /// Position (mm, volume frame) of a continuous index; voxel centres at whole numbers.
  Vector3 PointAt(double i, double j, double k) const;
  /// Continuous index of a position (mm, volume frame).
  Vector3 ContinuousIndex(const Vector3& point) const;
  /// Label of the voxel that holds the position; 0 outside the volume.
  std::uint16_t LabelAt(const Vector3& point) const;
  /// Number of voxels of every label that occurs.
  std::map<int, std::size_t> CountLabels() const;
  /// Throws InputError when sizes, spacing, direction and voxel count do not make a volume.
  void Validate(const std::string& name) const;
};
}

#endif
