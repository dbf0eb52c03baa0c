// SPDX-License-Identifier: Apache-2.0
#include "Private/DetectorBlur.h"

#include "mammoray/Foundation/ParallelFor.h"

#include <algorithm>
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

void BlurLine(const std::vector<double>& kernel, std::vector<double>& line,
  std::vector<double>& scratch)
{
  const auto last = static_cast<std::ptrdiff_t>(line.size()) - 1;
  const auto taps = static_cast<std::ptrdiff_t>(kernel.size());
  scratch.resize(line.size());
  for (std::ptrdiff_t place = 0; place <= last; ++place)
  {
    double sum = kernel[0] * line[static_cast<std::size_t>(place)];
    for (std::ptrdiff_t tap = 1; tap < taps; ++tap)
    {
      sum += kernel[static_cast<std::size_t>(tap)] *
        (line[static_cast<std::size_t>(std::max<std::ptrdiff_t>(place - tap, 0))] +
          line[static_cast<std::size_t>(std::min(place + tap, last))]);
    }
    scratch[static_cast<std::size_t>(place)] = sum;
  }
  line.swap(scratch);
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
  const auto width = static_cast<std::size_t>(columns);
  const auto height = static_cast<std::size_t>(rows);
  ParallelRanges(height, 16,
    [&](std::size_t begin, std::size_t end)
    {
      std::vector<double> line(width);
      std::vector<double> scratch;
      for (std::size_t row = begin; row < end; ++row)
      {
        std::copy_n(&image[row * width], width, line.begin());
        BlurLine(alongRows, line, scratch);
        std::copy(line.begin(), line.end(), &image[row * width]);
      }
    });
  ParallelRanges(width, 16,
    [&](std::size_t begin, std::size_t end)
    {
      std::vector<double> line(height);
      std::vector<double> scratch;
      for (std::size_t column = begin; column < end; ++column)
      {
        for (std::size_t row = 0; row < height; ++row)
        {
          line[row] = image[row * width + column];
        }
        BlurLine(alongColumns, line, scratch);
        for (std::size_t row = 0; row < height; ++row)
        {
          image[row * width + column] = line[row];
        }
      }
    });
}
}
