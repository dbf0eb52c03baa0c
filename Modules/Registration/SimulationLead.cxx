// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/SimulationLead.h"

#ifdef MAMMORAY_HAS_MESHING
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/MeshVoxels.h"
#include "mammoray/Meshing/SimulationMesh.h"
#include "mammoray/Registration/BreastMechanics.h"
#endif

namespace mammoray
{
#ifdef MAMMORAY_HAS_MESHING
namespace
{
/// Up to so many linear cells a cold start takes some ten seconds on its own.
constexpr std::size_t MostCellsWithoutLead = 20000;
}

void LeadIfLarge(CompressionSimulation& simulation, const TetrahedralMesh& mesh,
  const ElasticTable& materials, const CompressionOptions& options,
  const ProgressCallback& progress)
{
  if (options.Element == ElementType::Quadratic || mesh.NumberOfCells() <= MostCellsWithoutLead)
  {
    return;
  }
  CompressionOptions leading = options;
  leading.Element = ElementType::Quadratic;
  try
  {
    const LabelVolume voxels = Voxelize(mesh, BreastMechanicsOptions::VoxelMm);
    const TetrahedralMesh coarse = MeshForSimulation(voxels, materials.Held, 0, progress).Mesh;
    simulation.SetPredictor(std::make_unique<CompressionSimulation>(
      coarse, materials.Elastic, materials.Held,
      [&voxels](const Vector3& point) { return static_cast<int>(voxels.LabelAt(point)); },
      leading));
  }
  catch (const InputError&)
  {
    // A body too small or too large for such voxels: it goes its way alone.
  }
}
#else
void LeadIfLarge(CompressionSimulation&, const TetrahedralMesh&, const ElasticTable&,
  const CompressionOptions&, const ProgressCallback&)
{
}
#endif
}
