// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelEditing_h
#define mammoray_LabelEditing_h

#include "mammoray/Foundation/Volumes.h"
#include "mammorayFoundationModule.h"

#include <vector>

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

/**
 * Depth of each voxel's centre below the outer air, mm. It is the Euclidean distance to the boxes
 * of half the voxel size around the centres of the air's voxels; 0 in the air and infinity beyond
 * `reachMm`. The distance to the centres would be too large by half a voxel below axis-aligned
 * faces; the distance to the voxels' faces would be too small by nearly as much below the steps of
 * slanted ones. With half boxes, a layer of 0.8 to 5 mm of a ball is accurate to 0.1 mm for voxels
 * of 0.4 to 0.8 mm. Grids may be anisotropic and oblique.
 *
 * The outer air is label 0 as far as face-connected voxels reach the border of the volume. Outside
 * the volume is not air, so a cut face has no depth. `fixed[label]` (false beyond its end) marks
 * tissue of the body behind the breast: air that touches only such tissue is ignored.
 */
MAMMORAYFOUNDATION_EXPORT std::vector<float> DepthBelowAir(const LabelVolume& labels,
  double reachMm, const std::vector<bool>& fixed);

/**
 * Adds a layer with the label `skin`: every voxel that is neither air nor fixed and whose centre
 * lies at most `thicknessMm` below the outer air (see DepthBelowAir). Existing skin becomes part of
 * the layer. Throws InputError unless `skin` is a label of tissue that is not fixed and the
 * thickness is at least the largest voxel spacing, so that the layer is closed.
 */
MAMMORAYFOUNDATION_EXPORT LabelVolume AddSkin(const LabelVolume& labels, double thicknessMm,
  int skin, const std::vector<bool>& fixed);
}

#endif
