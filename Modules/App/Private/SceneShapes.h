// SPDX-License-Identifier: Apache-2.0
// What scenes are drawn of.
#ifndef mammoray_SceneShapes_h
#define mammoray_SceneShapes_h

#include "mammoray/Foundation/Vector3.h"
#include "mammorayAppModule.h"

#include "vtkSmartPointer.h"

#include <array>
#include <string>
#include <vector>

class vtkActor;
class vtkPolyData;
class vtkRenderer;
class vtkTextActor;

namespace mammoray
{
using Color = std::array<double, 3>;

inline constexpr Color BeamColor{ 1.0, 0.85, 0.2 };

/// Lines that SetLines draws.
vtkSmartPointer<vtkPolyData> NewLines();
/// Those of more than one point; closed: the last leads to the first.
void SetLines(vtkPolyData* data, const std::vector<std::vector<Vector3>>& lines, bool closed);
/// About the origin; mm.
vtkSmartPointer<vtkPolyData> NewBall(double radiusMm);
/// A rectangle with the picture's texture coordinates: corners 0 and 1 are the first row's.
vtkSmartPointer<vtkPolyData> NewPictureRectangle();
vtkSmartPointer<vtkActor> AddActor(vtkRenderer* view, vtkPolyData* data, const Color& color,
  double opacity);
/// With its upper left corner at a place of the view, in shares of it.
vtkSmartPointer<vtkTextActor> AddText(vtkRenderer* view, const std::string& text, double x,
  double y, int size);
/// True where the actor is visible at a pixel of the window.
bool IsAt(vtkRenderer* view, vtkActor* actor, int x, int y);
/// The place under a pixel of the window, in the plane across the view through `depth`.
MAMMORAYAPP_EXPORT Vector3 PlaceUnder(vtkRenderer* view, double x, double y, const Vector3& depth);
}

#endif
