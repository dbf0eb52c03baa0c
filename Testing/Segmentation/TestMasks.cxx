// SPDX-License-Identifier: Apache-2.0
#include "MadeUpImages.h"
#include "mammoray/Segmentation/Private/Masks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace
{
using namespace mammoray;
using test::MadeUpImage;
using test::NumberDifferent;
using test::NumberSet;

/// A voxel in three of noise, which has components of every size.
MaskImage::Pointer SpeckledMask()
{
  std::mt19937 generator(11);
  return MadeUpImage<MaskImage>({ 13, 11, 9 }, { 1, 1, 1 },
    [&](int, int, int) { return generator() % 3 == 0 ? 1 : 0; });
}

TEST(FindComponents, AreNumberedByFallingSizeAndShareFaces)
{
  // Two voxels, three in a row, and one that only touches the row along an edge.
  const MaskImage::Pointer mask = MadeUpImage<MaskImage>({ 6, 4, 1 }, { 1, 2, 3 },
    [](int x, int y, int)
    { return (y == 0 && x < 2) || (y == 2 && x > 1 && x < 5) || (y == 3 && x == 5); });
  const ComponentImage::Pointer all = FindComponents(mask, 0);
  EXPECT_EQ(all->GetPixel({ { 2, 2, 0 } }), 1u);
  EXPECT_EQ(all->GetPixel({ { 4, 2, 0 } }), 1u);
  EXPECT_EQ(all->GetPixel({ { 1, 0, 0 } }), 2u);
  EXPECT_EQ(all->GetPixel({ { 5, 3, 0 } }), 3u);
  EXPECT_EQ(all->GetPixel({ { 5, 2, 0 } }), 0u);
  const ComponentImage::Pointer some = FindComponents(mask, 2);
  EXPECT_EQ(some->GetPixel({ { 1, 0, 0 } }), 2u); // two voxels are enough
  EXPECT_EQ(some->GetPixel({ { 5, 3, 0 } }), 0u);
}

TEST(FindComponents, NeighboursHaveOneNumber)
{
  const MaskImage::Pointer mask = SpeckledMask();
  const ComponentImage::Pointer components = FindComponents(mask, 0);
  std::vector<std::size_t> sizes(1, 0);
  for (int z = 0; z < 9; ++z)
  {
    for (int y = 0; y < 11; ++y)
    {
      for (int x = 0; x < 13; ++x)
      {
        const unsigned component = components->GetPixel({ { x, y, z } });
        ASSERT_EQ(component != 0, mask->GetPixel({ { x, y, z } }) != 0);
        sizes.resize(std::max<std::size_t>(sizes.size(), component + 1), 0);
        ++sizes[component];
        const unsigned next = x + 1 < 13 ? components->GetPixel({ { x + 1, y, z } }) : 0;
        const unsigned above = y + 1 < 11 ? components->GetPixel({ { x, y + 1, z } }) : 0;
        ASSERT_TRUE(component == 0 || next == 0 || next == component);
        ASSERT_TRUE(component == 0 || above == 0 || above == component);
      }
    }
  }
  EXPECT_GT(sizes.size(), 5u);
  EXPECT_TRUE(std::is_sorted(sizes.begin() + 1, sizes.end(), std::greater<>()));
  EXPECT_EQ(NumberSet(LargestComponent(mask)), sizes[1]);
}

TEST(Masks, NothingComesOfNothing)
{
  const MaskImage::Pointer empty =
    MadeUpImage<MaskImage>({ 5, 4, 3 }, { 1, 1, 1 }, [](int, int, int) { return 0; });
  const FloatImage::Pointer image =
    MadeUpImage<FloatImage>({ 5, 4, 3 }, { 1, 1, 1 }, [](int x, int, int) { return x; });
  EXPECT_EQ(NumberSet(LargestComponent(empty)), 0u);
  EXPECT_EQ(NumberSet(ReachedFromFront(empty)), 0u);
  EXPECT_EQ(NumberSet(Dilate(empty, 2)), 0u);
  EXPECT_EQ(NumberSet(Open(empty, 1)), 0u);
  EXPECT_TRUE(ValuesIn(image, empty).empty());
  const MaskImage::Pointer full = Complement(empty);
  EXPECT_EQ(NumberSet(full), 60u);
  EXPECT_EQ(ValuesIn(image, full).size(), 60u);
}

TEST(ReachedFromFront, LeavesSealedCavitiesAndEdgeContacts)
{
  // A box with a hole of one voxel inside, and a second hole that meets the outside along an edge.
  const MaskImage::Pointer air = MadeUpImage<MaskImage>({ 7, 7, 7 }, { 1, 1, 1 },
    [](int x, int y, int z)
    {
      const bool box = x > 0 && x < 6 && y < 6 && z > 0 && z < 6;
      const bool cavity = x == 3 && y == 2 && z == 3;
      const bool atTheEdge = x == 1 && y == 5 && z == 1;
      return !box || cavity || atTheEdge;
    });
  const MaskImage::Pointer reached = ReachedFromFront(air);
  EXPECT_EQ(reached->GetPixel({ { 3, 2, 3 } }), 0);
  EXPECT_EQ(reached->GetPixel({ { 1, 5, 1 } }), 1); // its face at y = 6 is open
  EXPECT_EQ(reached->GetPixel({ { 0, 0, 0 } }), 1); // around the box
  EXPECT_EQ(NumberSet(reached), NumberSet(air) - 1);
  // What touches the other five faces only is not reached.
  const MaskImage::Pointer behind =
    MadeUpImage<MaskImage>({ 7, 7, 7 }, { 1, 1, 1 }, [](int, int y, int) { return y < 3 ? 1 : 0; });
  EXPECT_EQ(NumberSet(ReachedFromFront(behind)), 0u);
  const MaskImage::Pointer diagonal = MadeUpImage<MaskImage>({ 3, 3, 1 }, { 1, 1, 1 },
    [](int x, int y, int) { return x == y ? 1 : 0; });
  EXPECT_EQ(NumberSet(ReachedFromFront(diagonal)), 1u);
}

TEST(Dilate, ReachesTheBallOfTheRadiusOnAnyVoxels)
{
  const Vector3 spacing{ 1, 2, 4 };
  const MaskImage::Pointer mask = MadeUpImage<MaskImage>({ 15, 9, 7 }, spacing,
    [](int x, int y, int z) { return x == 7 && y == 4 && z == 3 ? 1 : 0; });
  const MaskImage::Pointer ball = Dilate(mask, 4);
  for (int z = 0; z < 7; ++z)
  {
    for (int y = 0; y < 9; ++y)
    {
      for (int x = 0; x < 15; ++x)
      {
        const Vector3 away{ x - 7.0, 2.0 * (y - 4), 4.0 * (z - 3) };
        const bool set = ball->GetPixel({ { x, y, z } }) != 0;
        // Half a voxel: the ball's rim runs through the voxels, which are in or out as a whole.
        EXPECT_TRUE(set || Norm(away) > 4) << x << ' ' << y << ' ' << z;
        EXPECT_TRUE(!set ||
          (std::abs(away[0]) <= 4.5 && std::abs(away[1]) <= 5 && std::abs(away[2]) <= 6 &&
            std::hypot(away[0] / 4.5, away[1] / 5, away[2] / 6) <= 1))
          << x << ' ' << y << ' ' << z;
      }
    }
  }
  // A radius of less than half a voxel does nothing along that axis.
  EXPECT_EQ(NumberSet(Dilate(mask, 1.4)), 3u * 3u);
  EXPECT_EQ(NumberSet(Dilate(mask, 0.4)), 1u);
}

TEST(Dilate, StopsAtTheBorder)
{
  const MaskImage::Pointer corner = MadeUpImage<MaskImage>({ 6, 6, 6 }, { 1, 1, 1 },
    [](int x, int y, int z) { return x == 0 && y == 0 && z == 5 ? 1 : 0; });
  // An eighth of the ball of 27 - 8 voxels around a voxel: those with at most two offsets.
  const std::size_t ball = NumberSet(Dilate(corner, 1));
  EXPECT_EQ(ball, 7u);
}

TEST(Open, TakesBridgesAndSpecksAndNothingElse)
{
  // Two blocks, a bridge two voxels thick between them and a speck.
  const auto isBlock = [](int x, int y, int z)
  { return y >= 3 && y < 15 && z >= 3 && z < 15 && ((x >= 3 && x < 15) || (x >= 21 && x < 33)); };
  const auto isBridge = [](int x, int y, int z)
  { return x >= 15 && x < 21 && y >= 8 && y < 10 && z >= 8 && z < 10; };
  const MaskImage::Pointer mask = MadeUpImage<MaskImage>({ 36, 18, 18 }, { 2, 2, 2 },
    [&](int x, int y, int z)
    { return isBlock(x, y, z) || isBridge(x, y, z) || (x == 18 && y == 14 && z == 14); });
  const MaskImage::Pointer opened = Open(mask, 4);
  EXPECT_EQ(NumberSet(LargestComponent(mask)), 2u * 12 * 12 * 12 + 6 * 4);
  for (int z = 0; z < 18; ++z)
  {
    for (int y = 0; y < 18; ++y)
    {
      for (int x = 0; x < 36; ++x)
      {
        const bool set = opened->GetPixel({ { x, y, z } }) != 0;
        ASSERT_TRUE(!set || mask->GetPixel({ { x, y, z } }));
        // A voxel of the bridge beside a block lies in a ball that the block holds but for its rim.
        ASSERT_TRUE(!set || isBlock(x, y, z)) << x << ' ' << y << ' ' << z;
      }
    }
  }
  // Faces stay; edges and corners of blocks are rounded.
  EXPECT_EQ(opened->GetPixel({ { 9, 3, 9 } }), 1);
  EXPECT_EQ(opened->GetPixel({ { 3, 3, 3 } }), 0);
  EXPECT_EQ(NumberDifferent(Open(opened, 4), opened), 0u);
}

TEST(Open, TheMaskGoesOnBeyondTheBorder)
{
  // A layer of 2 r + 1 voxels holds the ball; at the border of the volume half of it is enough.
  const auto remains = [](int first, int layers)
  {
    const MaskImage::Pointer mask = MadeUpImage<MaskImage>({ 12, 12, 12 }, { 2, 2, 2 },
      [&](int, int y, int) { return y >= first && y < first + layers ? 1 : 0; });
    const MaskImage::Pointer opened = Open(mask, 4);
    const bool same = NumberDifferent(opened, mask) == 0;
    EXPECT_TRUE(same || NumberSet(opened) == 0) << first << ' ' << layers;
    return same;
  };
  EXPECT_TRUE(remains(0, 3));
  EXPECT_FALSE(remains(0, 2));
  EXPECT_TRUE(remains(9, 3));
  EXPECT_FALSE(remains(10, 2));
  EXPECT_TRUE(remains(4, 5));
  EXPECT_FALSE(remains(4, 4));
}

TEST(Complement, OfTheComplementIsTheMask)
{
  const MaskImage::Pointer mask = SpeckledMask();
  const MaskImage::Pointer other = Complement(mask);
  EXPECT_EQ(NumberSet(mask) + NumberSet(other), CountOf(*mask));
  EXPECT_EQ(NumberDifferent(mask, other), CountOf(*mask));
  EXPECT_EQ(NumberDifferent(Complement(other), mask), 0u);
}

TEST(ValuesIn, AreThoseOfTheMaskInOrder)
{
  const FloatImage::Pointer image = MadeUpImage<FloatImage>({ 3, 2, 2 }, { 1, 1, 1 },
    [](int x, int y, int z) { return x + 10 * y + 100 * z; });
  const MaskImage::Pointer mask = MadeUpImage<MaskImage>({ 3, 2, 2 }, { 1, 1, 1 },
    [](int x, int y, int) { return x + y == 2 ? 1 : 0; });
  EXPECT_THAT(ValuesIn(image, mask), testing::ElementsAre(2, 11, 102, 111));
}
}
