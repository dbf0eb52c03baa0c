// SPDX-License-Identifier: Apache-2.0
#include "Private/FatLevel.h"

#include "Private/Thresholds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace mammoray
{
namespace
{
constexpr double CoarseMm = 24.0;
/// Reach of the first estimate where gland's level is known, wider than compact gland, mm.
constexpr double WideMm = 40.0;
constexpr double EarlyReachMm = 18.0;
constexpr double LateReachMm = 12.0;
constexpr double BlockMm = 4.0;
constexpr int Rounds = 6;
constexpr std::size_t EnoughVoxels = 50;
/// Tolerance of fat's logarithm in early and late iterations; gland and muscle lie outside. Bright
/// fat has little noise, and slightly darker voxels contain strands of gland.
constexpr std::array<double, 2> DarkTolerance{ 0.35, 0.25 };
constexpr std::array<double, 2> BrightTolerance{ 0.2, 0.1 };

/// Tolerance of gland's logarithm: less than half of its distance from fat, so that fat's noise is
/// not taken for gland.
constexpr double GlandTolerance = 0.15;

/// Weighted Gaussian means; `otherwise` far from all weights.
FloatImage::Pointer WeightedMean(FloatImage::Pointer sums, FloatImage::Pointer weights,
  double sigmaMm, float otherwise)
{
  constexpr float least = 1e-4f;
  // Clamp means to the range of the averaged values. Far from all weights the tails of the
  // recursive filter change sign, and not at the same place for sums and weights.
  float lowest = otherwise;
  float highest = otherwise;
  for (std::size_t n = 0; n < CountOf(*sums); ++n)
  {
    const float weight = weights->GetBufferPointer()[n];
    if (weight > least)
    {
      lowest = std::min(lowest, sums->GetBufferPointer()[n] / weight);
      highest = std::max(highest, sums->GetBufferPointer()[n] / weight);
    }
  }
  sums = GaussianMean<FloatImage>(sums, sigmaMm);
  weights = GaussianMean<FloatImage>(weights, sigmaMm);
  for (std::size_t n = 0; n < CountOf(*sums); ++n)
  {
    const float weight = std::max(0.0f, weights->GetBufferPointer()[n]);
    float& sum = sums->GetBufferPointer()[n];
    sum = (weight > 0 ? sum + least * otherwise : least * otherwise) / (weight + least);
    sum = std::clamp(sum, lowest, highest);
  }
  return sums;
}

/// The voxels of the region, grouped in coarser blocks.
class Region
{
public:
  Region(const FloatImage* image, const MaskImage* region)
    : Blocks(Shrink(image, BlockMm))
  {
    const std::array<int, 3> size = SizeOf(*image);
    const std::array<int, 3> blocks = SizeOf(*this->Blocks);
    std::array<int, 3> factor;
    for (std::size_t a = 0; a < 3; ++a)
    {
      factor[a] = size[a] / blocks[a];
    }
    std::size_t voxel = 0;
    for (int z = 0; z < size[2]; ++z)
    {
      for (int y = 0; y < size[1]; ++y)
      {
        for (int x = 0; x < size[0]; ++x, ++voxel)
        {
          const float value = image->GetBufferPointer()[voxel];
          const std::array<int, 3> at{ x / factor[0], y / factor[1], z / factor[2] };
          if (region->GetBufferPointer()[voxel] && value > 0 && at[0] < blocks[0] &&
            at[1] < blocks[1] && at[2] < blocks[2])
          {
            this->Logs.push_back(std::log(value));
            this->BlockOf.push_back(
              (static_cast<std::size_t>(at[2]) * blocks[1] + at[1]) * blocks[0] + at[0]);
          }
        }
      }
    }
  }

  FloatImage::Pointer Blocks;
  std::vector<float> Logs;
  std::vector<std::size_t> BlockOf;
};

/// The smoothed quantile of the logarithms in each coarse cube that has enough voxels.
FloatImage::Pointer BeginWithQuantiles(const Region& region, double quantile, float whole,
  double reachMm)
{
  const std::array<int, 3> size = SizeOf(*region.Blocks);
  std::array<int, 3> edge;
  std::array<int, 3> cubes;
  for (std::size_t a = 0; a < 3; ++a)
  {
    edge[a] = std::max(1,
      static_cast<int>(
        std::lround(CoarseMm / region.Blocks->GetSpacing()[static_cast<unsigned>(a)])));
    cubes[a] = (size[a] - 1) / edge[a] + 1;
  }
  const auto cubeOf = [&](std::size_t block)
  {
    const int x = static_cast<int>(block % static_cast<std::size_t>(size[0]));
    const int y = static_cast<int>(
      block / static_cast<std::size_t>(size[0]) % static_cast<std::size_t>(size[1]));
    const int z = static_cast<int>(
      block / static_cast<std::size_t>(size[0]) / static_cast<std::size_t>(size[1]));
    return (static_cast<std::size_t>(z / edge[2]) * cubes[1] + y / edge[1]) * cubes[0] +
      x / edge[0];
  };
  std::vector<std::vector<float>> values(static_cast<std::size_t>(cubes[0]) * cubes[1] * cubes[2]);
  for (std::size_t n = 0; n < region.Logs.size(); ++n)
  {
    values[cubeOf(region.BlockOf[n])].push_back(region.Logs[n]);
  }
  std::vector<float> levels(values.size(), 0.0f);
  std::vector<float> counts(values.size(), 0.0f);
  for (std::size_t cube = 0; cube < values.size(); ++cube)
  {
    if (values[cube].size() >= EnoughVoxels)
    {
      levels[cube] = static_cast<float>(Quantile(values[cube], quantile));
      counts[cube] = static_cast<float>(values[cube].size());
    }
  }
  return WeightedMean(MakeFrom<FloatImage>(*region.Blocks,
                        [&](std::size_t block)
                        { return counts[cubeOf(block)] * levels[cubeOf(block)]; }),
    MakeFrom<FloatImage>(*region.Blocks, [&](std::size_t block) { return counts[cubeOf(block)]; }),
    reachMm, whole);
}
}

FloatImage::Pointer FindFatLevel(const FloatImage* image, const MaskImage* mask, bool fatBright,
  bool even, double gland)
{
  const Region region(image, mask);
  if (region.Logs.size() < EnoughVoxels)
  {
    return nullptr;
  }
  const double logGland = gland > 0 ? std::log(gland) : 0.0;
  const double quantile = fatBright ? 0.9 : 0.25;
  const float whole = Quantile(region.Logs, quantile);
  FloatImage::Pointer level =
    BeginWithQuantiles(region, quantile, whole, gland > 0 ? WideMm : CoarseMm);
  if (even)
  {
    level->FillBuffer(whole);
  }
  for (int round = 0; round < Rounds; ++round)
  {
    const bool early = round < Rounds / 2;
    const double tolerance = (fatBright ? BrightTolerance : DarkTolerance)[early ? 0 : 1];
    auto sums = MakeLike<FloatImage>(*level, 0.0f);
    auto weights = MakeLike<FloatImage>(*level, 0.0f);
    double sum = 0;
    double total = 0;
    for (std::size_t n = 0; n < region.Logs.size(); ++n)
    {
      const std::size_t block = region.BlockOf[n];
      const double residual = region.Logs[n] - level->GetBufferPointer()[block];
      // On the side of fat where gland cannot be, there is only noise.
      const bool beyond = fatBright ? residual > 0 : residual < 0;
      const double away = (beyond ? 0.5 : 1.0) * residual / tolerance;
      double fat = std::exp(-away * away);
      double other = 0;
      if (gland > 0)
      {
        const double awayFromGland = (residual - logGland) / GlandTolerance;
        other = std::exp(-awayFromGland * awayFromGland);
        // Each voxel is one of them.
        const double both = std::max(1.0, fat + other);
        fat /= both;
        other /= both;
      }
      const double value = fat * region.Logs[n] + other * (region.Logs[n] - logGland);
      sums->GetBufferPointer()[block] += static_cast<float>(value);
      weights->GetBufferPointer()[block] += static_cast<float>(fat + other);
      sum += value;
      total += fat + other;
    }
    if (even)
    {
      level->FillBuffer(static_cast<float>(sum / total));
      continue;
    }
    level = WeightedMean(sums, weights, early ? EarlyReachMm : LateReachMm, whole);
  }
  for (std::size_t n = 0; n < CountOf(*level); ++n)
  {
    level->GetBufferPointer()[n] = std::exp(level->GetBufferPointer()[n]);
  }
  return ResampleLike(level, *image);
}

FloatImage::Pointer Divide(const FloatImage* image, const FloatImage* level)
{
  return MakeFrom<FloatImage>(*image,
    [&](std::size_t voxel)
    {
      return image->GetBufferPointer()[voxel] /
        std::max(std::numeric_limits<float>::min(), level->GetBufferPointer()[voxel]);
    });
}

FloatImage::Pointer Fatness(const FloatImage* image, const MaskImage* tissue, double muscleLevel,
  bool fatBright)
{
  // Keep the level away from fat, so that noise does not decide.
  const double muscle =
    fatBright ? std::min(muscleLevel, BrightestMuscle) : std::max(muscleLevel, DarkestMuscle);
  const FloatImage::Pointer fatness = MakeFrom<FloatImage>(*image,
    [&](std::size_t voxel)
    {
      const double share = (image->GetBufferPointer()[voxel] - muscle) / (1 - muscle);
      return tissue->GetBufferPointer()[voxel] ? std::clamp(share, 0.0, 1.0) : 0.0;
    });
  return GaussianMean<FloatImage>(fatness, 1.0);
}
}
