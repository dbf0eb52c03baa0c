// SPDX-License-Identifier: Apache-2.0
#include "Private/ChestWall.h"

#include "Private/Masks.h"

#include <itkFlatStructuringElement.h>
#include <itkGrayscaleMorphologicalClosingImageFilter.h>
#include <itkGrayscaleMorphologicalOpeningImageFilter.h>
#include <itkLinearInterpolateImageFunction.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace mammoray
{
namespace
{
/// The component of which most columns along y hold a voxel; 0 where there is none.
unsigned WidestComponent(const ComponentImage* components)
{
  const std::array<int, 3> size = SizeOf(*components);
  std::map<unsigned, std::size_t> columns;
  for (int z = 0; z < size[2]; ++z)
  {
    for (int x = 0; x < size[0]; ++x)
    {
      std::set<unsigned> here;
      for (int y = 0; y < size[1]; ++y)
      {
        here.insert(components->GetPixel({ { x, y, z } }));
      }
      for (const unsigned component : here)
      {
        ++columns[component];
      }
    }
  }
  columns.erase(0);
  unsigned widest = 0;
  std::size_t most = 0;
  for (const auto& [component, count] : columns)
  {
    if (count > most)
    {
      most = count;
      widest = component;
    }
  }
  return widest;
}

HeightMap::Pointer MakeHeightMap(const itk::ImageBase<3>& image)
{
  auto map = HeightMap::New();
  const std::array<int, 3> size = SizeOf(image);
  HeightMap::SizeType mapSize;
  HeightMap::SpacingType spacing;
  HeightMap::PointType origin;
  for (unsigned c = 0; c < 2; ++c)
  {
    mapSize[c] = static_cast<itk::SizeValueType>(size[2 * c]);
    spacing[c] = image.GetSpacing()[2 * c];
    origin[c] = image.GetOrigin()[2 * c];
  }
  map->SetRegions(mapSize);
  map->SetSpacing(spacing);
  map->SetOrigin(origin);
  map->Allocate();
  map->FillBuffer(NoChestWall);
  return map;
}

/// Front face of the component in each column.
HeightMap::Pointer FrontOf(const ComponentImage* components, unsigned component)
{
  HeightMap::Pointer front = MakeHeightMap(*components);
  const std::array<int, 3> size = SizeOf(*components);
  for (int z = 0; z < size[2]; ++z)
  {
    for (int x = 0; x < size[0]; ++x)
    {
      for (int y = size[1] - 1; y >= 0; --y)
      {
        if (components->GetPixel({ { x, y, z } }) == component)
        {
          front->SetPixel({ { x, z } },
            static_cast<float>(
              components->GetOrigin()[1] + (y + 0.5) * components->GetSpacing()[1]));
          break;
        }
      }
    }
  }
  return front;
}

template <template <typename, typename, typename> class Filter>
HeightMap::Pointer Morphology(const HeightMap* map, double radiusMm)
{
  using Element = itk::FlatStructuringElement<2>;
  Element::RadiusType radius;
  for (unsigned c = 0; c < 2; ++c)
  {
    radius[c] = static_cast<itk::SizeValueType>(std::lround(radiusMm / map->GetSpacing()[c]));
  }
  auto filter = Filter<HeightMap, HeightMap, Element>::New();
  filter->SetInput(map);
  filter->SetKernel(Element::Ball(radius));
  filter->Update();
  return filter->GetOutput();
}

/// A Gaussian mean of the columns that have a height.
HeightMap::Pointer SmoothHeights(const HeightMap* map, double sigmaMm)
{
  auto heights = HeightMap::New();
  heights->CopyInformation(map);
  heights->SetRegions(map->GetLargestPossibleRegion());
  heights->Allocate();
  auto weights = HeightMap::New();
  weights->CopyInformation(map);
  weights->SetRegions(map->GetLargestPossibleRegion());
  weights->Allocate();
  const std::size_t count = map->GetBufferedRegion().GetNumberOfPixels();
  for (std::size_t n = 0; n < count; ++n)
  {
    const float height = map->GetBufferPointer()[n];
    const bool has = height != NoChestWall;
    heights->GetBufferPointer()[n] = has ? height : 0.0f;
    weights->GetBufferPointer()[n] = has ? 1.0f : 0.0f;
  }
  const HeightMap::Pointer sums = GaussianMean<HeightMap>(heights, sigmaMm);
  const HeightMap::Pointer shares = GaussianMean<HeightMap>(weights, sigmaMm);
  for (std::size_t n = 0; n < count; ++n)
  {
    heights->GetBufferPointer()[n] = weights->GetBufferPointer()[n] > 0
      ? sums->GetBufferPointer()[n] / shares->GetBufferPointer()[n]
      : NoChestWall;
  }
  return heights;
}

/// The heights over the columns of another image.
HeightMap::Pointer HeightsOver(const HeightMap* map, const itk::ImageBase<3>& image)
{
  HeightMap::Pointer over = MakeHeightMap(image);
  auto linear = itk::LinearInterpolateImageFunction<HeightMap, double>::New();
  linear->SetInputImage(map);
  const auto size = map->GetLargestPossibleRegion().GetSize();
  const auto overSize = over->GetLargestPossibleRegion().GetSize();
  for (itk::IndexValueType z = 0; z < static_cast<itk::IndexValueType>(overSize[1]); ++z)
  {
    for (itk::IndexValueType x = 0; x < static_cast<itk::IndexValueType>(overSize[0]); ++x)
    {
      HeightMap::PointType point;
      over->TransformIndexToPhysicalPoint({ { x, z } }, point);
      itk::ContinuousIndex<double, 2> at;
      bool complete = true;
      (void)map->TransformPhysicalPointToContinuousIndex(point, at);
      for (unsigned c = 0; c < 2; ++c)
      {
        at[c] = std::clamp(at[c], 0.0, static_cast<double>(size[c] - 1));
      }
      // Beside the chest wall the mean of a height and of none would be neither.
      for (int corner = 0; corner < 4; ++corner)
      {
        const HeightMap::IndexType index{ { static_cast<itk::IndexValueType>(
                                              corner & 1 ? std::ceil(at[0]) : std::floor(at[0])),
          static_cast<itk::IndexValueType>(corner & 2 ? std::ceil(at[1]) : std::floor(at[1])) } };
        complete = complete && map->GetPixel(index) != NoChestWall;
      }
      const HeightMap::IndexType nearest{ { static_cast<itk::IndexValueType>(std::lround(at[0])),
        static_cast<itk::IndexValueType>(std::lround(at[1])) } };
      over->SetPixel({ { x, z } },
        complete ? static_cast<float>(linear->EvaluateAtContinuousIndex(at))
                 : map->GetPixel(nearest));
    }
  }
  return over;
}
}

HeightMap::Pointer FindChestWall(const MaskImage* dark)
{
  constexpr double blockMm = 2.0;
  constexpr double thinMm = 6.0;
  constexpr double gapMm = 12.0;
  constexpr double bumpWidthMm = 50.0;
  constexpr double bumpHeightMm = 5.0;
  const FloatImage::Pointer shares = Shrink(ToFloat(dark), blockMm);
  auto blocks = MakeLike<MaskImage>(*shares, 0);
  for (std::size_t block = 0; block < blocks->GetBufferedRegion().GetNumberOfPixels(); ++block)
  {
    blocks->GetBufferPointer()[block] = shares->GetBufferPointer()[block] >= 0.5f ? 1 : 0;
  }
  const ComponentImage::Pointer components = FindComponents(Open(blocks, 0.5 * thinMm), 0);
  const unsigned widest = WidestComponent(components);
  if (widest == 0)
  {
    return MakeHeightMap(*dark);
  }
  HeightMap::Pointer front = FrontOf(components, widest);
  front = Morphology<itk::GrayscaleMorphologicalClosingImageFilter>(front, 0.5 * gapMm);
  const HeightMap::Pointer opened =
    Morphology<itk::GrayscaleMorphologicalOpeningImageFilter>(front, 0.5 * bumpWidthMm);
  for (std::size_t n = 0; n < front->GetBufferedRegion().GetNumberOfPixels(); ++n)
  {
    float& height = front->GetBufferPointer()[n];
    const float low = opened->GetBufferPointer()[n];
    height = low != NoChestWall && height > low + bumpHeightMm ? low : height;
  }
  return HeightsOver(SmoothHeights(front, 3.0), *dark);
}
}
