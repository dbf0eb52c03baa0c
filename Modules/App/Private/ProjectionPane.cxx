// SPDX-License-Identifier: Apache-2.0
#include "Private/ProjectionPane.h"

#include "mammoray/Foundation/Numbers.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
ProjectionPane::ProjectionPane(LiveProjection& live)
  : Grid(live.Detector(1))
  , ColumnMm(Norm(live.Detector(1).ColumnStep))
  , RowMm(Norm(live.Detector(1).RowStep))
{
  std::array<Vector3, 4> corners;
  for (std::size_t corner = 0; corner < 4; ++corner)
  {
    corners[corner] = { this->ColumnMm * ((corner & 1) != 0 ? this->Grid.Columns - 0.5 : -0.5),
      -this->RowMm * ((corner & 2) != 0 ? this->Grid.Rows - 0.5 : -0.5), 0 };
  }
  this->AddRectangle(corners);
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

void ProjectionPane::ResetWindow()
{
  const float most = QuantileElement(this->Values, 0.999);
  this->Low = 0;
  this->High = std::isfinite(most) && most > 1e-6F ? most : 1;
  this->Compose();
}

void ProjectionPane::Compose()
{
  unsigned char* grey = this->GreyValues(this->Columns, this->Rows);
  const auto black = static_cast<float>(this->Low);
  const auto scale = static_cast<float>(255 / (this->High - this->Low));
  for (std::size_t pixel = 0; pixel < this->Values.size(); ++pixel)
  {
    const float value = (this->Values[pixel] - black) * scale;
    grey[pixel] = static_cast<unsigned char>(std::clamp(value, 0.0F, 255.0F) + 0.5F);
  }
}

void ProjectionPane::Frame()
{
  const double width = this->ColumnMm * this->Grid.Columns;
  const double height = this->RowMm * this->Grid.Rows;
  const double x = 0.5 * width - 0.5 * this->ColumnMm;
  const double y = -0.5 * height + 0.5 * this->RowMm;
  constexpr double Room = 1.06;
  this->LookAt({ x, y, 0 }, { x, y, std::max(width, height) }, { 0, 1, 0 }, Room * width,
    Room * height);
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
  return this->IsOnPicture(column, row);
}

bool ProjectionPane::IsOnPicture(double column, double row) const
{
  return column >= -0.5 && row >= -0.5 && column <= this->Grid.Columns - 0.5 &&
    row <= this->Grid.Rows - 0.5;
}

ProjectionPane::Profile ProjectionPane::AlongRuler() const
{
  Profile profile;
  const auto& ends = this->Over.RulerEnds();
  if (!ends)
  {
    return profile;
  }
  const Vector3 whole = (*ends)[1] - (*ends)[0];
  const double step = std::min(this->ColumnMm, this->RowMm);
  const int count = static_cast<int>(Norm(whole) / step) + 1;
  // A coarser picture has fewer pixels for the same detector.
  const auto index = [](double at, int all, int shown)
  { return std::clamp(static_cast<int>((at + 0.5) * shown / all), 0, shown - 1); };
  for (int point = 0; point < count; ++point)
  {
    const Vector3 at = (*ends)[0] + (point / std::max(count - 1.0, 1.0)) * whole;
    const double column = at[0] / this->ColumnMm;
    const double row = -at[1] / this->RowMm;
    if (this->IsOnPicture(column, row))
    {
      profile.Mm.push_back(Norm(at - (*ends)[0]));
      const int pixel = index(row, this->Grid.Rows, this->Rows) * this->Columns +
        index(column, this->Grid.Columns, this->Columns);
      profile.LogAttenuation.push_back(this->Values[static_cast<std::size_t>(pixel)]);
    }
  }
  return profile;
}
}
