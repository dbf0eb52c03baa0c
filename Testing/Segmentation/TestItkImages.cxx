// SPDX-License-Identifier: Apache-2.0
#include "MadeUpImages.h"
#include "mammoray/Segmentation/Private/ItkImages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace
{
using namespace mammoray;
using test::MadeUpImage;

/// A grid whose axes are a turned frame's, in any order and direction: `code` 0 to 47.
VolumeGrid ObliqueGrid(int code)
{
  // An orthonormal frame 10 to 20 degrees from the patient's, not on any axis.
  const double a = 0.2;
  const double b = 0.3;
  const Vector3 x{ std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b) };
  const Vector3 y{ -std::sin(a), std::cos(a), 0 };
  const std::array<Vector3, 3> frame{ x, y, Cross(x, y) };
  std::array<int, 3> order{ 0, 1, 2 };
  for (int n = 0; n < code / 8; ++n)
  {
    std::next_permutation(order.begin(), order.end());
  }
  VolumeGrid grid;
  grid.Size = { 21, 14, 15 };
  grid.Spacing = { 0.9, 1.4, 2.3 };
  grid.Origin = { 12, -34, 56 };
  for (int axis = 0; axis < 3; ++axis)
  {
    const double sign = (code >> axis) & 1 ? -1 : 1;
    grid.Direction[axis] = sign * frame[order[axis]];
  }
  return grid;
}

/// A function of the place that is linear, and the same in no two directions.
double LinearAt(const Vector3& point)
{
  return 500 + 1.0 * point[0] + 0.5 * point[1] - 0.25 * point[2];
}

IntensityVolume LinearVolume(const VolumeGrid& grid)
{
  IntensityVolume volume;
  static_cast<VolumeGrid&>(volume) = grid;
  for (int k = 0; k < grid.Size[2]; ++k)
  {
    for (int j = 0; j < grid.Size[1]; ++j)
    {
      for (int i = 0; i < grid.Size[0]; ++i)
      {
        volume.Voxels.push_back(static_cast<float>(LinearAt(grid.PointAt(i, j, k))));
      }
    }
  }
  return volume;
}

TEST(PatientOrder, TurnsEveryOrderOfAxesToThePatientAndBack)
{
  const AnatomicalAxes axes;
  for (int code = 0; code < 48; ++code)
  {
    const IntensityVolume volume = LinearVolume(ObliqueGrid(code));
    const PatientOrder order(volume, axes);
    const FloatImage::Pointer image = order.ToImage(volume);
    // Steps in the image go to the left, to the front and to the head: within 45 degrees.
    const std::array<int, 3> size = SizeOf(*image);
    ASSERT_EQ(CountOf(*image), volume.Voxels.size());
    std::array<Vector3, 3> step{ axes.Left, axes.Anterior, axes.Superior };
    for (int c = 0; c < 3; ++c)
    {
      const auto axis = static_cast<std::size_t>(
        std::find_if(volume.Direction.begin(), volume.Direction.end(),
          [&](const Vector3& d) { return std::abs(Dot(d, step[c])) > 0.75; }) -
        volume.Direction.begin());
      ASSERT_LT(axis, 3u);
      EXPECT_EQ(size[c], volume.Size[axis]) << code;
      EXPECT_EQ(image->GetSpacing()[c], volume.Spacing[axis]) << code;
      const Vector3 forward =
        (Dot(volume.Direction[axis], step[c]) > 0 ? 1.0 : -1.0) * volume.Direction[axis];
      itk::Index<3> index{ { 2, 3, 4 } };
      const float here = image->GetPixel(index);
      ++index[c];
      const double expected = LinearAt(volume.Spacing[axis] * forward) - LinearAt({ 0, 0, 0 });
      // Floats of about 500 have steps of 3e-5.
      EXPECT_NEAR(image->GetPixel(index) - here, expected, 2e-4) << code << " axis " << c;
    }
    // The image's grid is the volume's again.
    const VolumeGrid grid = order.GridOf(*image);
    EXPECT_EQ(grid.Size, volume.Size) << code;
    EXPECT_EQ(grid.Spacing, volume.Spacing) << code;
    EXPECT_EQ(grid.Direction, volume.Direction) << code;
    EXPECT_LT(Norm(grid.Origin - volume.Origin), 1e-9) << code;
    // Every voxel once, at its own place.
    std::vector<int> visits(volume.Voxels.size(), 0);
    order.ForEachVoxel(size,
      [&](std::size_t inImage, std::size_t inVolume)
      {
        ++visits[inVolume];
        EXPECT_EQ(image->GetBufferPointer()[inImage], volume.Voxels[inVolume]);
      });
    EXPECT_EQ(visits, std::vector<int>(visits.size(), 1)) << code;
  }
}

TEST(PatientOrder, ResampledImagesKeepTheirPlace)
{
  // Neither spacing divides the extents, so that voxels are left over at the far end, whichever it
  // is in the volume. Linear interpolation and even smoothing keep a linear function.
  for (const double spacing : { 0.7, 2.0 })
  {
    for (int code = 0; code < 48; ++code)
    {
      const IntensityVolume volume = LinearVolume(ObliqueGrid(code));
      const PatientOrder order(volume, {});
      const FloatImage::Pointer image = Resample(order.ToImage(volume), spacing);
      const VolumeGrid grid = order.GridOf(*image);
      const std::array<int, 3> size = SizeOf(*image);
      double largest = 0;
      std::size_t inside = 0;
      order.ForEachVoxel(size,
        [&](std::size_t inImage, std::size_t inVolume)
        {
          const auto i = static_cast<int>(inVolume % static_cast<std::size_t>(grid.Size[0]));
          const auto j = static_cast<int>(inVolume / static_cast<std::size_t>(grid.Size[0]) %
            static_cast<std::size_t>(grid.Size[1]));
          const auto k = static_cast<int>(inVolume / static_cast<std::size_t>(grid.Size[0]) /
            static_cast<std::size_t>(grid.Size[1]));
          const Vector3 point = grid.PointAt(i, j, k);
          const Vector3 at = volume.ContinuousIndex(point);
          bool inner = true;
          for (int c = 0; c < 3; ++c)
          {
            // The smoothing, of up to 0.9 mm, forgets the rim over 4 of its deviations.
            const double rim = spacing > 1 ? 4.0 / volume.Spacing[c] : 0.0;
            inner = inner && at[c] >= rim && at[c] <= volume.Size[c] - 1 - rim;
          }
          if (inner)
          {
            ++inside;
            largest =
              std::max(largest, std::abs(image->GetBufferPointer()[inImage] - LinearAt(point)));
          }
        });
      EXPECT_GT(inside, 20u) << code;
      // A misplacement by a tenth of a millimetre would show as 0.03 at least; floats of 500 and
      // the recursive filter's 1e-5 of them.
      EXPECT_LT(largest, 0.01) << code << ' ' << spacing;
    }
  }
}

TEST(PatientOrder, FlatVolumesHaveAnOrderToo)
{
  VolumeGrid grid = ObliqueGrid(0b010'011);
  grid.Size = { 1, 5, 1 };
  const IntensityVolume volume = LinearVolume(grid);
  const PatientOrder order(volume, {});
  const FloatImage::Pointer image = order.ToImage(volume);
  EXPECT_EQ(CountOf(*image), 5u);
  EXPECT_EQ(order.GridOf(*image).Size, grid.Size);
  EXPECT_LT(Norm(order.GridOf(*image).Origin - grid.Origin), 1e-9);
}

TEST(Resample, SizesHoldTheWholeImage)
{
  const FloatImage::Pointer image =
    MadeUpImage<FloatImage>({ 10, 9, 8 }, { 0.8, 1.0, 3.0 }, [](int, int, int) { return 7; });
  for (const double spacing : { 0.4, 0.8, 1.0, 2.0, 2.3 })
  {
    const FloatImage::Pointer cubes = Resample(image, spacing);
    const std::array<int, 3> size = SizeOf(*cubes);
    const Vector3 extent{ 8, 9, 24 };
    for (unsigned c = 0; c < 3; ++c)
    {
      EXPECT_EQ(cubes->GetSpacing()[c], spacing);
      EXPECT_DOUBLE_EQ(cubes->GetOrigin()[c], 0.5 * spacing);
      EXPECT_GE(size[c] * spacing, extent[c] - 1e-5);
      EXPECT_LT((size[c] - 1) * spacing, extent[c] - 1e-5);
    }
    for (std::size_t voxel = 0; voxel < CountOf(*cubes); ++voxel)
    {
      // A constant, up to the recursive filter's rounding.
      ASSERT_NEAR(cubes->GetBufferPointer()[voxel], 7, 1e-4);
    }
  }
}

TEST(Resample, AveragesWhereVoxelsGrow)
{
  // Voxel by voxel 0 and 2: on cubes of four voxels nothing of that is left but its mean.
  const FloatImage::Pointer image = MadeUpImage<FloatImage>({ 48, 48, 48 }, { 0.5, 0.5, 0.5 },
    [](int x, int y, int z) { return 2 * ((x + y + z) % 2); });
  const FloatImage::Pointer cubes = Resample(image, 2);
  for (int z = 2; z < 10; ++z)
  {
    for (int x = 2; x < 10; ++x)
    {
      // exp(-(pi sigma)^2 / 2) along each axis, sigma 1.9 voxels: 1e-8.
      ASSERT_NEAR(cubes->GetPixel({ { x, 5, z } }), 1, 1e-3);
    }
  }
}

TEST(ResampleLike, IsLinearWithinAndNearestBeyond)
{
  const FloatImage::Pointer image = MadeUpImage<FloatImage>({ 6, 5, 4 }, { 2, 2, 2 },
    [](int x, int y, int z) { return 3 * x - 2 * y + z; });
  const FloatImage::Pointer grid =
    MadeUpImage<FloatImage>({ 20, 14, 11 }, { 1, 1, 1 }, [](int, int, int) { return 0; });
  const FloatImage::Pointer like = ResampleLike(image, *grid);
  ASSERT_EQ(SizeOf(*like), SizeOf(*grid));
  for (int z = 0; z < 11; ++z)
  {
    for (int y = 0; y < 14; ++y)
    {
      for (int x = 0; x < 20; ++x)
      {
        const auto at = [](int n, int size)
        { return std::clamp((n + 0.5) / 2 - 0.5, 0.0, size - 1.0); };
        const bool inside = x < 12 && y < 10 && z < 8;
        const double expected = inside
          ? 3 * at(x, 6) - 2 * at(y, 5) + at(z, 4)
          : 3 * std::round(at(x, 6)) - 2 * std::round(at(y, 5)) + std::round(at(z, 4));
        // Within half a voxel of the border it is linear between the nearest, too. Outside, the
        // nearest voxel: a difference of half a step of each axis where places lie between two.
        ASSERT_NEAR(like->GetPixel({ { x, y, z } }), expected, inside ? 1e-4 : 3.0)
          << x << ' ' << y << ' ' << z;
      }
    }
  }
  // Far outside along one axis, on a voxel's own line.
  EXPECT_NEAR(like->GetPixel({ { 19, 0, 0 } }), 15, 1e-4);
}

TEST(Shrink, IsTheMeanOfBlocksAtTheirMiddle)
{
  const auto linear = [](double x, double y, double z) { return 100 + 3 * x - 2 * y + 0.5 * z; };
  // 11 = 3 blocks of 3 and 2 voxels left over; along z the voxels are as large as the blocks.
  const FloatImage::Pointer image = MadeUpImage<FloatImage>({ 11, 9, 4 }, { 1.9, 2.1, 6 },
    [&](int x, int y, int z) { return linear(1.9 * (x + 0.5), 2.1 * (y + 0.5), 6 * (z + 0.5)); });
  const FloatImage::Pointer blocks = Shrink(image, 6);
  EXPECT_EQ(SizeOf(*blocks), (std::array<int, 3>{ 3, 3, 4 }));
  for (int z = 0; z < 4; ++z)
  {
    for (int y = 0; y < 3; ++y)
    {
      for (int x = 0; x < 3; ++x)
      {
        const itk::Index<3> index{ { x, y, z } };
        itk::Point<double, 3> point;
        blocks->TransformIndexToPhysicalPoint(index, point);
        EXPECT_NEAR(point[0], 1.9 * 3 * (x + 0.5), 1e-9);
        EXPECT_NEAR(point[1], 2.1 * 3 * (y + 0.5), 1e-9);
        // Floats of about 100.
        EXPECT_NEAR(blocks->GetPixel(index), linear(point[0], point[1], point[2]), 1e-4);
      }
    }
  }
  // Never more than there is.
  EXPECT_EQ(SizeOf(*Shrink(image, 1000)), (std::array<int, 3>{ 1, 1, 1 }));
}

TEST(GaussianMean, HasTheWidthAndKeepsTheSum)
{
  const FloatImage::Pointer point = MadeUpImage<FloatImage>({ 41, 31, 21 }, { 1, 2, 2 },
    [](int x, int y, int z) { return x == 20 && y == 15 && z == 10 ? 1000 : 0; });
  const FloatImage::Pointer mean = GaussianMean<FloatImage>(point, 3);
  double sum = 0;
  Vector3 square{ 0, 0, 0 };
  for (int z = 0; z < 21; ++z)
  {
    for (int y = 0; y < 31; ++y)
    {
      for (int x = 0; x < 41; ++x)
      {
        const double value = mean->GetPixel({ { x, y, z } });
        sum += value;
        square[0] += value * (x - 20) * (x - 20);
        square[1] += value * 4 * (y - 15) * (y - 15);
        square[2] += value * 4 * (z - 10) * (z - 10);
      }
    }
  }
  EXPECT_NEAR(sum, 1000, 1); // the border cuts off a thousandth
  for (int c = 0; c < 3; ++c)
  {
    // Deriche's approximation of the Gaussian has 6 % less variance.
    EXPECT_NEAR(square[c] / sum, 9, 0.7) << c;
  }
}

TEST(ToFloat, KeepsTheMaskAndItsPlace)
{
  const MaskImage::Pointer mask = MadeUpImage<MaskImage>({ 3, 4, 5 }, { 1, 2, 3 },
    [](int x, int y, int z) { return (x + y + z) % 2; });
  const FloatImage::Pointer image = ToFloat(mask);
  EXPECT_EQ(image->GetSpacing(), mask->GetSpacing());
  EXPECT_EQ(image->GetOrigin(), mask->GetOrigin());
  for (std::size_t voxel = 0; voxel < CountOf(*mask); ++voxel)
  {
    ASSERT_EQ(image->GetBufferPointer()[voxel], mask->GetBufferPointer()[voxel]);
  }
}
}
