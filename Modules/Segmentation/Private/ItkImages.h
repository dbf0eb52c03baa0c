// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ItkImages_h
#define mammoray_ItkImages_h

#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammoraySegmentationModule.h"

#include <itkImage.h>
#include <itkRecursiveGaussianImageFilter.h>

namespace mammoray
{
using FloatImage = itk::Image<float, 3>;
using MaskImage = itk::Image<unsigned char, 3>;
/// An image over the coronal plane; its axes point left and superior.
using HeightMap = itk::Image<float, 2>;

/// Reorders the axes of a volume, without interpolation, to patient order: x towards the left, y
/// towards the front and z towards the head. Each direction takes the axis nearest to it.
class MAMMORAYSEGMENTATION_EXPORT PatientOrder
{
public:
  PatientOrder(const VolumeGrid& grid, const AnatomicalAxes& axes);

  /// The voxels in patient order; the image's first corner is at (0, 0, 0) mm.
  FloatImage::Pointer ToImage(const IntensityVolume& volume) const;
  /// The grid of an image in patient order, in the volume's own order and frame.
  VolumeGrid GridOf(const FloatImage& image) const;
  /// Calls visit(index in the image's buffer, index in the volume's array) for every voxel.
  template <typename Visit>
  void ForEachVoxel(const std::array<int, 3>& imageSize, Visit visit) const
  {
    std::array<int, 3> volumeSize;
    for (int c = 0; c < 3; ++c)
    {
      volumeSize[this->Axis[c]] = imageSize[c];
    }
    VolumeGrid grid;
    grid.Size = volumeSize;
    std::size_t index = 0;
    std::array<int, 3> voxel;
    for (int z = 0; z < imageSize[2]; ++z)
    {
      voxel[this->Axis[2]] = this->Flipped[2] ? imageSize[2] - 1 - z : z;
      for (int y = 0; y < imageSize[1]; ++y)
      {
        voxel[this->Axis[1]] = this->Flipped[1] ? imageSize[1] - 1 - y : y;
        for (int x = 0; x < imageSize[0]; ++x)
        {
          voxel[this->Axis[0]] = this->Flipped[0] ? imageSize[0] - 1 - x : x;
          visit(index++, grid.Index(voxel[0], voxel[1], voxel[2]));
        }
      }
    }
  }

private:
  VolumeGrid Grid;
  /// Axis of the volume that becomes x, y, z, and whether its direction is reversed.
  std::array<int, 3> Axis;
  std::array<bool, 3> Flipped;
};

MAMMORAYSEGMENTATION_EXPORT std::array<int, 3> SizeOf(const itk::ImageBase<3>& image);
/// Number of voxels of an image.
MAMMORAYSEGMENTATION_EXPORT std::size_t CountOf(const itk::ImageBase<3>& image);

/// Resamples the image to cubic voxels with the same first corner: averaged where they are larger,
/// otherwise linear.
MAMMORAYSEGMENTATION_EXPORT FloatImage::Pointer Resample(const FloatImage* image, double spacingMm);

/// Interpolates the image linearly at the voxels of another grid in the same frame; outside, the
/// nearest value is used.
MAMMORAYSEGMENTATION_EXPORT FloatImage::Pointer ResampleLike(const FloatImage* image,
  const itk::ImageBase<3>& grid);

/// Means over blocks of voxels of about `spacingMm`; unchanged if the voxels are already larger.
MAMMORAYSEGMENTATION_EXPORT FloatImage::Pointer Shrink(const FloatImage* image, double spacingMm);

MAMMORAYSEGMENTATION_EXPORT FloatImage::Pointer ToFloat(const MaskImage* mask);

/// Convolves the image with a Gaussian along all axes.
template <typename Image>
typename Image::Pointer GaussianMean(const Image* image, double sigmaMm)
{
  typename Image::Pointer mean;
  for (unsigned axis = 0; axis < Image::ImageDimension; ++axis)
  {
    auto gaussian = itk::RecursiveGaussianImageFilter<Image, Image>::New();
    gaussian->SetInput(axis == 0 ? image : mean.GetPointer());
    gaussian->SetDirection(axis);
    gaussian->SetSigma(sigmaMm);
    gaussian->Update();
    mean = gaussian->GetOutput();
  }
  return mean;
}

/// An image on the same grid, filled with `value`.
template <typename Image>
typename Image::Pointer MakeLike(const itk::ImageBase<Image::ImageDimension>& grid,
  typename Image::PixelType value)
{
  auto image = Image::New();
  image->CopyInformation(&grid);
  image->SetRegions(grid.GetLargestPossibleRegion());
  image->Allocate();
  image->FillBuffer(value);
  return image;
}

/// An image on the same grid with valueAt(index in the buffer) at every pixel.
template <typename Image, typename ValueAt>
typename Image::Pointer MakeFrom(const itk::ImageBase<Image::ImageDimension>& grid,
  const ValueAt& valueAt)
{
  auto image = MakeLike<Image>(grid, 0);
  const std::size_t count = grid.GetLargestPossibleRegion().GetNumberOfPixels();
  for (std::size_t pixel = 0; pixel < count; ++pixel)
  {
    image->GetBufferPointer()[pixel] = static_cast<typename Image::PixelType>(valueAt(pixel));
  }
  return image;
}
}

#endif
