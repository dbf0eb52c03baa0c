// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PaneOverlay_h
#define mammoray_PaneOverlay_h

#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayAppModule.h"

#include "vtkCornerAnnotation.h"
#include "vtkNew.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"
#include "vtkTextActor.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

class vtkPolyData;

namespace mammoray
{
/// "12.3 mm", and below a millimetre "123.4 um": samples may be small.
MAMMORAYAPP_EXPORT std::string LengthText(double mm);

/// The letters of a direction: "L", "HL"; parts of less than a quarter are left out.
std::string DirectionLetters(const Vector3& direction, const AnatomicalAxes& axes);

/**
 * What lies over a picture seen along its normal (a parallel camera): its title, letters of the
 * patient's directions at its sides, a bar of so many mm, a ruler, lines.
 */
class MAMMORAYAPP_EXPORT PaneOverlay
{
public:
  /// `view` must outlive this.
  explicit PaneOverlay(vtkRenderer* view);

  void SetTitle(const std::string& title);
  /// At the left, right, upper and lower side.
  void SetLetters(const std::array<std::string, 4>& letters);
  /// Ends of a distance, in the renderer's world; nothing: none.
  void SetRuler(const std::optional<std::array<Vector3, 2>>& ends);
  const std::optional<std::array<Vector3, 2>>& RulerEnds() const { return this->Ruler; }
  /// Lines to draw, in the renderer's world, whatever lies before them.
  void SetLines(const std::vector<std::vector<Vector3>>& lines);
  /// Follows camera and size; to be called before the window is drawn.
  void Update();

  /// The place of the camera's plane at a place of the window, pixels.
  Vector3 WorldAt(int x, int y) const;

private:
  vtkRenderer* View;
  std::optional<std::array<Vector3, 2>> Ruler;
  vtkNew<vtkCornerAnnotation> Texts;
  vtkNew<vtkTextActor> RulerText;
  vtkSmartPointer<vtkPolyData> Bar;
  vtkSmartPointer<vtkPolyData> RulerLine;
  vtkSmartPointer<vtkPolyData> Marks;
};
}

#endif
