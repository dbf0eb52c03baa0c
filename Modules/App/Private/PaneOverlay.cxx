// SPDX-License-Identifier: Apache-2.0
#include "Private/PaneOverlay.h"

#include "mammoray/Foundation/Numbers.h"

#include "vtkActor2D.h"
#include "vtkCamera.h"
#include "vtkCellArray.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper2D.h"
#include "vtkProperty2D.h"
#include "vtkTextActor.h"
#include "vtkTextProperty.h"

#include <cmath>
#include <cstdio>

namespace mammoray
{
namespace
{
constexpr std::array<double, 3> OverlayInk{ 0.85, 0.87, 0.90 };
constexpr std::array<double, 3> OverlayMark{ 0.1, 0.9, 0.45 };
constexpr std::array<double, 3> OverlayRuler{ 1.0, 0.85, 0.2 };
constexpr std::array<double, 3> OverlayWarning{ 1.0, 0.65, 0.25 };
/// The bar is about this long.
constexpr double BarPixels = 80;

/// Lines in pixels of the pane, over everything.
vtkSmartPointer<vtkPolyData> AddLines(vtkRenderer* view, const std::array<double, 3>& color)
{
  auto lines = vtkSmartPointer<vtkPolyData>::New();
  lines->SetPoints(vtkNew<vtkPoints>());
  lines->SetLines(vtkNew<vtkCellArray>());
  vtkNew<vtkPolyDataMapper2D> mapper;
  mapper->SetInputData(lines);
  vtkNew<vtkActor2D> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(color[0], color[1], color[2]);
  actor->GetProperty()->SetLineWidth(2);
  view->AddActor2D(actor);
  return lines;
}

void SetPixelLines(vtkPolyData* data, const std::vector<std::vector<std::array<double, 2>>>& lines)
{
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> cells;
  for (const auto& line : lines)
  {
    cells->InsertNextCell(static_cast<int>(line.size()));
    for (const auto& [x, y] : line)
    {
      cells->InsertCellPoint(points->InsertNextPoint(x, y, 0));
    }
  }
  data->SetPoints(points);
  data->SetLines(cells);
}

/// The plane that a camera looks at: the place in the middle of the view, and unit vectors to the
/// right and up.
struct ViewPlane
{
  Vector3 Focal;
  Vector3 Right;
  Vector3 Up;
};

ViewPlane PlaneOf(vtkCamera* camera)
{
  ViewPlane plane;
  Vector3 along;
  camera->GetFocalPoint(plane.Focal.data());
  camera->GetViewUp(plane.Up.data());
  camera->GetDirectionOfProjection(along.data());
  plane.Right = Cross(along, plane.Up);
  return plane;
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
  this->Title = this->AddText(14, 0.02, 0.99, -1, 1);
  this->Warning = this->AddText(13, 0.02, 0.95, -1, 1);
  this->Warning->GetTextProperty()->SetColor(OverlayWarning[0], OverlayWarning[1],
    OverlayWarning[2]);
  this->Letters = { this->AddText(16, 0.015, 0.5, -1, 0), this->AddText(16, 0.985, 0.5, 1, 0),
    this->AddText(16, 0.5, 0.985, 0, 1), this->AddText(16, 0.5, 0.015, 0, -1) };
  this->BarText = this->AddText(12, 0, 0, 1, -1);
  this->RulerText = this->AddText(13, 0, 0, -1, -1);
  this->RulerText->GetTextProperty()->SetColor(OverlayRuler[0], OverlayRuler[1], OverlayRuler[2]);
  for (vtkTextActor* placed : { this->BarText.Get(), this->RulerText.Get(), this->Title.Get(),
         this->Warning.Get(), this->Letters[2].Get() })
  {
    placed->GetPositionCoordinate()->SetCoordinateSystemToViewport();
  }
  this->Bar = AddLines(view, OverlayInk);
  this->RulerLine = AddLines(view, OverlayRuler);
  this->Marks = AddLines(view, OverlayMark);
}

/// `across`, `up`: which end of the text is there, -1, 0 or 1.
vtkSmartPointer<vtkTextActor> PaneOverlay::AddText(int size, double x, double y, int across, int up)
{
  auto actor = vtkSmartPointer<vtkTextActor>::New();
  vtkTextProperty* text = actor->GetTextProperty();
  text->SetFontSize(size);
  text->SetColor(OverlayInk[0], OverlayInk[1], OverlayInk[2]);
  text->ShadowOn();
  text->SetJustification(across < 0 ? VTK_TEXT_LEFT
      : across > 0                  ? VTK_TEXT_RIGHT
                                    : VTK_TEXT_CENTERED);
  text->SetVerticalJustification(up < 0 ? VTK_TEXT_BOTTOM
      : up > 0                          ? VTK_TEXT_TOP
                                        : VTK_TEXT_CENTERED);
  actor->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  actor->GetPositionCoordinate()->SetValue(x, y);
  this->View->AddActor2D(actor);
  return actor;
}

void PaneOverlay::SetTitle(const std::string& title)
{
  this->Title->SetInput(title.c_str());
}

void PaneOverlay::SetWarning(const std::string& warning)
{
  this->Warning->SetInput(warning.c_str());
}

void PaneOverlay::SetLetters(const std::array<std::string, 4>& letters)
{
  for (std::size_t side = 0; side < letters.size(); ++side)
  {
    this->Letters[side]->SetInput(letters[side].c_str());
  }
}

double PaneOverlay::MmPerPixel() const
{
  const int* size = this->View->GetSize();
  return 2 * this->View->GetActiveCamera()->GetParallelScale() / std::max(size[1], 1);
}

void PaneOverlay::Update()
{
  const int* size = this->View->GetSize();
  // Below each other at the upper edge: title, warning, letter.
  constexpr int Narrow = 260;
  constexpr double LinePixels = 20;
  constexpr double TopPixels = 4;
  const double top = size[1] - TopPixels;
  const bool warns = this->Warning->GetInput() && *this->Warning->GetInput() != 0;
  this->Warning->GetTextProperty()->SetFontSize(size[0] < Narrow ? 11 : 13);
  this->Title->GetPositionCoordinate()->SetValue(6, top);
  this->Warning->GetPositionCoordinate()->SetValue(6, top - LinePixels);
  this->Letters[2]->GetPositionCoordinate()->SetValue(0.5 * size[0],
    top - (warns ? 2 : 1) * LinePixels);
  // 1, 2 or 5 times a power of ten, about BarPixels long.
  const double wanted = BarPixels * this->MmPerPixel();
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  const double part = wanted / power;
  const double lengthMm = power * (part < 1.5 ? 1 : part < 3.5 ? 2 : part < 7.5 ? 5 : 10);
  const double length = lengthMm / this->MmPerPixel();
  const double right = size[0] - 14.0;
  constexpr double Low = 14;
  constexpr double Tick = 5;
  SetPixelLines(this->Bar,
    { { { right - length, Low + Tick }, { right - length, Low }, { right, Low },
      { right, Low + Tick } } });
  this->BarText->SetInput(
    (lengthMm < 1 ? NumberText(1000 * lengthMm) + " um" : NumberText(lengthMm) + " mm").c_str());
  this->BarText->GetPositionCoordinate()->SetValue(right, Low + Tick + 2);

  std::vector<std::vector<std::array<double, 2>>> ruler;
  this->RulerText->SetInput("");
  if (this->Ruler)
  {
    const auto from = this->PixelOf((*this->Ruler)[0]);
    const auto to = this->PixelOf((*this->Ruler)[1]);
    ruler.push_back({ from, to });
    this->RulerText->SetInput(LengthText(Norm((*this->Ruler)[1] - (*this->Ruler)[0])).c_str());
    this->RulerText->GetPositionCoordinate()->SetValue(to[0] + 6, to[1] + 4);
  }
  SetPixelLines(this->RulerLine, ruler);
  std::vector<std::vector<std::array<double, 2>>> marks;
  for (const auto& line : this->Lines)
  {
    auto& pixels = marks.emplace_back();
    for (const Vector3& point : line)
    {
      pixels.push_back(this->PixelOf(point));
    }
  }
  SetPixelLines(this->Marks, marks);
}

Vector3 PaneOverlay::WorldAt(int x, int y) const
{
  const auto [focal, right, up] = PlaneOf(this->View->GetActiveCamera());
  const int* origin = this->View->GetOrigin();
  const int* size = this->View->GetSize();
  const double mm = this->MmPerPixel();
  return focal + mm * (x + 0.5 - origin[0] - 0.5 * size[0]) * right +
    mm * (y + 0.5 - origin[1] - 0.5 * size[1]) * up;
}

std::array<double, 2> PaneOverlay::PixelOf(const Vector3& world) const
{
  const auto [focal, right, up] = PlaneOf(this->View->GetActiveCamera());
  const Vector3 offset = world - focal;
  const int* size = this->View->GetSize();
  const double mm = this->MmPerPixel();
  return { 0.5 * size[0] + Dot(offset, right) / mm, 0.5 * size[1] + Dot(offset, up) / mm };
}
}
