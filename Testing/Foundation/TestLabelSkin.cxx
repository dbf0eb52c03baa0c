// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/LabelEditing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

using namespace mammoray;

namespace
{
constexpr std::uint16_t Fat = 1;
constexpr std::uint16_t Skin = 2;
constexpr std::uint16_t Muscle = 3;
const std::vector<bool> Fixed{ false, false, false, true };

LabelVolume Make(const std::array<int, 3>& size, const Vector3& spacing)
{
  LabelVolume volume;
  volume.Size = size;
  volume.Spacing = spacing;
  volume.Origin = { 3, -7, 11 };
  volume.Direction = { { { 0.6, 0.8, 0 }, { -0.8, 0.6, 0 }, { 0, 0, 1 } } };
  volume.Voxels.assign(static_cast<std::size_t>(size[0]) * size[1] * size[2], 0);
  return volume;
}

template <typename LabelOf>
void Fill(LabelVolume& volume, LabelOf labelOf)
{
  for (int k = 0; k < volume.Size[2]; ++k)
  {
    for (int j = 0; j < volume.Size[1]; ++j)
    {
      for (int i = 0; i < volume.Size[0]; ++i)
      {
        volume.Voxels[volume.Index(i, j, k)] = labelOf(i, j, k);
      }
    }
  }
}
}

TEST(LabelSkin, ShellOfABallHasItsVolume)
{
  // Anisotropic and oblique; the middle of the volume is the ball's.
  LabelVolume volume = Make({ 101, 81, 51 }, { 0.4, 0.5, 0.8 });
  const Vector3 middle = volume.PointAt(50, 40, 25);
  constexpr double radius = 17;
  Fill(volume,
    [&](int i, int j, int k)
    { return Norm(volume.PointAt(i, j, k) - middle) <= radius ? Fat : 0; });
  for (const double thickness : { 0.8, 1.5, 3.0, 5.0 })
  {
    const LabelVolume result = AddSkin(volume, thickness, Skin, Fixed);
    const double inner = radius - thickness;
    const double shell = 4.0 / 3.0 * std::numbers::pi * (std::pow(radius, 3) - std::pow(inner, 3));
    const double found = static_cast<double>(result.CountLabels().at(Skin)) * volume.VoxelVolume();
    // 0.12 mm of thickness all over, a quarter of the voxels: how far their stairs are from the
    // ball.
    const double area = 4 * std::numbers::pi * std::pow(0.5 * (radius + inner), 2);
    EXPECT_NEAR(found, shell, 0.12 * area) << thickness;
  }
}

TEST(LabelSkin, LayersOfABoxAreExact)
{
  // Depths along the axes are (n + 3/4) voxels: 2 of 0.5 mm are at most 1.3 mm deep, 1 of 1.25 mm
  // and 5 of 0.25 mm. Nothing is deeper below an edge or a corner than below a face.
  LabelVolume volume = Make({ 24, 14, 40 }, { 0.5, 1.25, 0.25 });
  Fill(volume,
    [](int i, int j, int k)
    { return i >= 2 && i < 22 && j >= 2 && j < 12 && k >= 2 && k < 38 ? Fat : 0; });
  const LabelVolume result = AddSkin(volume, 1.3, Skin, Fixed);
  LabelVolume expected = volume;
  Fill(expected,
    [&](int i, int j, int k) -> std::uint16_t
    {
      const bool inside = i >= 4 && i < 20 && j >= 3 && j < 11 && k >= 7 && k < 33;
      return volume.Voxels[volume.Index(i, j, k)] == 0 ? 0 : inside ? Fat : Skin;
    });
  EXPECT_EQ(result.Voxels, expected.Voxels);
  // What is skin already counts.
  EXPECT_EQ(AddSkin(result, 1.3, Skin, Fixed).Voxels, result.Voxels);
}

TEST(LabelSkin, NoneAtTheBordersHeldTissueAndHoles)
{
  // Fat on muscle, both cut by five faces of the volume; a hole in the fat, air behind the muscle.
  LabelVolume volume = Make({ 10, 20, 10 }, { 1, 1, 1 });
  Fill(volume,
    [](int i, int j, int k) -> std::uint16_t
    {
      const bool hole = i == 5 && j == 8 && k == 5;
      return j < 2 || j >= 14 || hole ? 0 : j < 4 ? Muscle : Fat;
    });
  const LabelVolume result = AddSkin(volume, 3, Skin, Fixed);
  LabelVolume expected = volume;
  Fill(expected,
    [&](int i, int j, int k) -> std::uint16_t
    { return j >= 11 && j < 14 ? Skin : volume.Voxels[volume.Index(i, j, k)]; });
  // The air behind two millimetres of muscle is within three of the fat, but not its air.
  EXPECT_EQ(result.Voxels, expected.Voxels);
}

TEST(LabelSkin, DepthIsTheDistanceToTheNearestAir)
{
  // Random tissue against a search over all air that touches tissue.
  std::mt19937 generator(5);
  for (int round = 0; round < 10; ++round)
  {
    LabelVolume volume = Make({ 9, 8, 7 }, { 0.7, 1.1, 1.9 });
    Fill(volume, [&](int, int, int) -> std::uint16_t { return generator() % 5 == 0 ? 0 : Fat; });
    constexpr double reach = 2.5;
    const std::vector<float> depth = DepthBelowAir(volume, reach, Fixed);
    // Every air voxel at the border is outer air; compare where no other one matters.
    Fill(volume,
      [&](int i, int j, int k) -> std::uint16_t
      {
        const bool border = i == 0 || j == 0 || k == 0 || i == 8 || j == 7 || k == 6;
        return border ? volume.Voxels[volume.Index(i, j, k)] : Fat;
      });
    const std::vector<float> outer = DepthBelowAir(volume, reach, Fixed);
    for (int k = 0; k < 7; ++k)
    {
      for (int j = 0; j < 8; ++j)
      {
        for (int i = 0; i < 9; ++i)
        {
          double least = std::numeric_limits<double>::infinity();
          for (std::size_t air = 0; air < volume.Voxels.size(); ++air)
          {
            if (volume.Voxels[air] == 0)
            {
              const int other[3] = { static_cast<int>(air % 9), static_cast<int>(air / 9 % 8),
                static_cast<int>(air / 72) };
              const int here[3] = { i, j, k };
              double square = 0;
              for (int a = 0; a < 3; ++a)
              {
                const double way = std::max(0.0, std::abs(other[a] - here[a]) - 0.25);
                square += way * way * volume.Spacing[a] * volume.Spacing[a];
              }
              least = std::min(least, std::sqrt(square));
            }
          }
          const float found = outer[volume.Index(i, j, k)];
          if (least <= reach)
          {
            EXPECT_NEAR(found, least, 1e-6); // floats
          }
          else
          {
            EXPECT_EQ(found, std::numeric_limits<float>::infinity());
          }
          // Air further in only makes depths smaller.
          EXPECT_LE(depth[volume.Index(i, j, k)], found);
        }
      }
    }
  }
}

TEST(LabelSkin, RefusesWhatMakesNoClosedLayer)
{
  LabelVolume volume = Make({ 4, 4, 4 }, { 1, 1, 2 });
  volume.Voxels.assign(64, Fat);
  for (const double thickness :
    { 1.9, 0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity() })
  {
    EXPECT_THROW(AddSkin(volume, thickness, Skin, Fixed), InputError) << thickness;
  }
  EXPECT_THROW(AddSkin(volume, 2, 0, Fixed), InputError);
  EXPECT_THROW(AddSkin(volume, 2, Muscle, Fixed), InputError);
  EXPECT_EQ(AddSkin(volume, 2, Skin, Fixed).Voxels, volume.Voxels); // no air
}
