// SPDX-License-Identifier: Apache-2.0
#include "Private/ExposureViews.h"

#include "Private/SampleGrid.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/Raster.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace mammoray
{
namespace
{
/// Taps farther from the middle are below single precision.
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
        result[n] = kernel[0] * padded[n + middle];
      }
      // Tap by tap, so that processors add several pixels at once.
      for (std::size_t tap = 1; tap < kernel.size(); ++tap)
      {
        const double* const before = padded.data() + middle - tap * lanes;
        const double* const after = padded.data() + middle + tap * lanes;
        for (std::size_t n = 0; n < result.size(); ++n)
        {
          result[n] += kernel[tap] * (before[n] + after[n]);
        }
      }
      return true;
    });
}

/**
 * The middle and one side of a convolution kernel along a line of pixels, with the detector's
 * modulation transfer function up to the Nyquist frequency. The sum of the whole kernel is 1.
 */
std::vector<double> BlurKernel(const ExposureOptions& options, double pixelMm)
{
  std::vector<double> kernel;
  std::vector<double> transfer;
  for (int n = 0; n < Frequencies; ++n)
  {
    const double cycles = 0.5 * (n + 0.5) / Frequencies; // per pixel
    const double relative = cycles / (options.HalfModulationPerMm * pixelMm);
    transfer.push_back(options.Spread.DistancesMm.empty()
        ? std::exp(-std::numbers::ln2 * relative * relative)
        : options.Spread.Transfer(cycles / pixelMm));
  }
  for (int tap = 0; tap < MostTaps; ++tap)
  {
    // The mean over frequencies of the transfer's Fourier series.
    double sum = 0;
    for (int n = 0; n < Frequencies; ++n)
    {
      const double cycles = 0.5 * (n + 0.5) / Frequencies; // per pixel
      sum += transfer[static_cast<std::size_t>(n)] * std::cos(2 * std::numbers::pi * cycles * tap);
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

/// The transpose of BlurAlong for one line of values that lie `step` apart.
void TransposeLine(double* line, std::size_t count, std::size_t step,
  const std::vector<double>& kernel, std::vector<double>& sums)
{
  const auto last = static_cast<std::ptrdiff_t>(count) - 1;
  const auto reach = static_cast<std::ptrdiff_t>(kernel.size()) - 1;
  sums.assign(count, 0.0);
  for (std::ptrdiff_t n = 0; n <= last; ++n)
  {
    const double value = line[static_cast<std::size_t>(n) * step];
    for (std::ptrdiff_t tap = -reach; tap <= reach; ++tap)
    {
      sums[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(n + tap, 0, last))] +=
        kernel[static_cast<std::size_t>(std::abs(tap))] * value;
    }
  }
  for (std::size_t n = 0; n < count; ++n)
  {
    line[n * step] = sums[n];
  }
}
}

std::vector<ExposureView> ViewsOf(const XRaySource& source, const XRayDetector& detector,
  const ExposureOptions& options)
{
  RequireBetween("exposure", "samples", detector.Samples, 1, 16);
  const bool isPoint = options.FocalSpotColumnMm == 0 && options.FocalSpotRowMm == 0;
  if (!isPoint && source.Type == XRaySource::Kind::Parallel)
  {
    throw InputError("exposure: expected a point source for a focal spot, found a parallel beam");
  }
  const Vector3 u = (1 / Norm(detector.ColumnStep)) * detector.ColumnStep;
  const Vector3 v = (1 / Norm(detector.RowStep)) * detector.RowStep;
  const int spotColumns = options.FocalSpotColumnMm > 0 ? options.FocalSpotSamples : 1;
  const int spotRows = options.FocalSpotRowMm > 0 ? options.FocalSpotSamples : 1;
  std::vector<ExposureView> views;
  for (const double spotRow : GridOffsets(spotRows, options.FocalSpotRowMm))
  {
    for (const double spotColumn : GridOffsets(spotColumns, options.FocalSpotColumnMm))
    {
      for (const auto& [column, row] : SampleOffsets(detector.Samples))
      {
        ExposureView view{ source, detector, spotColumn, spotRow, column, row };
        if (!isPoint)
        {
          view.Source.Position = source.Position + spotColumn * u + spotRow * v;
        }
        view.Detector.Samples = 1;
        view.Detector.Origin =
          detector.Origin + column * detector.ColumnStep + row * detector.RowStep;
        views.push_back(view);
      }
    }
  }
  return views;
}

void BlurImage(const XRayDetector& detector, const ExposureOptions& options,
  std::vector<double>& image)
{
  const RasterShape shape(detector.Columns, detector.Rows);
  BlurAlong(shape, 0, BlurKernel(options, Norm(detector.ColumnStep)), image);
  BlurAlong(shape, 1, BlurKernel(options, Norm(detector.RowStep)), image);
}

void TransposeBlur(const XRayDetector& detector, const ExposureOptions& options,
  std::vector<double>& image)
{
  const auto columns = static_cast<std::size_t>(detector.Columns);
  const auto rows = static_cast<std::size_t>(detector.Rows);
  std::vector<double> sums;
  const std::vector<double> alongColumns = BlurKernel(options, Norm(detector.RowStep));
  for (std::size_t column = 0; column < columns; ++column)
  {
    TransposeLine(&image[column], rows, columns, alongColumns, sums);
  }
  const std::vector<double> alongRows = BlurKernel(options, Norm(detector.ColumnStep));
  for (std::size_t row = 0; row < rows; ++row)
  {
    TransposeLine(&image[row * columns], columns, 1, alongRows, sums);
  }
}
}
