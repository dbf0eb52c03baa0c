// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SurfaceMesher_h
#define mammoray_SurfaceMesher_h

#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Meshing/LabelMesher.h"

#include <optional>

namespace mammoray
{
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
 * Throws InputError on open surfaces and on surfaces that intersect each other (with places), on
 * unusable options, and in a build without TetGen (MAMMORAY_USE_TETGEN). The callback can stop the
 * refinement, not the steps before it.
 */
MAMMORAYMESHING_EXPORT MeshingResult MeshSurfaces(const SurfaceMesh& surfaces,
  const MeshingOptions& options, const ProgressCallback& progress = {});

/**
 * The second method from a volume of materials (0 = air) to tetrahedra, as in iso2mesh (Fang and
 * Boas, ISBI 2009). The interfaces are extracted as closed surfaces with the sizes of MeshMaterials
 * and filled by TetGen together with the surrounding air. The mesh is then improved once more,
 * which may move interfaces as far as in MeshMaterials. Components are merged, reported and checked
 * in the same way. Throws InputError in a build without TetGen, otherwise as MeshMaterials.
 */
MAMMORAYMESHING_EXPORT MeshingResult MeshMaterialSurfaces(const LabelVolume& materials,
  const MeshingOptions& options, const ProgressCallback& progress = {});

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

/// A surface of one material in air after RepairSurface, and what was changed.
struct RepairedSurface
{
  SurfaceMesh Surface;
  /// Points that became one with another.
  std::size_t WeldedPoints = 0;
  /// Triangles that were left out: without area, and there twice in either sense.
  std::size_t FlatTriangles = 0;
  std::size_t DoubledTriangles = 0;
  /// Triangles that were turned.
  std::size_t TurnedTriangles = 0;
  std::size_t ClosedHoles = 0;
  /// Holes with longer borders.
  std::size_t OpenHoles = 0;
};

/**
 * Makes a closed surface of triangles of one material, as far as it can be: welds points within a
 * distance (default: 1e-7 of the surface's extent), leaves out triangles that are flat or there
 * twice, turns the others alike and outwards (inwards around hollows), and closes holes whose
 * border is at most as long as that (default: a tenth of the extent), by CGAL's
 * Polygon_mesh_processing. Parts that cross each other stay as they are; all point outwards then.
 * Throws InputError on a surface of several materials.
 */
MAMMORAYMESHING_EXPORT RepairedSurface RepairSurface(const SurfaceMesh& surface,
  const std::optional<double>& weldMm = {}, const std::optional<double>& longestHoleMm = {});
}

#endif
