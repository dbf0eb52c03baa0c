// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SimulationMesh_h
#define mammoray_SimulationMesh_h

#include "mammoray/Meshing/LabelMesher.h"
#include "mammorayMeshingModule.h"

namespace mammoray
{
/**
 * Makes a coarse mesh of the tissue for a simulation that samples the materials itself
 * (CompressionSimulation with a material field). The mesh follows the skin and the border of the
 * fixed tissue, both smoothed at the size of its cells (Private/SimulationShape.h): folds, holes,
 * islands, steps of voxels and cuts by the field of view produce no cells. A layer of fixed tissue
 * one cell deep is kept. Cells have the most frequent fixed or the most frequent other material.
 * `cellSizeMm` is the upper bound of the circumradius of moving cells; 0 selects a size that gives
 * 3000 to 6000 cells. `materials` are indices, 0 = air; `fixed[m]` is true if m does not move.
 * VolumeInMm3 in the report of the moving material is the voxels' volume in front of the fixed
 * tissue's border. Throws InputError on a volume without moving tissue, an index beyond `fixed` or
 * an unusable size.
 */
MAMMORAYMESHING_EXPORT MeshingResult MeshForSimulation(const LabelVolume& materials,
  const std::vector<bool>& fixed, double cellSizeMm, const ProgressCallback& progress = {});
}

#endif
