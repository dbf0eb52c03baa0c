// SPDX-License-Identifier: Apache-2.0
#include "Private/SliceStack.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace mammoray
{
namespace
{
/// Throws InputError unless the slice has a place within a kilometre and orthonormal axes: other
/// values would put its voxels outside the grid.
void CheckPlace(const VolumeSlice& slice)
{
  if (!slice.Position)
  {
    throw InputError(slice.Name +
      ": expected Image Position (0020,0032), Image Orientation (0020,0037) and a positive Pixel "
      "Spacing (0028,0030), found some of them missing");
  }
  constexpr double farthest = 1e6; // mm
  // A hundredth: what few decimals leave of a direction's length.
  constexpr double rounding = 0.01;
  const bool near = std::all_of(slice.Position->begin(), slice.Position->end(),
                      [](double value) { return std::abs(value) <= farthest; }) &&
    slice.RowSpacingMm <= farthest && slice.ColumnSpacingMm <= farthest;
  const bool square = std::abs(Norm(slice.AlongRow) - 1) <= rounding &&
    std::abs(Norm(slice.AlongColumn) - 1) <= rounding &&
    std::abs(Dot(slice.AlongRow, slice.AlongColumn)) <= rounding;
  if (!near || !square)
  {
    throw InputError(slice.Name +
      ": expected image position and orientation of a picture (mm up to 1e6, two perpendicular "
      "directions of length 1), found others");
  }
}

/// Throws unless the slices lie in parallel on one grid.
void CheckParallel(const std::vector<VolumeSlice>& slices, const Vector3& normal)
{
  const VolumeSlice& first = slices.front();
  for (const VolumeSlice& slice : slices)
  {
    // 1e-4 of lengths and directions: what decimal strings of a scanner differ by.
    const bool same = slice.Columns == first.Columns && slice.Rows == first.Rows &&
      std::abs(slice.RowSpacingMm - first.RowSpacingMm) <= 1e-4 * first.RowSpacingMm &&
      std::abs(slice.ColumnSpacingMm - first.ColumnSpacingMm) <= 1e-4 * first.ColumnSpacingMm &&
      Norm(slice.AlongRow - first.AlongRow) <= 1e-4 &&
      Norm(slice.AlongColumn - first.AlongColumn) <= 1e-4;
    const Vector3 offset = *slice.Position - *first.Position;
    const Vector3 aside = offset - Dot(offset, normal) * normal;
    if (!same || Norm(aside) > 0.1 * std::min(first.RowSpacingMm, first.ColumnSpacingMm))
    {
      throw InputError(slice.Name + ": expected the size, spacing and orientation of " +
        first.Name + " and a place straight above or below it, found others");
    }
  }
}

/// `shared`: the number of slices that lie where another one does.
[[noreturn]] void RefuseShared(const std::vector<VolumeSlice>& slices, const Vector3& normal,
  std::size_t shared)
{
  std::vector<std::pair<double, const VolumeSlice*>> sorted;
  sorted.reserve(slices.size());
  for (const VolumeSlice& slice : slices)
  {
    sorted.emplace_back(Dot(*slice.Position - *slices.front().Position, normal), &slice);
  }
  std::stable_sort(sorted.begin(), sorted.end(),
    [](const auto& a, const auto& b) { return a.first < b.first; });
  const auto pair = std::adjacent_find(sorted.begin(), sorted.end(),
    [](const auto& a, const auto& b) { return b.first - a.first < 1e-3; });
  throw InputError(slices.front().Name +
    ": expected slices at places of their own, found two at "
    "one, " +
    pair->second->Name + " and " + std::next(pair)->second->Name +
    (shared > 1 ? ", and " + std::to_string(shared - 1) + " more" : "") +
    ": duplicates, or several volumes in one folder");
}

[[noreturn]] void RefuseDistances(const VolumeSlice& first, const std::vector<double>& heights)
{
  double least = heights[1] - heights[0];
  double most = least;
  for (std::size_t n = 2; n < heights.size(); ++n)
  {
    least = std::min(least, heights[n] - heights[n - 1]);
    most = std::max(most, heights[n] - heights[n - 1]);
  }
  char range[64];
  std::snprintf(range, sizeof range, " (%.2f to %.2f mm)", least, most);
  throw InputError(first.Name +
    ": expected slices at even distances, found a missing one or other distances" + range);
}

/// The distance of slices, at least two, of which none may be left out: the mean one, so that the
/// rounding of decimal strings does not add up.
double EvenSliceSpacing(const std::vector<VolumeSlice>& slices, const std::vector<double>& heights)
{
  const double spacing =
    (heights.back() - heights.front()) / static_cast<double>(heights.size() - 1);
  for (std::size_t n = 0; n < heights.size(); ++n)
  {
    // A twentieth of a step: a grid is still told from none.
    if (std::abs(heights[n] - heights.front() - static_cast<double>(n) * spacing) > 0.05 * spacing)
    {
      RefuseDistances(slices.front(), heights);
    }
  }
  return spacing;
}

/**
 * The distance of neighbouring slices of which some may be left out: the one that the file tells,
 * or, where slices do not lie on it, their smallest distance, or the largest fraction of that which
 * they lie on and which is about what the file tells. A smaller one would leave air between slices.
 */
double SparseSliceSpacing(const std::vector<VolumeSlice>& slices,
  const std::vector<double>& heights)
{
  double smallest = 0;
  for (std::size_t n = 1; n < heights.size(); ++n)
  {
    const double gap = heights[n] - heights[n - 1];
    smallest = smallest == 0 ? gap : std::min(smallest, gap);
  }
  const double told = slices.front().SliceSpacingMm;
  std::vector<double> candidates{ told, smallest };
  for (int parts = 2; parts <= 20 && told > 0 && smallest / parts > 0.7 * told; ++parts)
  {
    candidates.push_back(smallest / parts);
  }
  for (const double spacing : candidates)
  {
    // A twentieth of a step: no label is moved farther.
    const bool fits = spacing > 0 &&
      std::all_of(heights.begin(), heights.end(),
        [&](double height)
        {
          const double steps = (height - heights.front()) / spacing;
          return std::abs(steps - std::round(steps)) <= 0.05;
        });
    if (fits)
    {
      return spacing;
    }
  }
  if (smallest == 0)
  {
    throw InputError(
      slices.front().Name + ": expected several slices or a slice thickness, found neither");
  }
  RefuseDistances(slices.front(), heights);
}
}

VolumeGrid FindSliceGrid(const std::vector<VolumeSlice>& slices, bool gapsAllowed)
{
  const VolumeSlice& first = slices.front();
  std::for_each(slices.begin(), slices.end(), CheckPlace);
  const Vector3 across = Cross(first.AlongRow, first.AlongColumn);
  const Vector3 normal = (1 / Norm(across)) * across;
  CheckParallel(slices, normal);
  std::vector<double> heights;
  heights.reserve(slices.size());
  for (const VolumeSlice& slice : slices)
  {
    heights.push_back(Dot(*slice.Position - *first.Position, normal));
  }
  std::sort(heights.begin(), heights.end());
  const std::size_t count = heights.size();
  // A micrometre: frames of several segments share a place.
  heights.erase(
    std::unique(heights.begin(), heights.end(), [](double a, double b) { return b - a < 1e-3; }),
    heights.end());
  if (!gapsAllowed && heights.size() != count)
  {
    RefuseShared(slices, normal, count - heights.size());
  }
  const double spacing = gapsAllowed || heights.size() == 1 ? SparseSliceSpacing(slices, heights)
                                                            : EvenSliceSpacing(slices, heights);
  const auto depth = std::lround((heights.back() - heights.front()) / spacing) + 1;
  if (depth > 65536)
  {
    throw InputError(
      first.Name + ": expected slices near each other, found a stack of " + std::to_string(depth));
  }
  VolumeGrid grid;
  grid.Size = { first.Columns, first.Rows, static_cast<int>(depth) };
  grid.Spacing = { first.ColumnSpacingMm, first.RowSpacingMm, spacing };
  grid.Origin = *first.Position + heights.front() * normal;
  grid.Direction = { first.AlongRow, first.AlongColumn, normal };
  for (Vector3& axis : grid.Direction)
  {
    axis = (1 / Norm(axis)) * axis;
  }
  return grid;
}

IntensityVolume StackSlices(const std::vector<VolumeSlice>& slices, bool gapsAllowed)
{
  const VolumeSlice& first = slices.front();
  IntensityVolume volume;
  static_cast<VolumeGrid&>(volume) = FindSliceGrid(slices, gapsAllowed);
  const std::size_t area = first.Values.size();
  volume.Voxels.assign(area * static_cast<std::size_t>(volume.Size[2]), 0);
  // Large segments first, so that what lies within them is painted over: a lesion in a gland in a
  // breast. The order of a series, whose slices lie beside each other, means nothing.
  std::map<float, std::ptrdiff_t> sizes;
  std::vector<std::pair<const VolumeSlice*, const std::ptrdiff_t*>> order;
  for (const VolumeSlice& slice : slices)
  {
    std::ptrdiff_t& size = sizes[*std::max_element(slice.Values.begin(), slice.Values.end())];
    size += std::count_if(slice.Values.begin(), slice.Values.end(),
      [](float label) { return label != 0; });
    order.emplace_back(&slice, &size);
  }
  std::stable_sort(order.begin(), order.end(),
    [](const auto& a, const auto& b) { return *a.second > *b.second; });
  for (const auto& [slice, size] : order)
  {
    const double height = Dot(*slice->Position - volume.Origin, volume.Direction[2]);
    const auto layer = static_cast<std::size_t>(std::lround(height / volume.Spacing[2]));
    for (std::size_t pixel = 0; pixel < area; ++pixel)
    {
      float& voxel = volume.Voxels[layer * area + pixel];
      voxel = slice->Values[pixel] != 0 ? slice->Values[pixel] : voxel;
    }
  }
  volume.Validate(first.Name);
  return volume;
}
}
