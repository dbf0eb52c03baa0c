// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MeshingOptions_h
#define mammoray_MeshingOptions_h

#include "mammorayMeshingModule.h"

#include <cstddef>
#include <map>
#include <vector>

namespace mammoray
{
/// What is asked of the mesh. Sizes are upper bounds that refinement keeps; meshing refuses those
/// that give more cells or triangles than fit in the memory.
struct MAMMORAYMESHING_EXPORT MeshingOptions
{
  /// Upper bound of the circumradius of tetrahedra, mm.
  double CellSizeMm = 4.0;
  /// The same for single materials (index -> mm), where it differs.
  std::map<int, double> CellSizeOfMaterialMm;
  /// Upper bound of the circumradius of surface Delaunay balls, mm.
  double FacetSizeMm = 3.0;
  /// The same for facets that bound single materials (index -> mm); the smaller of the two sides
  /// counts.
  std::map<int, double> FacetSizeOfMaterialMm;
  /**
   * Facets that step over a layer of a third material (fat to air through thin skin) are refined
   * until the layer is closed or their size falls below this, mm. 0 leaves such gaps.
   */
  double LayerFacetSizeMm = 0.0;
  /// Upper bound of the distance between interface and mesh facet, mm.
  double FacetDistanceMm = 0.4;
  /// The same for interfaces of single materials (index -> mm), as with facet sizes.
  std::map<int, double> FacetDistanceOfMaterialMm;
  /// Lower bound of facet angles, degrees, at most 30.
  double FacetAngleDeg = 25.0;
  /// Upper bound of circumradius / shortest edge.
  double CellRadiusEdgeRatio = 3.0;
  /// Connected components of a material smaller than this are merged into what surrounds them,
  /// mm^3.
  double SmallestComponentMm3 = 5.0;
  /**
   * Width (standard deviation) of the smoothing of the voxels' stairs, in voxels; 0 leaves them.
   * The smoothed interfaces keep every voxel's centre in its own material.
   */
  double SmoothingVoxels = 1.0;
  /**
   * Slivers are mended until no dihedral angle is within this of 0 or 180 degrees, where that can
   * be reached; 0 leaves them.
   */
  double SmallestDihedralDeg = 12.0;
  /**
   * Time limit of each step of CGAL's own optimisation (perturb, exude) before that, s; 0 leaves
   * both out. A step that meets its limit makes the result depend on the machine:
   * MeshingResult::TimeLimitReached tells.
   */
  double OptimisationSeconds = 60.0;
  /**
   * Number of interface triangles to end with, within 10 %: all sizes and distances of facets are
   * scaled alike until that is reached, and cell sizes with them where they grow. 0 takes the sizes
   * as they are. Refused where triangles would be smaller than a sixteenth of a voxel's face, or
   * not fit in the memory.
   */
  std::size_t Triangles = 0;

  /// What pictures need: fine at the skin, no optimisation. `thinMaterials` are layers of about a
  /// millimetre.
  static MeshingOptions Anatomy(const std::vector<int>& thinMaterials);

  /// Throws InputError that names the first value out of range.
  void Validate() const;
};
}

#endif
