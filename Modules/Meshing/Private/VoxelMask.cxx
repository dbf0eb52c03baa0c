// SPDX-License-Identifier: Apache-2.0
#include "Private/VoxelMask.h"

#include "Private/LabelComponents.h"
#include "mammoray/Foundation/ParallelFor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace mammoray
{
namespace
{
constexpr float Far = std::numeric_limits<float>::infinity();

/// The lines of a grid along an axis.
struct Lines
{
  std::size_t Count;
  std::size_t Stride;

  Lines(const std::array<int, 3>& size, int axis)
    : Count(static_cast<std::size_t>(size[(axis + 1) % 3]) * size[(axis + 2) % 3])
    , Stride(axis == 0 ? 1
          : axis == 1  ? size[0]
                       : static_cast<std::size_t>(size[0]) * size[1])
    , Length(size[axis])
  {
  }
  /// The first voxel of a line.
  std::size_t First(std::size_t line) const
  {
    return line / this->Stride * this->Stride * this->Length + line % this->Stride;
  }

private:
  std::size_t Length;
};

/// Fractions of one interval of a line that come from the intervals of another.
struct Overlap
{
  int From = 0;
  std::vector<float> Shares;
};

/// Overlaps of new intervals (centres start + n step, length `step`) with old intervals of length 1
/// centred at 0, 1, ...
std::vector<Overlap> Overlaps(int newCount, double start, double step, int oldCount)
{
  std::vector<Overlap> overlaps(newCount);
  for (int n = 0; n < newCount; ++n)
  {
    const double low = start + (n - 0.5) * step + 0.5;
    const double high = low + step;
    const int first = std::max(0, static_cast<int>(std::floor(low)));
    const int last = std::min(oldCount - 1, static_cast<int>(std::ceil(high)) - 1);
    overlaps[n].From = first;
    for (int o = first; o <= last; ++o)
    {
      const double shared = std::min(high, o + 1.0) - std::max(low, static_cast<double>(o));
      overlaps[n].Shares.push_back(static_cast<float>(std::max(0.0, shared) / step));
    }
  }
  return overlaps;
}

/// Squared distance along a row to the nearest voxel of a value, in voxels.
void MeasureRow(const std::uint16_t* voxels, std::size_t count, std::uint16_t value, float* result)
{
  float way = Far;
  for (std::size_t n = 0; n < count; ++n)
  {
    way = voxels[n] == value ? 0 : way + 1;
    result[n] = way * way;
  }
  way = Far;
  for (std::size_t n = count; n-- > 0;)
  {
    way = voxels[n] == value ? 0 : way + 1;
    result[n] = std::min(result[n], way * way);
  }
}

/**
 * Squared distance transform of a line, in voxels, by the lower envelope of parabolas.
 */
void SpreadLine(const std::vector<float>& values, std::vector<float>& result,
  std::vector<int>& places, std::vector<float>& bounds)
{
  const int count = static_cast<int>(values.size());
  int last = -1;
  for (int q = 0; q < count; ++q)
  {
    if (values[q] == Far)
    {
      continue;
    }
    float bound = -Far;
    while (last >= 0)
    {
      const auto p = static_cast<float>(places[last]);
      const auto here = static_cast<float>(q);
      bound = ((values[q] + here * here) - (values[places[last]] + p * p)) / (2 * (here - p));
      if (bound > bounds[last])
      {
        break;
      }
      --last;
      bound = -Far;
    }
    ++last;
    places[last] = q;
    bounds[last] = bound;
  }
  int place = 0;
  for (int q = 0; q < count; ++q)
  {
    if (last < 0)
    {
      result[q] = Far;
      continue;
    }
    while (place < last && bounds[place + 1] < static_cast<float>(q))
    {
      ++place;
    }
    const auto way = static_cast<float>(q - places[place]);
    result[q] = way * way + values[places[place]];
  }
}

template <typename Rule>
VoxelMask MaskWhere(const VoxelField& field, Rule rule)
{
  VoxelMask mask;
  static_cast<VolumeGrid&>(mask) = field;
  mask.Voxels.resize(field.Values.size());
  std::transform(field.Values.begin(), field.Values.end(), mask.Voxels.begin(),
    [&](float value) { return static_cast<std::uint16_t>(rule(value) ? 1 : 0); });
  return mask;
}
}

VoxelField FractionOf(const LabelVolume& labels, const std::function<bool(std::uint16_t)>& belongs,
  const VolumeGrid& grid)
{
  std::vector<char> chosen(65536, 0);
  for (const auto& [label, count] : labels.CountLabels())
  {
    chosen[label] = belongs(static_cast<std::uint16_t>(label)) ? 1 : 0;
  }
  std::vector<float> values(labels.Voxels.size());
  std::transform(labels.Voxels.begin(), labels.Voxels.end(), values.begin(),
    [&](std::uint16_t label) { return chosen[label] ? 1.0f : 0.0f; });
  const Vector3 start = labels.ContinuousIndex(grid.Origin);
  std::array<int, 3> size = labels.Size;
  for (int axis = 0; axis < 3; ++axis)
  {
    const std::vector<Overlap> overlaps =
      Overlaps(grid.Size[axis], start[axis], grid.Spacing[axis] / labels.Spacing[axis], size[axis]);
    const Lines before(size, axis);
    size[axis] = grid.Size[axis];
    const Lines after(size, axis);
    std::vector<float> resampled(
      static_cast<std::size_t>(size[0]) * size[1] * static_cast<std::size_t>(size[2]), 0.0f);
    ParallelFor(after.Count,
      [&](std::size_t line)
      {
        const float* from = &values[before.First(line)];
        float* to = &resampled[after.First(line)];
        for (std::size_t n = 0; n < overlaps.size(); ++n)
        {
          float sum = 0;
          for (std::size_t o = 0; o < overlaps[n].Shares.size(); ++o)
          {
            sum += overlaps[n].Shares[o] * from[(overlaps[n].From + o) * before.Stride];
          }
          to[n * after.Stride] = sum;
        }
      });
    values.swap(resampled);
  }
  VoxelField field;
  static_cast<VolumeGrid&>(field) = grid;
  field.Values = std::move(values);
  return field;
}

void BlurField(VoxelField& field, double sigmaMm)
{
  const double sigma = sigmaMm / field.Spacing[0];
  const int radius = static_cast<int>(std::ceil(3 * sigma));
  if (radius == 0)
  {
    return;
  }
  std::vector<float> kernel(2 * radius + 1);
  double sum = 0;
  for (int t = -radius; t <= radius; ++t)
  {
    kernel[t + radius] = static_cast<float>(std::exp(-0.5 * t * t / (sigma * sigma)));
    sum += kernel[t + radius];
  }
  for (float& weight : kernel)
  {
    weight = static_cast<float>(weight / sum);
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    const Lines lines(field.Size, axis);
    const int count = field.Size[axis];
    ParallelFor(lines.Count,
      [&](std::size_t line)
      {
        float* values = &field.Values[lines.First(line)];
        std::vector<float> padded(count + 2 * radius);
        for (int n = 0; n < count + 2 * radius; ++n)
        {
          padded[n] = values[std::clamp(n - radius, 0, count - 1) * lines.Stride];
        }
        for (int n = 0; n < count; ++n)
        {
          float blurred = 0;
          for (int t = 0; t <= 2 * radius; ++t)
          {
            blurred += kernel[t] * padded[n + t];
          }
          values[n * lines.Stride] = blurred;
        }
      });
  }
}

VoxelMask Above(const VoxelField& field, double threshold)
{
  return MaskWhere(field, [=](float value) { return value > threshold; });
}

VoxelField DistanceTo(const VoxelMask& mask, std::uint16_t value)
{
  VoxelField field;
  static_cast<VolumeGrid&>(field) = mask;
  field.Values.resize(mask.Voxels.size());
  const auto length = static_cast<std::size_t>(mask.Size[0]);
  for (std::size_t row = 0; row < field.Values.size(); row += length)
  {
    MeasureRow(&mask.Voxels[row], length, value, &field.Values[row]);
  }
  for (int axis = 1; axis < 3; ++axis)
  {
    const Lines lines(mask.Size, axis);
    const auto count = static_cast<std::size_t>(mask.Size[axis]);
    ParallelRanges(lines.Count, 64,
      [&](std::size_t begin, std::size_t end)
      {
        std::vector<float> values(count);
        std::vector<float> result(count);
        std::vector<int> places(count);
        std::vector<float> bounds(count);
        for (std::size_t line = begin; line < end; ++line)
        {
          float* first = &field.Values[lines.First(line)];
          for (std::size_t n = 0; n < count; ++n)
          {
            values[n] = first[n * lines.Stride];
          }
          if (std::all_of(values.begin(), values.end(), [&](float v) { return v == values[0]; }))
          {
            continue; // nothing is nearer than what lies across
          }
          SpreadLine(values, result, places, bounds);
          for (std::size_t n = 0; n < count; ++n)
          {
            first[n * lines.Stride] = result[n];
          }
        }
      });
  }
  const auto spacing = static_cast<float>(mask.Spacing[0]);
  for (float& distance : field.Values)
  {
    distance = spacing * std::sqrt(distance);
  }
  return field;
}

VoxelField DepthIn(const VoxelMask& mask)
{
  VoxelField depth = DistanceTo(mask, 0);
  const VoxelField outside = DistanceTo(mask, 1);
  // The border lies half a voxel in front of the nearest centre beyond it.
  const auto half = static_cast<float>(0.5 * mask.Spacing[0]);
  for (std::size_t voxel = 0; voxel < depth.Values.size(); ++voxel)
  {
    depth.Values[voxel] =
      mask.Voxels[voxel] ? depth.Values[voxel] - half : half - outside.Values[voxel];
  }
  return depth;
}

VoxelMask LargestPiece(const VoxelMask& mask)
{
  const LabelComponents found = FindComponents(mask);
  const auto smaller = [](const LabelComponent& a, const LabelComponent& b)
  { return (a.Material ? a.Voxels : 0) < (b.Material ? b.Voxels : 0); };
  const auto largest = static_cast<std::uint32_t>(
    std::max_element(found.Components.begin(), found.Components.end(), smaller) -
    found.Components.begin());
  VoxelMask piece = mask;
  for (std::size_t voxel = 0; voxel < piece.Voxels.size(); ++voxel)
  {
    piece.Voxels[voxel] = mask.Voxels[voxel] && found.OfVoxel[voxel] == largest ? 1 : 0;
  }
  return piece;
}

VoxelMask WithoutHoles(const VoxelMask& mask)
{
  const LabelComponents found = FindComponents(mask);
  std::vector<char> open(found.Components.size(), 0);
  for (int k = 0; k < mask.Size[2]; ++k)
  {
    for (int j = 0; j < mask.Size[1]; ++j)
    {
      const bool inner = k > 0 && k + 1 < mask.Size[2] && j > 0 && j + 1 < mask.Size[1];
      for (int i = 0; i < mask.Size[0]; i += inner ? std::max(1, mask.Size[0] - 1) : 1)
      {
        open[found.OfVoxel[mask.Index(i, j, k)]] = 1;
      }
    }
  }
  VoxelMask filled = mask;
  for (std::size_t voxel = 0; voxel < filled.Voxels.size(); ++voxel)
  {
    filled.Voxels[voxel] = mask.Voxels[voxel] || !open[found.OfVoxel[voxel]] ? 1 : 0;
  }
  return filled;
}

VoxelMask OpenedLargest(const VoxelMask& mask, double radiusMm)
{
  const auto half = static_cast<float>(0.5 * mask.Spacing[0]);
  const VoxelMask core =
    LargestPiece(MaskWhere(DistanceTo(mask, 0), [=](float way) { return way - half > radiusMm; }));
  // The region's outermost centres lie half a voxel below its border.
  const double reach = radiusMm + 0.5 * mask.Spacing[0];
  VoxelMask opened = MaskWhere(DistanceTo(core, 1), [=](float way) { return way <= reach; });
  for (std::size_t voxel = 0; voxel < opened.Voxels.size(); ++voxel)
  {
    opened.Voxels[voxel] = opened.Voxels[voxel] && mask.Voxels[voxel] ? 1 : 0;
  }
  return opened;
}

VoxelMask Closed(const VoxelMask& mask, double radiusMm)
{
  const VoxelMask grown =
    MaskWhere(DistanceTo(mask, 1), [=](float way) { return way <= radiusMm; });
  VoxelMask closed = MaskWhere(DistanceTo(grown, 0), [=](float way) { return way > radiusMm; });
  for (std::size_t voxel = 0; voxel < closed.Voxels.size(); ++voxel)
  {
    closed.Voxels[voxel] = closed.Voxels[voxel] || mask.Voxels[voxel] ? 1 : 0;
  }
  return closed;
}
}
