// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Raster.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

using namespace mammoray;

namespace
{
VolumeGrid Grid(int i, int j, int k)
{
  VolumeGrid grid;
  grid.Size = { i, j, k };
  return grid;
}

/// Distance of a coordinate difference, in samples, to a box of this half width.
double Gap(int difference, double halfWidth)
{
  return std::max(0.0, std::abs(difference) - halfWidth);
}
}

TEST(Raster, DistancesAreThoseOfTheNearestSampleOfTheSet)
{
  std::mt19937 random(1);
  const VolumeGrid grid = Grid(9, 7, 5);
  const RasterShape shape(grid);
  const Vector3 spacing{ 0.7, 1.3, 2.1 };
  for (const double halfWidth : { 0.0, 0.25, 0.4 })
  {
    for (int round = 0; round < 20; ++round)
    {
      std::vector<unsigned char> set(shape.Count());
      std::generate(set.begin(), set.end(),
        [&] { return static_cast<unsigned char>(random() % 40 == 0); });
      const std::vector<float> found = DistanceToSet(shape, spacing, set, halfWidth);
      grid.ForEachVoxel(
        [&](int i, int j, int k, std::size_t index)
        {
          double least = std::numeric_limits<double>::infinity();
          grid.ForEachVoxel(
            [&](int u, int v, int w, std::size_t other)
            {
              const Vector3 way{ spacing[0] * Gap(i - u, halfWidth),
                spacing[1] * Gap(j - v, halfWidth), spacing[2] * Gap(k - w, halfWidth) };
              least = set[other] ? std::min(least, Norm(way)) : least;
            });
          // 1e-6 relative: squares are stored in single precision between the axes.
          EXPECT_TRUE(found[index] == least || std::abs(found[index] - least) < 1e-6 * least)
            << found[index] << " instead of " << least;
        });
    }
  }
}

TEST(Raster, DistancesToAnEmptySetAreInfinite)
{
  const std::vector<float> found =
    DistanceToSet(RasterShape(3, 2), { 1, 1, 1 }, std::vector<unsigned char>(6, 0));
  EXPECT_THAT(found, testing::Each(std::numeric_limits<float>::infinity()));
}

TEST(Raster, PiecesAreConnectedThroughFaces)
{
  // 1 1 0
  // 0 0 1
  // 1 0 1
  const std::vector<unsigned char> labels{ 1, 1, 0, 0, 0, 1, 1, 0, 1 };
  const RasterPieces pieces = FindPieces(RasterShape(3, 3), labels);
  EXPECT_THAT(pieces.Of, testing::ElementsAre(0, 0, 1, 2, 2, 3, 4, 2, 3));
  EXPECT_THAT(pieces.First, testing::ElementsAre(0, 2, 3, 5, 6));
  EXPECT_THAT(pieces.Size, testing::ElementsAre(2, 1, 3, 2, 1));
}

TEST(Raster, AnImageHasNoBorderAlongK)
{
  // A ring around one hole.
  const std::vector<unsigned char> ring{ 0, 0, 0, 0, 0, /**/ 0, 1, 1, 1, 0, /**/ 0, 1, 0, 1, 0,
    /**/ 0, 1, 1, 1, 0, /**/ 0, 0, 0, 0, 0 };
  std::vector<unsigned char> image = ring;
  FillHoles(RasterShape(5, 5), image);
  EXPECT_EQ(image[12], 1);
  EXPECT_EQ(std::count(image.begin(), image.end(), 1), 9);
  std::vector<unsigned char> slice = ring;
  FillHoles(RasterShape(Grid(5, 5, 1)), slice);
  EXPECT_EQ(slice, ring) << "every voxel of a single slice lies at the border";
}

TEST(Raster, TheFirstOfTheLargestPiecesIsKept)
{
  std::vector<std::uint16_t> mask{ 1, 0, 1, 1, 0, 1, 1 };
  EXPECT_TRUE(KeepLargestPiece(RasterShape(7, 1), mask));
  EXPECT_THAT(mask, testing::ElementsAre(0, 0, 1, 1, 0, 0, 0));
  std::vector<std::uint16_t> empty(4, 0);
  EXPECT_FALSE(KeepLargestPiece(RasterShape(4, 1), empty));
  EXPECT_THAT(empty, testing::Each(0));
}

TEST(Raster, ConvolutionKeepsConstantsAndWidensAPeakByItsVariance)
{
  const VolumeGrid grid = Grid(31, 29, 27);
  const RasterShape shape(grid);
  std::vector<float> constant(shape.Count(), 0.3f);
  const std::vector<float> kernel = GaussianKernel(2, 4);
  Convolve(shape, kernel, constant);
  EXPECT_THAT(constant, testing::Each(0.3f)) << "exactly, whatever the rounding";
  std::vector<float> peak(shape.Count(), 0.0f);
  peak[grid.Index(15, 14, 13)] = 1;
  Convolve(shape, kernel, peak);
  double sum = 0;
  Vector3 variance{ 0, 0, 0 };
  grid.ForEachVoxel(
    [&](int i, int j, int k, std::size_t index)
    {
      sum += peak[index];
      variance = variance +
        peak[index] *
          Vector3{ std::pow(i - 15.0, 2), std::pow(j - 14.0, 2), std::pow(k - 13.0, 2) };
    });
  EXPECT_NEAR(sum, 1, 1e-5);
  for (const double found : variance)
  {
    // 1 %: the kernel ends at 4 sigma.
    EXPECT_NEAR(found, 4, 0.04);
  }
}
