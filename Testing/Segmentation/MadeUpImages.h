// SPDX-License-Identifier: Apache-2.0
// Small images and height maps by formula, in patient order.
#ifndef mammoray_Testing_MadeUpImages_h
#define mammoray_Testing_MadeUpImages_h

#include "Private/ItkImages.h"

#include <array>
#include <cstddef>
#include <functional>

namespace mammoray::test
{
/// An image whose voxels are a function of their indices; its first corner lies at (0, 0, 0).
template <typename Image>
typename Image::Pointer MadeUpImage(const std::array<int, 3>& size, const Vector3& spacing,
  const std::function<double(int, int, int)>& value)
{
  auto image = Image::New();
  typename Image::SizeType imageSize;
  typename Image::SpacingType imageSpacing;
  typename Image::PointType origin;
  for (unsigned a = 0; a < 3; ++a)
  {
    imageSize[a] = static_cast<itk::SizeValueType>(size[a]);
    imageSpacing[a] = spacing[a];
    origin[a] = 0.5 * spacing[a];
  }
  image->SetRegions(imageSize);
  image->SetSpacing(imageSpacing);
  image->SetOrigin(origin);
  image->Allocate();
  auto* voxel = image->GetBufferPointer();
  for (int z = 0; z < size[2]; ++z)
  {
    for (int y = 0; y < size[1]; ++y)
    {
      for (int x = 0; x < size[0]; ++x)
      {
        *voxel++ = static_cast<typename Image::PixelType>(value(x, y, z));
      }
    }
  }
  return image;
}

/// Heights over the coronal plane as a function of the column (x, z).
inline HeightMap::Pointer MadeUpHeights(int columns, int rows, double spacing,
  const std::function<double(int, int)>& height)
{
  auto map = HeightMap::New();
  HeightMap::SizeType size;
  size[0] = static_cast<itk::SizeValueType>(columns);
  size[1] = static_cast<itk::SizeValueType>(rows);
  HeightMap::SpacingType mapSpacing;
  mapSpacing.Fill(spacing);
  HeightMap::PointType origin;
  origin.Fill(0.5 * spacing);
  map->SetRegions(size);
  map->SetSpacing(mapSpacing);
  map->SetOrigin(origin);
  map->Allocate();
  float* value = map->GetBufferPointer();
  for (int z = 0; z < rows; ++z)
  {
    for (int x = 0; x < columns; ++x)
    {
      *value++ = static_cast<float>(height(x, z));
    }
  }
  return map;
}

/// How many voxels of a mask are set.
inline std::size_t NumberSet(const MaskImage* mask)
{
  std::size_t count = 0;
  for (std::size_t voxel = 0; voxel < CountOf(*mask); ++voxel)
  {
    count += mask->GetBufferPointer()[voxel] ? 1 : 0;
  }
  return count;
}

/// How many voxels of two masks on one grid differ.
inline std::size_t NumberDifferent(const MaskImage* a, const MaskImage* b)
{
  std::size_t count = 0;
  for (std::size_t voxel = 0; voxel < CountOf(*a); ++voxel)
  {
    count += (a->GetBufferPointer()[voxel] != 0) != (b->GetBufferPointer()[voxel] != 0) ? 1 : 0;
  }
  return count;
}
}

#endif
