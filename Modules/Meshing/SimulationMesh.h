// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SimulationMesh_h
#define mammoray_SimulationMesh_h

#include "mammoray/Meshing/LabelMesher.h"
#include "mammorayMeshingModule.h"

namespace mammoray
{
/**
 * A coarse mesh of the whole tissue for a simulation that samples the materials itself
 * (CompressionSimulation with a material field): it follows the skin and the border of the held
 * tissue only, and its slivers are removed. Cells are of the commonest held or of the commonest
 * other material. `cellSizeMm`: upper bound of the circumradius; 0 takes a seventh of the cube root
 * of the volume, which gives 3000 to 4000 cells. `materials`: indices, 0 = air; `held[m]` tells
 * whether m does not move. Throws InputError on an empty volume, an index beyond `held` or an
 * unusable size.
 */
MAMMORAYMESHING_EXPORT MeshingResult MeshForSimulation(const LabelVolume& materials,
  const std::vector<bool>& held, double cellSizeMm, const ProgressCallback& progress = {});
}

#endif
