// SPDX-License-Identifier: Apache-2.0
#include "Private/MammogramPane.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ProjectionImage.h"
#include "mammoray/Registration/RegistrationTarget.h"

#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkCellArray.h"
#include "vtkFloatArray.h"
#include "vtkImageFlip.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mammoray
{
namespace
{
/// Black and white are this many standard deviations of the breast's grey from its mean.
constexpr double WindowSigmas = 2;
/// Log attenuation that counts as breast: beyond any air, below a millimetre of fat.
constexpr float LeastBreast = 0.03F;

struct GreyLevel
{
  double Mean = 0;
  double Deviation = 1;
};

/// Of the pixels where `inside` says so.
template <typename Inside>
GreyLevel LevelOf(const std::vector<float>& values, const Inside& inside)
{
  double count = 0;
  double sum = 0;
  double squares = 0;
  for (std::size_t pixel = 0; pixel < values.size(); ++pixel)
  {
    if (inside(pixel))
    {
      count += 1;
      sum += values[pixel];
      squares += static_cast<double>(values[pixel]) * values[pixel];
    }
  }
  if (count == 0)
  {
    return {};
  }
  const double mean = sum / count;
  return { mean, std::max(std::sqrt(std::max(squares / count - mean * mean, 0.0)), 1e-6) };
}
}

MammogramPane::MammogramPane(const ViewedBreast& viewed, LiveMammogram& live)
  : Grid(live.Grid(1))
  , Over(this->View)
  , Marks(vtkSmartPointer<vtkPolyData>::New())
{
  // Chest wall left for the left breast; where the side is not known, as the pixels run.
  const bool rightBreast = viewed.Laterality == 'R' ||
    (viewed.Laterality != 'L' && (this->Grid.ColumnStep[1] < 0 || this->Grid.RowStep[1] < 0));
  const double roll = viewed.Pose.RollDeg * std::numbers::pi / 180;
  // Gantry x along patient left and head (MammographyGeometry.h).
  const double head = -std::sin(roll);
  const bool oblique = std::abs(head) > 0.25;
  const double up = oblique ? head : (rightBreast ? -1 : 1) * std::cos(roll);
  this->Right = rightBreast ? -1 : 1;
  this->Up = up > 0 ? 1 : -1;
  const VolumeFromGantry placed = live.Placed();
  const auto letters = [&](double sign, const Vector3& direction)
  { return DirectionLetters(sign * direction, viewed.Axes); };
  this->Over.SetLetters({ letters(-this->Right, placed.Y), letters(this->Right, placed.Y),
    letters(this->Up, placed.X), letters(-this->Up, placed.X) });

  this->Synthetic = live.Project(1);
  const GreyLevel level = LevelOf(this->Synthetic,
    [&](std::size_t pixel) { return this->Synthetic[pixel] > LeastBreast; });
  this->Black = std::max(level.Mean - WindowSigmas * level.Deviation, 0.0);
  this->White = level.Mean + WindowSigmas * level.Deviation;
  if (viewed.Real)
  {
    this->Breast = viewed.Real->BreastMask;
    // Its grey has an arbitrary scale where the picture was made for presentation.
    const GreyLevel real = LevelOf(viewed.Real->LogAttenuation,
      [&](std::size_t pixel) { return viewed.Real->BreastMask[pixel] != 0; });
    for (int divisor = 1; divisor <= 2; ++divisor)
    {
      const RegistrationTarget target = divisor == 1 ? *viewed.Real : Coarsen(*viewed.Real, 2);
      std::vector<float>& grey = this->RealGrey[static_cast<std::size_t>(divisor - 1)];
      for (const float value : target.LogAttenuation)
      {
        const double scaled = level.Mean + (value - real.Mean) / real.Deviation * level.Deviation;
        grey.push_back(static_cast<float>((scaled - this->Black) / (this->White - this->Black)));
      }
    }
  }

  this->View->SetBackground(0, 0, 0);
  this->Texture->SetInputData(this->Image);
  this->Texture->SetColorModeToDirectScalars();
  this->Texture->InterpolateOn();
  // Else the interpolation at one edge mixes in the other, the chest wall beside the air.
  this->Texture->RepeatOff();
  this->Texture->EdgeClampOn();
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> coordinates;
  coordinates->SetNumberOfComponents(2);
  for (int corner = 0; corner < 4; ++corner)
  {
    const ReceptorPoint at =
      this->Grid.PositionOf((corner & 1) != 0 ? this->Grid.Columns - 0.5 : -0.5,
        (corner & 2) != 0 ? this->Grid.Rows - 0.5 : -0.5);
    points->InsertNextPoint(at[0], at[1], 0);
    coordinates->InsertNextTuple2(corner & 1, corner >> 1);
  }
  vtkNew<vtkCellArray> faces;
  constexpr vtkIdType corners[4] = { 0, 1, 3, 2 };
  faces->InsertNextCell(4, corners);
  vtkNew<vtkPolyData> rectangle;
  rectangle->SetPoints(points);
  rectangle->SetPolys(faces);
  rectangle->GetPointData()->SetTCoords(coordinates);
  for (vtkPolyData* data : { rectangle.Get(), this->Marks.Get() })
  {
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(data);
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->LightingOff();
    if (data == rectangle)
    {
      actor->SetTexture(this->Texture);
    }
    else
    {
      actor->GetProperty()->SetColor(0.1, 0.9, 0.45);
      actor->GetProperty()->SetLineWidth(2);
    }
    this->View->AddActor(actor);
  }
  this->Compose();
  this->Frame();
}

void MammogramPane::Update(LiveMammogram& live, int divisor)
{
  this->Synthetic = live.Project(divisor);
  this->Divisor = divisor;
  this->Compose();
}

void MammogramPane::SetBlend(double real)
{
  this->Real = this->RealGrey[0].empty() ? 0 : std::clamp(real, 0.0, 1.0);
  this->Compose();
}

void MammogramPane::Adjust(double windowFactor, double levelShare)
{
  const double window = this->High - this->Low;
  const double level = 0.5 * (this->Low + this->High) + levelShare * window;
  this->Low = level - 0.5 * windowFactor * window;
  this->High = level + 0.5 * windowFactor * window;
  this->Compose();
}

void MammogramPane::ResetWindow()
{
  this->Low = 0;
  this->High = 1;
  this->Compose();
}

void MammogramPane::Compose()
{
  const int columns = this->Grid.Columns / this->Divisor;
  const int rows = this->Grid.Rows / this->Divisor;
  this->Image->SetDimensions(columns, rows, 1);
  if (this->Image->GetScalarType() != VTK_UNSIGNED_CHAR ||
    this->Image->GetPointData()->GetScalars() == nullptr ||
    this->Image->GetPointData()->GetScalars()->GetNumberOfTuples() !=
      static_cast<vtkIdType>(this->Synthetic.size()))
  {
    this->Image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  }
  auto* grey = static_cast<unsigned char*>(this->Image->GetScalarPointer());
  const auto black = static_cast<float>(this->Black);
  const auto scale = static_cast<float>(1 / (this->White - this->Black));
  const auto low = static_cast<float>(this->Low);
  const auto stretch = static_cast<float>(1 / (this->High - this->Low));
  const auto share = static_cast<float>(this->Real);
  const std::vector<float>& real = this->RealGrey[static_cast<std::size_t>(this->Divisor - 1)];
  for (std::size_t pixel = 0; pixel < this->Synthetic.size(); ++pixel)
  {
    float value = (this->Synthetic[pixel] - black) * scale;
    if (share > 0)
    {
      value += share * (real[pixel] - value);
    }
    value = (value - low) * stretch;
    grey[pixel] = static_cast<unsigned char>(255.0F * std::clamp(value, 0.0F, 1.0F) + 0.5F);
  }
  this->Image->Modified();
}

void MammogramPane::SetMark(const std::vector<ReceptorPoint>& points,
  const std::vector<std::vector<ReceptorPoint>>& loops, const std::vector<ReceptorPoint>& drawn)
{
  constexpr double ArmMm = 3;
  vtkNew<vtkPoints> places;
  vtkNew<vtkCellArray> lines;
  // Between the picture and the camera, which stands on either side.
  const double front = -this->Right * this->Up;
  const auto add = [&](const std::vector<ReceptorPoint>& line, bool closed)
  {
    lines->InsertNextCell(static_cast<int>(line.size()) + (closed ? 1 : 0));
    const vtkIdType first = places->GetNumberOfPoints();
    for (const ReceptorPoint& point : line)
    {
      lines->InsertCellPoint(places->InsertNextPoint(point[0], point[1], front));
    }
    if (closed)
    {
      lines->InsertCellPoint(first);
    }
  };
  for (const auto& [x, y] : points)
  {
    add({ { x - ArmMm, y }, { x + ArmMm, y } }, false);
    add({ { x, y - ArmMm }, { x, y + ArmMm } }, false);
  }
  for (const std::vector<ReceptorPoint>& loop : loops)
  {
    add(loop, true);
  }
  if (drawn.size() > 1)
  {
    add(drawn, false);
  }
  this->Marks->SetPoints(places);
  this->Marks->SetLines(lines);
}

/// All of the breast, in either picture, and the chest wall's edge.
void MammogramPane::Frame()
{
  constexpr double MarginMm = 8;
  std::array<Extent, 2> reach;
  const auto show = [&reach](const ReceptorPoint& at)
  {
    reach[0].Add(at[0]);
    reach[1].Add(at[1]);
  };
  const int columns = this->Grid.Columns / this->Divisor;
  for (std::size_t pixel = 0; pixel < this->Synthetic.size(); ++pixel)
  {
    const int column = static_cast<int>(pixel % static_cast<std::size_t>(columns)) * this->Divisor;
    const int row = static_cast<int>(pixel / static_cast<std::size_t>(columns)) * this->Divisor;
    const bool real = !this->Breast.empty() &&
      this->Breast[static_cast<std::size_t>(row) * this->Grid.Columns + column] != 0;
    if (this->Synthetic[pixel] > LeastBreast || real)
    {
      show(this->Grid.PositionOf(column, row));
    }
  }
  if (!(reach[0].Length() > 0))
  {
    reach = {};
    show(this->Grid.PositionOf(0, 0));
    show(this->Grid.PositionOf(this->Grid.Columns - 1, this->Grid.Rows - 1));
  }
  else
  {
    reach[1].Add(0);
  }
  const ReceptorPoint middle{ reach[0].Middle(), reach[1].Middle() };
  // Gantry y runs to the right or left, x up or down: seen from above or from below.
  const double side = -this->Right * this->Up;
  vtkCamera* camera = this->View->GetActiveCamera();
  camera->ParallelProjectionOn();
  camera->SetFocalPoint(middle[0], middle[1], 0);
  camera->SetPosition(middle[0], middle[1], 500 * side);
  camera->SetViewUp(this->Up, 0, 0);
  const double height = reach[0].Length() + 2 * MarginMm;
  const double width = reach[1].Length() + 2 * MarginMm;
  const double aspect = this->View->GetTiledAspectRatio();
  camera->SetParallelScale(0.5 * std::max(height, width / (aspect > 0 ? aspect : 1)));
  this->View->ResetCameraClippingRange();
}

bool MammogramPane::PixelAt(int x, int y, double& column, double& row) const
{
  vtkRenderer* view = this->View;
  view->SetDisplayPoint(x, y, 0);
  view->DisplayToWorld();
  double world[4];
  view->GetWorldPoint(world);
  const double dx = world[0] / world[3] - this->Grid.Origin[0];
  const double dy = world[1] / world[3] - this->Grid.Origin[1];
  const std::array<double, 2>& u = this->Grid.ColumnStep;
  const std::array<double, 2>& v = this->Grid.RowStep;
  const double determinant = u[0] * v[1] - u[1] * v[0];
  column = (dx * v[1] - dy * v[0]) / determinant;
  row = (u[0] * dy - u[1] * dx) / determinant;
  return column >= -0.5 && row >= -0.5 && column <= this->Grid.Columns - 0.5 &&
    row <= this->Grid.Rows - 0.5;
}

void MammogramPane::Write(const std::string& path) const
{
  // VTK's row 0 is at the bottom.
  vtkNew<vtkImageFlip> flip;
  flip->SetInputData(this->Image);
  flip->SetFilteredAxis(1);
  flip->Update();
  WritePicture(flip->GetOutput(), path);
}
}
