// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SurfaceMesher_h
#define mammoray_SurfaceMesher_h

#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Meshing/LabelMesher.h"

namespace mammoray
{
/// True if this build includes TetGen (CMake's MAMMORAY_USE_TETGEN); otherwise the functions below
/// throw InputError.
MAMMORAYMESHING_EXPORT bool HasTetGen();

/**
 * Fills closed surfaces with tetrahedra that keep them, by TetGen. The boundary of every material
 * must be closed. Materials may be nested as separate shells (space inside several shells belongs
 * to the one that encloses least), share interfaces with a material on each side, or touch in
 * triangles with the same corners (points at the same position are merged). Space outside all
 * materials stays empty.
 *
 * These options apply: the cell sizes (as the volume of a regular tetrahedron of that circumradius,
 * which the final optimisation may exceed slightly), CellRadiusEdgeRatio (at least 2, reached where
 * the surface allows it) and SmallestDihedralDeg (at most 18, a goal; ignored if
 * OptimisationSeconds is 0). Facets are those of the surface, subdivided; parts that are flat to
 * 0.1 degrees are triangulated again. VolumeInMm3 of the reports is the volume that the surfaces
 * enclose.
 *
 * Throws InputError on open surfaces (with places), on surfaces that intersect each other, and on
 * unusable options. The callback can stop the refinement, not the steps before it.
 */
MAMMORAYMESHING_EXPORT MeshingResult MeshSurfaces(const SurfaceMesh& surfaces,
  const MeshingOptions& options, const ProgressCallback& progress = {});

/**
 * The second method from a volume of materials (0 = air) to tetrahedra, as in iso2mesh (Fang and
 * Boas, ISBI 2009). The interfaces are extracted as closed surfaces with the sizes of MeshMaterials
 * and filled by TetGen together with the surrounding air. The mesh is then improved once more,
 * which may move interfaces as far as in MeshMaterials. Components are merged, reported and checked
 * in the same way.
 */
MAMMORAYMESHING_EXPORT MeshingResult MeshMaterialSurfaces(const LabelVolume& materials,
  const MeshingOptions& options, const ProgressCallback& progress = {});
}

#endif
