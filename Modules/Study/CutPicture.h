// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_CutPicture_h
#define mammoray_CutPicture_h

#include "mammoray/Foundation/Vector3.h"
#include "mammorayStudyModule.h"

#include <string>
#include <vector>

class vtkUnstructuredGrid;

namespace mammoray
{
/// A plane cut through a mesh.
struct CutPanel
{
  /// Linear tetrahedra with the cell array "Material"; must outlive the panel.
  vtkUnstructuredGrid* Mesh = nullptr;
  /// A point of the plane, mm, frame of the mesh.
  Vector3 Point{ 0, 0, 0 };
  /// Directions in the plane that are right and up in the picture; orthonormal.
  Vector3 Right{ 1, 0, 0 };
  Vector3 Up{ 0, 1, 0 };
  std::string Title;
  /// Lines of points drawn over the cut, along its normal; mm, frame of the mesh.
  std::vector<std::vector<Vector3>> Lines;
};

/**
 * Draws cuts side by side to one scale, cells coloured by material and with their edges where these
 * can be seen, with a legend and a scale bar, and writes .png. `materialNames[m]` names material m.
 * No display is needed. Throws InputError when no plane meets its mesh or the file cannot be
 * written.
 */
MAMMORAYSTUDY_EXPORT void WriteCutPicture(const std::vector<CutPanel>& panels,
  const std::vector<std::string>& materialNames, const std::string& path);

/// Three panels, normal to z, y and x, through `point`.
MAMMORAYSTUDY_EXPORT std::vector<CutPanel> CutsThrough(vtkUnstructuredGrid* mesh,
  const Vector3& point);
}

#endif
