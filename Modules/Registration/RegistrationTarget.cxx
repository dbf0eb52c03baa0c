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
  double At[4];
  /// Place in the cell, [0, 1].
  double Column;
  double Row;
  bool InColumns;
  bool InRows;
  /// From the nearest point of the image to the given one, mm; 0 inside.
  ReceptorPoint Outside{ 0, 0 };

  Cell(const RegistrationTarget& target, const ReceptorPoint& point)
  {
    const auto [column, row] = PixelOf(target, point);
    const double insideColumn = std::clamp(column, 0.0, target.Columns - 1.0);
    const double insideRow = std::clamp(row, 0.0, target.Rows - 1.0);
    this->InColumns = insideColumn == column;
    this->InRows = insideRow == row;
    const int c0 = std::min(static_cast<int>(insideColumn), std::max(target.Columns - 2, 0));
    const int r0 = std::min(static_cast<int>(insideRow), std::max(target.Rows - 2, 0));
    const int c1 = std::min(c0 + 1, target.Columns - 1);
    const int r1 = std::min(r0 + 1, target.Rows - 1);
    this->Column = insideColumn - c0;
    this->Row = insideRow - r0;
    const auto at = [&](int c, int r)
    {
      return static_cast<double>(
        target.SignedDistanceMm[static_cast<std::size_t>(r) * target.Columns + c]);
    };
    this->At[0] = at(c0, r0);
    this->At[1] = at(c1, r0);
    this->At[2] = at(c0, r1);
    this->At[3] = at(c1, r1);
    if (!this->InColumns || !this->InRows)
    {
      const ReceptorPoint border = PixelPosition(target, insideColumn, insideRow);
      this->Outside = { point[0] - border[0], point[1] - border[1] };
    }
  }
};

void RequireBreast(const RegistrationTarget& target)
{
  const auto& mask = target.BreastMask;
  if (mask.size() != static_cast<std::size_t>(target.Columns) * target.Rows ||
    std::count(mask.begin(), mask.end(), 1) == 0)
  {
    throw InputError("mammogram: expected a breast, found an empty mask");
  }
}
}

void ValidateTarget(const RegistrationTarget& target)
{
  const auto pixels =
    static_cast<std::size_t>(std::max(target.Columns, 0)) * std::max(target.Rows, 0);
  if (pixels == 0 || target.LogAttenuation.size() != pixels || target.BreastMask.size() != pixels ||
    target.SignedDistanceMm.size() != pixels)
  {
    throw InputError("mammogram: expected " + std::to_string(target.Columns) + " x " +
      std::to_string(target.Rows) + " pixels of attenuation, mask and distance, found " +
      std::to_string(target.LogAttenuation.size()) + ", " +
      std::to_string(target.BreastMask.size()) + " and " +
      std::to_string(target.SignedDistanceMm.size()));
  }
  if (!target.Excluded.empty() && target.Excluded.size() != pixels)
  {
    throw InputError("mammogram: expected what is excluded for " + std::to_string(pixels) +
      " pixels or for none, found " + std::to_string(target.Excluded.size()));
  }
  const double area =
    target.ColumnStep[0] * target.RowStep[1] - target.ColumnStep[1] * target.RowStep[0];
  if (!(std::abs(area) > 1e-12))
  {
    throw InputError("mammogram: expected independent column and row steps on the receptor");
  }
  RequireBreast(target);
}

RegistrationTarget Coarsen(const RegistrationTarget& target, int factor)
{
  RegistrationTarget coarse;
  coarse.Columns = target.Columns / factor;
  coarse.Rows = target.Rows / factor;
  coarse.Origin = PixelPosition(target, 0.5 * (factor - 1), 0.5 * (factor - 1));
  for (int axis = 0; axis < 2; ++axis)
  {
    coarse.ColumnStep[axis] = factor * target.ColumnStep[axis];
    coarse.RowStep[axis] = factor * target.RowStep[axis];
  }
  coarse.OutlineFromMm = target.OutlineFromMm;
  coarse.Warnings = target.Warnings;
  const std::size_t pixels = static_cast<std::size_t>(coarse.Columns) * coarse.Rows;
  coarse.LogAttenuation.resize(pixels);
  coarse.BreastMask.resize(pixels);
  coarse.SignedDistanceMm.resize(pixels);
  coarse.Excluded.resize(target.Excluded.empty() ? 0 : pixels);
  for (int row = 0; row < coarse.Rows; ++row)
  {
    for (int column = 0; column < coarse.Columns; ++column)
    {
      double attenuation = 0;
      double distance = 0;
      bool breast = true;
      bool excluded = false;
      for (int y = 0; y < factor; ++y)
      {
        for (int x = 0; x < factor; ++x)
        {
          const std::size_t fine =
            static_cast<std::size_t>(row * factor + y) * target.Columns + column * factor + x;
          attenuation += target.LogAttenuation[fine];
          distance += target.SignedDistanceMm[fine];
          breast = breast && target.BreastMask[fine] != 0;
          excluded = excluded || IsExcluded(target, fine);
        }
      }
      const std::size_t index = static_cast<std::size_t>(row) * coarse.Columns + column;
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
  const double pixel = std::hypot(target.ColumnStep[0], target.ColumnStep[1]);
  return Coarsen(target, std::max(1, static_cast<int>(std::lround(pixelSizeMm / pixel))));
}

ReceptorPoint PixelPosition(const RegistrationTarget& target, double column, double row)
{
  return { target.Origin[0] + column * target.ColumnStep[0] + row * target.RowStep[0],
    target.Origin[1] + column * target.ColumnStep[1] + row * target.RowStep[1] };
}

std::array<double, 2> PixelOf(const RegistrationTarget& target, const ReceptorPoint& point)
{
  const double dx = point[0] - target.Origin[0];
  const double dy = point[1] - target.Origin[1];
  const auto& c = target.ColumnStep;
  const auto& r = target.RowStep;
  const double determinant = c[0] * r[1] - c[1] * r[0];
  return { (dx * r[1] - dy * r[0]) / determinant, (c[0] * dy - c[1] * dx) / determinant };
}

double SignedDistanceAt(const RegistrationTarget& target, const ReceptorPoint& point)
{
  const Cell cell(target, point);
  const double value =
    (1 - cell.Row) * ((1 - cell.Column) * cell.At[0] + cell.Column * cell.At[1]) +
    cell.Row * ((1 - cell.Column) * cell.At[2] + cell.Column * cell.At[3]);
  return value + std::hypot(cell.Outside[0], cell.Outside[1]);
}

ReceptorPoint SignedDistanceGradient(const RegistrationTarget& target, const ReceptorPoint& point)
{
  const Cell cell(target, point);
  // Per column and per row; nothing along what is clamped.
  const double byColumn = cell.InColumns
    ? (1 - cell.Row) * (cell.At[1] - cell.At[0]) + cell.Row * (cell.At[3] - cell.At[2])
    : 0.0;
  const double byRow = cell.InRows
    ? (1 - cell.Column) * (cell.At[2] - cell.At[0]) + cell.Column * (cell.At[3] - cell.At[1])
    : 0.0;
  const auto& c = target.ColumnStep;
  const auto& r = target.RowStep;
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

bool Contains(const RegistrationTarget& target, const ReceptorPoint& point, double marginMm)
{
  const auto [column, row] = PixelOf(target, point);
  const double columnMargin =
    marginMm / std::hypot(target.ColumnStep[0], target.ColumnStep[1]) - 0.5;
  const double rowMargin = marginMm / std::hypot(target.RowStep[0], target.RowStep[1]) - 0.5;
  return column >= columnMargin && column <= target.Columns - 1 - columnMargin &&
    row >= rowMargin && row <= target.Rows - 1 - rowMargin;
}

ReceptorPoint ChestWallCentre(const RegistrationTarget& target)
{
  RequireBreast(target);
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (int row = 0; row < target.Rows; ++row)
  {
    for (int column = 0; column < target.Columns; ++column)
    {
      if (target.BreastMask[static_cast<std::size_t>(row) * target.Columns + column])
      {
        const ReceptorPoint at = PixelPosition(target, column, row);
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
  const double pixel = std::hypot(target.ColumnStep[0], target.ColumnStep[1]);
  const double step = 0.5 * pixel;
  const double diagonal =
    pixel * target.Columns + std::hypot(target.RowStep[0], target.RowStep[1]) * target.Rows;
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
      const bool contained = Contains(target, at(r), 0);
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
      radius > 0 && end[1] >= target.OutlineFromMm && Contains(target, end, 2.0 + pixel);
    outline.push_back(seen ? std::optional(end) : std::nullopt);
  }
  return outline;
}
}
