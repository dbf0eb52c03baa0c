// SPDX-License-Identifier: Apache-2.0
#include "Private/ItkImages.h"

#include <itkBinShrinkImageFilter.h>
#include <itkCastImageFilter.h>
#include <itkLinearInterpolateImageFunction.h>
#include <itkNearestNeighborExtrapolateImageFunction.h>
#include <itkResampleImageFilter.h>

#include <algorithm>
#include <cmath>

namespace mammoray
{
PatientOrder::PatientOrder(const VolumeGrid& grid, const AnatomicalAxes& axes)
  : Grid(grid)
{
  const Vector3 directions[3] = { axes.Left, axes.Anterior, axes.Superior };
  const auto along = [&](int axis, int c) { return Dot(grid.Direction[axis], directions[c]); };
  std::array<int, 3> order{ 0, 1, 2 };
  double best = -1;
  do
  {
    const double sum =
      std::abs(along(order[0], 0)) + std::abs(along(order[1], 1)) + std::abs(along(order[2], 2));
    if (sum > best)
    {
      best = sum;
      this->Axis = order;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  for (int c = 0; c < 3; ++c)
  {
    this->Flipped[c] = along(this->Axis[c], c) < 0;
  }
}

FloatImage::Pointer PatientOrder::ToImage(const IntensityVolume& volume) const
{
  auto image = FloatImage::New();
  FloatImage::SizeType size;
  FloatImage::SpacingType spacing;
  FloatImage::PointType origin;
  for (int c = 0; c < 3; ++c)
  {
    size[c] = static_cast<itk::SizeValueType>(volume.Size[this->Axis[c]]);
    spacing[c] = volume.Spacing[this->Axis[c]];
    origin[c] = 0.5 * spacing[c];
  }
  image->SetRegions(size);
  image->SetSpacing(spacing);
  image->SetOrigin(origin);
  image->Allocate();
  float* voxels = image->GetBufferPointer();
  this->ForEachVoxel(SizeOf(*image),
    [&](std::size_t inImage, std::size_t inVolume) { voxels[inImage] = volume.Voxels[inVolume]; });
  return image;
}

VolumeGrid PatientOrder::GridOf(const FloatImage& image) const
{
  VolumeGrid grid = this->Grid;
  const std::array<int, 3> size = SizeOf(image);
  Vector3 first{ 0, 0, 0 };
  for (int c = 0; c < 3; ++c)
  {
    const int a = this->Axis[c];
    const double step = image.GetSpacing()[c] / this->Grid.Spacing[a];
    // The image starts at the volume's first corner, or at its last if the axis is reversed.
    const double corner = this->Flipped[c] ? this->Grid.Size[a] - 0.5 - size[c] * step : -0.5;
    first[a] = corner + 0.5 * step;
    grid.Size[a] = size[c];
    grid.Spacing[a] = image.GetSpacing()[c];
  }
  grid.Origin = this->Grid.PointAt(first[0], first[1], first[2]);
  return grid;
}

std::size_t CountOf(const itk::ImageBase<3>& image)
{
  return image.GetLargestPossibleRegion().GetNumberOfPixels();
}

std::array<int, 3> SizeOf(const itk::ImageBase<3>& image)
{
  const auto& size = image.GetLargestPossibleRegion().GetSize();
  return { static_cast<int>(size[0]), static_cast<int>(size[1]), static_cast<int>(size[2]) };
}

FloatImage::Pointer Resample(const FloatImage* image, double spacingMm)
{
  FloatImage::ConstPointer smooth = image;
  FloatImage::SizeType size;
  FloatImage::SpacingType spacing;
  FloatImage::PointType origin;
  for (unsigned c = 0; c < 3; ++c)
  {
    const double old = image->GetSpacing()[c];
    // Smooth by half of the difference in voxel size, as if both were Gaussians of half their size,
    // to avoid aliasing.
    if (spacingMm > 1.2 * old)
    {
      auto gaussian = itk::RecursiveGaussianImageFilter<FloatImage, FloatImage>::New();
      gaussian->SetInput(smooth);
      gaussian->SetDirection(c);
      gaussian->SetSigma(0.5 * std::sqrt(spacingMm * spacingMm - old * old));
      gaussian->Update();
      smooth = gaussian->GetOutput();
    }
    // 1e-6 of a voxel: rounding must not add a voxel to a whole number of them.
    const double extent = static_cast<double>(SizeOf(*image)[c]) * old;
    size[c] = static_cast<itk::SizeValueType>(std::ceil(extent / spacingMm - 1e-6));
    spacing[c] = spacingMm;
    origin[c] = 0.5 * spacingMm;
  }
  auto resample = itk::ResampleImageFilter<FloatImage, FloatImage>::New();
  resample->SetInput(smooth);
  resample->SetInterpolator(itk::LinearInterpolateImageFunction<FloatImage, double>::New());
  resample->SetExtrapolator(
    itk::NearestNeighborExtrapolateImageFunction<FloatImage, double>::New());
  resample->SetSize(size);
  resample->SetOutputSpacing(spacing);
  resample->SetOutputOrigin(origin);
  resample->Update();
  return resample->GetOutput();
}

FloatImage::Pointer ResampleLike(const FloatImage* image, const itk::ImageBase<3>& grid)
{
  auto resample = itk::ResampleImageFilter<FloatImage, FloatImage>::New();
  resample->SetInput(image);
  resample->SetInterpolator(itk::LinearInterpolateImageFunction<FloatImage, double>::New());
  resample->SetExtrapolator(
    itk::NearestNeighborExtrapolateImageFunction<FloatImage, double>::New());
  resample->SetSize(grid.GetLargestPossibleRegion().GetSize());
  resample->SetOutputSpacing(grid.GetSpacing());
  resample->SetOutputOrigin(grid.GetOrigin());
  resample->Update();
  return resample->GetOutput();
}

FloatImage::Pointer Shrink(const FloatImage* image, double spacingMm)
{
  auto shrink = itk::BinShrinkImageFilter<FloatImage, FloatImage>::New();
  shrink->SetInput(image);
  for (unsigned c = 0; c < 3; ++c)
  {
    const int blocks = static_cast<int>(std::lround(spacingMm / image->GetSpacing()[c]));
    shrink->SetShrinkFactor(c, static_cast<unsigned>(std::clamp(blocks, 1, SizeOf(*image)[c])));
  }
  shrink->Update();
  return shrink->GetOutput();
}

FloatImage::Pointer ToFloat(const MaskImage* mask)
{
  auto cast = itk::CastImageFilter<MaskImage, FloatImage>::New();
  cast->SetInput(mask);
  cast->Update();
  return cast->GetOutput();
}
}
