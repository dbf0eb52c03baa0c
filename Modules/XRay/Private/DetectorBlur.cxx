// SPDX-License-Identifier: Apache-2.0
#include "Private/DetectorBlur.h"

#include "mammoray/Foundation/Raster.h"

#include <cmath>
#include <numbers>

namespace mammoray
{
namespace
{
/// Farther away the kernels of a detector are below single precision.
constexpr int MostTaps = 64;
constexpr double SmallestTap = 1e-7;
constexpr int Frequencies = 2000;

/// Convolves all lines along an axis with a symmetric kernel, given from its middle on.
void BlurAlong(const RasterShape& shape, int axis, const std::vector<double>& kernel,
  std::vector<double>& image)
{
  FilterLines(shape, axis, static_cast<int>(kernel.size()) - 1, image,
    [&](const std::vector<double>& padded, std::size_t lanes, std::vector<double>& result)
    {
      const std::size_t middle = (kernel.size() - 1) * lanes;
      for (std::size_t n = 0; n < result.size(); ++n)
      {
        double sum = kernel[0] * padded[n + middle];
        for (std::size_t tap = 1; tap < kernel.size(); ++tap)
        {
          sum +=
            kernel[tap] * (padded[n + middle - tap * lanes] + padded[n + middle + tap * lanes]);
        }
        result[n] = sum;
      }
      return true;
    });
}
}

std::vector<double> BlurKernel(double half, double pixelMm)
{
  std::vector<double> kernel;
  for (int tap = 0; tap < MostTaps; ++tap)
  {
    // The mean over frequencies of the transfer's Fourier series.
    double sum = 0;
    for (int n = 0; n < Frequencies; ++n)
    {
      const double cycles = 0.5 * (n + 0.5) / Frequencies; // per pixel
      const double relative = cycles / (half * pixelMm);
      sum += std::exp(-std::numbers::ln2 * relative * relative) *
        std::cos(2 * std::numbers::pi * cycles * tap);
    }
    kernel.push_back(sum / Frequencies);
  }
  while (kernel.size() > 1 && std::abs(kernel.back()) < SmallestTap)
  {
    kernel.pop_back();
  }
  double whole = kernel[0];
  for (std::size_t tap = 1; tap < kernel.size(); ++tap)
  {
    whole += 2 * kernel[tap];
  }
  for (double& value : kernel)
  {
    value /= whole;
  }
  return kernel;
}

void Blur(std::vector<double>& image, int columns, int rows, const std::vector<double>& alongRows,
  const std::vector<double>& alongColumns)
{
  const RasterShape shape(columns, rows);
  BlurAlong(shape, 0, alongRows, image);
  BlurAlong(shape, 1, alongColumns, image);
}
}
