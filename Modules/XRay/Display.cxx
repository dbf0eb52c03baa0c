// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Display.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/ParallelFor.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
/// Running means of 2 half + 1 values; beyond its ends a line is 0.
void RunningMean(std::vector<float>& line, std::size_t half, std::vector<double>& sums)
{
  sums.assign(line.size() + 1, 0);
  for (std::size_t place = 0; place < line.size(); ++place)
  {
    sums[place + 1] = sums[place] + line[place];
  }
  for (std::size_t place = 0; place < line.size(); ++place)
  {
    const std::size_t begin = place > half ? place - half : 0;
    const std::size_t end = std::min(place + half + 1, line.size());
    line[place] = static_cast<float>((sums[end] - sums[begin]) / static_cast<double>(2 * half + 1));
  }
}

/// Nearly a Gaussian: three running means along rows and columns (Wells, IEEE PAMI 8, 1986).
void Smooth(std::vector<float>& values, const XRayDetector& detector, double sigmaMm)
{
  const auto columns = static_cast<std::size_t>(detector.Columns);
  const auto rows = static_cast<std::size_t>(detector.Rows);
  const auto along = [&](std::size_t lines, std::size_t length, std::size_t lineStep,
                       std::size_t step, double pixelMm)
  {
    // Three boxes of 2 h + 1 have the variance h (h + 1).
    const double variance = std::pow(sigmaMm / pixelMm, 2);
    const auto half =
      static_cast<std::size_t>(std::lround(0.5 * (std::sqrt(1 + 4 * variance) - 1)));
    ParallelRanges(lines, 16,
      [&](std::size_t begin, std::size_t end)
      {
        std::vector<float> line(length);
        std::vector<double> sums;
        for (std::size_t number = begin; number < end; ++number)
        {
          for (std::size_t place = 0; place < length; ++place)
          {
            line[place] = values[number * lineStep + place * step];
          }
          for (int pass = 0; pass < 3; ++pass)
          {
            RunningMean(line, half, sums);
          }
          for (std::size_t place = 0; place < length; ++place)
          {
            values[number * lineStep + place * step] = line[place];
          }
        }
      });
  };
  along(rows, columns, columns, 1, Norm(detector.ColumnStep));
  along(columns, rows, 1, columns, Norm(detector.RowStep));
}

/// Means of the values of the breast around each of its pixels.
std::vector<float> MeanInside(const std::vector<float>& values, const std::vector<float>& inside,
  const XRayDetector& detector, double sigmaMm)
{
  std::vector<float> means(values.size());
  std::transform(values.begin(), values.end(), inside.begin(), means.begin(), std::multiplies<>());
  std::vector<float> shares = inside;
  Smooth(means, detector, sigmaMm);
  Smooth(shares, detector, sigmaMm);
  for (std::size_t pixel = 0; pixel < means.size(); ++pixel)
  {
    means[pixel] = inside[pixel] > 0 ? means[pixel] / shares[pixel] : values[pixel];
  }
  return means;
}

/// The value that this share of the breast's pixels does not reach.
float Quantile(const std::vector<float>& values, const std::vector<float>& inside, double share)
{
  std::vector<float> breast;
  for (std::size_t pixel = 0; pixel < values.size(); ++pixel)
  {
    if (inside[pixel] > 0)
    {
      breast.push_back(values[pixel]);
    }
  }
  return QuantileElement(std::move(breast), share);
}
}

std::vector<float> DisplayValues(const Exposure& exposure, const XRayDetector& detector,
  const DisplayOptions& options)
{
  RequireBetween("display", "a rim (mm)", options.RimMm, 0.5, 50);
  RequireBetween("display", "a share of the rim", options.RimShare, 0, 1);
  RequireBetween("display", "detail (mm)", options.DetailMm, 0.1, 20);
  RequireBetween("display", "a share of detail", options.DetailShare, 0, 5);
  RequireBetween("display", "a window (deviations)", options.WindowDeviations, 1, 100);
  const std::size_t pixels = exposure.LogAttenuation.size();
  std::vector<float> inside(pixels, 0.0F);
  for (int material = 1; material < exposure.Lengths->Materials; ++material)
  {
    const float* lengths = exposure.Lengths->Material(material);
    for (std::size_t pixel = 0; pixel < pixels; ++pixel)
    {
      inside[pixel] = lengths[pixel] > 0 ? 1.0F : inside[pixel];
    }
  }
  if (std::find(inside.begin(), inside.end(), 1.0F) == inside.end())
  {
    throw InputError("display: expected something in the beam, found air alone");
  }
  std::vector<float> values = exposure.LogAttenuation;
  const std::vector<float> thick = MeanInside(values, inside, detector, options.RimMm);
  const float usual = Quantile(thick, inside, 0.7);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel)
  {
    values[pixel] +=
      inside[pixel] * static_cast<float>(options.RimShare) * std::max(usual - thick[pixel], 0.0F);
  }
  const std::vector<float> around = MeanInside(values, inside, detector, options.DetailMm);
  double sum = 0;
  double squares = 0;
  double count = 0;
  for (std::size_t pixel = 0; pixel < pixels; ++pixel)
  {
    values[pixel] += static_cast<float>(options.DetailShare) * (values[pixel] - around[pixel]);
    sum += inside[pixel] * values[pixel];
    squares += inside[pixel] * values[pixel] * values[pixel];
    count += inside[pixel];
  }
  const double mean = sum / count;
  const double deviation = std::sqrt(std::max(squares / count - mean * mean, 1e-12));
  const double window = options.WindowDeviations * deviation;
  for (float& value : values)
  {
    value = static_cast<float>(1 / (1 + std::exp(-4 * (value - mean) / window)));
  }
  return values;
}
}
