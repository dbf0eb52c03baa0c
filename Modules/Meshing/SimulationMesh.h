// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SimulationMesh_h
#define mammoray_SimulationMesh_h

#include "mammoray/Meshing/LabelMesher.h"
#include "mammorayMeshingModule.h"

namespace mammoray
{
/**
 * A coarse mesh of the tissue for a simulation that samples the materials itself
 * (CompressionSimulation with a material field). It follows the skin and the border of the held
 * tissue, both smoothed at the size of its cells (Private/SimulationShape.h): folds, holes, islands
 * and streaks of other tissue, stairs and a cut by the field of view make no cells. Of the held
 * tissue a layer one cell deep is left. Cells are of the commonest held or of the commonest other
 * material. `cellSizeMm`: upper bound of the circumradius of cells that move; 0: as large as gives
 * 3000 to 6000 cells. `materials`: indices, 0 = air; `held[m]` tells whether m does not move. In
 * the reports VolumeInMm3 is, of what moves, the voxels' volume in front of the held tissue's
 * border. Throws InputError on a volume without tissue that moves, an index beyond `held` or an
 * unusable size.
 */
MAMMORAYMESHING_EXPORT MeshingResult MeshForSimulation(const LabelVolume& materials,
  const std::vector<bool>& held, double cellSizeMm, const ProgressCallback& progress = {});
}

#endif
