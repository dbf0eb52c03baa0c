// SPDX-License-Identifier: Apache-2.0
#include "SimulatedMammogram.h"

#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkImageGaussianSmooth.h"
#include "vtkNew.h"
#include "vtkPointData.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace mammoray
{
namespace
{
constexpr double LargestStored = 4095;

std::vector<float> Intensities(const std::vector<float>& logAttenuation)
{
  std::vector<float> intensities(logAttenuation.size());
  std::transform(logAttenuation.begin(), logAttenuation.end(), intensities.begin(),
    [](float attenuation) { return std::exp(-attenuation); });
  return intensities;
}

std::vector<float> LogAttenuationOf(const std::vector<float>& intensities)
{
  std::vector<float> logarithms(intensities.size());
  std::transform(intensities.begin(), intensities.end(), logarithms.begin(),
    [](float intensity) { return -std::log(std::max(intensity, 1e-6F)); });
  return logarithms;
}

/// Blurs with a Gaussian.
std::vector<float> Spread(std::vector<float> values, const ReceptorGrid& grid, double sigmaMm)
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(grid.Columns, grid.Rows, 1);
  vtkNew<vtkFloatArray> array;
  array->SetArray(values.data(), static_cast<vtkIdType>(values.size()), 1);
  image->GetPointData()->SetScalars(array);
  const double pixels = sigmaMm / grid.ColumnSpacingMm();
  vtkNew<vtkImageGaussianSmooth> spread;
  spread->SetInputData(image);
  spread->SetDimensionality(2);
  spread->SetStandardDeviations(pixels, pixels, 0);
  spread->SetRadiusFactors(3, 3, 0);
  spread->Update();
  auto* found = vtkFloatArray::SafeDownCast(spread->GetOutput()->GetPointData()->GetScalars());
  const float* begin = found->GetPointer(0);
  return { begin, begin + found->GetNumberOfValues() };
}

/// PictureKind::Scattered.
std::vector<float> WithHeelAndScatter(const std::vector<float>& primary,
  const std::vector<float>& logAttenuation, const ReceptorGrid& grid)
{
  constexpr double HeelAtFront = 0.2;
  constexpr double ScatterToPrimary = 0.5;
  constexpr double ScatterMm = 15;
  std::vector<float> heeled = primary;
  const double inward = std::copysign(1.0, grid.ColumnStep[1]);
  for (std::size_t pixel = 0; pixel < heeled.size(); ++pixel)
  {
    const auto column = static_cast<int>(pixel % static_cast<std::size_t>(grid.Columns));
    const int depth = inward > 0 ? column : grid.Columns - 1 - column;
    heeled[pixel] *= static_cast<float>(1 - HeelAtFront * depth / grid.Columns);
  }
  std::vector<float> behind = heeled;
  for (std::size_t pixel = 0; pixel < behind.size(); ++pixel)
  {
    behind[pixel] = logAttenuation[pixel] > 0 ? behind[pixel] : 0.0F;
  }
  const std::vector<float> scatter = Spread(behind, grid, ScatterMm);
  for (std::size_t pixel = 0; pixel < heeled.size(); ++pixel)
  {
    heeled[pixel] += static_cast<float>(ScatterToPrimary) * scatter[pixel];
  }
  return heeled;
}

/// PictureKind::Equalised: subtracts most of the slow variation within the breast, which is where
/// `logAttenuation` is positive, from `values`.
void Equalise(const std::vector<float>& logAttenuation, const ReceptorGrid& grid,
  std::vector<float>& values)
{
  constexpr float TakenOff = 0.7F;
  constexpr double SlowMm = 12;
  std::vector<float> share(values.size());
  std::vector<float> inside(values.size());
  double sum = 0;
  double count = 0;
  for (std::size_t pixel = 0; pixel < values.size(); ++pixel)
  {
    share[pixel] = logAttenuation[pixel] > 0 ? 1.0F : 0.0F;
    inside[pixel] = share[pixel] * values[pixel];
    sum += inside[pixel];
    count += share[pixel];
  }
  const std::vector<float> shares = Spread(share, grid, SlowMm);
  const std::vector<float> means = Spread(inside, grid, SlowMm);
  const auto level = static_cast<float>(sum / std::max(count, 1.0));
  for (std::size_t pixel = 0; pixel < values.size(); ++pixel)
  {
    if (share[pixel] > 0)
    {
      values[pixel] -= TakenOff * (means[pixel] / shares[pixel] - level);
    }
  }
}

/// Intensities as whole numbers; air, 1, lies well below the largest.
std::vector<float> Stored(const std::vector<float>& intensities)
{
  constexpr double Air = 0.85 * LargestStored;
  std::vector<float> stored(intensities.size());
  std::transform(intensities.begin(), intensities.end(), stored.begin(),
    [](float intensity)
    { return static_cast<float>(std::clamp(std::round(Air * intensity), 0.0, LargestStored)); });
  return stored;
}

/// Maps `attenuation` by a sigmoid whose window covers the breast, which is where `logAttenuation`
/// is positive. `clean`: the same values without noise.
std::vector<float> Displayed(const std::vector<float>& attenuation, const std::vector<float>& clean,
  const std::vector<float>& logAttenuation)
{
  double sum = 0;
  double squares = 0;
  double count = 0;
  for (std::size_t pixel = 0; pixel < clean.size(); ++pixel)
  {
    if (logAttenuation[pixel] > 0)
    {
      sum += clean[pixel];
      squares += clean[pixel] * clean[pixel];
      count += 1;
    }
  }
  const double centre = sum / count;
  const double deviation = std::sqrt(std::max(squares / count - centre * centre, 1e-12));
  const double width = 8 * deviation;
  std::vector<float> shown(attenuation.size());
  std::transform(attenuation.begin(), attenuation.end(), shown.begin(),
    [&](float value)
    {
      return static_cast<float>(
        std::round(LargestStored / (1 + std::exp(-4 * (value - centre) / width))));
    });
  return shown;
}
}

const char* NameOf(PictureKind kind)
{
  constexpr const char* Names[]{ "display", "equalised", "raw", "scattered" };
  return Names[static_cast<std::size_t>(kind)];
}

ReceptorGrid SimulatedDetector(double pixelMm, double up, const DetectorField& field)
{
  // The left breast's, whose up is +x, has its chest wall at the left.
  const double inward = up;
  ReceptorGrid grid;
  grid.Columns = static_cast<int>(field.DepthMm / pixelMm);
  grid.Rows = static_cast<int>(field.WidthMm / pixelMm);
  grid.Origin = { up * 0.5 * (grid.Rows - 1) * pixelMm,
    (inward > 0 ? 0.5 : grid.Columns - 0.5) * pixelMm };
  grid.ColumnStep = { 0, inward * pixelMm };
  grid.RowStep = { -up * pixelMm, 0 };
  return grid;
}

bool IsCutAtFront(const std::vector<float>& logAttenuation, const ReceptorGrid& grid)
{
  const auto columns = static_cast<std::size_t>(grid.Columns);
  const std::size_t front = grid.ColumnStep[1] > 0 ? columns - 1 : 0;
  for (std::size_t pixel = front; pixel < logAttenuation.size(); pixel += columns)
  {
    if (logAttenuation[pixel] > 0)
    {
      return true;
    }
  }
  return false;
}

Mammogram Develop(Mammogram header, const std::vector<float>& logAttenuation,
  const ReceptorGrid& grid, const DevelopOptions& options, Draws& draws)
{
  const std::vector<float> primary = Intensities(logAttenuation);
  const std::vector<float> reaching = options.Kind == PictureKind::Scattered
    ? WithHeelAndScatter(primary, logAttenuation, grid)
    : primary;
  std::normal_distribution<double> normal(0, options.Noise);
  std::vector<float> seen;
  seen.reserve(reaching.size());
  for (const float intensity : reaching)
  {
    seen.push_back(static_cast<float>(intensity * (1 + normal(draws.Bits()))));
  }
  header.Columns = grid.Columns;
  header.Rows = grid.Rows;
  header.BitsStored = 12;
  header.ColumnSpacingMm = grid.ColumnSpacingMm();
  header.RowSpacingMm = header.ColumnSpacingMm;
  if (options.Kind == PictureKind::Raw || options.Kind == PictureKind::Scattered)
  {
    header.PresentationIntent = Mammogram::Intent::ForProcessing;
    header.IntensityRelationship = Mammogram::Relationship::Linear;
    header.IntensitySign = 1;
    header.Pixels = Stored(seen);
    return header;
  }
  header.IntensitySign = -1;
  std::vector<float> attenuation = LogAttenuationOf(seen);
  std::vector<float> clean = logAttenuation;
  if (options.Kind == PictureKind::Equalised)
  {
    Equalise(logAttenuation, grid, attenuation);
    Equalise(logAttenuation, grid, clean);
  }
  header.Pixels = Displayed(attenuation, clean, logAttenuation);
  return header;
}
}
