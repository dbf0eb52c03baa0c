// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Volumes_h
#define mammoray_Volumes_h

#include "mammoray/Foundation/Vector3.h"
#include "mammorayFoundationModule.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

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

/// A segmented volume.
struct MAMMORAYFOUNDATION_EXPORT LabelVolume : VolumeGrid
{
  /// Labels, i fastest; Size[0] * Size[1] * Size[2] values.
  std::vector<std::uint16_t> Voxels;
  /// Names of labels, as far as their file states them (see IO's ReadLabelFile). If there are any,
  /// they decide what a label is (MaterialTable::ToMaterials).
  std::map<int, std::string> Names;

  std::size_t NumberOfVoxels() const { return this->Voxels.size(); }
  /// Label of the voxel that contains the position (mm, volume frame); 0 outside the volume.
  std::uint16_t LabelAt(const Vector3& point) const;
  /// Number of voxels of every label that occurs.
  std::map<int, std::size_t> CountLabels() const;
  /// Throws InputError if sizes, spacing, direction and number of voxels do not form a volume.
  void Validate(const std::string& name) const;
};

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
