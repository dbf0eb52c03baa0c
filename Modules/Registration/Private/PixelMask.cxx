// SPDX-License-Identifier: Apache-2.0
#include "Private/PixelMask.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mammoray
{
namespace
{
/**
 * Squared distance transform of one line by the lower envelope of parabolas (Felzenszwalb and
 * Huttenlocher 2012, algorithm 1). `heights` are squared distances at places `spacing` apart;
 * infinite where there is none. `hull` and `reach` are working space of the line's length (+ 1).
 */
void TransformLine(const std::vector<double>& heights, double spacing, std::vector<int>& hull,
  std::vector<double>& reach, std::vector<double>& result)
{
  constexpr double Infinity = std::numeric_limits<double>::infinity();
  const int count = static_cast<int>(heights.size());
  int last = -1;
  for (int q = 0; q < count; ++q)
  {
    if (heights[q] == Infinity)
    {
      continue;
    }
    const double atQ = q * spacing;
    double crossing = -Infinity;
    while (last >= 0)
    {
      const double atP = hull[last] * spacing;
      crossing = (heights[q] + atQ * atQ - heights[hull[last]] - atP * atP) / (2 * (atQ - atP));
      if (crossing > reach[last])
      {
        break;
      }
      --last;
    }
    ++last;
    hull[last] = q;
    reach[last] = last == 0 ? -Infinity : crossing;
  }
  if (last < 0)
  {
    std::fill(result.begin(), result.end(), Infinity);
    return;
  }
  int piece = 0;
  for (int q = 0; q < count; ++q)
  {
    while (piece < last && reach[piece + 1] < q * spacing)
    {
      ++piece;
    }
    const double offset = (q - hull[piece]) * spacing;
    result[q] = offset * offset + heights[hull[piece]];
  }
}

/// Pieces of a mask whose pixels share edges: a label for each pixel (0 outside) and the pixel
/// count of each label (from 1).
struct Pieces
{
  std::vector<int> Labels;
  std::vector<std::size_t> Sizes;
};

/// Here and not by vtkImageConnectivityFilter, whose module ParaView's VTK lacks.
Pieces FindPieces(const PixelGrid& grid, const PixelMask& mask)
{
  Pieces pieces;
  pieces.Labels.assign(mask.size(), 0);
  pieces.Sizes.assign(1, 0);
  std::vector<std::array<int, 2>> front;
  const auto visit = [&](int column, int row)
  {
    const std::size_t pixel = grid.Index(column, row);
    if (mask[pixel] != 0 && pieces.Labels[pixel] == 0)
    {
      pieces.Labels[pixel] = static_cast<int>(pieces.Sizes.size()) - 1;
      ++pieces.Sizes.back();
      front.push_back({ column, row });
    }
  };
  for (std::size_t pixel = 0; pixel < mask.size(); ++pixel)
  {
    if (mask[pixel] == 0 || pieces.Labels[pixel] != 0)
    {
      continue;
    }
    pieces.Sizes.push_back(0);
    visit(static_cast<int>(pixel) % grid.Columns, static_cast<int>(pixel) / grid.Columns);
    while (!front.empty())
    {
      const auto [column, row] = front.back();
      front.pop_back();
      for (const int step : { -1, 1 })
      {
        if (column + step >= 0 && column + step < grid.Columns)
        {
          visit(column + step, row);
        }
        if (row + step >= 0 && row + step < grid.Rows)
        {
          visit(column, row + step);
        }
      }
    }
  }
  return pieces;
}

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
  constexpr double Infinity = std::numeric_limits<double>::infinity();
  std::vector<float> squares(mask.size());
  const int longest = std::max(grid.Columns, grid.Rows);
  std::vector<int> hull(longest);
  std::vector<double> reach(longest);
  std::vector<double> heights(grid.Columns);
  std::vector<double> line(grid.Columns);
  for (int row = 0; row < grid.Rows; ++row)
  {
    for (int column = 0; column < grid.Columns; ++column)
    {
      heights[column] = mask[grid.Index(column, row)] ? Infinity : 0;
    }
    TransformLine(heights, grid.ColumnSpacing, hull, reach, line);
    std::copy(line.begin(), line.end(),
      squares.begin() + static_cast<std::ptrdiff_t>(grid.Index(0, row)));
  }
  heights.resize(grid.Rows);
  line.resize(grid.Rows);
  for (int column = 0; column < grid.Columns; ++column)
  {
    for (int row = 0; row < grid.Rows; ++row)
    {
      heights[row] = squares[grid.Index(column, row)];
    }
    TransformLine(heights, grid.RowSpacing, hull, reach, line);
    for (int row = 0; row < grid.Rows; ++row)
    {
      squares[grid.Index(column, row)] = static_cast<float>(std::sqrt(line[row]));
    }
  }
  return squares;
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

void KeepLargestPiece(const PixelGrid& grid, PixelMask& mask)
{
  const Pieces pieces = FindPieces(grid, mask);
  if (pieces.Sizes.size() < 2)
  {
    throw InputError("mammogram: expected a breast, found nothing brighter than the air");
  }
  const auto largest = static_cast<int>(
    std::max_element(pieces.Sizes.begin(), pieces.Sizes.end()) - pieces.Sizes.begin());
  std::transform(pieces.Labels.begin(), pieces.Labels.end(), mask.begin(),
    [largest](int label) { return label == largest ? 1 : 0; });
}

void FillHoles(const PixelGrid& grid, PixelMask& mask)
{
  const Pieces pieces = FindPieces(grid, Complement(mask));
  std::vector<bool> open(pieces.Sizes.size(), false);
  for (int row = 0; row < grid.Rows; ++row)
  {
    open[pieces.Labels[grid.Index(0, row)]] = true;
    open[pieces.Labels[grid.Index(grid.Columns - 1, row)]] = true;
  }
  for (int column = 0; column < grid.Columns; ++column)
  {
    open[pieces.Labels[grid.Index(column, 0)]] = true;
    open[pieces.Labels[grid.Index(column, grid.Rows - 1)]] = true;
  }
  for (std::size_t i = 0; i < mask.size(); ++i)
  {
    mask[i] = mask[i] || !open[pieces.Labels[i]] ? 1 : 0;
  }
}
}
