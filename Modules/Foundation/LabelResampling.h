// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelResampling_h
#define mammoray_LabelResampling_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammorayFoundationModule.h"

namespace mammoray
{
/**
 * The volume on a grid of another spacing (mm, positive, the same along all axes), same axes and
 * same first corner. A new voxel takes the label that fills most of it, what lies outside the
 * volume counting as 0; the smallest label wins a tie. The last voxels may reach past the old grid
 * by less than one spacing. Replace labels by materials (MaterialTable::ToMaterials) first where
 * thin structures of several labels belong together. Throws InputError on an unusable spacing.
 */
MAMMORAYFOUNDATION_EXPORT LabelVolume ResampleLabels(const LabelVolume& labels, double spacingMm);

/// A box of voxels; First and Last belong to it.
struct VoxelBox
{
  std::array<int, 3> First{ 0, 0, 0 };
  std::array<int, 3> Last{ 0, 0, 0 };
};

/// The smallest box that holds every voxel that is not 0. Throws InputError when all are 0.
MAMMORAYFOUNDATION_EXPORT VoxelBox FindTissueBox(const LabelVolume& labels);

/**
 * The smallest box of the volume that holds every voxel that is not 0, with `marginVoxels` (not
 * negative) around it where the volume reaches that far. Throws InputError when all voxels are 0.
 */
MAMMORAYFOUNDATION_EXPORT LabelVolume CropToTissue(const LabelVolume& labels, int marginVoxels);

/**
 * The voxels of a box, each at its place in the volume frame. Throws InputError, naming both,
 * unless the box holds a voxel and lies in the volume.
 */
MAMMORAYFOUNDATION_EXPORT LabelVolume CropToBox(const LabelVolume& labels, const VoxelBox& box);
}

#endif
