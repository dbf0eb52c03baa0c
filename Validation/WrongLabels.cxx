// SPDX-License-Identifier: Apache-2.0
#include "WrongLabels.h"

#include "mammoray/Foundation/Vector3.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mammoray
{
double BreastVolume(const LabelVolume& materials, const std::vector<bool>& held)
{
  const auto count = std::count_if(materials.Voxels.begin(), materials.Voxels.end(),
    [&](std::uint16_t material) { return material != 0 && !held[material]; });
  return static_cast<double>(count) * materials.VoxelVolume();
}

LabelVolume Resized(LabelVolume materials, double factor)
{
  for (double& spacing : materials.Spacing)
  {
    spacing *= factor;
  }
  materials.Origin = factor * materials.Origin;
  return materials;
}

LabelVolume Mirrored(LabelVolume materials, const Vector3& axis)
{
  int along = 0;
  for (int index = 1; index < 3; ++index)
  {
    along = std::abs(Dot(materials.Direction[index], axis)) >
        std::abs(Dot(materials.Direction[along], axis))
      ? index
      : along;
  }
  const LabelVolume original = materials;
  original.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      int at[3] = { i, j, k };
      at[along] = original.Size[along] - 1 - at[along];
      materials.Voxels[voxel] = original.Voxels[original.Index(at[0], at[1], at[2])];
    });
  return materials;
}

LabelVolume WithoutQuarter(LabelVolume materials, const std::vector<bool>& held,
  const Vector3& axis)
{
  double least = std::numeric_limits<double>::infinity();
  double most = -least;
  const auto ofBreast = [&](std::size_t voxel)
  {
    const std::size_t material = materials.Voxels[voxel];
    return material != 0 && !held[material];
  };
  const auto forEachOfBreast = [&](const auto& visit)
  {
    materials.ForEachVoxel(
      [&](int i, int j, int k, std::size_t voxel)
      {
        if (ofBreast(voxel))
        {
          visit(voxel, Dot(materials.PointAt(i, j, k), axis));
        }
      });
  };
  forEachOfBreast(
    [&](std::size_t, double place)
    {
      least = std::min(least, place);
      most = std::max(most, place);
    });
  const double end = most - 0.25 * (most - least);
  forEachOfBreast(
    [&](std::size_t voxel, double place)
    {
      if (place > end)
      {
        materials.Voxels[voxel] = 0;
      }
    });
  return materials;
}
}
