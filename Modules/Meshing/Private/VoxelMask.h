// SPDX-License-Identifier: Apache-2.0
// Regions of cubic voxels, and what mathematical morphology does with them.
#ifndef mammoray_VoxelMask_h
#define mammoray_VoxelMask_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammorayMeshingModule.h"

#include <functional>
#include <vector>

namespace mammoray
{
/// A number for each voxel of a grid, i fastest.
struct VoxelField : VolumeGrid
{
  std::vector<float> Values;
};

/// A region: 1 inside, 0 outside. All voxels of its grid are cubes of one size; what lies outside
/// the grid is outside the region.
using VoxelMask = LabelVolume;

/// The part of each voxel of `grid` that lies in voxels of `labels` for which `belongs` is true,
/// [0, 1]. The grids share their axes.
MAMMORAYMESHING_EXPORT VoxelField FractionOf(const LabelVolume& labels,
  const std::function<bool(std::uint16_t)>& belongs, const VolumeGrid& grid);

/// Blurs with a Gaussian of this standard deviation; the ends are continued.
MAMMORAYMESHING_EXPORT void BlurField(VoxelField& field, double sigmaMm);

/// Voxels whose value is above the threshold.
MAMMORAYMESHING_EXPORT VoxelMask Above(const VoxelField& field, double threshold);

/**
 * Distance of every voxel's centre to the nearest centre of a voxel whose value is `value`, mm; 0
 * there; infinity where there is none (Felzenszwalb and Huttenlocher 2012).
 */
MAMMORAYMESHING_EXPORT VoxelField DistanceTo(const VoxelMask& mask, std::uint16_t value);

/// Distance to the region's border, positive inside, to half a voxel.
MAMMORAYMESHING_EXPORT VoxelField DepthIn(const VoxelMask& mask);

/// The largest connected piece (face neighbours) of the region; of equals the first.
MAMMORAYMESHING_EXPORT VoxelMask LargestPiece(const VoxelMask& mask);
/// The region and all air that does not reach the border of the grid.
MAMMORAYMESHING_EXPORT VoxelMask WithoutHoles(const VoxelMask& mask);
/// The points of all balls of this radius that fit into the region's largest piece left after
/// taking away all within the radius of its border: neither thin parts nor what hangs on them.
MAMMORAYMESHING_EXPORT VoxelMask OpenedLargest(const VoxelMask& mask, double radiusMm);
/// The region and all points that no ball of this radius outside it reaches.
MAMMORAYMESHING_EXPORT VoxelMask Closed(const VoxelMask& mask, double radiusMm);
}

#endif
