// SPDX-License-Identifier: Apache-2.0
// What the ways from a label volume to tetrahedra share.
#ifndef mammoray_MeshingSteps_h
#define mammoray_MeshingSteps_h

#include "Private/LabelComponents.h"
#include "mammoray/Meshing/LabelMesher.h"
#include "mammoray/Meshing/MeshCheck.h"
#include "mammorayMeshingModule.h"

#include <cstdio>
#include <string>

namespace mammoray
{
/// A line of at most 159 characters with numbers in it, as printf writes them.
inline std::string FormattedText(const char* format, double a, double b = 0, double c = 0)
{
  char text[160];
  std::snprintf(text, sizeof(text), format, a, b, c);
  return text;
}

/// The volume's tissue with a margin of air around it, in voxels.
MAMMORAYMESHING_EXPORT LabelVolume PrepareVolume(const LabelVolume& materials, int margin);

/**
 * MergeSmallComponents; throws InputError where nothing but air is left. Returns the number of
 * voxels that changed.
 */
MAMMORAYMESHING_EXPORT std::size_t MergeTissue(LabelVolume& volume, double smallestMm3);

/**
 * Throws ConvergenceError, naming material, place and volume, unless every component of tissue
 * holds a cell of its material. The mesh is in the grid frame (LabelField); depths and deepest
 * voxels of the components are for the message.
 */
MAMMORAYMESHING_EXPORT void CheckComponents(const TetrahedralMesh& mesh, const LabelVolume& volume,
  const LabelComponents& found);

/// CheckSurface; throws InputError, with places, where a boundary has holes.
MAMMORAYMESHING_EXPORT MeshCheck CheckClosed(const SurfaceMesh& surfaces);

/// How far interfaces may move: half a voxel, or half the facet distance where that is more, mm.
MAMMORAYMESHING_EXPORT double LargestShift(const LabelVolume& materials,
  const MeshingOptions& options);

/**
 * What both ways from labels end with, in the grid frame: slivers are taken away down to
 * SmallestDihedralDeg where that can be reached, boundaries that touch themselves are mended, and
 * interfaces move within LargestShift until every material has the volume of its voxels in
 * `materials`, those of merged components included. The mesh may come with cells of air (material
 * 0), which keep its surface from cutting itself.
 */
MAMMORAYMESHING_EXPORT void FinishMesh(const LabelVolume& materials, const MeshingOptions& options,
  TetrahedralMesh& mesh, const ProgressCallback& progress);

/// The part of a progress from `begin` to `end`.
MAMMORAYMESHING_EXPORT ProgressCallback Within(const ProgressCallback& progress, double begin,
  double end);

/// Carries a mesh from the grid frame to the volume frame.
MAMMORAYMESHING_EXPORT void PlaceInVolumeFrame(const LabelVolume& volume, TetrahedralMesh& mesh);

/// Volumes of the voxels and of the cells, and the cells' quality.
MAMMORAYMESHING_EXPORT std::vector<MaterialReport> ReportMaterials(const LabelVolume& materials,
  const TetrahedralMesh& mesh);
}

#endif
