// SPDX-License-Identifier: Apache-2.0
#include "Private/BreastColumns.h"

#include <algorithm>
#include <cmath>
#include <limits>
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

std::vector<char> BreastColumns::HighestHill(const std::vector<double>& heights) const
{
  // Visit columns from the highest down; each joins the hills that it touches. A hill that rises
  // above its saddle to a higher hill by no more than the depth of a valley is a part of that hill.
  std::vector<std::size_t> order(heights.size());
  std::iota(order.begin(), order.end(), std::size_t{ 0 });
  std::stable_sort(order.begin(), order.end(),
    [&](std::size_t a, std::size_t b) { return heights[a] > heights[b]; });
  const std::size_t peak = order.front();
  const double valley = ValleyPart * heights[peak];
  constexpr auto none = std::numeric_limits<std::size_t>::max();
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
  std::vector<char> members(heights.size(), 0);
  for (std::size_t column = 0; column < members.size(); ++column)
  {
    members[column] = leads[column] != none && peakOf(column) == peak ? 1 : 0;
  }
  return members;
}

void BreastColumns::Find()
{
  const std::vector<double> heights = this->Heights();
  const std::vector<char> hill = this->HighestHill(heights);
  const double peak = *std::max_element(heights.begin(), heights.end());
  // If nothing lies in front of the fixed tissue, all columns belong to the breast.
  const double reach = peak > 0 ? SlopePart * peak / this->WidthMm : Infinity;
  for (std::size_t core = 0; core < hill.size(); ++core)
  {
    if (hill[core] && heights[core] >= CorePart * peak)
    {
      const int steps =
        static_cast<int>(std::min<double>(reach, this->CountAcross + this->CountAlong));
      this->VisitNear(core, steps,
        [&](std::size_t other, double way)
        { this->Breast[other] = this->Breast[other] || (hill[other] && way <= reach) ? 1 : 0; });
    }
  }
}
}
