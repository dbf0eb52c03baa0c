// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MeshCase_h
#define mammoray_MeshCase_h

#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Progress.h"
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
/// Inputs of a mesh, by files, and its options. The members have the defaults.
struct MeshCase
{
  /// Segmented volume. Without a path the surfaces are meshed.
  LabelSource Labels;
  /// Material and file of closed surfaces (ReadSurface), each a boundary of its material.
  std::vector<std::pair<std::string, std::string>> Surfaces;
  /// Unit of these files' numbers, as LengthUnitMm has it. Empty: that of their formats.
  std::string SurfaceUnit;
  /// Edge of cubic voxels that the surfaces label and that are then meshed, mm, positive. Absent:
  /// the surfaces, which must not cut each other, are filled.
  std::optional<double> SurfaceVoxelsMm;
  /// Material table: a path (.json) or the name of a shipped one. Surfaces need none: their
  /// materials are then numbered from 1 in their order.
  std::string Materials;
  /// What fills labels with tetrahedra. Surfaces are always filled by TetGen.
  enum class Method
  {
    Cgal,
    TetGen
  };
  Method Filling = Method::Cgal;
  /// Cell size of a coarse mesh for the mechanics (MeshForSimulation), mm; 0 for a size by that of
  /// the breast. Absent: a mesh of the anatomy.
  std::optional<double> MechanicsCellSizeMm;
  /// Options of the anatomy's mesh. Sizes of single materials are set by the following members.
  MeshingOptions Options = MeshingOptions::Anatomy({});
  /// Names of the materials that form layers of about a millimetre. Empty: the table's thin ones;
  /// "none": none.
  std::vector<std::string> Thin;
  /// Sizes by the names of materials, mm.
  std::map<std::string, double> CellSizeOfMm;
  std::map<std::string, double> FacetSizeOfMm;
};

struct MeshCaseResult
{
  MaterialTable Materials;
  /// With the case's sizes of single materials.
  MeshingOptions Options;
  MeshingResult Meshed;
  MeshCheck Check;
  /// Materials that are thinner than half of the facets that bound them. Facets are placed where
  /// interfaces are met, and may miss a thin layer between two of them. Empty if the sizes of
  /// facets were not used.
  std::vector<MaterialQuality> TooThin;
};

/// Upper bound of the facets that bound a material, mm.
MAMMORAYSTUDY_EXPORT double FacetSizeMm(const MeshingOptions& options, int material);

/**
 * Reads, meshes and checks the mesh. Throws InputError on unusable input, ConvergenceError if a
 * material was lost, Interrupted.
 */
MAMMORAYSTUDY_EXPORT MeshCaseResult RunMeshCase(const MeshCase& input,
  const ProgressCallback& progress = {});

/// The name of a material, or its number if it has none.
MAMMORAYSTUDY_EXPORT std::string NameOfMaterial(int material,
  const std::vector<std::string>& names);

/// Returns JSON of troubles with their places, volumes and cell quality; lengths in mm.
MAMMORAYSTUDY_EXPORT std::string CheckReport(const MeshCheck& check,
  const std::vector<std::string>& names);

/// Returns the same, and the inputs, the volume of each material before and after, and the
/// processor time and memory of the process up to now.
MAMMORAYSTUDY_EXPORT std::string MeshReport(const MeshCase& input, const MeshCaseResult& result);

/// Draws three plane cuts (.png) through the cell that is nearest to the middle of the mesh. Throws
/// InputError if it cannot be written.
MAMMORAYSTUDY_EXPORT void WriteMeshCuts(vtkUnstructuredGrid* mesh,
  const std::vector<std::string>& names, const std::string& path);
}

#endif
