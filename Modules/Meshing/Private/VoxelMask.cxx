// SPDX-License-Identifier: Apache-2.0
#include "Private/VoxelMask.h"

#include "mammoray/Foundation/Raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace mammoray
{
namespace
{
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
  Convolve(RasterShape(field), GaussianKernel(sigmaMm / field.Spacing[0], 3), field.Values);
}

VoxelMask Above(const VoxelField& field, double threshold)
{
  return MaskWhere(field, [=](float value) { return value > threshold; });
}

VoxelField DistanceTo(const VoxelMask& mask, std::uint16_t value)
{
  std::vector<unsigned char> set(mask.Voxels.size());
  std::transform(mask.Voxels.begin(), mask.Voxels.end(), set.begin(),
    [value](std::uint16_t voxel) { return static_cast<unsigned char>(voxel == value ? 1 : 0); });
  VoxelField field;
  static_cast<VolumeGrid&>(field) = mask;
  field.Values = DistanceToSet(RasterShape(mask), { 1, 1, 1 }, set);
  const auto spacing = static_cast<float>(mask.Spacing[0]);
  for (float& distance : field.Values)
  {
    distance *= spacing;
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

VoxelMask LargestPiece(VoxelMask mask)
{
  KeepLargestPiece(RasterShape(mask), mask.Voxels);
  return mask;
}

VoxelMask WithoutHoles(VoxelMask mask)
{
  FillHoles(RasterShape(mask), mask.Voxels);
  return mask;
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
