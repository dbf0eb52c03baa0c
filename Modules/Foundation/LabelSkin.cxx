// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/LabelSkin.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace mammoray
{
namespace
{
constexpr float Far = std::numeric_limits<float>::infinity();

bool IsFixed(const std::vector<bool>& fixed, std::uint16_t label)
{
  return label < fixed.size() && fixed[label];
}

/// Calls visit(index) for the voxels that share a face with one.
template <typename Visit>
void ForEachNeighbour(const VolumeGrid& grid, std::size_t index, Visit visit)
{
  std::size_t stride = 1;
  for (int a = 0; a < 3; ++a)
  {
    const auto size = static_cast<std::size_t>(grid.Size[a]);
    const std::size_t place = index / stride % size;
    if (place > 0)
    {
      visit(index - stride);
    }
    if (place + 1 < size)
    {
      visit(index + stride);
    }
    stride *= size;
  }
}

/// 1 for label 0 that is connected with the border of the volume.
std::vector<unsigned char> FindOuterAir(const LabelVolume& labels)
{
  std::vector<unsigned char> air(labels.Voxels.size(), 0);
  std::vector<std::size_t> queue;
  const auto add = [&](std::size_t index)
  {
    if (labels.Voxels[index] == 0 && !air[index])
    {
      air[index] = 1;
      queue.push_back(index);
    }
  };
  const auto& size = labels.Size;
  for (int k = 0; k < size[2]; ++k)
  {
    for (int j = 0; j < size[1]; ++j)
    {
      const bool inner = k > 0 && k + 1 < size[2] && j > 0 && j + 1 < size[1];
      for (int i = 0; i < size[0]; i += inner ? std::max(1, size[0] - 1) : 1)
      {
        add(labels.Index(i, j, k));
      }
    }
  }
  while (!queue.empty())
  {
    const std::size_t index = queue.back();
    queue.pop_back();
    ForEachNeighbour(labels, index, add);
  }
  return air;
}

/**
 * Adds the squared distances along one axis: each value becomes the least of its line's values plus
 * the square of the way to the voxel there, at half its edge length. Squares of the axes add up, so
 * that three passes give the distance in space.
 */
void SpreadAlong(const VolumeGrid& grid, int axis, double reachMm, std::vector<float>& squares)
{
  const auto size = static_cast<std::size_t>(grid.Size[axis]);
  std::size_t stride = 1;
  for (int a = 0; a < axis; ++a)
  {
    stride *= static_cast<std::size_t>(grid.Size[a]);
  }
  std::vector<float> steps;
  for (std::size_t n = 0; n < size; ++n)
  {
    const double way = n == 0 ? 0 : (static_cast<double>(n) - 0.25) * grid.Spacing[axis];
    if (way > reachMm)
    {
      break;
    }
    steps.push_back(static_cast<float>(way * way));
  }
  std::vector<float> line(size);
  for (std::size_t block = 0; block < squares.size(); block += stride * size)
  {
    for (std::size_t first = block; first < block + stride; ++first)
    {
      bool any = false;
      for (std::size_t n = 0; n < size; ++n)
      {
        line[n] = squares[first + n * stride];
        any = any || line[n] != Far;
      }
      for (std::size_t n = 0; any && n < size; ++n)
      {
        float least = line[n];
        for (std::size_t step = 1; step < steps.size(); ++step)
        {
          least = std::min(least, n >= step ? line[n - step] + steps[step] : Far);
          least = std::min(least, n + step < size ? line[n + step] + steps[step] : Far);
        }
        squares[first + n * stride] = least;
      }
    }
  }
}
}

std::vector<float> DepthBelowAir(const LabelVolume& labels, double reachMm,
  const std::vector<bool>& fixed)
{
  const std::vector<unsigned char> air = FindOuterAir(labels);
  std::vector<float> depth(labels.Voxels.size(), Far);
  for (std::size_t voxel = 0; voxel < depth.size(); ++voxel)
  {
    // The air nearest to a voxel of tissue touches tissue.
    bool touches = false;
    if (air[voxel])
    {
      ForEachNeighbour(labels, voxel,
        [&](std::size_t other) {
          touches = touches || (labels.Voxels[other] != 0 && !IsFixed(fixed, labels.Voxels[other]));
        });
    }
    depth[voxel] = touches ? 0.0f : Far;
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    SpreadAlong(labels, axis, reachMm, depth);
  }
  // 1e-5: a depth of the reach itself shall not be lost to rounding.
  const auto most = static_cast<float>(reachMm * (1 + 1e-5));
  for (std::size_t voxel = 0; voxel < depth.size(); ++voxel)
  {
    const float distance = std::sqrt(depth[voxel]);
    depth[voxel] = air[voxel] ? 0.0f : distance <= most ? distance : Far;
  }
  return depth;
}

LabelVolume AddSkin(const LabelVolume& labels, double thicknessMm, int skin,
  const std::vector<bool>& fixed)
{
  labels.Validate("volume for a skin");
  const double coarsest = *std::max_element(labels.Spacing.begin(), labels.Spacing.end());
  if (!(thicknessMm >= coarsest) || !std::isfinite(thicknessMm))
  {
    std::ostringstream text;
    text << "skin of " << thicknessMm << " mm: expected at least the voxel spacing, " << coarsest
         << " mm; a smaller spacing allows a thinner skin";
    throw InputError(text.str());
  }
  if (skin < 1 || skin > 65535 || IsFixed(fixed, static_cast<std::uint16_t>(skin)))
  {
    throw InputError(
      "skin: expected a label of tissue that is not fixed, found " + std::to_string(skin));
  }
  const std::vector<float> depth = DepthBelowAir(labels, thicknessMm, fixed);
  LabelVolume result = labels;
  for (std::size_t voxel = 0; voxel < depth.size(); ++voxel)
  {
    std::uint16_t& label = result.Voxels[voxel];
    if (label != 0 && !IsFixed(fixed, label) && depth[voxel] != Far)
    {
      label = static_cast<std::uint16_t>(skin);
    }
  }
  return result;
}
}
