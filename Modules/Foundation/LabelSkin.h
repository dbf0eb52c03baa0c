// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelSkin_h
#define mammoray_LabelSkin_h

#include "mammoray/Foundation/Volumes.h"
#include "mammorayFoundationModule.h"

#include <vector>

namespace mammoray
{
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
