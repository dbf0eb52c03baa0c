// SPDX-License-Identifier: Apache-2.0
#include "WrongLabels.h"

#include "mammoray/Foundation/Vector3.h"

#include <algorithm>
#include <array>

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
  const std::size_t along = materials.AxisAlong(axis);
  const LabelVolume original = materials;
  original.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      std::array<int, 3> at{ i, j, k };
      at[along] = original.Size[along] - 1 - at[along];
      materials.Voxels[voxel] = original.Voxels[original.Index(at[0], at[1], at[2])];
    });
  return materials;
}

LabelVolume WithoutQuarter(LabelVolume materials, const std::vector<bool>& held,
  const Vector3& axis)
{
  Extent extent;
  const auto forEachOfBreast = [&](const auto& visit)
  {
    materials.ForEachVoxel(
      [&](int i, int j, int k, std::size_t voxel)
      {
        const std::size_t material = materials.Voxels[voxel];
        if (material != 0 && !held[material])
        {
          visit(voxel, Dot(materials.PointAt(i, j, k), axis));
        }
      });
  };
  forEachOfBreast([&](std::size_t, double place) { extent.Add(place); });
  const double end = extent.High - 0.25 * extent.Length();
  forEachOfBreast([&](std::size_t voxel, double place)
    { materials.Voxels[voxel] = place > end ? std::uint16_t{ 0 } : materials.Voxels[voxel]; });
  return materials;
}
}
