// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_BreastScene_h
#define mammoray_BreastScene_h

#include "Private/LiveMammogram.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammorayAppModule.h"

#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

class vtkActor;
class vtkCellPicker;
class vtkPolyData;
class vtkTexture;

namespace mammoray
{
/// A closed line in space.
using Loop = std::vector<Vector3>;

/// A colour for each material of a table, for all views; `host` lies around the others.
MAMMORAYAPP_EXPORT std::vector<std::array<double, 3>> TissueColors(const MaterialTable& table,
  int host);

/**
 * A breast in a renderer: the skin to look through, what lies inside, and, where wanted, the unit
 * around it. Volume frame, mm.
 */
class MAMMORAYAPP_EXPORT BreastScene
{
public:
  BreastScene(const LiveMammogram& live, const ViewedBreast& viewed);

  vtkRenderer* Renderer() { return this->View; }
  /// Lies over the other, in layer 1, with the marks, which nothing hides.
  vtkRenderer* MarkRenderer() { return this->Front; }
  /// The one that there is most of lies around the others.
  const std::vector<std::array<double, 3>>& TissueColors() const { return this->Colors; }
  /// New places of the anatomy's points, 3 x pointCount.
  void SetPoints(const std::vector<double>& points);
  /// Plates, receptor with `picture` on it, beam and source; the source is drawn near the breast,
  /// on the beam's axis.
  void SetUnit(const LiveMammogram& live, vtkTexture* picture);
  /// Letters of the patient's directions around the breast at `points`.
  void AddLetters(const AnatomicalAxes& axes, const std::vector<double>& points);
  /// Looks at the breast from the front, and a little from the lateral side and above, as a unit
  /// that stands at `placed` has it. `laterality`: the breast's, 'L' or 'R'.
  void LookFromFront(const VolumeFromGantry& placed, char laterality);
  /// Where the source is drawn.
  const Vector3& ShownSource() const { return this->SourceShown; }
  /// Where the source is when it is drawn there.
  Vector3 SourceAt(const Vector3& shown) const;
  /// A marked point (none: no point), a line through the breast and loops of uncertainty.
  void SetMark(const std::vector<Vector3>& point, const std::vector<Vector3>& line,
    const std::vector<Loop>& loops);

  /// What is seen at a place of the window, pixels: first what lies inside, then the skin. The
  /// place of the same tissue in `rest`, the anatomy uncompressed; nothing beside the breast.
  std::optional<Vector3> Pick(int x, int y, const TetrahedralMesh& rest);
  /// True at the drawn source.
  bool OnSource(int x, int y);

private:
  struct Part
  {
    vtkSmartPointer<vtkActor> Actor;
    /// Three points of the surface for each cell.
    std::vector<vtkIdType> Corners;
  };
  void AddPart(const std::vector<std::size_t>& triangles, double cellMm,
    const std::array<double, 3>& color, double opacity);
  std::vector<vtkIdType> Thinned(const std::vector<std::size_t>& triangles, double cellMm) const;

  const SurfaceMesh& Surface;
  const std::vector<std::int32_t>& PointIds;
  vtkNew<vtkRenderer> View;
  vtkNew<vtkRenderer> Front;
  vtkNew<vtkPoints> Points;
  std::vector<std::array<double, 3>> Colors;
  /// The skin is the last one.
  std::vector<Part> Parts;
  vtkSmartPointer<vtkPolyData> Support;
  vtkSmartPointer<vtkPolyData> Paddle;
  vtkSmartPointer<vtkPolyData> Receptor;
  vtkSmartPointer<vtkPolyData> BeamEdges;
  vtkSmartPointer<vtkPolyData> MarkedLine;
  vtkSmartPointer<vtkPolyData> MarkedLoops;
  vtkSmartPointer<vtkActor> ReceptorActor;
  vtkSmartPointer<vtkActor> Source;
  vtkSmartPointer<vtkActor> MarkedPoint;
  Vector3 SourceShown{ 0, 0, 0 };
  Vector3 Middle{ 0, 0, 0 };
};
}

#endif
