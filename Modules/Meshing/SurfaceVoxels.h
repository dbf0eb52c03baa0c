// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SurfaceVoxels_h
#define mammoray_SurfaceVoxels_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/SurfaceMesh.h"
#include "mammorayMeshingModule.h"

namespace mammoray
{
/**
 * Labels a grid of cubic voxels of `voxelMm` by the materials that closed surfaces enclose: a way
 * to mesh surfaces that MeshSurfaces refuses because they cut each other. A voxel belongs to the
 * materials whose boundaries wind around its centre at least once, so that pieces that overlap
 * become one; of several materials to the one that encloses least. The grid's axes are x, y, z; it
 * has a margin of one voxel of air.
 *
 * Throws InputError on open surfaces (with places), on a size that is not positive, and on one that
 * asks for more than 10^9 voxels.
 */
MAMMORAYMESHING_EXPORT LabelVolume LabelSurfaces(const SurfaceMesh& surfaces, double voxelMm,
  const ProgressCallback& progress = {});
}

#endif
