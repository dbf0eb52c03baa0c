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
/// The components of a volume, tissue and enclosed air, and where points of a mesh are seeded from.
struct SeedPlan
{
  /// With their depths.
  LabelComponents Found;
  /// Voxels of each component to seed from, the deepest first: one for a component that a mesher
  /// follows by itself, several for small ones, which may be long and thin.
  std::vector<std::vector<std::size_t>> SeedVoxels;
  /// Distance of every voxel to other materials, mm.
  std::vector<float> Distance;
};

MAMMORAYMESHING_EXPORT SeedPlan PlanSeeds(const LabelVolume& volume, const MeshingOptions& options);
}

#endif
