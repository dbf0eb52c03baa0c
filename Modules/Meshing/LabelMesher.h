// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelMesher_h
#define mammoray_LabelMesher_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/TetrahedralMesh.h"
#include "mammoray/Meshing/MeshingOptions.h"
#include "mammorayMeshingModule.h"

#include <cmath>
#include <vector>

namespace mammoray
{
/// What became of one material.
struct MaterialReport
{
  int Material = 0;
  /// What the voxels have, before small components were merged.
  double VolumeInMm3 = 0;
  /// What the cells have.
  double VolumeOutMm3 = 0;
  std::size_t Cells = 0;
  /// Smallest dihedral angle, degrees.
  double SmallestDihedralDeg = 0;
  /// Largest circumradius / shortest edge.
  double LargestRadiusEdgeRatio = 0;

  /// True when the volume is within 2 % of the voxels', or within 5 % where that is below 1 cm^3.
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
  /// Voxels whose component was below SmallestComponentMm3 and was merged.
  std::size_t MergedVoxels = 0;
  /// Number of connected components (face neighbours) that were seeded, and are all in the mesh.
  std::size_t Components = 0;
  /// True when perturb or exude met OptimisationSeconds.
  bool TimeLimitReached = false;
  double Seconds = 0;
};

/**
 * Meshes a volume of material indices (0 = air) with CGAL Mesh_3: one conforming mesh, the material
 * of every cell kept. Every connected component of a material of at least SmallestComponentMm3 is
 * seeded and must be in the result. The boundary of every material, and of all together, is a
 * closed surface that nowhere touches itself, and every material has the volume of its voxels where
 * that takes moving interfaces by no more than half a voxel or half the facet distance.
 * Deterministic. Throws InputError on an empty volume or unusable options and ConvergenceError,
 * naming the material, place and volume, when one was lost.
 */
MAMMORAYMESHING_EXPORT MeshingResult MeshMaterials(const LabelVolume& materials,
  const MeshingOptions& options, const ProgressCallback& progress = {});
}

#endif
