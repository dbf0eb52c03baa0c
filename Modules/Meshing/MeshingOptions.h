// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MeshingOptions_h
#define mammoray_MeshingOptions_h

#include "mammorayMeshingModule.h"

#include <cstddef>
#include <map>
#include <vector>

namespace mammoray
{
/// Options of a mesh. Sizes are upper bounds, which refinement satisfies. Meshing rejects sizes
/// whose cells or triangles would not fit in memory.
struct MAMMORAYMESHING_EXPORT MeshingOptions
{
  /// Upper bound of the circumradius of tetrahedra, mm.
  double CellSizeMm = 4.0;
  /// Cell sizes of single materials that differ from CellSizeMm (index -> mm).
  std::map<int, double> CellSizeOfMaterialMm;
  /// Upper bound of the circumradius of surface Delaunay balls, mm.
  double FacetSizeMm = 3.0;
  /// Facet sizes of single materials (index -> mm). The smaller value of the two sides of a facet
  /// applies.
  std::map<int, double> FacetSizeOfMaterialMm;
  /// Smallest facet size that closes thin layers, mm. Facets that skip a third material (fat to air
  /// through thin skin) are refined until the layer is closed or their size falls below this value.
  /// 0 leaves such gaps.
  double LayerFacetSizeMm = 0.0;
  /// Upper bound of the distance between interface and mesh facet, mm.
  double FacetDistanceMm = 0.4;
  /// Facet distances of single materials (index -> mm), as for facet sizes.
  std::map<int, double> FacetDistanceOfMaterialMm;
  /// Lower bound of facet angles, degrees, at most 30.
  double FacetAngleDeg = 25.0;
  /// Upper bound of circumradius / shortest edge.
  double CellRadiusEdgeRatio = 3.0;
  /// Connected components below this volume, mm^3, are merged into the surrounding material.
  double SmallestComponentMm3 = 5.0;
  /// Standard deviation of the Gaussian that smooths the steps of the voxels, in voxels; 0 leaves
  /// them. Smoothed interfaces keep the centre of every voxel in its own material.
  double SmoothingVoxels = 1.0;
  /// Slivers are improved until no dihedral angle is within this value of 0 or 180 degrees, if that
  /// can be reached; 0 leaves them.
  double SmallestDihedralDeg = 12.0;
  /// Time limit of each step of CGAL's own optimisation (perturb, exude), s; 0 skips both. If a
  /// step reaches its limit, the result depends on the machine (MeshingResult::TimeLimitReached).
  double OptimisationSeconds = 60.0;
  /// Number of interface triangles to produce, within 10 %; 0 uses the sizes as they are. All sizes
  /// and distances of facets are scaled by one factor, and cell sizes too where they grow. Rejected
  /// if triangles would be smaller than a sixteenth of a voxel's face or would not fit in memory.
  std::size_t Triangles = 0;

  /// Options for pictures: fine at the skin and without optimisation. `thinMaterials` are layers of
  /// about a millimetre.
  static MeshingOptions Anatomy(const std::vector<int>& thinMaterials);

  /// Throws InputError with the first value that is out of range.
  void Validate() const;
};
}

#endif
