// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/CutPicture.h"

#include "Private/Picture.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MeshConversion.h"

#include "vtkCellData.h"
#include "vtkCutter.h"
#include "vtkDataArray.h"
#include "vtkNew.h"
#include "vtkPlane.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

namespace mammoray
{
namespace
{
constexpr int LongestSidePixels = 460;
constexpr int CutMargin = 20;
constexpr double LineMarginMm = 4;
constexpr int TitleHeight = 46;
constexpr int CutLegendWidth = 190;
constexpr int Supersampling = 4;

struct CutCell
{
  /// In the plane of the cut, mm.
  std::vector<PicturePoint> Corners;
  int Material = 0;
};

struct Cut
{
  std::vector<CutCell> Cells;
  std::vector<std::vector<PicturePoint>> Lines;
  PicturePoint Least{ std::numeric_limits<double>::max(), std::numeric_limits<double>::max() };
  PicturePoint Most{ std::numeric_limits<double>::lowest(), std::numeric_limits<double>::lowest() };

  double Width() const { return this->Most.X - this->Least.X; }
  double Height() const { return this->Most.Y - this->Least.Y; }
};

Cut MakeCut(const CutPanel& panel)
{
  const auto inPlane = [&](const Vector3& point)
  {
    return PicturePoint{ Dot(point - panel.Point, panel.Right),
      Dot(point - panel.Point, panel.Up) };
  };
  const Vector3 normal = Cross(panel.Right, panel.Up);
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(panel.Point.data());
  plane->SetNormal(normal.data());
  vtkNew<vtkCutter> cutter;
  cutter->SetInputData(panel.Mesh);
  cutter->SetCutFunction(plane);
  cutter->GenerateTrianglesOff();
  cutter->Update();
  vtkPolyData* polygons = cutter->GetOutput();
  Cut cut;
  vtkDataArray* materials = polygons->GetCellData()->GetArray(MaterialArrayName);
  if (!materials)
  {
    return cut;
  }
  for (vtkIdType cell = 0; cell < polygons->GetNumberOfCells(); ++cell)
  {
    vtkIdType count = 0;
    const vtkIdType* ids = nullptr;
    polygons->GetCellPoints(cell, count, ids);
    CutCell& added = cut.Cells.emplace_back();
    added.Material = static_cast<int>(materials->GetTuple1(cell));
    for (vtkIdType corner = 0; corner < count; ++corner)
    {
      Vector3 point;
      polygons->GetPoint(ids[corner], point.data());
      const PicturePoint at = inPlane(point);
      added.Corners.push_back(at);
      cut.Least = { std::min(cut.Least.X, at.X), std::min(cut.Least.Y, at.Y) };
      cut.Most = { std::max(cut.Most.X, at.X), std::max(cut.Most.Y, at.Y) };
    }
  }
  for (int side = 0; side < 2 && !panel.Lines.empty(); ++side)
  {
    // Lines that the cells touch would else be halved.
    double& least = side == 0 ? cut.Least.X : cut.Least.Y;
    double& most = side == 0 ? cut.Most.X : cut.Most.Y;
    least -= LineMarginMm;
    most += LineMarginMm;
  }
  for (const std::vector<Vector3>& line : panel.Lines)
  {
    std::vector<PicturePoint>& added = cut.Lines.emplace_back();
    std::transform(line.begin(), line.end(), std::back_inserter(added), inPlane);
  }
  return cut;
}

/// Mean length of the sides of the cut cells, mm.
double MeanSideMm(const Cut& cut)
{
  double sum = 0;
  std::size_t count = 0;
  for (const CutCell& cell : cut.Cells)
  {
    for (std::size_t corner = 0; corner < cell.Corners.size(); ++corner)
    {
      const PicturePoint& a = cell.Corners[corner];
      const PicturePoint& b = cell.Corners[(corner + 1) % cell.Corners.size()];
      sum += std::hypot(a.X - b.X, a.Y - b.Y);
      ++count;
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

/// Supersampling pixels for each of `pixelMm`.
Picture DrawCut(const Cut& cut, int width, int height, double pixelMm)
{
  Picture picture(Supersampling * width, Supersampling * height);
  const double scale = Supersampling / pixelMm;
  const auto at = [&](const PicturePoint& point) {
    return PicturePoint{ (point.X - cut.Least.X) * scale, (point.Y - cut.Least.Y) * scale };
  };
  const bool withEdges = MeanSideMm(cut) > 3 * pixelMm;
  const auto color = [](const CutCell& cell)
  { return GroupColor(static_cast<std::size_t>(cell.Material) - 1); };
  for (const CutCell& cell : cut.Cells)
  {
    std::vector<PicturePoint> corners(cell.Corners.size());
    std::transform(cell.Corners.begin(), cell.Corners.end(), corners.begin(), at);
    picture.Polygon(corners, color(cell));
  }
  for (const CutCell& cell : cut.Cells)
  {
    for (std::size_t corner = 0; withEdges && corner < cell.Corners.size(); ++corner)
    {
      picture.Line(at(cell.Corners[corner]), at(cell.Corners[(corner + 1) % cell.Corners.size()]),
        2, Mixed({ 0, 0, 0 }, color(cell), 0.6));
    }
  }
  for (const std::vector<PicturePoint>& line : cut.Lines)
  {
    for (std::size_t point = 1; point < line.size(); ++point)
    {
      picture.Line(at(line[point - 1]), at(line[point]), 6, PictureInk);
    }
  }
  return picture;
}

void DrawScaleBar(Picture& picture, double x, double y, double pixelMm)
{
  const double lengthMm = TickStep(100 * pixelMm, 1);
  char text[32];
  std::snprintf(text, sizeof(text), "%g mm", lengthMm);
  picture.Box(x, y, x + lengthMm / pixelMm, y + 3, PictureInk);
  picture.Text(x + 0.5 * lengthMm / pixelMm, y + 16, 0.5, text);
}
}

void WriteCutPicture(const std::vector<CutPanel>& panels,
  const std::vector<std::string>& materialNames, const std::string& path)
{
  std::vector<Cut> cuts;
  double longestMm = 0;
  std::set<int> materials;
  for (const CutPanel& panel : panels)
  {
    cuts.push_back(MakeCut(panel));
    Cut& cut = cuts.back();
    if (cut.Cells.empty())
    {
      throw InputError("cut picture: expected a plane that meets the mesh, found none of it in '" +
        panel.Title + "'");
    }
    longestMm = std::max({ longestMm, cut.Width(), cut.Height() });
    for (const CutCell& cell : cut.Cells)
    {
      materials.insert(cell.Material);
    }
  }
  const double pixelMm = longestMm / LongestSidePixels;
  const auto pixels = [&](double mm) { return std::max(1, static_cast<int>(mm / pixelMm) + 1); };
  int width = CutMargin + CutLegendWidth;
  int height = 0;
  for (const Cut& cut : cuts)
  {
    width += pixels(cut.Width()) + CutMargin;
    height = std::max(height, pixels(cut.Height()));
  }
  Picture picture(width, height + TitleHeight + 2 * CutMargin);
  int left = CutMargin;
  for (std::size_t index = 0; index < cuts.size(); ++index)
  {
    const Cut& cut = cuts[index];
    const int across = pixels(cut.Width());
    picture.PasteShrunk(left, TitleHeight + CutMargin + (height - pixels(cut.Height())) / 2,
      Supersampling, DrawCut(cut, across, pixels(cut.Height()), pixelMm));
    picture.Text(left + 0.5 * across, 0.5 * TitleHeight, 0.5, panels[index].Title);
    left += across + CutMargin;
  }
  std::size_t row = 0;
  for (const int material : materials)
  {
    const auto index = static_cast<std::size_t>(material);
    picture.LegendEntry(left, picture.Height() - CutMargin, row++, index - 1,
      index < materialNames.size() ? materialNames[index] : "material " + std::to_string(material));
  }
  DrawScaleBar(picture, left, 0.5 * TitleHeight, pixelMm);
  picture.Write(path);
}

std::vector<CutPanel> CutsThrough(vtkUnstructuredGrid* mesh, const Vector3& point)
{
  char text[3][48];
  for (int axis = 0; axis < 3; ++axis)
  {
    std::snprintf(text[axis], sizeof(text[axis]), "%c = %.1f mm", "xyz"[axis], point[axis]);
  }
  const Vector3 x{ 1, 0, 0 };
  const Vector3 y{ 0, 1, 0 };
  const Vector3 z{ 0, 0, 1 };
  return { { mesh, point, x, y, std::string(text[2]) + " (right: x, up: y)", {} },
    { mesh, point, x, z, std::string(text[1]) + " (right: x, up: z)", {} },
    { mesh, point, y, z, std::string(text[0]) + " (right: y, up: z)", {} } };
}
}
