// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelSkin_h
#define mammoray_LabelSkin_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammorayFoundationModule.h"

#include <vector>

namespace mammoray
{
/**
 * How deep each voxel's centre lies below the outer air, mm: the Euclidean distance to the air's
 * voxels at half their edge length; infinity beyond `reachMm` and 0 in that air. Distances to their
 * centres are too large by half a voxel below faces along the axes, distances to their faces too
 * small by nearly as much below the stairs of slanted ones; half way a ball's layer of 0.8 to 5 mm
 * is right to 0.1 mm for voxels of 0.4 to 0.8 mm. For anisotropic and oblique grids.
 *
 * The outer air is label 0 as far as it reaches the border of the volume from voxel to voxel
 * through faces; what lies outside the volume is not air, so a cut face has no depth. `held[label]`
 * (false beyond its end) is tissue at the body: air that touches only it counts as little.
 */
MAMMORAYFOUNDATION_EXPORT std::vector<float> DepthBelowAir(const LabelVolume& labels,
  double reachMm, const std::vector<bool>& held);

/**
 * The volume with a layer of label `skin`: every voxel that is neither air nor held and whose
 * centre lies at most `thicknessMm` below the outer air (see DepthBelowAir). Skin that is there
 * already counts as part of the layer. Throws InputError unless `skin` is a label of tissue that is
 * not held and the thickness at least the largest voxel spacing, so that the layer is closed.
 */
MAMMORAYFOUNDATION_EXPORT LabelVolume AddSkin(const LabelVolume& labels, double thicknessMm,
  int skin, const std::vector<bool>& held);
}

#endif
