// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelMesher_h
#define mammoray_LabelMesher_h

#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammorayMeshingModule.h"

#include <cmath>
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
  /// Upper bound of the circumradius of surface Delaunay balls, mm; as the cells' where that is
  /// smaller.
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

/// Volume and quality of one material in the mesh.
struct MaterialReport
{
  int Material = 0;
  /// Volume of the voxels before small components were merged.
  double VolumeInMm3 = 0;
  /// Volume of the cells.
  double VolumeOutMm3 = 0;
  std::size_t Cells = 0;
  /// Smallest dihedral angle, degrees.
  double SmallestDihedralDeg = 0;
  /// Largest circumradius / shortest edge.
  double LargestRadiusEdgeRatio = 0;

  /// True if the volume is within 2 % of the voxels' volume, or within 5 % if that is below 1 cm^3.
  bool KeepsVolume() const
  {
    const double share = this->VolumeInMm3 < 1000 ? 0.05 : 0.02;
    return std::abs(this->VolumeOutMm3 - this->VolumeInMm3) <= share * this->VolumeInMm3;
  }
};

struct MeshingResult
{
  TetrahedralMesh Mesh;
  std::vector<MaterialReport> Reports;
  /// Number of voxels whose component was smaller than SmallestComponentMm3 and was merged.
  std::size_t MergedVoxels = 0;
  /// Number of face-connected components that were seeded; all of them are in the mesh.
  std::size_t Components = 0;
  /// True if CGAL's perturb or exude reached OptimisationSeconds.
  bool TimeLimitReached = false;
  double Seconds = 0;
};

/**
 * Meshes a volume of material indices (0 = air) with CGAL Mesh_3: one conforming mesh that keeps
 * the material of every cell. Every connected component of at least SmallestComponentMm3 is seeded
 * and must be in the result. The boundary of every material, and of all materials together, is a
 * closed surface that nowhere touches itself. Every material has the volume of its voxels, as far
 * as moving interfaces by at most half a voxel or half the facet distance achieves it. The result
 * is deterministic. Throws InputError on an empty volume or unusable options, and ConvergenceError
 * with material, position and volume if a component was lost.
 */
MAMMORAYMESHING_EXPORT MeshingResult MeshMaterials(const LabelVolume& materials,
  const MeshingOptions& options, const ProgressCallback& progress = {});

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
