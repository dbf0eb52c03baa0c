// Regions of cubic voxels and their mathematical morphology.
#ifndef mammoray_VoxelMask_h
#define mammoray_VoxelMask_h

#include "mammoray/Foundation/Volumes.h"
#include "mammorayMeshingModule.h"

#include <functional>
#include <vector>

namespace mammoray
{
/// A value for each voxel of a grid, i fastest.
struct VoxelField : VolumeGrid
{
  std::vector<float> Values;
};

/// A region: 1 inside, 0 outside. The voxels of its grid are cubes of one size; outside the grid is
/// outside the region.
using VoxelMask = LabelVolume;

/// Fraction, [0, 1], of each voxel of `grid` that lies in voxels of `labels` accepted by `belongs`.
/// The grids share their axes.
MAMMORAYMESHING_EXPORT VoxelField FractionOf(const LabelVolume& labels,
  const std::function<bool(std::uint16_t)>& belongs, const VolumeGrid& grid);

/// Blurs with a Gaussian of this standard deviation; values continue beyond the ends of the grid.
MAMMORAYMESHING_EXPORT void BlurField(VoxelField& field, double sigmaMm);

/// The region of voxels whose value exceeds the threshold.
MAMMORAYMESHING_EXPORT VoxelMask Above(const VoxelField& field, double threshold);

/// Distance of every voxel's centre to the nearest centre of a voxel with `value`, mm; infinite if
/// there is none.
MAMMORAYMESHING_EXPORT VoxelField DistanceTo(const VoxelMask& mask, std::uint16_t value);

/// Distance to the region's border, mm, positive inside; accurate to half a voxel.
MAMMORAYMESHING_EXPORT VoxelField DepthIn(const VoxelMask& mask);

/// The largest face-connected piece of the region; the first one wins a tie.
MAMMORAYMESHING_EXPORT VoxelMask LargestPiece(VoxelMask mask);
/// The region and all air that is not connected with the border of the grid.
MAMMORAYMESHING_EXPORT VoxelMask WithoutHoles(VoxelMask mask);
/// The morphological opening of the region by a ball, restricted to the largest piece of its
/// erosion: thin parts and parts connected through them are removed.
MAMMORAYMESHING_EXPORT VoxelMask OpenedLargest(const VoxelMask& mask, double radiusMm);
/// The morphological closing of the region by a ball.
MAMMORAYMESHING_EXPORT VoxelMask Closed(const VoxelMask& mask, double radiusMm);
}

#endif
