// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelResampling_h
#define mammoray_LabelResampling_h

#include "mammoray/Foundation/Volumes.h"
#include "mammorayFoundationModule.h"

namespace mammoray
{
/**
 * Resamples the volume to a grid with cubic voxels of `spacingMm` (positive), the same axes and the
 * same first corner. Each new voxel takes the label that fills most of it; the outside counts as
 * label 0, and the smallest label wins a tie. The last voxels may extend beyond the old grid by
 * less than one spacing. Where thin structures consist of several labels, replace labels by
 * materials first (MaterialTable::ToMaterials). Throws InputError on an unusable spacing.
 */
MAMMORAYFOUNDATION_EXPORT LabelVolume ResampleLabels(const LabelVolume& labels, double spacingMm);

/// A box of voxels; First and Last are inside.
struct VoxelBox
{
  std::array<int, 3> First{ 0, 0, 0 };
  std::array<int, 3> Last{ 0, 0, 0 };
};

/// The smallest box with all voxels that are not 0. Throws InputError if all are 0.
MAMMORAYFOUNDATION_EXPORT VoxelBox FindTissueBox(const LabelVolume& labels);

/// Crops the volume to the smallest box with all voxels that are not 0, enlarged by `marginVoxels`
/// (not negative) where the volume extends that far. Throws InputError if all voxels are 0.
MAMMORAYFOUNDATION_EXPORT LabelVolume CropToTissue(const LabelVolume& labels, int marginVoxels);

/// Crops the volume to a box; voxels keep their positions. Throws InputError, with both sizes,
/// unless the box is not empty and lies inside the volume.
MAMMORAYFOUNDATION_EXPORT LabelVolume CropToBox(const LabelVolume& labels, const VoxelBox& box);
}

#endif
