// SPDX-License-Identifier: Apache-2.0
#include "Private/BiasField.h"

#include <itkBSplineControlPointImageFilter.h>
#include <itkLinearInterpolateImageFunction.h>
#include <itkN4BiasFieldCorrectionImageFilter.h>
#include <itkNearestNeighborExtrapolateImageFunction.h>
#include <itkResampleImageFilter.h>

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
using N4 = itk::N4BiasFieldCorrectionImageFilter<FloatImage, MaskImage, FloatImage>;
constexpr unsigned Levels = 4;
constexpr unsigned IterationsPerLevel = 30;
/// The field has no detail below the 20 mm or more between the last level's control points.
constexpr double BlockMm = 5.0;

/// Means over the masked part of each block; the mask of blocks keeps those that are half filled.
FloatImage::Pointer MaskedBlocks(const FloatImage* image, const MaskImage* mask,
  MaskImage::Pointer& blockMask)
{
  auto masked = MakeLike<FloatImage>(*image, 0.0f);
  const std::size_t count = image->GetBufferedRegion().GetNumberOfPixels();
  for (std::size_t voxel = 0; voxel < count; ++voxel)
  {
    masked->GetBufferPointer()[voxel] =
      mask->GetBufferPointer()[voxel] ? image->GetBufferPointer()[voxel] : 0.0f;
  }
  const FloatImage::Pointer sums = Shrink(masked, BlockMm);
  const FloatImage::Pointer shares = Shrink(ToFloat(mask), BlockMm);
  blockMask = MakeLike<MaskImage>(*sums, 0);
  const std::size_t blocks = sums->GetBufferedRegion().GetNumberOfPixels();
  for (std::size_t block = 0; block < blocks; ++block)
  {
    const float share = shares->GetBufferPointer()[block];
    float& mean = sums->GetBufferPointer()[block];
    mean = share > 0 ? mean / share : 0.0f;
    // N4 takes logarithms, so darkness itself tells nothing.
    blockMask->GetBufferPointer()[block] = share >= 0.5f && mean > 0 ? 1 : 0;
  }
  return sums;
}

FloatImage::Pointer LogField(N4* n4, const FloatImage* blocks)
{
  using Lattice = N4::BiasFieldControlPointLatticeType;
  using Reconstruct = itk::BSplineControlPointImageFilter<Lattice, N4::ScalarImageType>;
  auto reconstruct = Reconstruct::New();
  reconstruct->SetInput(n4->GetLogBiasFieldControlPointLattice());
  reconstruct->SetSplineOrder(n4->GetSplineOrder());
  reconstruct->SetSize(blocks->GetLargestPossibleRegion().GetSize());
  reconstruct->SetOrigin(blocks->GetOrigin());
  reconstruct->SetSpacing(blocks->GetSpacing());
  reconstruct->SetDirection(blocks->GetDirection());
  reconstruct->Update();
  auto field = MakeLike<FloatImage>(*blocks, 0.0f);
  const std::size_t count = blocks->GetBufferedRegion().GetNumberOfPixels();
  for (std::size_t block = 0; block < count; ++block)
  {
    field->GetBufferPointer()[block] = reconstruct->GetOutput()->GetBufferPointer()[block][0];
  }
  return field;
}
}

FloatImage::Pointer CorrectBias(const FloatImage* image, const MaskImage* mask,
  const ProgressCallback& progress)
{
  MaskImage::Pointer blockMask;
  const FloatImage::Pointer blocks = MaskedBlocks(image, mask, blockMask);
  auto n4 = N4::New();
  n4->SetInput(blocks);
  n4->SetMaskImage(blockMask);
  n4->SetMaskLabel(1);
  n4->SetNumberOfFittingLevels(Levels);
  N4::VariableSizeArrayType iterations(Levels);
  iterations.Fill(IterationsPerLevel);
  n4->SetMaximumNumberOfIterations(iterations);
  n4->SetConvergenceThreshold(1e-3);
  int done = 0;
  n4->AddObserver(itk::IterationEvent(),
    [&](const itk::EventObject&)
    {
      ReportProgress(progress,
        std::min(1.0, static_cast<double>(done++) / (Levels * IterationsPerLevel)),
        "correct the bias field");
    });
  n4->Update();

  auto resample = itk::ResampleImageFilter<FloatImage, FloatImage>::New();
  resample->SetInput(LogField(n4, blocks));
  resample->SetInterpolator(itk::LinearInterpolateImageFunction<FloatImage, double>::New());
  resample->SetExtrapolator(
    itk::NearestNeighborExtrapolateImageFunction<FloatImage, double>::New());
  resample->SetReferenceImage(image);
  resample->UseReferenceImageOn();
  resample->Update();
  auto corrected = MakeLike<FloatImage>(*image, 0.0f);
  const std::size_t count = image->GetBufferedRegion().GetNumberOfPixels();
  for (std::size_t voxel = 0; voxel < count; ++voxel)
  {
    corrected->GetBufferPointer()[voxel] = image->GetBufferPointer()[voxel] *
      std::exp(-resample->GetOutput()->GetBufferPointer()[voxel]);
  }
  return corrected;
}
}
