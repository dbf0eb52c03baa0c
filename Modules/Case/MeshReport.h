// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MeshReport_h
#define mammoray_MeshReport_h

#include "mammoray/Case/MeshCase.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammoray/Meshing/MeshCheck.h"
#include "mammorayCaseModule.h"

#include <optional>
#include <string>
#include <vector>

class vtkUnstructuredGrid;

namespace mammoray
{
/// The name of a material, or its number where it has none.
MAMMORAYCASE_EXPORT std::string NameOfMaterial(int material, const std::vector<std::string>& names);

/// Troubles with their places, volumes and cell quality as JSON; lengths in mm.
MAMMORAYCASE_EXPORT std::string CheckReport(const MeshCheck& check,
  const std::vector<std::string>& names);

/// The same, and before it what was meshed, what became of each material, and the time and memory
/// that the process took up to now.
MAMMORAYCASE_EXPORT std::string MeshReport(const MeshCase& input, const MeshCaseResult& result);

/// Draws how many cells of each material have which smallest dihedral angle and which ratio of
/// circumradius and shortest edge (.png). Throws InputError when it cannot be written.
MAMMORAYCASE_EXPORT void WriteQualityPicture(const MeshCheck& check,
  const std::vector<std::string>& names, const std::string& path);

/// Draws three plane cuts (.png) through a point, mm; without one through the cell that is nearest
/// to the middle of the mesh. Throws InputError when it cannot be written.
MAMMORAYCASE_EXPORT void WriteMeshCuts(vtkUnstructuredGrid* mesh,
  const std::optional<Vector3>& point, const std::vector<std::string>& names,
  const std::string& path);
}

#endif
