// SPDX-License-Identifier: Apache-2.0
#include "Private/PixelMask.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
PixelMask Complement(const PixelMask& mask)
{
  PixelMask clear(mask.size());
  std::transform(mask.begin(), mask.end(), clear.begin(),
    [](unsigned char set) { return set ? 0 : 1; });
  return clear;
}
}

const char* NameOf(Side side)
{
  switch (side)
  {
    case Side::Left:
      return "left";
    case Side::Right:
      return "right";
    case Side::Top:
      return "upper";
    default:
      return "lower";
  }
}

// Not vtkImageEuclideanDistance: it left pixels of a mammogram at its upper limit, and took half a
// minute for 14 million of them.
std::vector<float> DistanceToClear(const PixelGrid& grid, const PixelMask& mask)
{
  return DistanceToSet(grid.Shape(), { grid.ColumnSpacing, grid.RowSpacing, 1 }, Complement(mask));
}

std::vector<float> SignedDistance(const PixelGrid& grid, const PixelMask& mask)
{
  std::vector<float> distances = DistanceToClear(grid, mask);
  const std::vector<float> outside = DistanceToClear(grid, Complement(mask));
  // The outline runs midway between the centres of a pixel in the breast and one outside.
  const auto half = static_cast<float>(0.25 * (grid.ColumnSpacing + grid.RowSpacing));
  for (std::size_t i = 0; i < mask.size(); ++i)
  {
    distances[i] = mask[i] ? half - distances[i] : outside[i] - half;
  }
  return distances;
}

std::array<double, 4> TouchedSides(const PixelGrid& grid, const PixelMask& mask)
{
  std::array<double, 4> touched{ 0, 0, 0, 0 };
  for (int row = 0; row < grid.Rows; ++row)
  {
    touched[0] += mask[grid.Index(0, row)] != 0;
    touched[1] += mask[grid.Index(grid.Columns - 1, row)] != 0;
  }
  for (int column = 0; column < grid.Columns; ++column)
  {
    touched[2] += mask[grid.Index(column, 0)] != 0;
    touched[3] += mask[grid.Index(column, grid.Rows - 1)] != 0;
  }
  for (int side = 0; side < 4; ++side)
  {
    touched[side] *= side < 2 ? grid.RowSpacing : grid.ColumnSpacing; // mm of contact
  }
  return touched;
}

void FillDarkFrame(const PixelGrid& grid, PixelMask& mask)
{
  constexpr double FrameMm = 1;
  const int columns = grid.Columns;
  const int rows = grid.Rows;
  for (const Side side : { Side::Left, Side::Right, Side::Top, Side::Bottom })
  {
    const bool upright = side == Side::Left || side == Side::Right;
    const int length = upright ? rows : columns;
    const double spacing = upright ? grid.ColumnSpacing : grid.RowSpacing;
    const int depth = std::max(2, static_cast<int>(std::lround(FrameMm / spacing)));
    if (2 * depth >= (upright ? columns : rows))
    {
      continue;
    }
    const auto at = [&](int along, int inward)
    {
      const bool far = side == Side::Right || side == Side::Bottom;
      const int across = far ? (upright ? columns : rows) - 1 - inward : inward;
      return upright ? grid.Index(across, along) : grid.Index(along, across);
    };
    int touching = 0;
    int near = 0;
    for (int along = 0; along < length; ++along)
    {
      touching += mask[at(along, 0)];
      near += mask[at(along, depth)];
    }
    if (2 * touching >= near)
    {
      continue;
    }
    for (int along = 0; along < length; ++along)
    {
      for (int inward = 0; mask[at(along, depth)] && inward < depth; ++inward)
      {
        mask[at(along, inward)] = 1;
      }
    }
  }
}

PixelMask WithoutThinParts(const PixelGrid& grid, PixelMask mask, double thinnest)
{
  const double radius = 0.5 * thinnest;
  if (radius < std::max(grid.ColumnSpacing, grid.RowSpacing))
  {
    return mask;
  }
  const std::vector<float> depth = DistanceToClear(grid, mask);
  PixelMask notCore(mask.size());
  std::transform(depth.begin(), depth.end(), notCore.begin(),
    [radius](float distance) { return distance <= radius ? 1 : 0; });
  const std::vector<float> toCore = DistanceToClear(grid, notCore);
  for (std::size_t i = 0; i < mask.size(); ++i)
  {
    // Twice the radius lets corners of the breast through, which the core does not reach into.
    mask[i] = mask[i] && toCore[i] <= 2 * radius ? 1 : 0;
  }
  return mask;
}
}
