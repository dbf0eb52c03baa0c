// Steps that the methods from a label volume to tetrahedra share.
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
/// Formats up to three numbers as printf does; at most 159 characters.
inline std::string FormattedText(const char* format, double a, double b = 0, double c = 0)
{
  char text[160];
  std::snprintf(text, sizeof(text), format, a, b, c);
  return text;
}

/// The volume's tissue with a margin of air, in voxels.
MAMMORAYMESHING_EXPORT LabelVolume PrepareVolume(const LabelVolume& materials, int margin);

/// As MergeSmallComponents, but throws InputError if only air remains. Returns the number of voxels
/// that changed.
MAMMORAYMESHING_EXPORT std::size_t MergeTissue(LabelVolume& volume, double smallestMm3);

/// Throws ConvergenceError, with material, position and volume, unless every component of tissue
/// contains a cell of its material. The mesh is in the grid frame (see LabelField). Depths and
/// deepest voxels of the components appear in the message.
MAMMORAYMESHING_EXPORT void CheckComponents(const TetrahedralMesh& mesh, const LabelVolume& volume,
  const LabelComponents& found);

/// As CheckSurface, but throws InputError, with places, if a boundary has holes.
MAMMORAYMESHING_EXPORT MeshCheck CheckClosed(const SurfaceMesh& surfaces);

/// Largest motion of interfaces, mm: half a voxel, or half the facet distance if that is more.
MAMMORAYMESHING_EXPORT double LargestShift(const LabelVolume& materials,
  const MeshingOptions& options);

/**
 * Final steps of both methods, in the grid frame: slivers are improved down to SmallestDihedralDeg
 * where possible, boundaries that touch themselves are repaired, and interfaces move within
 * LargestShift until every material has the volume of its voxels in `materials`, including merged
 * components. The mesh may contain cells of air (material 0), which keep its surface from
 * intersecting itself.
 */
MAMMORAYMESHING_EXPORT void FinishMesh(const LabelVolume& materials, const MeshingOptions& options,
  TetrahedralMesh& mesh, const ProgressCallback& progress);

/// Transforms a mesh from the grid frame to the volume frame.
MAMMORAYMESHING_EXPORT void PlaceInVolumeFrame(const LabelVolume& volume, TetrahedralMesh& mesh);

/// Smallest dihedral angle of a cell, degrees; at best 70.5.
MAMMORAYMESHING_EXPORT double SmallestDihedralDeg(const TetrahedralMesh& mesh, std::size_t cell);

/// Radius of the circumscribed sphere divided by the shortest edge; at best 0.61.
MAMMORAYMESHING_EXPORT double RadiusEdgeRatio(const TetrahedralMesh& mesh, std::size_t cell);

/// Reports the volumes of voxels and cells, and the quality of the cells.
MAMMORAYMESHING_EXPORT std::vector<MaterialReport> ReportMaterials(const LabelVolume& materials,
  const TetrahedralMesh& mesh);
}

#endif
