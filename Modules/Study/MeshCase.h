// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MeshCase_h
#define mammoray_MeshCase_h

#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammoray/Meshing/LabelMesher.h"
#include "mammoray/Meshing/MeshCheck.h"
#include "mammoray/Study/LabelSource.h"
#include "mammorayStudyModule.h"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

class vtkUnstructuredGrid;

namespace mammoray
{
/// What is meshed and how, by files; the members carry the defaults.
struct MeshCase
{
  /// Segmented volume; without a path the surfaces are meshed.
  LabelSource Labels;
  /// Material and file of closed surfaces (ReadSurface), each the boundary of its material; a
  /// material may have several.
  std::vector<std::pair<std::string, std::string>> Surfaces;
  /// Edge of cubic voxels that the surfaces label and that are then meshed, mm, positive; none: the
  /// surfaces, which then must not cut each other, are filled as they are.
  std::optional<double> SurfaceVoxelsMm;
  /// Material table: a path (.json) or the name of a shipped one. Surfaces do without: their
  /// materials are then numbered from 1 in their order.
  std::string Materials;
  /// What fills labels with tetrahedra; surfaces are always filled by TetGen.
  enum class Method
  {
    Cgal,
    TetGen
  };
  Method Filling = Method::Cgal;
  /// A coarse mesh for the mechanics (MeshForSimulation) of this cell size, mm; 0: by the size of
  /// the breast. None: a mesh of the anatomy.
  std::optional<double> MechanicsCellSizeMm;
  /// Of the anatomy. What it says of single materials is filled in from the following.
  MeshingOptions Options = MeshingOptions::Anatomy({});
  /// Names of the materials that form layers of about a millimetre; empty: the table's thin ones;
  /// "none" stands for none.
  std::vector<std::string> Thin;
  /// Name of a material and its size, mm.
  std::map<std::string, double> CellSizeOfMm;
  std::map<std::string, double> FacetSizeOfMm;
  std::map<std::string, double> FacetDistanceOfMm;
};

struct MeshCaseResult
{
  MaterialTable Materials;
  /// With what the case said of single materials.
  MeshingOptions Options;
  MeshingResult Meshed;
  MeshCheck Check;
  /// Materials of plates that are thinner than half of the facets that bound them: facets are
  /// placed where interfaces are met, and may miss a plate between two of them. Empty where such
  /// sizes were not used.
  std::vector<MaterialQuality> TooThin;
};

/// Upper bound of the facets that bound a material, mm.
MAMMORAYSTUDY_EXPORT double FacetSizeMm(const MeshingOptions& options, int material);

/**
 * Reads, meshes and checks the mesh. Throws InputError on unusable input, ConvergenceError where a
 * material was lost, Interrupted.
 */
MAMMORAYSTUDY_EXPORT MeshCaseResult RunMeshCase(const MeshCase& input,
  const ProgressCallback& progress = {});

/// The name of a material, or its number where it has none.
MAMMORAYSTUDY_EXPORT std::string NameOfMaterial(int material,
  const std::vector<std::string>& names);

/// Troubles with their places, volumes and cell quality as JSON; lengths in mm.
MAMMORAYSTUDY_EXPORT std::string CheckReport(const MeshCheck& check,
  const std::vector<std::string>& names);

/// The same, and before it what was meshed, what became of each material, and the time and memory
/// that the process took up to now.
MAMMORAYSTUDY_EXPORT std::string MeshReport(const MeshCase& input, const MeshCaseResult& result);

/// Draws how many cells of each material have which smallest dihedral angle and which ratio of
/// circumradius and shortest edge (.png). Throws InputError when it cannot be written.
MAMMORAYSTUDY_EXPORT void WriteQualityPicture(const MeshCheck& check,
  const std::vector<std::string>& names, const std::string& path);

/// Draws three plane cuts (.png) through a point, mm; without one through the cell that is nearest
/// to the middle of the mesh. Throws InputError when it cannot be written.
MAMMORAYSTUDY_EXPORT void WriteMeshCuts(vtkUnstructuredGrid* mesh,
  const std::optional<Vector3>& point, const std::vector<std::string>& names,
  const std::string& path);
}

#endif
