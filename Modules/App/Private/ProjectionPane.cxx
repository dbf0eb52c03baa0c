// SPDX-License-Identifier: Apache-2.0
#include "Private/ProjectionPane.h"

#include "Private/SceneShapes.h"
#include "mammoray/IO/ProjectionImage.h"

#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkImageFlip.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkProperty.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
ProjectionPane::ProjectionPane(LiveProjection& live)
  : Grid(live.Detector(1))
  , ColumnMm(Norm(live.Detector(1).ColumnStep))
  , RowMm(Norm(live.Detector(1).RowStep))
  , Over(this->View)
{
  this->View->SetBackground(0, 0, 0);
  this->Texture->SetInputData(this->Image);
  this->Texture->SetColorModeToDirectScalars();
  this->Texture->InterpolateOn();
  this->Texture->RepeatOff();
  this->Texture->EdgeClampOn();
  const auto rectangle = NewPictureRectangle();
  for (int corner = 0; corner < 4; ++corner)
  {
    rectangle->GetPoints()->SetPoint(corner,
      this->ColumnMm * ((corner & 1) != 0 ? this->Grid.Columns - 0.5 : -0.5),
      -this->RowMm * ((corner & 2) != 0 ? this->Grid.Rows - 0.5 : -0.5), 0);
  }
  const auto actor = AddActor(this->View, rectangle, { 1, 1, 1 }, 1);
  actor->GetProperty()->LightingOff();
  actor->SetTexture(this->Texture);
  this->Over.SetTitle("X-ray");
  this->Update(live, 1);
  this->ResetWindow();
  this->Frame();
}

void ProjectionPane::Update(LiveProjection& live, int divisor)
{
  this->Values = live.Project(divisor);
  this->Columns = live.Detector(divisor).Columns;
  this->Rows = live.Detector(divisor).Rows;
  this->Compose();
}

void ProjectionPane::Adjust(double windowFactor, double levelShare)
{
  const double window = this->White - this->Black;
  const double level = 0.5 * (this->Black + this->White) + levelShare * window;
  this->Black = level - 0.5 * windowFactor * window;
  this->White = level + 0.5 * windowFactor * window;
  this->Compose();
}

void ProjectionPane::ResetWindow()
{
  std::vector<float> sorted = this->Values;
  const auto most = sorted.begin() + static_cast<std::ptrdiff_t>(0.999 * (sorted.size() - 1));
  std::nth_element(sorted.begin(), most, sorted.end());
  this->Black = 0;
  this->White = std::isfinite(*most) && *most > 1e-6F ? *most : 1;
  this->Compose();
}

void ProjectionPane::Compose()
{
  const int* now = this->Image->GetDimensions();
  if (now[0] != this->Columns || now[1] != this->Rows)
  {
    this->Image->SetDimensions(this->Columns, this->Rows, 1);
    this->Image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  }
  auto* grey = static_cast<unsigned char*>(this->Image->GetScalarPointer());
  const auto black = static_cast<float>(this->Black);
  const auto scale = static_cast<float>(255 / (this->White - this->Black));
  for (std::size_t pixel = 0; pixel < this->Values.size(); ++pixel)
  {
    const float value = (this->Values[pixel] - black) * scale;
    grey[pixel] = static_cast<unsigned char>(std::clamp(value, 0.0F, 255.0F) + 0.5F);
  }
  this->Image->Modified();
}

void ProjectionPane::Frame()
{
  const double width = this->ColumnMm * this->Grid.Columns;
  const double height = this->RowMm * this->Grid.Rows;
  const double x = 0.5 * width - 0.5 * this->ColumnMm;
  const double y = -0.5 * height + 0.5 * this->RowMm;
  vtkCamera* camera = this->View->GetActiveCamera();
  camera->ParallelProjectionOn();
  camera->SetFocalPoint(x, y, 0);
  camera->SetPosition(x, y, std::max(width, height));
  camera->SetViewUp(0, 1, 0);
  const double aspect = this->View->GetTiledAspectRatio();
  constexpr double Room = 1.06;
  camera->SetParallelScale(0.5 * Room * std::max(height, width / (aspect > 0 ? aspect : 1)));
  this->View->ResetCameraClippingRange();
}

void ProjectionPane::SetMark(const std::optional<std::array<double, 2>>& pixel)
{
  if (!pixel)
  {
    this->Over.SetLines({});
    return;
  }
  const Vector3 at{ this->ColumnMm * (*pixel)[0], -this->RowMm * (*pixel)[1], 0 };
  const double arm = 0.01 * this->RowMm * this->Grid.Rows;
  this->Over.SetLines({ { at - Vector3{ arm, 0, 0 }, at + Vector3{ arm, 0, 0 } },
    { at - Vector3{ 0, arm, 0 }, at + Vector3{ 0, arm, 0 } } });
}

bool ProjectionPane::PixelAt(int x, int y, double& column, double& row) const
{
  const Vector3 at = this->Over.WorldAt(x, y);
  column = at[0] / this->ColumnMm;
  row = -at[1] / this->RowMm;
  return column >= -0.5 && row >= -0.5 && column <= this->Grid.Columns - 0.5 &&
    row <= this->Grid.Rows - 0.5;
}

void ProjectionPane::Write(const std::string& path) const
{
  // VTK's row 0 is at the bottom.
  vtkNew<vtkImageFlip> flip;
  flip->SetInputData(this->Image);
  flip->SetFilteredAxis(1);
  flip->Update();
  WritePicture(flip->GetOutput(), path);
}
}
