// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/RegistrationTarget.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace mammoray
{
namespace
{
/// Four neighbouring pixels and a place between them.
struct Cell
{
  /// Signed distances at (column, row), the next column, the next row, and both.
  double Corners[4];
  /// Place in the cell, [0, 1].
  double Column;
  double Row;
  bool InColumns;
  bool InRows;
  /// From the nearest point of the image to the given one, mm; 0 inside.
  ReceptorPoint Outside{ 0, 0 };

  Cell(const RegistrationTarget& target, const ReceptorPoint& point)
  {
    const auto [column, row] = target.Grid.IndexOf(point);
    const double insideColumn = std::clamp(column, 0.0, target.Grid.Columns - 1.0);
    const double insideRow = std::clamp(row, 0.0, target.Grid.Rows - 1.0);
    this->InColumns = insideColumn == column;
    this->InRows = insideRow == row;
    const int c0 = std::min(static_cast<int>(insideColumn), std::max(target.Grid.Columns - 2, 0));
    const int r0 = std::min(static_cast<int>(insideRow), std::max(target.Grid.Rows - 2, 0));
    const int c1 = std::min(c0 + 1, target.Grid.Columns - 1);
    const int r1 = std::min(r0 + 1, target.Grid.Rows - 1);
    this->Column = insideColumn - c0;
    this->Row = insideRow - r0;
    const auto at = [&](int c, int r)
    { return static_cast<double>(target.SignedDistanceMm[target.Grid.Index(c, r)]); };
    this->Corners[0] = at(c0, r0);
    this->Corners[1] = at(c1, r0);
    this->Corners[2] = at(c0, r1);
    this->Corners[3] = at(c1, r1);
    if (!this->InColumns || !this->InRows)
    {
      const ReceptorPoint border = target.Grid.PositionOf(insideColumn, insideRow);
      this->Outside = { point[0] - border[0], point[1] - border[1] };
    }
  }
};

void RequireBreast(const RegistrationTarget& target)
{
  const auto& mask = target.BreastMask;
  if (mask.size() != target.Grid.NumberOfPixels() || std::count(mask.begin(), mask.end(), 1) == 0)
  {
    throw InputError("mammogram: expected a breast, found an empty mask");
  }
}
}

void ValidateTarget(const RegistrationTarget& target)
{
  const std::size_t pixels = target.Grid.NumberOfPixels();
  if (pixels == 0 || target.LogAttenuation.size() != pixels || target.BreastMask.size() != pixels ||
    target.SignedDistanceMm.size() != pixels)
  {
    throw InputError("mammogram: expected " + std::to_string(target.Grid.Columns) + " x " +
      std::to_string(target.Grid.Rows) + " pixels of attenuation, mask and distance, found " +
      std::to_string(target.LogAttenuation.size()) + ", " +
      std::to_string(target.BreastMask.size()) + " and " +
      std::to_string(target.SignedDistanceMm.size()));
  }
  if (!target.Excluded.empty() && target.Excluded.size() != pixels)
  {
    throw InputError("mammogram: expected what is excluded for " + std::to_string(pixels) +
      " pixels or for none, found " + std::to_string(target.Excluded.size()));
  }
  if (!(target.Grid.PixelAreaMm2() > 1e-12))
  {
    throw InputError("mammogram: expected independent column and row steps on the receptor");
  }
  RequireBreast(target);
}

void ExcludePixels(const std::vector<unsigned char>& mask, RegistrationTarget& target)
{
  if (mask.size() != target.BreastMask.size())
  {
    throw InputError("mask: expected a value for each of " +
      std::to_string(target.BreastMask.size()) + " pixels, found " + std::to_string(mask.size()));
  }
  target.Excluded.resize(target.BreastMask.size(), 0);
  for (std::size_t pixel = 0; pixel < mask.size(); ++pixel)
  {
    if (mask[pixel] != 0)
    {
      target.Excluded[pixel] = 1;
    }
  }
}

RegistrationTarget Coarsen(const RegistrationTarget& target, int factor)
{
  RegistrationTarget coarse;
  coarse.Grid = target.Grid.Coarsened(factor);
  coarse.OutlineFromMm = target.OutlineFromMm;
  coarse.HeaderThicknessMm = target.HeaderThicknessMm;
  coarse.Warnings = target.Warnings;
  coarse.Disagreements = target.Disagreements;
  const std::size_t pixels = coarse.Grid.NumberOfPixels();
  coarse.LogAttenuation.resize(pixels);
  coarse.BreastMask.resize(pixels);
  coarse.SignedDistanceMm.resize(pixels);
  coarse.Excluded.resize(target.Excluded.empty() ? 0 : pixels);
  for (int row = 0; row < coarse.Grid.Rows; ++row)
  {
    for (int column = 0; column < coarse.Grid.Columns; ++column)
    {
      double attenuation = 0;
      double distance = 0;
      bool breast = true;
      bool excluded = false;
      for (int y = 0; y < factor; ++y)
      {
        for (int x = 0; x < factor; ++x)
        {
          const std::size_t fine = target.Grid.Index(column * factor + x, row * factor + y);
          attenuation += target.LogAttenuation[fine];
          distance += target.SignedDistanceMm[fine];
          breast = breast && target.BreastMask[fine] != 0;
          excluded = excluded || IsExcluded(target, fine);
        }
      }
      const std::size_t index = coarse.Grid.Index(column, row);
      coarse.LogAttenuation[index] = static_cast<float>(attenuation / (factor * factor));
      coarse.SignedDistanceMm[index] = static_cast<float>(distance / (factor * factor));
      coarse.BreastMask[index] = breast ? 1 : 0;
      if (!coarse.Excluded.empty())
      {
        coarse.Excluded[index] = excluded ? 1 : 0;
      }
    }
  }
  return coarse;
}

RegistrationTarget CoarsenTo(const RegistrationTarget& target, double pixelSizeMm)
{
  const double pixel = target.Grid.ColumnSpacingMm();
  return Coarsen(target, std::max(1, static_cast<int>(std::lround(pixelSizeMm / pixel))));
}

double SignedDistanceAt(const RegistrationTarget& target, const ReceptorPoint& point)
{
  const Cell cell(target, point);
  const double value =
    (1 - cell.Row) * ((1 - cell.Column) * cell.Corners[0] + cell.Column * cell.Corners[1]) +
    cell.Row * ((1 - cell.Column) * cell.Corners[2] + cell.Column * cell.Corners[3]);
  return value + std::hypot(cell.Outside[0], cell.Outside[1]);
}

ReceptorPoint SignedDistanceGradient(const RegistrationTarget& target, const ReceptorPoint& point)
{
  const Cell cell(target, point);
  // Per column and per row; nothing along what is clamped.
  const double byColumn = cell.InColumns ? (1 - cell.Row) * (cell.Corners[1] - cell.Corners[0]) +
      cell.Row * (cell.Corners[3] - cell.Corners[2])
                                         : 0.0;
  const double byRow = cell.InRows ? (1 - cell.Column) * (cell.Corners[2] - cell.Corners[0]) +
      cell.Column * (cell.Corners[3] - cell.Corners[1])
                                   : 0.0;
  const auto& c = target.Grid.ColumnStep;
  const auto& r = target.Grid.RowStep;
  const double determinant = c[0] * r[1] - c[1] * r[0];
  ReceptorPoint gradient{ (byColumn * r[1] - byRow * c[1]) / determinant,
    (byRow * c[0] - byColumn * r[0]) / determinant };
  const double outside = std::hypot(cell.Outside[0], cell.Outside[1]);
  if (outside > 0)
  {
    gradient[0] += cell.Outside[0] / outside;
    gradient[1] += cell.Outside[1] / outside;
  }
  return gradient;
}

ReceptorPoint ChestWallCentre(const RegistrationTarget& target)
{
  RequireBreast(target);
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (int row = 0; row < target.Grid.Rows; ++row)
  {
    for (int column = 0; column < target.Grid.Columns; ++column)
    {
      if (target.BreastMask[target.Grid.Index(column, row)])
      {
        const ReceptorPoint at = target.Grid.PositionOf(column, row);
        if (at[1] >= target.OutlineFromMm)
        {
          low = std::min(low, at[0]);
          high = std::max(high, at[0]);
        }
      }
    }
  }
  if (low > high)
  {
    throw InputError("registration target: expected a breast that reaches farther than " +
      std::to_string(target.OutlineFromMm) + " mm from the chest wall, found none");
  }
  return { 0.5 * (low + high), 0.0 };
}

std::vector<std::optional<ReceptorPoint>> OutlineAlong(const RegistrationTarget& target,
  const ReceptorPoint& centre, const std::vector<ReceptorPoint>& directions)
{
  const double pixel = target.Grid.ColumnSpacingMm();
  const double step = 0.5 * pixel;
  const double diagonal =
    pixel * target.Grid.Columns + target.Grid.RowSpacingMm() * target.Grid.Rows;
  std::vector<std::optional<ReceptorPoint>> outline;
  for (const ReceptorPoint& direction : directions)
  {
    const auto at = [&](double r) -> ReceptorPoint {
      return { centre[0] + r * direction[0], centre[1] + r * direction[1] };
    };
    double radius = 0;
    bool entered = false; // the image may begin a little in front of the chest wall
    for (double r = 0; r <= diagonal; r += step)
    {
      const bool contained = target.Grid.Contains(at(r), 0);
      if (entered && !contained)
      {
        break;
      }
      entered = entered || contained;
      if (SignedDistanceAt(target, at(r)) < 0)
      {
        radius = r;
      }
    }
    const double inside = SignedDistanceAt(target, at(radius));
    const double outside = SignedDistanceAt(target, at(radius + step));
    const ReceptorPoint end =
      at(outside >= 0 && inside < 0 ? radius + step * inside / (inside - outside) : radius);
    const bool seen =
      radius > 0 && end[1] >= target.OutlineFromMm && target.Grid.Contains(end, 2.0 + pixel);
    outline.push_back(seen ? std::optional(end) : std::nullopt);
  }
  return outline;
}
}
