// SPDX-License-Identifier: Apache-2.0
#include "Private/LabelComponents.h"

#include <algorithm>
#include <limits>

namespace mammoray
{
namespace
{
template <typename Visit>
void ForFaceNeighbours(const LabelVolume& volume, std::size_t voxel, Visit visit)
{
  const std::size_t step[3] = { 1, static_cast<std::size_t>(volume.Size[0]),
    static_cast<std::size_t>(volume.Size[0]) * volume.Size[1] };
  const std::size_t index[3] = { voxel % step[1], voxel / step[1] % volume.Size[1],
    voxel / step[2] };
  for (int a = 0; a < 3; ++a)
  {
    if (index[a] > 0)
    {
      visit(voxel - step[a], a);
    }
    if (index[a] + 1 < static_cast<std::size_t>(volume.Size[a]))
    {
      visit(voxel + step[a], a);
    }
  }
}
}

LabelComponents FindComponents(const LabelVolume& volume)
{
  constexpr auto none = std::numeric_limits<std::uint32_t>::max();
  LabelComponents found;
  found.OfVoxel.assign(volume.NumberOfVoxels(), none);
  std::vector<std::size_t> stack;
  for (std::size_t start = 0; start < volume.NumberOfVoxels(); ++start)
  {
    if (found.OfVoxel[start] != none)
    {
      continue;
    }
    const auto id = static_cast<std::uint32_t>(found.Components.size());
    LabelComponent component;
    component.Material = volume.Voxels[start];
    found.OfVoxel[start] = id;
    stack.push_back(start);
    while (!stack.empty())
    {
      const std::size_t voxel = stack.back();
      stack.pop_back();
      ++component.Voxels;
      ForFaceNeighbours(volume, voxel,
        [&](std::size_t neighbour, int)
        {
          if (found.OfVoxel[neighbour] == none && volume.Voxels[neighbour] == component.Material)
          {
            found.OfVoxel[neighbour] = id;
            stack.push_back(neighbour);
          }
        });
    }
    found.Components.push_back(component);
  }
  return found;
}

std::size_t MergeSmallComponents(LabelVolume& volume, double smallestMm3)
{
  const double areas[3] = { volume.Spacing[1] * volume.Spacing[2],
    volume.Spacing[0] * volume.Spacing[2], volume.Spacing[0] * volume.Spacing[1] };
  std::size_t merged = 0;
  // Small ones inside other small ones wait for the next round.
  for (bool changed = true; changed;)
  {
    changed = false;
    const LabelComponents found = FindComponents(volume);
    const auto isSmall = [&](std::uint32_t id)
    {
      // 1e-9: a component of exactly the limit is kept whatever the rounding of the voxel's volume.
      return static_cast<double>(found.Components[id].Voxels) * volume.VoxelVolume() <
        smallestMm3 * (1 - 1e-9);
    };
    std::map<std::uint32_t, std::map<int, double>> contacts;
    for (std::size_t voxel = 0; voxel < volume.NumberOfVoxels(); ++voxel)
    {
      const std::uint32_t id = found.OfVoxel[voxel];
      if (isSmall(id))
      {
        ForFaceNeighbours(volume, voxel,
          [&](std::size_t neighbour, int axis)
          {
            const std::uint32_t other = found.OfVoxel[neighbour];
            if (other != id && !isSmall(other))
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
      const auto place = target.find(found.OfVoxel[voxel]);
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
  const int nx = volume.Size[0];
  const int ny = volume.Size[1];
  const int nz = volume.Size[2];
  std::vector<float> distance(volume.NumberOfVoxels(), std::numeric_limits<float>::max());
  for (std::size_t voxel = 0; voxel < distance.size(); ++voxel)
  {
    ForFaceNeighbours(volume, voxel,
      [&](std::size_t neighbour, int axis)
      {
        if (volume.Voxels[neighbour] != volume.Voxels[voxel])
        {
          distance[voxel] =
            std::min(distance[voxel], static_cast<float>(0.5 * volume.Spacing[axis]));
        }
      });
  }
  // Two sweeps with half of the 26 neighbours each.
  const auto sweep = [&](bool forward)
  {
    for (int n = 0; n < nz; ++n)
    {
      const int k = forward ? n : nz - 1 - n;
      for (int m = 0; m < ny; ++m)
      {
        const int j = forward ? m : ny - 1 - m;
        for (int l = 0; l < nx; ++l)
        {
          const int i = forward ? l : nx - 1 - l;
          float& here = distance[volume.Index(i, j, k)];
          for (int dk = -1; dk <= 0; ++dk)
          {
            for (int dj = -1; dj <= (dk < 0 ? 1 : 0); ++dj)
            {
              for (int di = -1; di <= (dk < 0 || dj < 0 ? 1 : -1); ++di)
              {
                const int s = forward ? 1 : -1;
                const int ni = i + s * di;
                const int nj = j + s * dj;
                const int nk = k + s * dk;
                if (ni < 0 || nj < 0 || nk < 0 || ni >= nx || nj >= ny || nk >= nz)
                {
                  continue;
                }
                const std::size_t neighbour = volume.Index(ni, nj, nk);
                if (volume.Voxels[neighbour] == volume.Voxels[volume.Index(i, j, k)])
                {
                  const double step = Norm(
                    { di * volume.Spacing[0], dj * volume.Spacing[1], dk * volume.Spacing[2] });
                  here = std::min(here, distance[neighbour] + static_cast<float>(step));
                }
              }
            }
          }
        }
      }
    }
  };
  sweep(true);
  sweep(false);
  return distance;
}
}
