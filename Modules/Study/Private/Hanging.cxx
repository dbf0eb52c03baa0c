// SPDX-License-Identifier: Apache-2.0
#include "Private/Hanging.h"

#include "mammoray/Foundation/ParallelFor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace mammoray
{
namespace
{
constexpr int LongerSidePixels = 900;
constexpr double MarginMm = 8;

/// Sets which way the picture is turned, and its letters.
void Orient(const Mammogram& mammogram, const ReceptorGrid& grid, Hanging& hanging)
{
  // Chest wall to nipple leads forward. Where the side is not known it is taken from the target,
  // whose preparation warned: chest wall at the picture's right (y falls with the column).
  Mammogram known = mammogram;
  if (known.Laterality != 'L' && known.Laterality != 'R')
  {
    known.Laterality = grid.ColumnStep[1] < 0 || grid.RowStep[1] < 0 ? 'R' : 'L';
  }
  // Gantry x along patient left and head (MammographyGeometry.h).
  const double roll = NominalRollDeg(known).value_or(0) * std::numbers::pi / 180;
  const double left = std::cos(roll);
  const double head = -std::sin(roll);
  const bool oblique = std::abs(head) > 0.1;
  const double up = oblique ? head : known.Laterality == 'L' ? left : -left;
  hanging.Right = known.Laterality == 'R' ? -1 : 1;
  hanging.Up = up > 0 ? 1 : -1;
  const auto letters = [left, head](double along)
  {
    std::string text;
    text += std::abs(head) > 0.1 ? (along * head > 0 ? "H" : "F") : "";
    text += std::abs(left) > 0.1 ? (along * left > 0 ? "L" : "R") : "";
    return text;
  };
  hanging.Letters = { hanging.Right > 0 ? "P" : "A", hanging.Right > 0 ? "A" : "P",
    letters(hanging.Up), letters(-hanging.Up) };
}

/// Extent along gantry x and y, mm.
struct Bounds
{
  std::array<double, 2> Least{ 1e9, 1e9 };
  std::array<double, 2> Most{ -1e9, -1e9 };

  void Add(int axis, double low, double high)
  {
    this->Least[axis] = std::min(this->Least[axis], low);
    this->Most[axis] = std::max(this->Most[axis], high);
  }
};

/// What is shown with its margin, within the mammogram; all of it where nothing is shown.
Bounds BoundsOf(const ReceptorGrid& grid, const std::vector<unsigned char>& shown)
{
  Bounds all;
  Bounds bounds;
  for (int row = 0; row < grid.Rows; ++row)
  {
    for (int column = 0; column < grid.Columns; ++column)
    {
      const bool corner =
        (row == 0 || row == grid.Rows - 1) && (column == 0 || column == grid.Columns - 1);
      const std::size_t pixel = grid.Index(column, row);
      for (int axis = 0; axis < 2 && (corner || shown[pixel]); ++axis)
      {
        const double place = grid.PositionOf(column, row)[axis];
        const double half = 0.5 * (std::abs(grid.ColumnStep[axis]) + std::abs(grid.RowStep[axis]));
        if (corner)
        {
          all.Add(axis, place - half, place + half);
        }
        if (shown[pixel])
        {
          bounds.Add(axis, place - half - MarginMm, place + half + MarginMm);
        }
      }
    }
  }
  for (int axis = 0; axis < 2; ++axis)
  {
    const bool any = bounds.Least[axis] < bounds.Most[axis];
    bounds.Least[axis] = any ? std::max(bounds.Least[axis], all.Least[axis]) : all.Least[axis];
    bounds.Most[axis] = any ? std::min(bounds.Most[axis], all.Most[axis]) : all.Most[axis];
  }
  return bounds;
}

/// An image on the target's grid at a gantry point, bilinear; its border goes on outside.
double ValueAt(const ReceptorGrid& grid, const std::vector<float>& image, double x, double y)
{
  const auto index = grid.IndexOf({ x, y });
  const double column = std::clamp(index[0], 0.0, grid.Columns - 1.0);
  const double row = std::clamp(index[1], 0.0, grid.Rows - 1.0);
  const int column0 = std::min(static_cast<int>(column), std::max(0, grid.Columns - 2));
  const int row0 = std::min(static_cast<int>(row), std::max(0, grid.Rows - 2));
  const double u = column - column0;
  const double v = row - row0;
  const auto at = [&](int i, int j)
  { return image[grid.Index(std::min(i, grid.Columns - 1), std::min(j, grid.Rows - 1))]; };
  return (1 - v) * ((1 - u) * at(column0, row0) + u * at(column0 + 1, row0)) +
    v * ((1 - u) * at(column0, row0 + 1) + u * at(column0 + 1, row0 + 1));
}
}

std::array<double, 2> Hanging::ToPicture(double x, double y) const
{
  return { 0.5 * this->Width + this->Right * (y - this->Centre[1]) / this->PixelMm,
    0.5 * this->Height + this->Up * (x - this->Centre[0]) / this->PixelMm };
}

std::array<double, 2> Hanging::ToGantry(double right, double up) const
{
  return { this->Centre[0] + this->Up * (up - 0.5 * this->Height) * this->PixelMm,
    this->Centre[1] + this->Right * (right - 0.5 * this->Width) * this->PixelMm };
}

Hanging Hang(const Mammogram& mammogram, const ReceptorGrid& grid,
  const std::vector<unsigned char>& shown)
{
  Hanging hanging;
  Orient(mammogram, grid, hanging);
  const auto [least, most] = BoundsOf(grid, shown);
  const double extent[2] = { most[0] - least[0], most[1] - least[1] };
  hanging.Centre = { 0.5 * (least[0] + most[0]), 0.5 * (least[1] + most[1]) };
  hanging.PixelMm = std::max(extent[0], extent[1]) / LongerSidePixels;
  hanging.Width = std::max(1, static_cast<int>(std::lround(extent[1] / hanging.PixelMm)));
  hanging.Height = std::max(1, static_cast<int>(std::lround(extent[0] / hanging.PixelMm)));
  return hanging;
}

std::vector<float> Resample(const ReceptorGrid& grid, const std::vector<float>& image,
  const Hanging& hanging)
{
  const double step = std::min(grid.ColumnSpacingMm(), grid.RowSpacingMm());
  const int samples = std::clamp(static_cast<int>(std::ceil(hanging.PixelMm / step)), 1, 6);
  const auto width = static_cast<std::size_t>(hanging.Width);
  std::vector<float> result(width * static_cast<std::size_t>(hanging.Height));
  ParallelFor(static_cast<std::size_t>(hanging.Height),
    [&](std::size_t y)
    {
      for (std::size_t x = 0; x < width; ++x)
      {
        double sum = 0;
        for (int s = 0; s < samples * samples; ++s)
        {
          const int across = s % samples;
          const int down = s / samples;
          const auto point = hanging.ToGantry(static_cast<double>(x) + (across + 0.5) / samples,
            static_cast<double>(y) + (down + 0.5) / samples);
          sum += ValueAt(grid, image, point[0], point[1]);
        }
        result[y * width + x] = static_cast<float>(sum / (samples * samples));
      }
    });
  return result;
}
}
