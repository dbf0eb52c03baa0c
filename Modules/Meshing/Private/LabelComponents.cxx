// SPDX-License-Identifier: Apache-2.0
#include "Private/LabelComponents.h"

#include "mammoray/Foundation/Raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace mammoray
{
namespace
{
/// Calls visit(row, its first voxel) for all rows along i, forwards or backwards; row[0] is 0.
template <typename Visit>
void ForRows(const LabelVolume& volume, bool forward, Visit visit)
{
  const int rows = volume.Size[1] * volume.Size[2];
  for (int n = 0; n < rows; ++n)
  {
    const int row = forward ? n : rows - 1 - n;
    const int j = row % volume.Size[1];
    const int k = row / volume.Size[1];
    visit(std::array<int, 3>{ 0, j, k }, volume.Index(0, j, k));
  }
}

/// Lowers the distances in a row to those of the preceding neighbours plus a step, in a sweep
/// forwards (1) or backwards (-1).
void SpreadInto(const LabelVolume& volume, const std::array<int, 3>& row, int forth,
  std::vector<float>& distance)
{
  const int count = volume.Size[0];
  const auto stepTo = [&](int di, int dj, int dk)
  {
    return static_cast<float>(
      Norm({ di * volume.Spacing[0], dj * volume.Spacing[1], dk * volume.Spacing[2] }));
  };
  const std::size_t first = volume.Index(0, row[1], row[2]);
  float* here = &distance[first];
  const std::uint16_t* labels = &volume.Voxels[first];
  constexpr int before[4][2] = { { -1, 0 }, { -1, -1 }, { 0, -1 }, { 1, -1 } };
  for (const auto& [dj, dk] : before)
  {
    const int j = row[1] + forth * dj;
    const int k = row[2] + forth * dk;
    if (j < 0 || k < 0 || j >= volume.Size[1] || k >= volume.Size[2])
    {
      continue;
    }
    const float* there = &distance[volume.Index(0, j, k)];
    const std::uint16_t* theirLabels = &volume.Voxels[volume.Index(0, j, k)];
    for (const int di : { -1, 0, 1 })
    {
      const float step = stepTo(di, dj, dk);
      const int end = count - std::max(0, di);
      for (int i = std::max(0, -di); i < end; ++i)
      {
        const float way = std::min(here[i], there[i + di] + step);
        here[i] = labels[i] == theirLabels[i + di] ? way : here[i];
      }
    }
  }
  const float step = stepTo(1, 0, 0);
  for (int n = 1; n < count; ++n)
  {
    const int i = forth > 0 ? n : count - 1 - n;
    if (labels[i] == labels[i - forth])
    {
      here[i] = std::min(here[i], here[i - forth] + step);
    }
  }
}
}

LabelComponents FindComponents(const LabelVolume& volume)
{
  RasterPieces pieces = FindPieces(RasterShape(volume), volume.Voxels);
  LabelComponents found;
  for (std::size_t piece = 0; piece < pieces.First.size(); ++piece)
  {
    LabelComponent& component = found.Components.emplace_back();
    component.Material = volume.Voxels[pieces.First[piece]];
    component.Voxels = pieces.Size[piece];
  }
  found.OfVoxel = std::move(pieces.Of);
  return found;
}

std::size_t MergeSmallComponents(LabelVolume& volume, double smallestMm3)
{
  const double areas[3] = { volume.Spacing[1] * volume.Spacing[2],
    volume.Spacing[0] * volume.Spacing[2], volume.Spacing[0] * volume.Spacing[1] };
  std::size_t merged = 0;
  // Small components inside other small ones wait for the next round.
  for (bool changed = true; changed;)
  {
    changed = false;
    const LabelComponents found = FindComponents(volume);
    std::vector<char> isSmall;
    for (const LabelComponent& component : found.Components)
    {
      // 1e-9: a component of exactly the limit is kept whatever the rounding of the voxel's volume.
      isSmall.push_back(
        static_cast<double>(component.Voxels) * volume.VoxelVolume() < smallestMm3 * (1 - 1e-9));
    }
    std::map<std::uint32_t, std::map<int, double>> contacts;
    for (std::size_t voxel = 0; voxel < volume.NumberOfVoxels(); ++voxel)
    {
      const std::uint32_t id = found.OfVoxel[voxel];
      if (isSmall[id])
      {
        RasterShape(volume).ForEachNeighbour(voxel,
          [&](std::size_t neighbour, int axis)
          {
            const std::uint32_t other = found.OfVoxel[neighbour];
            if (other != id && !isSmall[other])
            {
              contacts[id][volume.Voxels[neighbour]] += areas[axis];
            }
          });
      }
    }
    std::map<std::uint32_t, std::uint16_t> target;
    for (const auto& [id, areaOf] : contacts)
    {
      const auto most = std::max_element(areaOf.begin(), areaOf.end(),
        [](const auto& a, const auto& b) { return a.second < b.second; });
      target[id] = static_cast<std::uint16_t>(most->first);
    }
    for (std::size_t voxel = 0; !target.empty() && voxel < volume.NumberOfVoxels(); ++voxel)
    {
      const std::uint32_t id = found.OfVoxel[voxel];
      const auto place = isSmall[id] ? target.find(id) : target.end();
      if (place != target.end())
      {
        volume.Voxels[voxel] = place->second;
        ++merged;
        changed = true;
      }
    }
  }
  return merged;
}

std::vector<float> InterfaceDistance(const LabelVolume& volume)
{
  constexpr float far = std::numeric_limits<float>::max();
  std::vector<float> distance(volume.NumberOfVoxels(), far);
  const std::size_t step[3] = { 1, static_cast<std::size_t>(volume.Size[0]),
    static_cast<std::size_t>(volume.Size[0]) * volume.Size[1] };
  const std::uint16_t* labels = volume.Voxels.data();
  ForRows(volume, true,
    [&](const std::array<int, 3>& row, std::size_t first)
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        if (axis > 0 && row[axis] == 0)
        {
          continue;
        }
        const auto half = static_cast<float>(0.5 * volume.Spacing[axis]);
        const std::size_t end = first + step[1];
        for (std::size_t voxel = first + (axis == 0 ? 1 : 0); voxel < end; ++voxel)
        {
          const float found = labels[voxel] != labels[voxel - step[axis]] ? half : far;
          distance[voxel] = std::min(distance[voxel], found);
          distance[voxel - step[axis]] = std::min(distance[voxel - step[axis]], found);
        }
      }
    });
  // Two sweeps with half of the 26 neighbours each.
  for (const bool forward : { true, false })
  {
    ForRows(volume, forward,
      [&](const std::array<int, 3>& row, std::size_t)
      { SpreadInto(volume, row, forward ? 1 : -1, distance); });
  }
  return distance;
}

SeedPlan PlanSeeds(const LabelVolume& volume, double facetSizeMm)
{
  SeedPlan plan;
  plan.Components = FindComponents(volume);
  plan.Distance = InterfaceDistance(volume);
  const std::size_t count = plan.Components.Components.size();
  plan.SeedVoxels.resize(count);
  // A small component can be long and thin, so one seed would not suffice; CGAL follows large ones.
  const double smallMm3 = 8 * std::pow(facetSizeMm, 3);
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
      const double apart = std::max<double>(facetSizeMm, 2 * plan.Distance[voxel]);
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
