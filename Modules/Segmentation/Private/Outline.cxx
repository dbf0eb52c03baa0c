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
/// The level of tissue is the mean over this reach, on voxels of this size; neighbours of a voxel
/// are those within this distance; mm.
constexpr double LevelBlockMm = 4.0;
constexpr double LevelReachMm = 20.0;
constexpr double NeighbourMm = 3.0;
/// Deviations of the logarithm within air, after smoothing, and within tissue.
constexpr double AirDeviation = 0.22;
constexpr double TissueDeviation = 0.5;
/// Weight of the neighbours (Potts), largest evidence of one voxel, and iterations.
constexpr double NeighbourWeight = 4.0;
constexpr double LargestEvidence = 6.0;
constexpr int OutlineRounds = 9;
constexpr int RoundsOfLevel = 3;
/// Three quarters of the front of the body, mm, must be this many times as bright as noise in a
/// plane.
constexpr double FrontLayerMm = 30.0;
constexpr double SmallestClarity = 2.0;

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

/// Gaussian sums of values over the voxels that count, and of these voxels.
class MeanOver
{
public:
  template <typename Counts, typename ValueAt>
  MeanOver(const FloatImage& grid, double reachMm, const Counts& counts, const ValueAt& valueAt)
    : Sums(GaussianMean<FloatImage>(
        MakeFrom<FloatImage>(grid, [&](std::size_t n) { return counts(n) ? valueAt(n) : 0.0f; }),
        reachMm))
    , Weights(GaussianMean<FloatImage>(
        MakeFrom<FloatImage>(grid, [&](std::size_t n) { return counts(n) ? 1.0f : 0.0f; }),
        reachMm))
  {
  }
  float Sum(std::size_t n) const { return this->Sums->GetBufferPointer()[n]; }
  float Weight(std::size_t n) const { return this->Weights->GetBufferPointer()[n]; }

private:
  FloatImage::Pointer Sums;
  FloatImage::Pointer Weights;
};

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
  const auto isNoise = [&](std::size_t n)
  {
    const float value = mean->GetBufferPointer()[n];
    return ratios[n] > LowestRatio * air && ratios[n] < HighestRatio * air &&
      value < 2.5 * threshold && value > 0.02 * threshold;
  };
  const MeanOver noise(*mean, NoiseReachMm, isNoise,
    [&](std::size_t n) { return mean->GetBufferPointer()[n]; });
  // Less than 1 % of a full weight is rounding error.
  return MakeFrom<FloatImage>(*mean,
    [&](std::size_t n) { return std::max(0.0f, noise.Sum(n)) / std::max(0.01f, noise.Weight(n)); });
}

MaskImage::Pointer Below(const FloatImage* image, const FloatImage* threshold)
{
  return MakeFrom<MaskImage>(*image,
    [&](std::size_t voxel)
    { return image->GetBufferPointer()[voxel] < threshold->GetBufferPointer()[voxel]; });
}

/// The body without parts connected by a thin bridge.
MaskImage::Pointer WithoutBridges(const MaskImage* body)
{
  const double voxelMm = body->GetSpacing()[0];
  const MaskImage::Pointer core = LargestComponent(Open(body, BridgeMm));
  const MaskImage::Pointer near = Dilate(core, BridgeMm + voxelMm);
  bool any = false;
  const MaskImage::Pointer kept = MakeFrom<MaskImage>(*body,
    [&](std::size_t voxel)
    {
      const bool in = body->GetBufferPointer()[voxel] && near->GetBufferPointer()[voxel];
      any = any || in;
      return in;
    });
  return LargestComponent(any ? kept.GetPointer() : body);
}

/// The body as a Markov random field of two labels, by the mean-field approximation.
class BodyField
{
public:
  /// Smoothed noise ends at the threshold.
  BodyField(const FloatImage* smooth, const FloatImage* threshold)
    : Values(LogOf(smooth, 1))
    , Air(LogOf(threshold, NoiseTop))
  {
  }

  MaskImage::Pointer Find(const MaskImage* first)
  {
    FloatImage::Pointer inside = ToFloat(first);
    for (int round = 0; round < OutlineRounds; ++round)
    {
      if (round % RoundsOfLevel == 0)
      {
        this->FindLevel(Inside(inside));
      }
      const FloatImage::Pointer near = GaussianMean<FloatImage>(inside, NeighbourMm);
      for (std::size_t n = 0; n < CountOf(*inside); ++n)
      {
        const double prior = NeighbourWeight * (2 * near->GetBufferPointer()[n] - 1);
        inside->GetBufferPointer()[n] =
          static_cast<float>(1 / (1 + std::exp(-(this->Evidence(n) + prior))));
      }
    }
    return Inside(inside);
  }

  /// The level of tissue as a multiple of the noise, at least 1.
  FloatImage::Pointer Clarity() const
  {
    return MakeFrom<FloatImage>(*this->Level,
      [&](std::size_t n) { return std::exp(this->TissueAt(n) - this->AirAt(n)); });
  }

private:
  static FloatImage::Pointer LogOf(const FloatImage* image, double unit)
  {
    return MakeFrom<FloatImage>(*image,
      [&](std::size_t n) { return std::log(std::max(image->GetBufferPointer()[n] / unit, 1e-6)); });
  }
  static MaskImage::Pointer Inside(const FloatImage* inside)
  {
    return MakeFrom<MaskImage>(*inside,
      [&](std::size_t n) { return inside->GetBufferPointer()[n] > 0.5f; });
  }

  /// The mean logarithm of the body nearby.
  void FindLevel(const MaskImage* body)
  {
    const FloatImage::Pointer coarse = Shrink(this->Values, LevelBlockMm);
    const FloatImage::Pointer in = Shrink(ToFloat(body), LevelBlockMm);
    const MeanOver level(
      *coarse, LevelReachMm, [&](std::size_t n) { return in->GetBufferPointer()[n] > 0.9f; },
      [&](std::size_t n) { return coarse->GetBufferPointer()[n]; });
    this->Level = ResampleLike(MakeFrom<FloatImage>(*coarse,
                                 [&](std::size_t n)
                                 {
                                   return level.Weight(n) > 1e-3f ? level.Sum(n) / level.Weight(n)
                                                                  : coarse->GetBufferPointer()[n];
                                 }),
      *this->Values);
  }

  double AirAt(std::size_t n) const { return this->Air->GetBufferPointer()[n]; }
  double TissueAt(std::size_t n) const
  {
    return std::max<double>(this->Level->GetBufferPointer()[n], this->AirAt(n));
  }

  /// Logarithm of the ratio of a value's probabilities in tissue and in air.
  double Evidence(std::size_t n) const
  {
    const double value = this->Values->GetBufferPointer()[n];
    const double above = std::max(0.0, value - this->AirAt(n)) / AirDeviation;
    const double below = std::min(0.0, value - this->TissueAt(n)) / TissueDeviation;
    return std::clamp(0.5 * (above * above - below * below) +
        std::log(AirDeviation / TissueDeviation),
      -LargestEvidence, LargestEvidence);
  }

  FloatImage::Pointer Values;
  FloatImage::Pointer Air;
  FloatImage::Pointer Level;
};

/// The range of axial planes in which the front of the body stands out from the noise.
std::array<int, 2> ClearPlanes(const MaskImage* body, const FloatImage* clarity)
{
  const std::array<int, 3> size = SizeOf(*body);
  const int depth = static_cast<int>(FrontLayerMm / body->GetSpacing()[1]);
  const auto isClear = [&](int z)
  {
    std::vector<float> values;
    for (int x = 0; x < size[0]; ++x)
    {
      int in = 0;
      for (int y = size[1] - 1; y >= 0 && in < depth; --y)
      {
        if (body->GetPixel({ { x, y, z } }))
        {
          ++in;
          values.push_back(clarity->GetPixel({ { x, y, z } }));
        }
      }
    }
    return !values.empty() && Quantile(values, 0.25) >= SmallestClarity;
  };
  std::array<int, 2> planes{ 0, size[2] - 1 };
  while (planes[0] < size[2] / 3 && !isClear(planes[0]))
  {
    ++planes[0];
  }
  while (planes[1] > 2 * size[2] / 3 && !isClear(planes[1]))
  {
    --planes[1];
  }
  return planes;
}

/// Repeats the outermost of these planes in the planes beyond.
void ContinueBeyond(MaskImage* body, const std::array<int, 2>& planes)
{
  const std::array<int, 3> size = SizeOf(*body);
  const std::size_t plane = static_cast<std::size_t>(size[0]) * size[1];
  unsigned char* voxels = body->GetBufferPointer();
  for (int z = 0; z < size[2]; ++z)
  {
    const int from = std::clamp(z, planes[0], planes[1]);
    std::copy_n(voxels + plane * static_cast<std::size_t>(from), plane,
      voxels + plane * static_cast<std::size_t>(z));
  }
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
  BodyField field(smooth, outline.Threshold);
  const MaskImage::Pointer air =
    ReachedFromFront(Complement(field.Find(Complement(ReachedFromFront(dark)))));
  outline.Clarity = field.Clarity();
  outline.Body = WithoutBridges(Complement(air));
  outline.Planes = ClearPlanes(outline.Body, outline.Clarity);
  ContinueBeyond(outline.Body, outline.Planes);
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
  const auto inRim = [&](std::size_t voxel)
  { return outline.Body->GetBufferPointer()[voxel] && !core->GetBufferPointer()[voxel]; };
  const MeanOver rim(*work, reachMm, inRim,
    [&](std::size_t voxel) { return work->GetBufferPointer()[voxel]; });
  return MakeFrom<FloatImage>(*work,
    [&](std::size_t voxel)
    {
      const float mean = rim.Weight(voxel) > 1e-3f ? rim.Sum(voxel) / rim.Weight(voxel) : 0.0f;
      return std::max(outline.Threshold->GetBufferPointer()[voxel], half * mean);
    });
}
}
