// SPDX-License-Identifier: Apache-2.0
#include "Private/PaneOverlay.h"

#include "Private/SceneShapes.h"
#include "mammoray/Foundation/Numbers.h"

#include "vtkActor2D.h"
#include "vtkCamera.h"
#include "vtkCoordinate.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper2D.h"
#include "vtkProperty2D.h"
#include "vtkTextProperty.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace mammoray
{
namespace
{
constexpr Color OverlayInk{ 0.85, 0.87, 0.90 };
constexpr Color OverlayMark{ 0.1, 0.9, 0.45 };
constexpr Color OverlayRuler{ 1.0, 0.85, 0.2 };
constexpr int FontPixels = 14;
/// The bar is about this long.
constexpr double BarPixels = 80;

/// Lines over everything, in the renderer's world or in pixels of the pane.
vtkSmartPointer<vtkPolyData> AddLines(vtkRenderer* view, const Color& color, bool ofWorld)
{
  auto lines = NewLines();
  vtkNew<vtkPolyDataMapper2D> mapper;
  mapper->SetInputData(lines);
  if (ofWorld)
  {
    vtkNew<vtkCoordinate> world;
    world->SetCoordinateSystemToWorld();
    mapper->SetTransformCoordinate(world);
  }
  vtkNew<vtkActor2D> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(color[0], color[1], color[2]);
  actor->GetProperty()->SetLineWidth(2);
  view->AddActor2D(actor);
  return lines;
}
}

std::string LengthText(double mm)
{
  char text[40];
  std::snprintf(text, sizeof text, mm < 1 ? "%.4g um" : "%.1f mm", mm < 1 ? 1000 * mm : mm);
  return text;
}

std::string DirectionLetters(const Vector3& direction, const AnatomicalAxes& axes)
{
  constexpr double Least = 0.25;
  std::string letters;
  const std::pair<Vector3, const char*> named[] = { { axes.Superior, "HF" },
    { axes.Anterior, "AP" }, { axes.Left, "LR" } };
  for (const auto& [axis, ends] : named)
  {
    const double along = Dot(direction, axis);
    if (std::abs(along) > Least)
    {
      letters += along > 0 ? ends[0] : ends[1];
    }
  }
  return letters;
}

PaneOverlay::PaneOverlay(vtkRenderer* view)
  : View(view)
{
  this->Texts->SetMinimumFontSize(FontPixels);
  this->Texts->SetMaximumFontSize(FontPixels);
  this->Texts->GetTextProperty()->SetColor(OverlayInk[0], OverlayInk[1], OverlayInk[2]);
  this->Texts->GetTextProperty()->ShadowOn();
  view->AddActor2D(this->Texts);
  this->RulerText->GetTextProperty()->SetFontSize(FontPixels);
  this->RulerText->GetTextProperty()->SetColor(OverlayRuler[0], OverlayRuler[1], OverlayRuler[2]);
  this->RulerText->GetTextProperty()->ShadowOn();
  this->RulerText->GetPositionCoordinate()->SetCoordinateSystemToWorld();
  view->AddActor2D(this->RulerText);
  this->Bar = AddLines(view, OverlayInk, false);
  this->RulerLine = AddLines(view, OverlayRuler, true);
  this->Marks = AddLines(view, OverlayMark, true);
}

void PaneOverlay::SetTitle(const std::string& title)
{
  this->Texts->SetText(vtkCornerAnnotation::UpperLeft, title.c_str());
}

void PaneOverlay::SetLetters(const std::array<std::string, 4>& letters)
{
  this->Texts->SetText(vtkCornerAnnotation::LeftEdge, letters[0].c_str());
  this->Texts->SetText(vtkCornerAnnotation::RightEdge, letters[1].c_str());
  // Below the title.
  this->Texts->SetText(vtkCornerAnnotation::UpperEdge, ("\n" + letters[2]).c_str());
  this->Texts->SetText(vtkCornerAnnotation::LowerEdge, letters[3].c_str());
}

void PaneOverlay::SetRuler(const std::optional<std::array<Vector3, 2>>& ends)
{
  this->Ruler = ends;
  std::vector<Vector3> line;
  std::string length;
  if (ends)
  {
    line.assign(ends->begin(), ends->end());
    length = ' ';
    length += LengthText(Norm((*ends)[1] - (*ends)[0]));
    this->RulerText->GetPositionCoordinate()->SetValue(line.back().data());
  }
  this->RulerText->SetInput(length.c_str());
  mammoray::SetLines(this->RulerLine, { line }, false);
}

void PaneOverlay::SetLines(const std::vector<std::vector<Vector3>>& lines)
{
  mammoray::SetLines(this->Marks, lines, false);
}

void PaneOverlay::Update()
{
  const int* size = this->View->GetSize();
  const double pixelMm =
    2 * this->View->GetActiveCamera()->GetParallelScale() / std::max(size[1], 1);
  // 1, 2 or 5 times a power of ten, about BarPixels long.
  const double wanted = BarPixels * pixelMm;
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  const double part = wanted / power;
  const double lengthMm = power * (part < 1.5 ? 1 : part < 3.5 ? 2 : part < 7.5 ? 5 : 10);
  const double right = size[0] - 6.0;
  const double left = right - lengthMm / pixelMm;
  constexpr double Low = 26; // above its length
  constexpr double High = Low + 5;
  mammoray::SetLines(this->Bar,
    { { { left, High, 0 }, { left, Low, 0 }, { right, Low, 0 }, { right, High, 0 } } }, false);
  this->Texts->SetText(vtkCornerAnnotation::LowerRight,
    (lengthMm < 1 ? NumberText(1000 * lengthMm) + " um" : NumberText(lengthMm) + " mm").c_str());
}

Vector3 PaneOverlay::WorldAt(int x, int y) const
{
  Vector3 focal;
  this->View->GetActiveCamera()->GetFocalPoint(focal.data());
  return PlaceUnder(this->View, x + 0.5, y + 0.5, focal);
}
}
