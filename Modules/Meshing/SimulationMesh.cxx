// SPDX-License-Identifier: Apache-2.0
#include "SimulationMesh.h"

#include "Error.h"
#include "LabelResampling.h"

#include <algorithm>

namespace mammoray
{
MeshingResult MeshForSimulation(const LabelVolume& materials, const std::vector<bool>& held,
  double sizeMm, const ProgressCallback& progress)
{
  if (!(sizeMm > 0))
  {
    throw InputError("simulation mesh: expected a positive size");
  }
  const auto isHeld = [&](int material)
  { return static_cast<std::size_t>(material) < held.size() && held[material]; };
  int heldMaterial = 0;
  int softMaterial = 0;
  std::size_t largest = 0;
  for (const auto& [material, count] : materials.CountLabels())
  {
    if (material == 0)
    {
      continue;
    }
    if (isHeld(material))
    {
      heldMaterial = heldMaterial ? heldMaterial : material;
    }
    else if (count > largest)
    {
      largest = count;
      softMaterial = material;
    }
  }
  LabelVolume two = materials;
  for (std::uint16_t& voxel : two.Voxels)
  {
    voxel = static_cast<std::uint16_t>(voxel == 0 ? 0
        : isHeld(voxel)                           ? heldMaterial
                                                  : softMaterial);
  }
  // A tenth of the size is as fine as the mesh can see.
  const double finest = std::min({ two.Spacing[0], two.Spacing[1], two.Spacing[2] });
  if (finest < 0.1 * sizeMm)
  {
    two = ResampleLabels(two, 0.1 * sizeMm);
  }
  MeshingOptions options;
  options.FacetSizeMm = 0.95 * sizeMm;
  options.CellSizeMm = 1.1 * sizeMm;
  options.FacetDistanceMm = 0.1 * sizeMm;
  options.SmallestComponentMm3 = 0.25 * sizeMm * sizeMm * sizeMm;
  return MeshMaterials(two, options, progress);
}
}
