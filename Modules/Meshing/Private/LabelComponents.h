// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelComponents_h
#define mammoray_LabelComponents_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammorayMeshingModule.h"

namespace mammoray
{
/// A connected piece (face neighbours) of one material, air included.
struct LabelComponent
{
  int Material = 0;
  std::size_t Voxels = 0;
  /// The voxel farthest from other materials, and its distance to them, mm.
  std::array<int, 3> Deepest{ 0, 0, 0 };
  double DepthMm = 0;
};

struct LabelComponents
{
  /// Component of every voxel.
  std::vector<std::uint32_t> OfVoxel;
  std::vector<LabelComponent> Components;
};

/// Components of a volume, in the order of their first voxels; depths are left out.
MAMMORAYMESHING_EXPORT LabelComponents FindComponents(const LabelVolume& volume);

/**
 * Gives every component below `smallestMm3` to the material it shares the most area with among
 * larger ones; the lowest wins a tie. Returns the number of voxels that changed.
 */
MAMMORAYMESHING_EXPORT std::size_t MergeSmallComponents(LabelVolume& volume, double smallestMm3);

/**
 * Distance of every voxel's centre to the nearest interface, mm, by chamfer steps over faces, edges
 * and corners (at most 8 % too long on cubic voxels).
 */
MAMMORAYMESHING_EXPORT std::vector<float> InterfaceDistance(const LabelVolume& volume);
}

#endif
