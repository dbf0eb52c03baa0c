// SPDX-License-Identifier: Apache-2.0
#include "Private/MeshingSteps.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/ParallelFor.h"
#include "mammoray/Foundation/TriangleTree.h"
#include "mammoray/Meshing/SurfaceMesher.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace mammoray
{
namespace
{
LabelVolume MakeGrid(const SurfaceMesh& surfaces, double voxelMm)
{
  LabelVolume volume;
  volume.Spacing = { voxelMm, voxelMm, voxelMm };
  double voxels = 1;
  double size[3];
  for (std::size_t a = 0; a < 3; ++a)
  {
    double low = std::numeric_limits<double>::max();
    double high = -low;
    for (std::size_t at = a; at < surfaces.Points.size(); at += 3)
    {
      low = std::min(low, surfaces.Points[at]);
      high = std::max(high, surfaces.Points[at]);
    }
    volume.Origin[a] = low - 0.5 * voxelMm;
    size[a] = std::ceil((high - low) / voxelMm) + 2;
    voxels *= size[a];
  }
  if (!(voxels <= 1e9))
  {
    char text[120];
    std::snprintf(text, sizeof(text),
      "surfaces: expected voxels of a size that makes 1e9 at most, found %g mm, which makes %.2g",
      voxelMm, voxels);
    throw InputError(text);
  }
  std::transform(size, size + 3, volume.Size.begin(),
    [](double count) { return static_cast<int>(count); });
  volume.Voxels.assign(static_cast<std::size_t>(voxels), 0);
  return volume;
}

/// Assigns the material to the voxels of a row along x around which its boundary has a winding
/// number of at least 1. `hits` are the surface's along the row from +x to -x; T = -x.
void FillRow(const SurfaceMesh& surfaces, const std::vector<LineHit>& hits, int material,
  const LabelVolume& grid, std::uint16_t* row)
{
  const auto voxel = [&](const LineHit& hit)
  { return static_cast<int>(std::ceil((-hit.T - grid.Origin[0]) / grid.Spacing[0])); };
  int winding = 0;
  for (std::size_t n = 0; n + 1 < hits.size(); ++n)
  {
    const auto [before, behind] = MaterialsAt(surfaces, hits[n]);
    winding += (behind == material) - (before == material);
    if (winding > 0)
    {
      std::fill(row + voxel(hits[n + 1]), row + voxel(hits[n]),
        static_cast<std::uint16_t>(material));
    }
  }
}
}

LabelVolume LabelSurfaces(const SurfaceMesh& surfaces, double voxelMm,
  const ProgressCallback& progress)
{
  if (!(voxelMm > 0) || !std::isfinite(voxelMm))
  {
    throw InputError(
      "surfaces: expected voxels of a positive number of mm, found " + std::to_string(voxelMm));
  }
  constexpr const char* stage = "labelling voxels";
  ReportProgress(progress, 0.0, stage);
  std::vector<MaterialQuality> materials = CheckClosed(surfaces).Materials;
  std::stable_sort(materials.begin(), materials.end(),
    [](const auto& a, const auto& b) { return a.VolumeMm3 > b.VolumeMm3; });
  LabelVolume grid = MakeGrid(surfaces, voxelMm);
  const TriangleTree tree(surfaces);
  for (int k = 0; k < grid.Size[2]; ++k)
  {
    ReportProgress(progress, (k + 1.0) / (grid.Size[2] + 1.0), stage);
    ParallelFor(static_cast<std::size_t>(grid.Size[1]),
      [&](std::size_t j)
      {
        std::vector<LineHit> hits;
        tree.CrossLine({ 0, grid.Origin[1] + static_cast<double>(j) * grid.Spacing[1],
                         grid.Origin[2] + k * grid.Spacing[2] },
          { -1, 0, 0 }, hits);
        for (const MaterialQuality& material : materials)
        {
          FillRow(surfaces, hits, material.Material, grid,
            &grid.Voxels[grid.Index(0, static_cast<int>(j), k)]);
        }
      });
  }
  return grid;
}
}
