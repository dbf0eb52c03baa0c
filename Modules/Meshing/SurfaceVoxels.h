// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SurfaceVoxels_h
#define mammoray_SurfaceVoxels_h

#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammorayMeshingModule.h"

namespace mammoray
{
/**
 * Labels a grid of cubic voxels of `voxelMm` by the materials that closed surfaces enclose. Use it
 * to mesh surfaces that MeshSurfaces rejects because they intersect each other. A voxel belongs to
 * the materials whose boundaries have a winding number of at least 1 around its centre, so
 * overlapping pieces are united; if there are several, to the one that encloses least. The grid's
 * axes are x, y and z, with a margin of one voxel of air.
 *
 * Throws InputError on open surfaces (with places), on a size that is not positive, and on a size
 * that needs more than 10^9 voxels.
 */
MAMMORAYMESHING_EXPORT LabelVolume LabelSurfaces(const SurfaceMesh& surfaces, double voxelMm,
  const ProgressCallback& progress = {});
}

#endif
