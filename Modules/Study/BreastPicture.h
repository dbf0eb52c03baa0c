// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_BreastPicture_h
#define mammoray_BreastPicture_h

#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammoray/Study/LayeredPicture.h"
#include "mammorayStudyModule.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace mammoray
{
/// A breast in space: what lies in it, the skin and plates to look through. One frame, mm.
struct BreastInSpace
{
  /// Interfaces of materials of the table; both must outlive this.
  const SurfaceMesh* Surface = nullptr;
  const MaterialTable* Materials = nullptr;
  /// The corners of each plate's face, in turn.
  std::vector<std::array<Vector3, 4>> Plates;
  /// From the breast to the eye, far away, and what is up; unit vectors, not parallel.
  Vector3 ToEye{ 0, 0, 1 };
  Vector3 Up{ 0, 1, 0 };
  /// Places with a name, drawn as lines, which nothing hides.
  std::vector<std::pair<std::string, Vector3>> Marks;
};

/**
 * For each triangle the one of its two materials that lies in the other: what is not the host, the
 * material that there is most of apart from fixed and thin ones; of two others the smaller one. 0
 * where one of them is air or thin, which encloses all the rest. `host`, if given, receives it; 0:
 * there is none. The surface must be closed.
 */
MAMMORAYSTUDY_EXPORT std::vector<int> EnclosedMaterials(const SurfaceMesh& surface,
  const MaterialTable& materials, int* host = nullptr);

/// Draws it from far away, 720 pixels wide, with a legend of the tissues. No display is needed.
/// Throws InputError where there is no surface.
MAMMORAYSTUDY_EXPORT LayeredPicture DrawBreast(const BreastInSpace& breast);
}

#endif
