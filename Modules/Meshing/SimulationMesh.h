// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SimulationMesh_h
#define mammoray_SimulationMesh_h

#include "LabelMesher.h"
#include "mammorayMeshingModule.h"

namespace mammoray
{
/**
 * A coarse mesh of the whole tissue for a simulation that samples the materials itself
 * (CompressionSimulation with a material field): it follows the skin and the border of the held
 * tissue only. Cells are of the first held material or of the commonest other one. `sizeMm`: about
 * the length of edges; 6 mm gives some 7,000 cells in a breast of a quarter of a litre. Throws
 * InputError on an empty volume or an unusable size.
 */
MAMMORAYMESHING_EXPORT MeshingResult MeshForSimulation(const LabelVolume& materials,
  const std::vector<bool>& held, double sizeMm, const ProgressCallback& progress = {});
}

#endif
