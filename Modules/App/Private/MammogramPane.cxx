// SPDX-License-Identifier: Apache-2.0
#include "Private/MammogramPane.h"

#include "Private/GreyLevel.h"
#include "mammoray/Registration/RegistrationTarget.h"

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
}

MammogramPane::MammogramPane(const ViewedBreast& viewed, LiveMammogram& live)
  : Grid(live.Grid(1))
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

  std::array<Vector3, 4> corners;
  for (std::size_t corner = 0; corner < 4; ++corner)
  {
    const ReceptorPoint at =
      this->Grid.PositionOf((corner & 1) != 0 ? this->Grid.Columns - 0.5 : -0.5,
        (corner & 2) != 0 ? this->Grid.Rows - 0.5 : -0.5);
    corners[corner] = { at[0], at[1], 0 };
  }
  this->AddRectangle(corners);
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

void MammogramPane::SetComparison(Comparison comparison)
{
  this->Compared = comparison;
  this->Compose();
}

float MammogramPane::ShareAt(int column, int row) const
{
  constexpr double SquareMm = 10;
  switch (this->Compared)
  {
    case Comparison::Checkerboard:
    {
      const double stepMm =
        this->Divisor * std::hypot(this->Grid.ColumnStep[0], this->Grid.ColumnStep[1]);
      const int side = std::max(1, static_cast<int>(SquareMm / stepMm));
      return (column / side + row / side) % 2 == 0 ? 1.0F : 0.0F;
    }
    case Comparison::Swipe:
      return column < this->Real * this->Grid.Columns / this->Divisor ? 1.0F : 0.0F;
    case Comparison::Blend:
      break;
  }
  return static_cast<float>(this->Real);
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
  unsigned char* grey = this->GreyValues(columns, rows);
  const auto black = static_cast<float>(this->Black);
  const auto scale = static_cast<float>(1 / (this->White - this->Black));
  const auto low = static_cast<float>(this->Low);
  const auto stretch = static_cast<float>(1 / (this->High - this->Low));
  const std::vector<float>& real = this->RealGrey[static_cast<std::size_t>(this->Divisor - 1)];
  for (std::size_t pixel = 0; pixel < this->Synthetic.size(); ++pixel)
  {
    float value = (this->Synthetic[pixel] - black) * scale;
    if (!real.empty())
    {
      const int column = static_cast<int>(pixel % static_cast<std::size_t>(columns));
      const int row = static_cast<int>(pixel / static_cast<std::size_t>(columns));
      value += this->ShareAt(column, row) * (real[pixel] - value);
    }
    value = (value - low) * stretch;
    grey[pixel] = static_cast<unsigned char>(255.0F * std::clamp(value, 0.0F, 1.0F) + 0.5F);
  }
}

void MammogramPane::SetMark(const std::vector<ReceptorPoint>& points,
  const std::vector<std::vector<ReceptorPoint>>& loops, const std::vector<ReceptorPoint>& drawn)
{
  constexpr double ArmMm = 3;
  std::vector<std::vector<Vector3>> lines;
  const auto add = [&](const std::vector<ReceptorPoint>& line, bool closed)
  {
    std::vector<Vector3>& added = lines.emplace_back();
    for (const ReceptorPoint& point : line)
    {
      added.push_back({ point[0], point[1], 0 });
    }
    if (closed && !line.empty())
    {
      added.push_back(added.front());
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
  add(drawn, false);
  this->Over.SetLines(lines);
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
  this->LookAt({ middle[0], middle[1], 0 }, { middle[0], middle[1], 500 * side },
    { this->Up, 0, 0 }, reach[1].Length() + 2 * MarginMm, reach[0].Length() + 2 * MarginMm);
}

bool MammogramPane::PixelAt(int x, int y, double& column, double& row) const
{
  const Vector3 world = this->Over.WorldAt(x, y);
  const ReceptorPoint at{ world[0], world[1] };
  const auto index = this->Grid.IndexOf(at);
  column = index[0];
  row = index[1];
  return this->Grid.Contains(at);
}
}
