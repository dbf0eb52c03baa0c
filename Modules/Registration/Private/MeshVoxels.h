// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MeshVoxels_h
#define mammoray_MeshVoxels_h

#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammorayRegistrationModule.h"

namespace mammoray
{
/**
 * The volume of material indices that a mesh fills: every voxel has the material of the cell that
 * holds its centre, 0 outside. Axes are those of the mesh's frame; a border of one voxel of air
 * lies around it. `spacingMm`: positive. Throws InputError on another spacing, on a mesh without
 * cells and where the volume would have more than 2^31 voxels.
 */
MAMMORAYREGISTRATION_EXPORT LabelVolume Voxelize(const TetrahedralMesh& mesh, double spacingMm);
}

#endif
