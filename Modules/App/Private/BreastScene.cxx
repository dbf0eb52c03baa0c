// SPDX-License-Identifier: Apache-2.0
#include "Private/BreastScene.h"

#include "Private/SceneShapes.h"
#include "mammoray/Registration/PosedBreast.h"
#include "mammoray/Study/StudyPictures.h"

#include "vtkActor.h"
#include "vtkBillboardTextActor3D.h"
#include "vtkCamera.h"
#include "vtkCell.h"
#include "vtkCellArray.h"
#include "vtkCellPicker.h"
#include "vtkDataSet.h"
#include "vtkIdList.h"
#include "vtkMapper.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkQuadricClustering.h"
#include "vtkTextProperty.h"
#include "vtkTexture.h"

#include <algorithm>
#include <map>

namespace mammoray
{
namespace
{
constexpr Color SkinColor{ 0.93, 0.76, 0.66 };
constexpr Color PlateColor{ 0.55, 0.75, 0.95 };
constexpr Color MarkColor{ 0.1, 0.9, 0.45 };
/// Of the material that lies around the others, fat in a breast.
constexpr Color HostColor{ 0.93, 0.82, 0.50 };
/// Of what lies inside, in the materials' order.
constexpr Color InnerColors[] = { { 0.80, 0.30, 0.35 }, { 0.60, 0.35, 0.65 }, { 0.25, 0.55, 0.60 },
  { 0.85, 0.60, 0.20 }, { 0.30, 0.40, 0.75 }, { 0.45, 0.60, 0.25 } };
/// Edges of the triangles drawn, mm: no frame is to wait for them.
constexpr double InnerCellMm = 2;
constexpr double SkinCellMm = 4;
constexpr double SkinOpacity = 0.28;
constexpr double PlateOpacity = 0.35;
constexpr double PlateThicknessMm = 3;
/// Share of the way to the source at which it is drawn.
constexpr double ShownShare = 0.18;

/// A box whose corners SetBox places.
vtkSmartPointer<vtkPolyData> NewBox()
{
  auto box = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetNumberOfPoints(8);
  box->SetPoints(points);
  vtkNew<vtkCellArray> faces;
  constexpr vtkIdType corners[6][4] = { { 0, 1, 3, 2 }, { 4, 6, 7, 5 }, { 0, 4, 5, 1 },
    { 2, 3, 7, 6 }, { 0, 2, 6, 4 }, { 1, 5, 7, 3 } };
  for (const auto& face : corners)
  {
    faces->InsertNextCell(4, face);
  }
  box->SetPolys(faces);
  return box;
}

/// The slab of a plate over `from` to `to` along its chest-wall edge and `depth` into it.
void SetPlate(vtkPolyData* box, const Plate& plate, const Vector3& along, double from, double to,
  double depth)
{
  for (int corner = 0; corner < 8; ++corner)
  {
    const Vector3 point = plate.Edge + ((corner & 1) != 0 ? to : from) * along +
      ((corner & 2) != 0 ? depth : 0.0) * plate.Inward -
      ((corner & 4) != 0 ? PlateThicknessMm : 0.0) * plate.Normal;
    box->GetPoints()->SetPoint(corner, point.data());
  }
  box->GetPoints()->Modified();
}

}

std::vector<std::array<double, 3>> TissueColors(const MaterialTable& table, int host)
{
  std::vector<Color> colors{ { 0, 0, 0 } };
  std::size_t inner = 0;
  for (std::size_t material = 1; material < table.Materials.size(); ++material)
  {
    const bool around = static_cast<int>(material) == host;
    const bool thin = table.Materials[material].Thin;
    colors.push_back(around ? HostColor : thin ? SkinColor : InnerColors[inner]);
    inner = around || thin ? inner : (inner + 1) % std::size(InnerColors);
  }
  return colors;
}

BreastScene::BreastScene(const LiveMammogram& live, const ViewedBreast& viewed)
  : Surface(live.Surface())
  , PointIds(live.SurfacePoints())
{
  this->View->SetBackground(0.09, 0.10, 0.13);
  this->Front->SetLayer(1);
  this->Front->InteractiveOff();
  this->Front->SetActiveCamera(this->View->GetActiveCamera());
  this->Points->SetDataTypeToFloat();
  this->Points->SetNumberOfPoints(static_cast<vtkIdType>(this->PointIds.size()));
  int host = 0;
  const std::vector<int> enclosed = EnclosedMaterials(this->Surface, viewed.Materials, &host);
  this->Colors = mammoray::TissueColors(viewed.Materials, host);
  std::map<int, std::vector<std::size_t>> inner;
  std::vector<std::size_t> outer;
  for (std::size_t triangle = 0; triangle < this->Surface.NumberOfTriangles(); ++triangle)
  {
    const int material = enclosed[triangle];
    const bool air =
      this->Surface.FrontMaterials[triangle] == 0 || this->Surface.BackMaterials[triangle] == 0;
    if (material > 0)
    {
      inner[material].push_back(triangle);
    }
    else if (air)
    {
      outer.push_back(triangle);
    }
  }
  for (const auto& [material, triangles] : inner)
  {
    this->AddPart(triangles, InnerCellMm, this->Colors[static_cast<std::size_t>(material)], 1);
  }
  this->AddPart(outer, SkinCellMm, SkinColor, inner.empty() ? 1 : SkinOpacity);

  this->MarkedLine = NewLines();
  this->MarkedLoops = NewLines();
  this->MarkedPoint = AddActor(this->Front, NewBall(1.5), MarkColor, 1);
  this->MarkedPoint->VisibilityOff();
  for (vtkPolyData* lines : { this->MarkedLine.Get(), this->MarkedLoops.Get() })
  {
    const auto actor = AddActor(this->Front, lines, MarkColor, 1);
    actor->GetProperty()->LightingOff();
    actor->GetProperty()->SetLineWidth(2);
  }
}

/// Fewer triangles over some of the same points, for software OpenGL: Lindstrom's quadric
/// clustering.
std::vector<vtkIdType> BreastScene::Thinned(const std::vector<std::size_t>& triangles,
  double cellMm) const
{
  std::map<std::array<float, 3>, vtkIdType> idOf;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToFloat();
  for (std::size_t id = 0; id < this->Surface.NumberOfPoints(); ++id)
  {
    std::array<float, 3> place{};
    std::copy_n(&this->Surface.Points[3 * id], 3, place.begin());
    points->InsertNextPoint(place.data());
    idOf.emplace(place, static_cast<vtkIdType>(id));
  }
  vtkNew<vtkCellArray> cells;
  for (const std::size_t triangle : triangles)
  {
    const std::uint32_t* corner = &this->Surface.Triangles[3 * triangle];
    const vtkIdType ids[3] = { corner[0], corner[1], corner[2] };
    cells->InsertNextCell(3, ids);
  }
  vtkNew<vtkPolyData> whole;
  whole->SetPoints(points);
  whole->SetPolys(cells);
  vtkNew<vtkQuadricClustering> clustering;
  clustering->SetInputData(whole);
  clustering->SetUseInputPoints(1);
  clustering->SetDivisionSpacing(cellMm, cellMm, cellMm);
  clustering->Update();
  vtkPolyData* thin = clustering->GetOutput();
  std::vector<vtkIdType> corners;
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < thin->GetNumberOfCells(); ++cell)
  {
    thin->GetCellPoints(cell, ids);
    for (vtkIdType corner = 0; ids->GetNumberOfIds() == 3 && corner < 3; ++corner)
    {
      double place[3];
      thin->GetPoint(ids->GetId(corner), place);
      corners.push_back(idOf.at({ static_cast<float>(place[0]), static_cast<float>(place[1]),
        static_cast<float>(place[2]) }));
    }
  }
  return corners;
}

void BreastScene::AddPart(const std::vector<std::size_t>& triangles, double cellMm,
  const Color& color, double opacity)
{
  const std::vector<vtkIdType> corners = this->Thinned(triangles, cellMm);
  vtkNew<vtkCellArray> cells;
  for (std::size_t corner = 0; corner < corners.size(); corner += 3)
  {
    cells->InsertNextCell(3, &corners[corner]);
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(this->Points);
  data->SetPolys(cells);
  this->Parts.push_back({ AddActor(this->View, data, color, opacity), corners });
}

void BreastScene::LookFromFront(const VolumeFromGantry& placed, char laterality)
{
  const double side = laterality == 'R' ? -1 : 1;
  const Vector3 from = placed.Direction({ 0.75 * side, 0.62, 0.22 });
  vtkCamera* camera = this->View->GetActiveCamera();
  camera->SetFocalPoint(0, 0, 0);
  camera->SetPosition(from.data());
  camera->SetViewUp(placed.Z.data());
  this->View->ResetCamera();
  camera->Zoom(1.25); // that fits the sphere around the scene, which is wider than it
  this->View->ResetCameraClippingRange();
}

void BreastScene::AddLetters(const AnatomicalAxes& axes, const std::vector<double>& points)
{
  constexpr double BesideMm = 8;
  const std::pair<Vector3, const char*> named[] = { { axes.Left, "LR" }, { axes.Anterior, "AP" },
    { axes.Superior, "HF" } };
  const std::array<Extent, 3> reach =
    ExtentsAlong(std::array{ axes.Left, axes.Anterior, axes.Superior }, points);
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    for (const int end : { 0, 1 })
    {
      Vector3 at{ 0, 0, 0 };
      for (std::size_t other = 0; other < 3; ++other)
      {
        const double along = other != axis ? reach[other].Middle()
          : end == 0                       ? reach[other].High + BesideMm
                                           : reach[other].Low - BesideMm;
        at = at + along * named[other].first;
      }
      vtkNew<vtkBillboardTextActor3D> letter;
      letter->SetInput(std::string(1, named[axis].second[end]).c_str());
      letter->SetPosition(at.data());
      letter->GetTextProperty()->SetFontSize(16);
      letter->GetTextProperty()->SetColor(0.85, 0.87, 0.90);
      letter->GetTextProperty()->SetJustificationToCentered();
      letter->GetTextProperty()->SetVerticalJustificationToCentered();
      letter->PickableOff();
      letter->UseBoundsOff(); // of its pixels: the camera that frames the breast would follow them
      this->View->AddActor(letter);
    }
  }
}

void BreastScene::SetPoints(const std::vector<double>& points)
{
  for (std::size_t id = 0; id < this->PointIds.size(); ++id)
  {
    this->Points->SetPoint(static_cast<vtkIdType>(id),
      &points[3 * static_cast<std::size_t>(this->PointIds[id])]);
  }
  this->Points->Modified();
  for (const Part& part : this->Parts)
  {
    part.Actor->GetMapper()->GetInputAsDataSet()->Modified();
  }
}

void BreastScene::SetUnit(const LiveMammogram& live, vtkTexture* picture)
{
  if (!this->Receptor)
  {
    this->Support = NewBox();
    this->Paddle = NewBox();
    for (vtkPolyData* plate : { this->Support.Get(), this->Paddle.Get() })
    {
      AddActor(this->View, plate, PlateColor, PlateOpacity)->GetProperty()->LightingOff();
    }
    this->Receptor = NewPictureRectangle();
    this->ReceptorActor = AddActor(this->View, this->Receptor, { 1, 1, 1 }, 1);
    this->ReceptorActor->GetProperty()->LightingOff();
    this->ReceptorActor->SetTexture(picture);
    this->BeamEdges = NewLines();
    AddActor(this->View, this->BeamEdges, BeamColor, 1)->GetProperty()->LightingOff();
    this->Source = AddActor(this->View, NewBall(6), BeamColor, 1);
  }
  const VolumeFromGantry placed = live.Placed();
  const ReceptorGrid& grid = live.Grid(1);
  const Vector3 source = live.SourcePosition();
  double low = 1e9;
  double high = -1e9;
  double depth = 0;
  std::vector<Vector3> corners;
  for (int corner = 0; corner < 4; ++corner)
  {
    const ReceptorPoint at = grid.PositionOf((corner & 1) != 0 ? grid.Columns - 0.5 : -0.5,
      (corner & 2) != 0 ? grid.Rows - 0.5 : -0.5);
    corners.push_back(placed.Point({ at[0], at[1], 0 }));
    this->Receptor->GetPoints()->SetPoint(corner, corners.back().data());
    low = std::min(low, at[0]);
    high = std::max(high, at[0]);
    depth = std::max(depth, at[1]);
  }
  this->Receptor->GetPoints()->Modified();
  this->Middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  const PlatePair plates = live.Plates();
  SetPlate(this->Support, plates.Support, placed.X, low, high, depth);
  SetPlate(this->Paddle, plates.Paddle, placed.X, low, high, depth);
  const auto towardsSource = [&](const Vector3& from)
  { return from + ShownShare * (source - from); };
  std::vector<std::vector<Vector3>> edges;
  edges.reserve(corners.size() + 1);
  for (const Vector3& corner : corners)
  {
    edges.push_back({ corner, towardsSource(corner) });
  }
  this->SourceShown = towardsSource(this->Middle);
  edges.push_back({ this->Middle, this->SourceShown });
  SetLines(this->BeamEdges, edges, false);
  this->Source->SetPosition(this->SourceShown.data());
}

Vector3 BreastScene::SourceAt(const Vector3& shown) const
{
  return this->Middle + (1 / ShownShare) * (shown - this->Middle);
}

void BreastScene::SetMark(const std::vector<Vector3>& point, const std::vector<Vector3>& line,
  const std::vector<Loop>& loops)
{
  this->MarkedPoint->SetVisibility(point.empty() ? 0 : 1);
  if (!point.empty())
  {
    Vector3 position = point.front();
    this->MarkedPoint->SetPosition(position.data());
  }
  SetLines(this->MarkedLine, { line }, false);
  SetLines(this->MarkedLoops, loops, true);
}

std::optional<Vector3> BreastScene::Pick(int x, int y, const TetrahedralMesh& rest)
{
  // Opaque parts hide each other and are picked together; the skin where they are missed.
  for (const bool skin : { false, true })
  {
    vtkNew<vtkCellPicker> picker;
    picker->SetTolerance(0);
    picker->PickFromListOn();
    for (const Part& part : this->Parts)
    {
      if ((&part == &this->Parts.back()) == skin)
      {
        picker->AddPickList(part.Actor);
      }
    }
    if (picker->Pick(x, y, 0, this->View) == 0 || picker->GetCellId() < 0)
    {
      continue;
    }
    const auto part = std::find_if(this->Parts.begin(), this->Parts.end(),
      [&](const Part& candidate) { return candidate.Actor == picker->GetActor(); });
    if (part == this->Parts.end())
    {
      continue;
    }
    double parametric[3];
    picker->GetPCoords(parametric);
    const double weights[] = { 1 - parametric[0] - parametric[1], parametric[0], parametric[1] };
    Vector3 point{ 0, 0, 0 };
    for (std::size_t corner = 0; corner < 3; ++corner)
    {
      const vtkIdType id =
        part->Corners[3 * static_cast<std::size_t>(picker->GetCellId()) + corner];
      point = point +
        weights[corner] *
          rest.Point(static_cast<std::size_t>(this->PointIds[static_cast<std::size_t>(id)]));
    }
    return point;
  }
  return std::nullopt;
}

bool BreastScene::OnSource(int x, int y)
{
  return this->Source && IsAt(this->View, this->Source, x, y);
}
}
