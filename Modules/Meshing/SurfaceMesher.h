// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SurfaceMesher_h
#define mammoray_SurfaceMesher_h

#include "mammoray/Foundation/SurfaceMesh.h"
#include "mammoray/Meshing/LabelMesher.h"

namespace mammoray
{
/// Whether this build has TetGen (CMake's MAMMORAY_USE_TETGEN); without it the functions below
/// throw InputError.
MAMMORAYMESHING_EXPORT bool HasTetGen();

/**
 * Fills closed surfaces with tetrahedra that keep them, by TetGen. The boundary of every material
 * is closed; materials may be nested as shells of their own (the inside of a shell within another
 * belongs to the one that encloses less), share interfaces with a material on each side, or touch
 * where their triangles have the same corners (points at the same place are one).
 * What lies in no material stays empty.
 *
 * These options count: the cell sizes (as the volume of a regular tetrahedron of that circumradius,
 * which the last optimisation may exceed by a fraction), CellRadiusEdgeRatio (at least 2 is kept
 * where the surface allows) and SmallestDihedralDeg (at most 18, a goal; left out with
 * OptimisationSeconds 0); facets are those of the surface, divided further, and parts of it
 * that are flat (to 0.1 degrees) are triangulated anew. VolumeInMm3 of the reports is what the
 * surfaces enclose.
 *
 * Throws InputError on open surfaces (with places), on ones that cut each other, and on unusable
 * options. The callback can stop the refinement, not the steps before it.
 */
MAMMORAYMESHING_EXPORT MeshingResult MeshSurfaces(const SurfaceMesh& surfaces,
  const MeshingOptions& options, const ProgressCallback& progress = {});

/**
 * The second way from a volume of materials (0 = air) to tetrahedra, that of iso2mesh (Fang and
 * Boas, ISBI 2009): the interfaces as closed surfaces of the sizes asked for, which are those of
 * MeshMaterials, filled by TetGen together with the air around and mended once more, by which
 * interfaces may move as far as there again. Components are merged, reported and guarded as there.
 */
MAMMORAYMESHING_EXPORT MeshingResult MeshMaterialSurfaces(const LabelVolume& materials,
  const MeshingOptions& options, const ProgressCallback& progress = {});
}

#endif
