// SPDX-License-Identifier: Apache-2.0
#include "Private/Masks.h"

#include <itkBinaryDilateImageFilter.h>
#include <itkBinaryMorphologicalOpeningImageFilter.h>
#include <itkConnectedComponentImageFilter.h>
#include <itkFlatStructuringElement.h>
#include <itkRelabelComponentImageFilter.h>

#include <cmath>
#include <set>

namespace mammoray
{
ComponentImage::Pointer FindComponents(const MaskImage* mask, std::size_t smallestVoxels)
{
  auto components = itk::ConnectedComponentImageFilter<MaskImage, ComponentImage>::New();
  components->SetInput(mask);
  auto relabel = itk::RelabelComponentImageFilter<ComponentImage, ComponentImage>::New();
  relabel->SetInput(components->GetOutput());
  relabel->SetMinimumObjectSize(smallestVoxels);
  relabel->Update();
  return relabel->GetOutput();
}

MaskImage::Pointer LargestComponent(const MaskImage* mask)
{
  const ComponentImage::Pointer components = FindComponents(mask, 0);
  return MakeFrom<MaskImage>(*mask,
    [&](std::size_t voxel) { return components->GetBufferPointer()[voxel] == 1; });
}

MaskImage::Pointer ReachedFromFront(const MaskImage* mask)
{
  const ComponentImage::Pointer components = FindComponents(mask, 0);
  const std::array<int, 3> size = SizeOf(*mask);
  std::set<unsigned> atFront;
  for (int z = 0; z < size[2]; ++z)
  {
    for (int x = 0; x < size[0]; ++x)
    {
      atFront.insert(components->GetPixel({ { x, size[1] - 1, z } }));
    }
  }
  atFront.erase(0);
  return MakeFrom<MaskImage>(*mask,
    [&](std::size_t voxel) { return atFront.count(components->GetBufferPointer()[voxel]) > 0; });
}

MaskImage::Pointer Complement(const MaskImage* mask)
{
  return MakeFrom<MaskImage>(*mask,
    [&](std::size_t voxel) { return mask->GetBufferPointer()[voxel] == 0; });
}

namespace
{
using Element = itk::FlatStructuringElement<3>;

Element BallOf(const MaskImage* mask, double radiusMm)
{
  Element::RadiusType radius;
  for (unsigned c = 0; c < 3; ++c)
  {
    radius[c] = static_cast<itk::SizeValueType>(std::lround(radiusMm / mask->GetSpacing()[c]));
  }
  return Element::Ball(radius);
}

/// The result of a morphological filter with a ball of this radius.
template <typename Filter>
MaskImage::Pointer Filtered(const MaskImage* mask, double radiusMm)
{
  auto filter = Filter::New();
  filter->SetInput(mask);
  filter->SetKernel(BallOf(mask, radiusMm));
  filter->SetForegroundValue(1);
  filter->Update();
  return filter->GetOutput();
}
}

MaskImage::Pointer Open(const MaskImage* mask, double radiusMm)
{
  return Filtered<itk::BinaryMorphologicalOpeningImageFilter<MaskImage, MaskImage, Element>>(mask,
    radiusMm);
}

MaskImage::Pointer Dilate(const MaskImage* mask, double radiusMm)
{
  return Filtered<itk::BinaryDilateImageFilter<MaskImage, MaskImage, Element>>(mask, radiusMm);
}

std::vector<float> ValuesIn(const FloatImage* image, const MaskImage* mask)
{
  std::vector<float> values;
  const std::size_t count = image->GetBufferedRegion().GetNumberOfPixels();
  for (std::size_t voxel = 0; voxel < count; ++voxel)
  {
    if (mask->GetBufferPointer()[voxel])
    {
      values.push_back(image->GetBufferPointer()[voxel]);
    }
  }
  return values;
}
}
