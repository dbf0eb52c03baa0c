// SPDX-License-Identifier: Apache-2.0
#include "Private/SampleScene.h"

#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkCellArray.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkProperty.h"
#include "vtkQuadricClustering.h"
#include "vtkTexture.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace mammoray
{
namespace
{
constexpr Color SampleColors[] = { { 0.62, 0.68, 0.76 }, { 0.85, 0.55, 0.25 }, { 0.35, 0.62, 0.60 },
  { 0.72, 0.40, 0.55 }, { 0.55, 0.62, 0.30 }, { 0.40, 0.48, 0.78 } };
constexpr Color AxisColor{ 0.1, 0.9, 0.45 };
/// Of a material that has others in it.
constexpr double OuterOpacity = 0.35;
/// More triangles than this are thinned for software OpenGL.
constexpr std::size_t MostDrawn = 60000;
/// How far source and detector are drawn from the samples' middle, diagonals of their box.
constexpr double SourceDiagonals = 1.7;
constexpr double DetectorDiagonals = 0.9;

struct MaterialPart
{
  vtkNew<vtkCellArray> Triangles;
  std::array<Extent, 3> Box;

  bool Holds(const MaterialPart& other) const
  {
    bool holds = this != &other;
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      holds = holds && this->Box[axis].Low <= other.Box[axis].Low &&
        this->Box[axis].High >= other.Box[axis].High;
    }
    return holds;
  }
};

vtkSmartPointer<vtkPolyData> Thinned(vtkPolyData* whole)
{
  if (static_cast<std::size_t>(whole->GetNumberOfPolys()) <= MostDrawn)
  {
    return whole;
  }
  vtkNew<vtkQuadricClustering> clustering;
  clustering->SetInputData(whole);
  clustering->SetNumberOfDivisions(120, 120, 120);
  clustering->Update();
  return clustering->GetOutput();
}
}

SampleScene::SampleScene(const MaterialTable& materials, const LiveProjection& live,
  vtkTexture* picture)
{
  this->View->SetBackground(0.09, 0.10, 0.13);
  const std::array<Extent, 3> box =
    ExtentsAlong<3>({ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } }, live.Surface().Points);
  this->Middle = live.Axis().Point;
  this->Diagonal = Norm({ box[0].Length(), box[1].Length(), box[2].Length() });
  this->MaterialColors.push_back({ 0, 0, 0 });
  for (std::size_t material = 1; material < materials.Materials.size(); ++material)
  {
    this->MaterialColors.push_back(SampleColors[(material - 1) % std::size(SampleColors)]);
  }
  this->AddSamples(live);
  this->Detector = NewPictureRectangle();
  const auto detector = AddActor(this->View, this->Detector, { 1, 1, 1 }, 1);
  detector->GetProperty()->LightingOff();
  detector->SetTexture(picture);
  this->BeamEdges = NewLines();
  AddActor(this->View, this->BeamEdges, BeamColor, 1)->GetProperty()->LightingOff();
  this->AxisLine = NewLines();
  AddActor(this->View, this->AxisLine, AxisColor, 1)->GetProperty()->LightingOff();
  this->Source = AddActor(this->View, NewBall(0.03 * this->Diagonal), BeamColor, 1);
  this->Source->SetVisibility(live.Source().Type == XRaySource::Kind::Point ? 1 : 0);
}

void SampleScene::AddSamples(const LiveProjection& live)
{
  const SurfaceMesh& surface = live.Surface();
  vtkNew<vtkPoints> points;
  // Single precision: seen from their middle small samples keep their digits far from the origin.
  for (std::size_t id = 0; id < surface.NumberOfPoints(); ++id)
  {
    Vector3 point{ 0, 0, 0 };
    std::copy_n(&surface.Points[3 * id], 3, point.begin());
    points->InsertNextPoint((point - this->Middle).data());
  }
  std::map<int, MaterialPart> parts;
  for (std::size_t triangle = 0; triangle < surface.NumberOfTriangles(); ++triangle)
  {
    const int back = surface.BackMaterials[triangle];
    MaterialPart& part = parts[back != 0 ? back : surface.FrontMaterials[triangle]];
    const std::uint32_t* corners = &surface.Triangles[3 * triangle];
    const vtkIdType ids[3] = { corners[0], corners[1], corners[2] };
    part.Triangles->InsertNextCell(3, ids);
    for (const std::uint32_t id : { corners[0], corners[1], corners[2] })
    {
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        part.Box[axis].Add(surface.Points[3 * static_cast<std::size_t>(id) + axis]);
      }
    }
  }
  for (const auto& [material, part] : parts)
  {
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetPolys(part.Triangles);
    const MaterialPart& own = part;
    const bool outer = std::any_of(parts.begin(), parts.end(),
      [&own](const auto& other) { return own.Holds(other.second); });
    const auto color = static_cast<std::size_t>(material) < this->MaterialColors.size()
      ? this->MaterialColors[static_cast<std::size_t>(material)]
      : Color{ 1, 1, 1 };
    const auto actor = AddActor(this->View, Thinned(data), color, outer ? OuterOpacity : 1);
    actor->SetUserTransform(this->Turned);
  }
}

void SampleScene::Update(const LiveProjection& live)
{
  const Vector3& axis = live.Axis().Direction;
  this->Turned->Identity();
  this->Turned->Translate(this->Middle.data());
  this->Turned->RotateWXYZ(live.Turn(), axis.data());

  const XRaySource& source = live.Source();
  const XRayDetector& grid = live.Detector(1);
  const bool point = source.Type == XRaySource::Kind::Point;
  // Where the source stands when it is not moved.
  const Vector3 towards =
    point ? source.Position - live.SourceOffset() - this->Middle : -1.0 * source.Direction;
  const Vector3 up = (1 / Norm(towards)) * towards;
  const double distance = point ? Norm(towards) : SourceDiagonals * this->Diagonal;
  const double shownDistance = std::min(distance, SourceDiagonals * this->Diagonal);
  this->Share = shownDistance < distance ? 1 / live.SourceGain() : 1;
  this->SourceShown = this->Middle + shownDistance * up + this->Share * live.SourceOffset();

  // The plane nearer the samples, along each corner's ray.
  const Vector3 normal = Cross(grid.ColumnStep, grid.RowStep);
  const double behind = Dot(grid.Origin - this->Middle, normal) / Dot(-1.0 * up, normal);
  const double shown = std::min(behind, DetectorDiagonals * this->Diagonal);
  const double shrunk =
    point && behind > 0 ? (distance + std::max(shown, 0.0)) / (distance + behind) : 1;
  const Vector3 shift = point || behind <= 0 ? Vector3{ 0, 0, 0 } : (behind - shown) * up;
  std::vector<std::vector<Vector3>> edges;
  for (int corner = 0; corner < 4; ++corner)
  {
    const Vector3 pixel = grid.Origin +
      ((corner & 1) != 0 ? grid.Columns - 0.5 : -0.5) * grid.ColumnStep +
      ((corner & 2) != 0 ? grid.Rows - 0.5 : -0.5) * grid.RowStep;
    const Vector3 at = point ? source.Position + shrunk * (pixel - source.Position) : pixel + shift;
    this->Detector->GetPoints()->SetPoint(corner, at.data());
    const Vector3 back = point ? source.Position - at : up;
    const double length = Dot(this->SourceShown - at, up) / Dot(back, up);
    edges.push_back({ at, at + length * back });
  }
  this->Detector->GetPoints()->Modified();
  edges.push_back({ this->SourceShown, this->Middle - std::max(shown, 0.0) * up });
  SetLines(this->BeamEdges, edges, false);
  const Vector3 half = (0.7 * this->Diagonal / Norm(axis)) * axis;
  SetLines(this->AxisLine, { { this->Middle - half, this->Middle + half } }, false);
  this->Source->SetPosition(this->SourceShown.data());
  this->View->ResetCameraClippingRange();
}

void SampleScene::LookAt(const LiveProjection& live)
{
  const XRayDetector& grid = live.Detector(1);
  const Vector3 right = (1 / Norm(grid.ColumnStep)) * grid.ColumnStep;
  const Vector3 up = (-1 / Norm(grid.RowStep)) * grid.RowStep;
  const Vector3 towards = live.Source().Type == XRaySource::Kind::Point
    ? live.Source().Position - this->Middle
    : -1.0 * live.Source().Direction;
  const Vector3 from = (0.55 / Norm(towards)) * towards + 0.8 * right + 0.45 * up;
  vtkCamera* camera = this->View->GetActiveCamera();
  camera->SetFocalPoint(this->Middle.data());
  camera->SetPosition((this->Middle + this->Diagonal * from).data());
  camera->SetViewUp(up.data());
  this->View->ResetCamera();
  this->View->ResetCameraClippingRange();
}

bool SampleScene::OnSource(int x, int y)
{
  return IsAt(this->View, this->Source, x, y);
}
}
