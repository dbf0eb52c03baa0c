// SPDX-License-Identifier: Apache-2.0
// Pictures (.png) of volumes, meshes and breasts. They are drawn without a display.
#ifndef mammoray_StudyPictures_h
#define mammoray_StudyPictures_h

#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammorayStudyModule.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

class vtkUnstructuredGrid;

namespace mammoray
{
/// A picture, and lines over it that a page can hide.
struct LayeredPicture
{
  /// Bytes of a PNG file; empty if there is no picture.
  std::string Png;
  /// Its size, pixels.
  int Width = 0;
  int Height = 0;
  /// SVG elements in pixels from the upper left corner.
  std::string Lines;
};

/**
 * Draws three axial, three coronal and three sagittal slices of a volume over the box of its
 * labels, with the labels' outlines in colours and a legend. Grey goes from 0 to the 99.5th
 * percentile in the box. Both volumes have one grid; `names[label]` names a label, `title` the
 * picture. Throws InputError if the grids differ or there is no label.
 */
MAMMORAYSTUDY_EXPORT LayeredPicture DrawLabelSlices(const IntensityVolume& image,
  const LabelVolume& labels, const AnatomicalAxes& axes, const std::vector<std::string>& names,
  const std::string& title = {});

/// What three slices through a point show.
struct PointSlices
{
  /// Shown in grey, from 0 to the 99.5th percentile of the labels' box; null: tissues in colour.
  const IntensityVolume* Image = nullptr;
  /// Tissue. The slices show the box of the labels above 0. Required.
  const LabelVolume* Labels = nullptr;
  AnatomicalAxes Axes;
  /// Names by label, for the legend of tissues in colour.
  std::vector<std::string> Names;
  /// Frame of the volumes, mm, in or near the box; marked in each slice.
  Vector3 Point{ 0, 0, 0 };
  /// Volume whose label `LesionLabel` is outlined; null: none.
  const LabelVolume* Lesions = nullptr;
  int LesionLabel = 0;
};

/**
 * Draws the axial, coronal and sagittal slices through a point side by side, to one scale, with a
 * scale bar and letters of the patient's directions. Throws InputError if there is no label.
 */
MAMMORAYSTUDY_EXPORT LayeredPicture DrawPointSlices(const PointSlices& slices);

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
  /// Polylines drawn over the cut, along its normal; mm, frame of the mesh.
  std::vector<std::vector<Vector3>> Lines;
};

/**
 * Draws cuts side by side to one scale, cells coloured by material and with their edges if these
 * are wide enough to be seen, with a legend and a scale bar, and writes .png. `materialNames[m]`
 * names material m. Throws InputError if a plane misses its mesh or the file cannot be written.
 */
MAMMORAYSTUDY_EXPORT void WriteCutPicture(const std::vector<CutPanel>& panels,
  const std::vector<std::string>& materialNames, const std::string& path);

/// Three panels, normal to z, y and x, through `point`.
MAMMORAYSTUDY_EXPORT std::vector<CutPanel> CutsThrough(vtkUnstructuredGrid* mesh,
  const Vector3& point);

/// A breast with translucent skin and plates. One frame, mm.
struct BreastInSpace
{
  /// Interfaces of materials of the table; both must outlive this.
  const SurfaceMesh* Surface = nullptr;
  const MaterialTable* Materials = nullptr;
  /// The corners of each plate's face, in turn.
  std::vector<std::array<Vector3, 4>> Plates;
  /// Direction from the breast to the distant eye, and what is up; unit vectors, not parallel.
  Vector3 ToEye{ 0, 0, 1 };
  Vector3 Up{ 0, 1, 0 };
  /// Places with a name, drawn as lines that nothing hides.
  std::vector<std::pair<std::string, Vector3>> Marks;
};

/**
 * Returns for each triangle the one of its two materials that lies inside the other one. The host,
 * which has the largest volume apart from fixed and thin materials, lies inside none; of two other
 * materials the smaller one lies inside. The value is 0 if one material is air or thin. `host`
 * receives the host, 0 if there is none. The surface must be closed.
 */
MAMMORAYSTUDY_EXPORT std::vector<int> EnclosedMaterials(const SurfaceMesh& surface,
  const MaterialTable& materials, int* host = nullptr);

/// Draws a breast from far away, 720 pixels wide, with a legend of the tissues. Throws InputError
/// without a surface.
MAMMORAYSTUDY_EXPORT LayeredPicture DrawBreast(const BreastInSpace& breast);
}

#endif
