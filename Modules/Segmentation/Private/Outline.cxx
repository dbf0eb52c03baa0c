// SPDX-License-Identifier: Apache-2.0
#include "Private/Outline.h"

#include "Private/Masks.h"
#include "Private/Thresholds.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mammoray
{
namespace
{
/// Size of the blocks in which noise is measured, mm: a hundred voxels of 1.2 mm.
constexpr double NoiseBlockMm = 6.0;
/// Range of influence of measured noise, mm.
constexpr double NoiseReachMm = 16.0;
/// Ratios of mean and deviation, relative to air's, that count as noise.
constexpr double LowestRatio = 0.75;
constexpr double HighestRatio = 1.2;
/// Smoothed noise stays below this multiple of its mean.
constexpr double NoiseTop = 1.8;
/// Parts connected with the body by less than twice this are not body (ghosts, the coil), mm.
constexpr double BridgeMm = 4.0;

/// Half the mean square difference of neighbours along the axes: the variance of noise and
/// structure.
FloatImage::Pointer NeighbourVariance(const FloatImage* image)
{
  auto variance = MakeLike<FloatImage>(*image, 0.0f);
  const std::array<int, 3> size = SizeOf(*image);
  const float* in = image->GetBufferPointer();
  float* out = variance->GetBufferPointer();
  const std::array<std::size_t, 3> stride{ 1, static_cast<std::size_t>(size[0]),
    static_cast<std::size_t>(size[0]) * size[1] };
  std::size_t voxel = 0;
  for (int z = 0; z < size[2]; ++z)
  {
    for (int y = 0; y < size[1]; ++y)
    {
      for (int x = 0; x < size[0]; ++x, ++voxel)
      {
        const std::array<int, 3> at{ x, y, z };
        float sum = 0;
        for (std::size_t a = 0; a < 3; ++a)
        {
          const std::size_t other = at[a] + 1 < size[a] ? voxel + stride[a] : voxel - stride[a];
          sum += (in[other] - in[voxel]) * (in[other] - in[voxel]);
        }
        out[voxel] = sum / 6;
      }
    }
  }
  return variance;
}

/// Mean of the noise near every block; 0 without noise. `threshold` separates air and tissue.
FloatImage::Pointer NoiseLevel(const FloatImage* image, double threshold)
{
  const FloatImage::Pointer mean = Shrink(image, NoiseBlockMm);
  const FloatImage::Pointer variance = Shrink(NeighbourVariance(image), NoiseBlockMm);
  const std::size_t count = CountOf(*mean);
  std::vector<float> ratios(count);
  std::vector<float> ofAir;
  for (std::size_t n = 0; n < count; ++n)
  {
    const double deviation = std::sqrt(variance->GetBufferPointer()[n]);
    const float value = mean->GetBufferPointer()[n];
    ratios[n] = deviation > 0 ? static_cast<float>(value / deviation) : 0.0f;
    // Ignore zeros outside the field of view.
    if (value < threshold && value > 0.02 * threshold && ratios[n] > 0.8f)
    {
      ofAir.push_back(ratios[n]);
    }
  }
  const double air = ofAir.size() > 50 ? Quantile(ofAir, 0.5) : 1.91;
  auto sums = MakeLike<FloatImage>(*mean, 0.0f);
  auto weights = MakeLike<FloatImage>(*mean, 0.0f);
  for (std::size_t n = 0; n < count; ++n)
  {
    const float value = mean->GetBufferPointer()[n];
    const bool noise = ratios[n] > LowestRatio * air && ratios[n] < HighestRatio * air &&
      value < 2.5 * threshold && value > 0.02 * threshold;
    sums->GetBufferPointer()[n] = noise ? value : 0.0f;
    weights->GetBufferPointer()[n] = noise ? 1.0f : 0.0f;
  }
  sums = GaussianMean<FloatImage>(sums, NoiseReachMm);
  weights = GaussianMean<FloatImage>(weights, NoiseReachMm);
  for (std::size_t n = 0; n < count; ++n)
  {
    // Less than 1 % of a full weight is rounding error.
    const float weight = weights->GetBufferPointer()[n];
    sums->GetBufferPointer()[n] =
      std::max(0.0f, sums->GetBufferPointer()[n]) / std::max(0.01f, weight);
  }
  return sums;
}

MaskImage::Pointer Below(const FloatImage* image, const FloatImage* threshold)
{
  auto below = MakeLike<MaskImage>(*image, 0);
  for (std::size_t voxel = 0; voxel < CountOf(*image); ++voxel)
  {
    below->GetBufferPointer()[voxel] =
      image->GetBufferPointer()[voxel] < threshold->GetBufferPointer()[voxel] ? 1 : 0;
  }
  return below;
}

/// The body without parts connected by a thin bridge.
MaskImage::Pointer WithoutBridges(const MaskImage* body)
{
  const double voxelMm = body->GetSpacing()[0];
  const MaskImage::Pointer core = LargestComponent(Open(body, BridgeMm));
  const MaskImage::Pointer near = Dilate(core, BridgeMm + voxelMm);
  auto kept = MakeLike<MaskImage>(*body, 0);
  bool any = false;
  for (std::size_t voxel = 0; voxel < CountOf(*body); ++voxel)
  {
    kept->GetBufferPointer()[voxel] =
      body->GetBufferPointer()[voxel] && near->GetBufferPointer()[voxel] ? 1 : 0;
    any = any || kept->GetBufferPointer()[voxel];
  }
  return any ? LargestComponent(kept) : LargestComponent(body);
}

/// Otsu's threshold of the logarithm.
double LogOtsu(const FloatImage* smooth)
{
  // On a logarithmic scale the decrease of the coil's sensitivity is small compared with the step
  // from air to tissue. Adding 1 % of the maximum keeps zeros and noise in one class.
  const auto* voxels = smooth->GetBufferPointer();
  std::vector<float> values(voxels, voxels + CountOf(*smooth));
  const double floor = 0.01 * Quantile(values, 0.99) + std::numeric_limits<float>::min();
  for (float& value : values)
  {
    // The recursive filter undershoots next to steps.
    value = static_cast<float>(std::log(std::max(value, 0.0f) + floor));
  }
  return std::exp(OtsuThresholds(values, 2).front()) - floor;
}
}

Outline FindOutline(const FloatImage* image, const FloatImage* work, double given)
{
  Outline outline;
  const FloatImage::Pointer smooth = GaussianMean<FloatImage>(work, 1.0);
  outline.AirThreshold = given > 0 ? given : LogOtsu(smooth);
  outline.Threshold = MakeLike<FloatImage>(*work, static_cast<float>(outline.AirThreshold));
  if (given == 0)
  {
    const FloatImage::Pointer noise = ResampleLike(NoiseLevel(image, outline.AirThreshold), *work);
    for (std::size_t voxel = 0; voxel < CountOf(*work); ++voxel)
    {
      float& threshold = outline.Threshold->GetBufferPointer()[voxel];
      threshold =
        std::max(threshold, static_cast<float>(NoiseTop) * noise->GetBufferPointer()[voxel]);
    }
  }
  const MaskImage::Pointer dark = Below(smooth, outline.Threshold);
  outline.Tissue = Complement(dark);
  const MaskImage::Pointer air = ReachedFromFront(dark);
  outline.Body = WithoutBridges(Complement(air));
  std::vector<float> inside = ValuesIn(smooth, outline.Body);
  std::vector<float> outside = ValuesIn(smooth, air);
  if (!inside.empty() && !outside.empty())
  {
    outline.Contrast = Quantile(inside, 0.5) / std::max(1e-30, std::abs(Quantile(outside, 0.5)));
  }
  return outline;
}

FloatImage::Pointer SkinThreshold(const Outline& outline, const FloatImage* work, bool fatBright)
{
  constexpr double rimMm = 4.0;
  constexpr double reachMm = 5.0;
  const float half = fatBright ? 0.25f : 0.55f;
  const MaskImage::Pointer core = Complement(Dilate(Complement(outline.Body), rimMm));
  auto sums = MakeLike<FloatImage>(*work, 0.0f);
  auto weights = MakeLike<FloatImage>(*work, 0.0f);
  for (std::size_t voxel = 0; voxel < CountOf(*work); ++voxel)
  {
    const bool rim = outline.Body->GetBufferPointer()[voxel] && !core->GetBufferPointer()[voxel];
    sums->GetBufferPointer()[voxel] = rim ? work->GetBufferPointer()[voxel] : 0.0f;
    weights->GetBufferPointer()[voxel] = rim ? 1.0f : 0.0f;
  }
  sums = GaussianMean<FloatImage>(sums, reachMm);
  weights = GaussianMean<FloatImage>(weights, reachMm);
  for (std::size_t voxel = 0; voxel < CountOf(*work); ++voxel)
  {
    const float weight = weights->GetBufferPointer()[voxel];
    const float rim = weight > 1e-3f ? sums->GetBufferPointer()[voxel] / weight : 0.0f;
    sums->GetBufferPointer()[voxel] =
      std::max(outline.Threshold->GetBufferPointer()[voxel], half * rim);
  }
  return sums;
}
}
