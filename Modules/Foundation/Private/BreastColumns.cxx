// SPDX-License-Identifier: Apache-2.0
#include "Private/BreastColumns.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>

namespace mammoray
{
namespace
{
constexpr double Infinity = std::numeric_limits<double>::infinity();
/// Smallest width of a column, mm.
constexpr double LeastWidthMm = 3;
/// Stray voxels of fixed tissue in front of the chest wall, and streaks of other tissue in it, are
/// narrower than this many columns on either side.
constexpr int StraySteps = 3;
/// Fractions of the peak's height.
constexpr double ValleyPart = 0.1;
constexpr double CorePart = 0.25;
constexpr double SlopePart = 0.375;
/// A second breast, beside the first: least height and volume, as parts of the first one's, and
/// height over the valley between, mm (as Segmentation counts breasts).
constexpr double OtherHeightPart = 0.5;
constexpr double OtherVolumePart = 0.25;
constexpr double SmallestBreastMm = 15;
}

BreastColumns::BreastColumns(const Vector3& low, const Vector3& high, double pieceMm)
  : Low(low)
  , WidthMm(std::max(LeastWidthMm, pieceMm))
  , CountAcross(1 + static_cast<int>((high[0] - low[0]) / WidthMm))
  , CountAlong(1 + static_cast<int>((high[2] - low[2]) / WidthMm))
{
  const std::size_t count = static_cast<std::size_t>(this->CountAcross) * this->CountAlong;
  this->Front.assign(count, -Infinity);
  this->Back.assign(count, Infinity);
  this->FixedFront.assign(count, -Infinity);
  this->Sums.assign(count, { 0, 0, 0 });
  this->Core.assign(count, 0);
  this->Breast.assign(count, 0);
}

std::size_t BreastColumns::ColumnOf(const Vector3& place) const
{
  const int across = static_cast<int>((place[0] - this->Low[0]) / this->WidthMm);
  const int along = static_cast<int>((place[2] - this->Low[2]) / this->WidthMm);
  return static_cast<std::size_t>(std::clamp(along, 0, this->CountAlong - 1)) * this->CountAcross +
    std::clamp(across, 0, this->CountAcross - 1);
}

void BreastColumns::Add(const Vector3& place, bool isFixed)
{
  const std::size_t column = this->ColumnOf(place);
  this->Sums[column] = this->Sums[column] + Vector3{ place[0], place[2], 1 };
  this->Front[column] = std::max(this->Front[column], place[1]);
  this->Back[column] = std::min(this->Back[column], place[1]);
  if (isFixed)
  {
    this->FixedFront[column] = std::max(this->FixedFront[column], place[1]);
  }
}

template <typename Visit>
void BreastColumns::VisitNear(std::size_t column, int steps, Visit visit) const
{
  const int x = static_cast<int>(column % this->CountAcross);
  const int z = static_cast<int>(column / this->CountAcross);
  for (int v = std::max(0, z - steps); v <= std::min(this->CountAlong - 1, z + steps); ++v)
  {
    for (int u = std::max(0, x - steps); u <= std::min(this->CountAcross - 1, x + steps); ++u)
    {
      visit(static_cast<std::size_t>(v) * this->CountAcross + u, std::hypot(u - x, v - z));
    }
  }
}

std::vector<double> BreastColumns::Heights() const
{
  std::vector<double> raw(this->Front.size(), -1);
  for (std::size_t column = 0; column < raw.size(); ++column)
  {
    if (this->Front[column] < this->Back[column])
    {
      continue; // no tissue
    }
    std::vector<double> walls;
    this->VisitNear(column, StraySteps,
      [&](std::size_t other, double)
      {
        if (this->Front[other] >= this->Back[other])
        {
          walls.push_back(std::max(this->FixedFront[other], this->Back[other]));
        }
      });
    const auto middle = walls.begin() + static_cast<std::ptrdiff_t>(walls.size() / 2);
    std::nth_element(walls.begin(), middle, walls.end());
    raw[column] = std::max(0.0, this->Front[column] - *middle);
  }
  std::vector<double> heights = raw;
  for (std::size_t column = 0; column < raw.size(); ++column)
  {
    double sum = 0;
    int count = 0;
    this->VisitNear(column, 1,
      [&](std::size_t other, double)
      {
        sum += std::max(0.0, raw[other]);
        count += raw[other] >= 0 ? 1 : 0;
      });
    heights[column] = raw[column] < 0 ? -1 : sum / count;
  }
  return heights;
}

std::vector<std::size_t> BreastColumns::Hills(const std::vector<double>& heights) const
{
  // Visit columns from the highest down; each joins the hills that it touches. A hill that rises
  // above its saddle to a higher hill by no more than the depth of a valley is a part of that hill.
  std::vector<std::size_t> order(heights.size());
  std::iota(order.begin(), order.end(), std::size_t{ 0 });
  std::stable_sort(order.begin(), order.end(),
    [&](std::size_t a, std::size_t b) { return heights[a] > heights[b]; });
  const double valley = ValleyPart * heights[order.front()];
  constexpr auto none = NoHill;
  // The column to which each column leads, finally the peak of its hill.
  std::vector<std::size_t> leads(heights.size(), none);
  const auto peakOf = [&](std::size_t column)
  {
    while (leads[column] != column)
    {
      column = leads[column];
    }
    return column;
  };
  for (const std::size_t column : order)
  {
    if (heights[column] < 0)
    {
      break;
    }
    std::size_t highest = none;
    this->VisitNear(column, 1,
      [&](std::size_t other, double)
      {
        const std::size_t hill = leads[other] == none ? none : peakOf(other);
        if (hill != none && (highest == none || heights[hill] > heights[highest]))
        {
          highest = hill;
        }
      });
    leads[column] = highest == none ? column : highest;
    this->VisitNear(column, 1,
      [&](std::size_t other, double)
      {
        const std::size_t hill = leads[other] == none ? none : peakOf(other);
        if (hill != none && hill != highest && heights[hill] - heights[column] <= valley)
        {
          leads[hill] = peakOf(column);
        }
      });
  }
  std::vector<std::size_t> hills(heights.size(), none);
  for (std::size_t column = 0; column < hills.size(); ++column)
  {
    hills[column] = leads[column] == none ? none : peakOf(column);
  }
  return hills;
}

void BreastColumns::Find()
{
  const std::vector<double> heights = this->Heights();
  const std::vector<std::size_t> hills = this->Hills(heights);
  const auto highest = std::max_element(heights.begin(), heights.end());
  const double peak = *highest;
  const auto isHill = [&](std::size_t column)
  { return hills[column] == static_cast<std::size_t>(highest - heights.begin()); };
  // If nothing lies in front of the fixed tissue, all columns belong to the breast.
  const double reach = peak > 0 ? SlopePart * peak / this->WidthMm : Infinity;
  for (std::size_t core = 0; core < hills.size(); ++core)
  {
    if (isHill(core) && heights[core] >= CorePart * peak)
    {
      this->Core[core] = 1;
      const int steps =
        static_cast<int>(std::min<double>(reach, this->CountAcross + this->CountAlong));
      this->VisitNear(core, steps,
        [&](std::size_t other, double way)
        { this->Breast[other] = this->Breast[other] || (isHill(other) && way <= reach) ? 1 : 0; });
    }
  }
}

std::vector<Vector3> BreastColumns::CoreColumns() const
{
  std::vector<Vector3> columns;
  for (std::size_t column = 0; column < this->Core.size(); ++column)
  {
    if (this->Core[column])
    {
      const auto& [across, along, count] = this->Sums[column];
      columns.push_back({ across / count, this->FixedFront[column], along / count });
    }
  }
  return columns;
}

Vector3 BreastColumns::Middle() const
{
  Vector3 sum{ 0, 0, 0 };
  double all = 0;
  double fixed = 0;
  for (const Vector3& column : this->CoreColumns())
  {
    const bool isFixed = std::isfinite(column[1]);
    sum = sum + Vector3{ column[0], isFixed ? column[1] : 0, column[2] };
    fixed += isFixed ? 1 : 0;
    ++all;
  }
  return { sum[0] / all, sum[1] / std::max(fixed, 1.0), sum[2] / all };
}

std::array<double, 2> BreastColumns::WallSlopes() const
{
  std::vector<Vector3> walls = this->CoreColumns();
  std::erase_if(walls, [](const Vector3& wall) { return !std::isfinite(wall[1]); });
  Vector3 middle{ 0, 0, 0 };
  for (const Vector3& wall : walls)
  {
    middle = middle + (1.0 / static_cast<double>(walls.size())) * wall;
  }
  double xx = 0;
  double xz = 0;
  double zz = 0;
  double xy = 0;
  double zy = 0;
  for (const Vector3& wall : walls)
  {
    const Vector3 d = wall - middle;
    xx += d[0] * d[0];
    xz += d[0] * d[2];
    zz += d[2] * d[2];
    xy += d[0] * d[1];
    zy += d[2] * d[1];
  }
  const double determinant = xx * zz - xz * xz;
  if (determinant <= 0)
  {
    return { 0, 0 }; // fewer columns than a plane has parameters
  }
  return { (xy * zz - zy * xz) / determinant, (zy * xx - xy * xz) / determinant };
}

std::optional<double> BreastColumns::Midline() const
{
  const std::vector<double> heights = this->Heights();
  const std::vector<std::size_t> hills = this->Hills(heights);
  std::map<std::size_t, double> volumes;
  for (std::size_t column = 0; column < hills.size(); ++column)
  {
    if (hills[column] != NoHill)
    {
      volumes[hills[column]] += heights[column];
    }
  }
  const auto first =
    static_cast<std::size_t>(std::max_element(heights.begin(), heights.end()) - heights.begin());
  const auto acrossOf = [this](std::size_t column)
  { return static_cast<int>(column % this->CountAcross); };
  const auto alongOf = [this](std::size_t column)
  { return static_cast<int>(column / this->CountAcross); };
  for (const auto& [peak, volume] : volumes)
  {
    const auto [left, right] = std::minmax({ acrossOf(first), acrossOf(peak) });
    const auto [low, high] = std::minmax({ alongOf(first), alongOf(peak) });
    if (right - left <= high - low || heights[peak] < OtherHeightPart * heights[first] ||
      volume < OtherVolumePart * volumes[first])
    {
      continue;
    }
    // Height of the valley along the way from one peak to the other.
    std::vector<double> valley;
    for (int across = left; across <= right; ++across)
    {
      double most = 0;
      for (int along = low; along <= high; ++along)
      {
        const std::size_t row = static_cast<std::size_t>(along) * this->CountAcross;
        most = std::max(most, heights[row + across]);
      }
      valley.push_back(most);
    }
    const auto lowest = std::min_element(valley.begin(), valley.end());
    if (heights[peak] - *lowest >= SmallestBreastMm)
    {
      // The middle of its floor.
      const auto isFloor = [floor = *lowest + LeastWidthMm](double height)
      { return height <= floor; };
      const auto end = std::find_if_not(lowest, valley.end(), isFloor);
      const auto begin =
        std::find_if_not(std::make_reverse_iterator(lowest), valley.rend(), isFloor).base();
      const double middle =
        0.5 * static_cast<double>((begin - valley.begin()) + (end - valley.begin()));
      return this->Low[0] + (left + middle) * this->WidthMm;
    }
  }
  return std::nullopt;
}
}
