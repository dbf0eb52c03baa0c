// SPDX-License-Identifier: Apache-2.0
#include "Private/PixelFilters.h"

#include "Private/RobustStatistics.h"

#include "vtkDataArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkImageGaussianSmooth.h"
#include "vtkImageInterpolator.h"
#include "vtkImageMedian3D.h"
#include "vtkImageReslice.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace mammoray
{
namespace
{
/// The image refers to `values`, which must outlive it.
vtkSmartPointer<vtkImageData> Wrap(const PixelGrid& grid, std::vector<float>& values)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(grid.Columns, grid.Rows, 1);
  image->SetSpacing(grid.ColumnSpacing, grid.RowSpacing, 1);
  vtkNew<vtkFloatArray> array;
  array->SetArray(values.data(), static_cast<vtkIdType>(values.size()), 1);
  image->GetPointData()->SetScalars(array);
  return image;
}

std::vector<float> Copy(vtkImageData* image)
{
  vtkDataArray* array = image->GetPointData()->GetScalars();
  const auto* values = static_cast<const float*>(array->GetVoidPointer(0));
  return { values, values + array->GetNumberOfValues() };
}

std::vector<float> GaussianSmooth(const PixelGrid& grid, std::vector<float>& values, double sigmaMm)
{
  vtkNew<vtkImageGaussianSmooth> smooth;
  smooth->SetInputData(Wrap(grid, values));
  smooth->SetDimensionality(2);
  smooth->SetStandardDeviations(sigmaMm / grid.ColumnSpacing, sigmaMm / grid.RowSpacing, 0);
  smooth->SetRadiusFactors(3, 3, 0);
  smooth->Update();
  return Copy(smooth->GetOutput());
}
}

std::vector<float> Median3x3(const PixelGrid& grid, std::vector<float>& values)
{
  vtkNew<vtkImageMedian3D> median;
  median->SetInputData(Wrap(grid, values));
  median->SetKernelSize(3, 3, 1);
  median->Update();
  return Copy(median->GetOutput());
}

std::vector<float> Refine(const PixelGrid& grid, std::vector<float>& values, const PixelGrid& fine,
  int factor)
{
  if (factor == 1)
  {
    return values;
  }
  vtkNew<vtkImageInterpolator> linear;
  linear->SetInterpolationModeToLinear();
  linear->SetBorderModeToClamp();
  // Pixels at the border reach half a pixel beyond their centres.
  linear->SetTolerance(1.0);
  vtkNew<vtkImageReslice> reslice;
  reslice->SetInputData(Wrap(grid, values));
  reslice->SetInterpolator(linear);
  // Which it tells the interpolator otherwise.
  reslice->SetInterpolationModeToLinear();
  reslice->SetOutputSpacing(fine.ColumnSpacing, fine.RowSpacing, 1);
  reslice->SetOutputExtent(0, fine.Columns - 1, 0, fine.Rows - 1, 0, 0);
  const int half = factor / 2;
  reslice->SetOutputOrigin(-half * fine.ColumnSpacing, -half * fine.RowSpacing, 0);
  reslice->Update();
  return Copy(reslice->GetOutput());
}

std::vector<float> Details(const PixelGrid& grid, const std::vector<float>& values,
  const PixelMask& mask, double sigmaMm)
{
  std::vector<float> inside(values.size(), 0.0F);
  std::vector<float> weight(values.size(), 0.0F);
  for (std::size_t pixel = 0; pixel < values.size(); ++pixel)
  {
    inside[pixel] = mask[pixel] != 0 ? values[pixel] : 0.0F;
    weight[pixel] = mask[pixel] != 0 ? 1.0F : 0.0F;
  }
  const std::vector<float> sum = GaussianSmooth(grid, inside, sigmaMm);
  const std::vector<float> share = GaussianSmooth(grid, weight, sigmaMm);
  for (std::size_t pixel = 0; pixel < values.size(); ++pixel)
  {
    // The pixel itself has a share.
    inside[pixel] -= mask[pixel] != 0 ? sum[pixel] / share[pixel] : 0.0F;
  }
  return inside;
}

namespace
{
constexpr int BlockSize = 8;
constexpr double EdgeZoneMm = 5;
/// Fewer blocks tell nothing.
constexpr std::size_t FewestBlocks = 24;

struct Block
{
  float Level = 0;
  float Noise = 0;
};

Block Measure(const PixelGrid& grid, const std::vector<float>& values, int column, int row)
{
  std::vector<float> levels;
  std::vector<float> differences;
  for (int r = row; r < row + BlockSize; ++r)
  {
    for (int c = column; c < column + BlockSize; ++c)
    {
      const float* const at = values.data() + grid.Index(c, r);
      levels.push_back(*at);
      if (c >= 2 && c + 2 < grid.Columns)
      {
        differences.push_back(at[-2] - 4 * at[-1] + 6 * at[0] - 4 * at[1] + at[2]);
      }
    }
  }
  // The root of 1 + 16 + 36 + 16 + 1.
  return { Median(levels), RobustSigma(differences, 0.0F) / std::sqrt(70.0F) };
}

float MedianNoise(const std::vector<Block>& blocks, std::size_t first, std::size_t last)
{
  std::vector<float> noise;
  for (std::size_t index = first; index < last; ++index)
  {
    noise.push_back(blocks[index].Noise);
  }
  return Median(noise);
}
}

NoiseTrend FindNoiseTrend(const PixelGrid& grid, const std::vector<float>& values,
  const std::vector<float>& signedDistanceMm)
{
  std::vector<Block> air;
  std::vector<Block> breast;
  for (int row = 0; row + BlockSize <= grid.Rows; row += BlockSize)
  {
    for (int column = 0; column + BlockSize <= grid.Columns; column += BlockSize)
    {
      const double distance =
        signedDistanceMm[grid.Index(column + BlockSize / 2, row + BlockSize / 2)];
      if (std::abs(distance) > EdgeZoneMm)
      {
        (distance > 0 ? air : breast).push_back(Measure(grid, values, column, row));
      }
    }
  }
  if (breast.size() < FewestBlocks)
  {
    return NoiseTrend::Unknown;
  }
  std::sort(breast.begin(), breast.end(),
    [](const Block& a, const Block& b) { return a.Level < b.Level; });
  const float dense = MedianNoise(breast, breast.size() / 2, breast.size());
  float light = air.size() < FewestBlocks ? 0 : MedianNoise(air, 0, air.size());
  const bool isSeenInAir = light > 0;
  light = isSeenInAir ? light : MedianNoise(breast, 0, breast.size() / 4);
  const float range = breast.back().Level - breast.front().Level;
  // What rounding leaves of a picture without noise.
  if (!(std::max(light, dense) > 1e-3F * range))
  {
    return NoiseTrend::Unknown;
  }
  return light > (isSeenInAir ? 2.0F : 1.35F) * dense ? NoiseTrend::Falls
    : dense > 1.5F * light                            ? NoiseTrend::Rises
                                                      : NoiseTrend::Unknown;
}
}
