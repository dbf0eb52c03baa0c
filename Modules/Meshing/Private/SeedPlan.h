// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SeedPlan_h
#define mammoray_SeedPlan_h

#include "Private/LabelComponents.h"
#include "mammoray/Meshing/MeshingOptions.h"
#include "mammorayMeshingModule.h"

#include <cstddef>
#include <vector>

namespace mammoray
{
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

MAMMORAYMESHING_EXPORT SeedPlan PlanSeeds(const LabelVolume& volume, const MeshingOptions& options);
}

#endif
