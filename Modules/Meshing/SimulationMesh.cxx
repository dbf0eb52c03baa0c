// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Meshing/SimulationMesh.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/LabelResampling.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
// At 1 mm the mesher's sliver removal reaches its bound more often than on finer stairs.
constexpr double FinestSpacingMm = 1.0;

/// Held tissue and all other tissue, each under the index of its commonest material.
LabelVolume TissueAndHeld(const LabelVolume& materials, const std::vector<bool>& held)
{
  int commonest[2] = { 0, 0 };
  std::size_t counts[2] = { 0, 0 };
  for (const auto& [material, count] : materials.CountLabels())
  {
    if (static_cast<std::size_t>(material) >= held.size())
    {
      throw InputError("simulation mesh: expected materials 0 to " +
        std::to_string(held.size() - 1) + ", found " + std::to_string(material));
    }
    const int side = held[material] ? 1 : 0;
    if (material != 0 && count > counts[side])
    {
      commonest[side] = material;
      counts[side] = count;
    }
  }
  LabelVolume merged = materials;
  for (std::uint16_t& voxel : merged.Voxels)
  {
    voxel = voxel == 0 ? 0 : static_cast<std::uint16_t>(commonest[held[voxel] ? 1 : 0]);
  }
  return merged;
}
}

MeshingResult MeshForSimulation(const LabelVolume& materials, const std::vector<bool>& held,
  double cellSizeMm, const ProgressCallback& progress)
{
  if (!(cellSizeMm >= 0))
  {
    throw InputError("simulation mesh: expected a cell size of at least 0 mm, found " +
      std::to_string(cellSizeMm));
  }
  LabelVolume tissue = TissueAndHeld(materials, held);
  const auto voxels = static_cast<double>(tissue.Voxels.size() -
    static_cast<std::size_t>(std::count(tissue.Voxels.begin(), tissue.Voxels.end(), 0)));
  MeshingOptions options;
  options.CellSizeMm = cellSizeMm > 0 ? cellSizeMm : std::cbrt(voxels * tissue.VoxelVolume()) / 7;
  options.FacetSizeMm = std::max(8.0, options.CellSizeMm);
  options.FacetDistanceMm = 1.0;
  options.CellRadiusEdgeRatio = 2.0;
  options.SmallestComponentMm3 = 500.0;
  if (*std::max_element(tissue.Spacing.begin(), tissue.Spacing.end()) < FinestSpacingMm)
  {
    tissue = ResampleLabels(tissue, FinestSpacingMm);
  }
  return MeshMaterials(tissue, options, progress);
}
}
