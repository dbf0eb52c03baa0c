// SPDX-License-Identifier: Apache-2.0
#include "Private/SeedPlan.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mammoray
{
SeedPlan PlanSeeds(const LabelVolume& volume, const MeshingOptions& options)
{
  SeedPlan plan;
  plan.Components = FindComponents(volume);
  plan.Distance = InterfaceDistance(volume);
  const std::size_t count = plan.Components.Components.size();
  plan.SeedVoxels.resize(count);
  // A small component can be long and thin, so one seed would not suffice; CGAL follows large ones.
  const double smallMm3 = 8 * std::pow(options.FacetSizeMm, 3);
  std::vector<std::vector<std::size_t>> members(count);
  std::vector<std::size_t> deepest(count, 0);
  std::vector<float> depth(count, -1);
  for (std::size_t voxel = 0; voxel < volume.NumberOfVoxels(); ++voxel)
  {
    const std::uint32_t id = plan.Components.OfVoxel[voxel];
    const double volumeMm3 =
      static_cast<double>(plan.Components.Components[id].Voxels) * volume.VoxelVolume();
    if (volumeMm3 < smallMm3)
    {
      members[id].push_back(voxel);
    }
    if (plan.Distance[voxel] > depth[id])
    {
      depth[id] = plan.Distance[voxel];
      deepest[id] = voxel;
    }
  }
  const auto indexOf = [&](std::size_t voxel)
  {
    const std::size_t row = volume.Size[0];
    const std::size_t slice = row * volume.Size[1];
    return std::array<int, 3>{ static_cast<int>(voxel % row),
      static_cast<int>(voxel / row % volume.Size[1]), static_cast<int>(voxel / slice) };
  };
  for (std::size_t id = 0; id < count; ++id)
  {
    plan.Components.Components[id].Deepest = indexOf(deepest[id]);
    plan.Components.Components[id].DepthMm = depth[id];
    plan.SeedVoxels[id].push_back(deepest[id]);
    std::stable_sort(members[id].begin(), members[id].end(),
      [&](std::size_t a, std::size_t b) { return plan.Distance[a] > plan.Distance[b]; });
    for (const std::size_t voxel : members[id])
    {
      const std::array<int, 3> index = indexOf(voxel);
      const double apart = std::max<double>(options.FacetSizeMm, 2 * plan.Distance[voxel]);
      const bool isNew = std::all_of(plan.SeedVoxels[id].begin(), plan.SeedVoxels[id].end(),
        [&](std::size_t other)
        {
          const std::array<int, 3> otherIndex = indexOf(other);
          return Norm({ (index[0] - otherIndex[0]) * volume.Spacing[0],
                   (index[1] - otherIndex[1]) * volume.Spacing[1],
                   (index[2] - otherIndex[2]) * volume.Spacing[2] }) >= apart;
        });
      if (isNew)
      {
        plan.SeedVoxels[id].push_back(voxel);
      }
    }
  }
  return plan;
}
}
