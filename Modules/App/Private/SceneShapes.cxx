// SPDX-License-Identifier: Apache-2.0
#include "Private/SceneShapes.h"

#include "vtkActor.h"
#include "vtkCellArray.h"
#include "vtkCellPicker.h"
#include "vtkCoordinate.h"
#include "vtkFloatArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRenderer.h"
#include "vtkSphereSource.h"
#include "vtkTextActor.h"
#include "vtkTextProperty.h"

namespace mammoray
{
namespace
{
void AddLine(vtkPolyData* data, const std::vector<Vector3>& line, bool closed)
{
  vtkCellArray* cells = data->GetLines();
  cells->InsertNextCell(static_cast<int>(line.size()) + (closed ? 1 : 0));
  const vtkIdType first = data->GetNumberOfPoints();
  for (const Vector3& point : line)
  {
    cells->InsertCellPoint(data->GetPoints()->InsertNextPoint(point.data()));
  }
  if (closed)
  {
    cells->InsertCellPoint(first);
  }
}
}

vtkSmartPointer<vtkPolyData> NewLines()
{
  auto lines = vtkSmartPointer<vtkPolyData>::New();
  lines->SetPoints(vtkNew<vtkPoints>());
  lines->SetLines(vtkNew<vtkCellArray>());
  return lines;
}

void SetLines(vtkPolyData* data, const std::vector<std::vector<Vector3>>& lines, bool closed)
{
  data->GetPoints()->Reset();
  data->GetLines()->Reset();
  for (const std::vector<Vector3>& line : lines)
  {
    if (line.size() > 1)
    {
      AddLine(data, line, closed);
    }
  }
  data->GetPoints()->Modified();
  data->GetLines()->Modified();
  data->Modified();
}

vtkSmartPointer<vtkPolyData> NewBall(double radiusMm)
{
  vtkNew<vtkSphereSource> ball;
  ball->SetRadius(radiusMm);
  ball->SetThetaResolution(24);
  ball->SetPhiResolution(24);
  ball->Update();
  return ball->GetOutput();
}

vtkSmartPointer<vtkPolyData> NewPictureRectangle()
{
  auto rectangle = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetNumberOfPoints(4);
  rectangle->SetPoints(points);
  vtkNew<vtkCellArray> faces;
  constexpr vtkIdType corners[4] = { 0, 1, 3, 2 };
  faces->InsertNextCell(4, corners);
  rectangle->SetPolys(faces);
  vtkNew<vtkFloatArray> coordinates;
  coordinates->SetNumberOfComponents(2);
  for (int corner = 0; corner < 4; ++corner)
  {
    coordinates->InsertNextTuple2(corner & 1, corner >> 1);
  }
  rectangle->GetPointData()->SetTCoords(coordinates);
  return rectangle;
}

vtkSmartPointer<vtkActor> AddActor(vtkRenderer* view, vtkPolyData* data, const Color& color,
  double opacity)
{
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  mapper->ScalarVisibilityOff();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(color[0], color[1], color[2]);
  actor->GetProperty()->SetOpacity(opacity);
  view->AddActor(actor);
  return actor.Get();
}

vtkSmartPointer<vtkTextActor> AddText(vtkRenderer* renderer, const std::string& text, double x,
  double y, int size)
{
  vtkNew<vtkTextActor> actor;
  actor->SetInput(text.c_str());
  actor->GetTextProperty()->SetFontSize(size);
  actor->GetTextProperty()->SetVerticalJustificationToTop();
  actor->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  actor->GetPositionCoordinate()->SetValue(x, y);
  renderer->AddActor(actor);
  return actor.Get();
}

bool IsAt(vtkRenderer* view, vtkActor* actor, int x, int y)
{
  vtkNew<vtkCellPicker> picker;
  picker->SetTolerance(0.005);
  picker->PickFromListOn();
  picker->AddPickList(actor);
  return actor->GetVisibility() != 0 && picker->Pick(x, y, 0, view) != 0;
}

Vector3 PlaceUnder(vtkRenderer* view, double x, double y, const Vector3& depth)
{
  view->SetWorldPoint(depth[0], depth[1], depth[2], 1);
  view->WorldToDisplay();
  view->SetDisplayPoint(x, y, view->GetDisplayPoint()[2]);
  view->DisplayToWorld();
  const double* world = view->GetWorldPoint();
  return { world[0] / world[3], world[1] / world[3], world[2] / world[3] };
}
}
