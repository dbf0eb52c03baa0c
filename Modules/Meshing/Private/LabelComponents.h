// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelComponents_h
#define mammoray_LabelComponents_h

#include "mammoray/Foundation/Volumes.h"
#include "mammorayMeshingModule.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace mammoray
{
/// A face-connected component of one material, or of air.
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
  /// Index of the component of every voxel.
  std::vector<std::uint32_t> OfVoxel;
  std::vector<LabelComponent> Components;
};

/// Finds the components of a volume, in the order of their first voxels. Deepest and DepthMm are
/// not set.
MAMMORAYMESHING_EXPORT LabelComponents FindComponents(const LabelVolume& volume);

/// Gives every component below `smallestMm3` to the material with which it shares the largest area
/// among larger components; the lowest material wins a tie. Returns the number of voxels that
/// changed.
MAMMORAYMESHING_EXPORT std::size_t MergeSmallComponents(LabelVolume& volume, double smallestMm3);

/// Distance of every voxel's centre to the nearest interface, mm, by chamfer steps over faces,
/// edges and corners (at most 8 % too long on cubic voxels).
MAMMORAYMESHING_EXPORT std::vector<float> InterfaceDistance(const LabelVolume& volume);

/// The components of a volume (tissue and enclosed air) and the voxels from which mesh points are
/// seeded.
struct SeedPlan
{
  /// Components with their depths.
  LabelComponents Components;
  /// Voxels from which each component is seeded, the deepest first: one for a component that the
  /// mesher follows by itself, several for small components, which can be long and thin.
  std::vector<std::vector<std::size_t>> SeedVoxels;
  /// Distance of every voxel to other materials, mm.
  std::vector<float> Distance;
};

/// `facetSizeMm` is that of the mesh: components below eight of its cubes count as small.
MAMMORAYMESHING_EXPORT SeedPlan PlanSeeds(const LabelVolume& volume, double facetSizeMm);
}

#endif
