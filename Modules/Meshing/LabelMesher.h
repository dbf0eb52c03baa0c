// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelMesher_h
#define mammoray_LabelMesher_h

#include "LabelVolume.h"
#include "Progress.h"
#include "TetrahedralMesh.h"
#include "mammorayMeshingModule.h"

#include <map>
#include <string>
#include <vector>

namespace mammoray
{
struct MeshingOptions
{
  /// Upper bound of the circumradius of tetrahedra, mm.
  double CellSizeMm = 4.0;
  /// The same for single materials (index -> mm), where it differs.
  std::map<int, double> CellSizeOfMaterialMm;
  /// Upper bound of the circumradius of surface Delaunay balls, mm.
  double FacetSizeMm = 3.0;
  /// Upper bound of the distance between interface and mesh facet, mm.
  double FacetDistanceMm = 0.4;
  /// Lower bound of facet angles, degrees, at most 30.
  double FacetAngleDeg = 25.0;
  /// Upper bound of circumradius / shortest edge.
  double CellRadiusEdgeRatio = 3.0;
  /// Connected components of a material smaller than this are merged into what surrounds them, mm^3.
  double SmallestComponentMm3 = 5.0;
  /// Time limit of each optimisation step (perturb, exude), s; 0 leaves it out.
  double OptimisationSeconds = 10.0;
};

/// What became of one material.
struct MaterialReport
{
  int Material = 0;
  double VolumeInMm3 = 0;
  double VolumeOutMm3 = 0;
  std::size_t Cells = 0;
  /// Smallest dihedral angle, degrees.
  double SmallestDihedralDeg = 0;
  /// Largest circumradius / shortest edge.
  double LargestRadiusEdgeRatio = 0;
};

struct MeshingResult
{
  TetrahedralMesh Mesh;
  std::vector<MaterialReport> Reports;
  /// Voxels whose component was below SmallestComponentMm3 and was merged.
  std::size_t MergedVoxels = 0;
  double Seconds = 0;
};

/**
 * Meshes a volume of material indices (0 = air) with CGAL Mesh_3: one conforming mesh, the material of
 * every cell kept. Every connected component of a material of at least SmallestComponentMm3 is seeded
 * and must be in the result. Deterministic. Throws InputError on an empty volume or unusable options and
 * ConvergenceError, naming the material, place and volume, when one was lost.
 */
MAMMORAYMESHING_EXPORT MeshingResult MeshMaterials(const LabelVolume& materials,
  const MeshingOptions& options, const ProgressCallback& progress = {});
}

#endif
