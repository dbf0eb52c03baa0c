// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelMesher_h
#define mammoray_LabelMesher_h

#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammoray/Meshing/MeshingOptions.h"
#include "mammorayMeshingModule.h"

#include <cmath>
#include <vector>

namespace mammoray
{
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
}

#endif
