// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SimulationLead_h
#define mammoray_SimulationLead_h

#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/ElasticTable.h"
#include "mammorayRegistrationModule.h"

namespace mammoray
{
/**
 * Gives the simulation of a mesh with more than 20000 linear cells a coarse quadratic one to lead
 * it (CompressionSimulation::SetPredictor), on a mesh made by MeshForSimulation of the large one's
 * voxels; nothing where there are fewer cells, where no such mesh can be made, or where the toolkit
 * was built without Meshing. Quadratic cells have their linear ones to lead them. `mesh`,
 * `materials`, `options`: those of the simulation.
 */
MAMMORAYREGISTRATION_EXPORT void LeadIfLarge(CompressionSimulation& simulation,
  const TetrahedralMesh& mesh, const ElasticTable& materials, const CompressionOptions& options,
  const ProgressCallback& progress = {});
}

#endif
