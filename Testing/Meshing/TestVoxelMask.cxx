// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "Private/VoxelMask.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

namespace
{
using namespace mammoray;

double VolumeOf(const VoxelMask& mask)
{
  return mask.VoxelVolume() * std::accumulate(mask.Voxels.begin(), mask.Voxels.end(), 0.0);
}

/// A slab 20 mm thick, on it a sheet 3 mm thick and 12 mm high, and beside it a crumb.
VoxelMask SlabWithSheet()
{
  return test::LabelledCube(64, 1,
    [](const Vector3& p)
    {
      const bool slab = std::abs(p[0]) < 24 && std::abs(p[1]) < 24 && p[2] > -20 && p[2] < 0;
      const bool sheet = std::abs(p[0]) < 24 && std::abs(p[1]) < 1.6 && p[2] >= 0 && p[2] < 12;
      return slab || sheet || Norm(p - Vector3{ 0, 12, 15 }) < 3 ? 1 : 0;
    });
}

TEST(VoxelMask, FractionsOfVoxelsAddUpOnAnyGrid)
{
  std::mt19937 generator(3);
  LabelVolume labels = test::LabelledCube(7, 1, [&](const Vector3&) { return generator() % 3; });
  labels.Spacing = { 0.7, 1.0, 3.0 };
  VolumeGrid grid = labels;
  grid.Spacing = { 1.3, 1.3, 1.3 };
  grid.Size = { 8, 9, 20 };
  grid.Origin = labels.PointAt(-2.3, -1.7, -1.1);
  const VoxelField field = FractionOf(
    labels, [](std::uint16_t label) { return label == 2; }, grid);
  const double sum = std::accumulate(field.Values.begin(), field.Values.end(), 0.0);
  const double wanted = static_cast<double>(labels.CountLabels()[2]) * labels.VoxelVolume();
  // The grid covers the volume; sums of floats.
  EXPECT_NEAR(sum * grid.VoxelVolume(), wanted, 1e-4 * wanted);
  for (const float value : field.Values)
  {
    EXPECT_GE(value, 0.0f);
    EXPECT_LE(value, 1.0f + 1e-6f);
  }
}

TEST(VoxelMask, BlurredStepIsTheErrorFunction)
{
  VoxelField field;
  field.Size = { 81, 1, 1 };
  field.Spacing = { 0.5, 0.5, 0.5 };
  field.Values.assign(81, 0.0f);
  std::fill(field.Values.begin() + 41, field.Values.end(), 1.0f);
  BlurField(field, 3.0);
  for (int n = 20; n <= 60; ++n)
  {
    const double away = 0.5 * (n - 40.5);
    // Cut at three standard deviations, which leaves 0.3 % out.
    EXPECT_NEAR(field.Values[n], 0.5 * std::erfc(-away / (3 * std::numbers::sqrt2)), 2e-3);
  }
}

TEST(VoxelMask, DistancesAreThoseOfTheNearestVoxel)
{
  std::mt19937 generator(5);
  VoxelMask mask =
    test::LabelledCube(9, 0.6, [&](const Vector3&) { return generator() % 40 == 0; });
  const VoxelField distance = DistanceTo(mask, 1);
  for (std::size_t voxel = 0; voxel < mask.Voxels.size(); ++voxel)
  {
    const auto at = [](std::size_t v) {
      return Vector3{ double(v % 9), double(v / 9 % 9), double(v / 81) };
    };
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t other = 0; other < mask.Voxels.size(); ++other)
    {
      nearest = mask.Voxels[other] ? std::min(nearest, 0.6 * Norm(at(other) - at(voxel))) : nearest;
    }
    EXPECT_NEAR(distance.Values[voxel], nearest, 1e-5);
  }
  mask.Voxels.assign(mask.Voxels.size(), 0);
  EXPECT_TRUE(std::isinf(DistanceTo(mask, 1).Values.front()));
}

TEST(VoxelMask, OpeningTakesSheetsAndCrumbsAndLeavesTheRest)
{
  const VoxelMask mask = SlabWithSheet();
  const VoxelMask opened = OpenedLargest(mask, 4);
  // The slab with its edges rounded: (1 - pi / 4) 4^2 along each of twelve edges, at most.
  const double slab = 48 * 48 * 20;
  EXPECT_LT(VolumeOf(opened), slab);
  EXPECT_GT(VolumeOf(opened), slab - (1 - std::numbers::pi / 4) * 16 * (8 * 48 + 4 * 20) - 100);
  // Without a ball the largest piece as it is.
  EXPECT_EQ(VolumeOf(OpenedLargest(mask, 0)), VolumeOf(LargestPiece(mask)));
}

TEST(VoxelMask, ClosingFillsGapsAndLeavesBalls)
{
  const auto ball = [](const Vector3& p) { return Norm(p) < 12 ? 1 : 0; };
  const VoxelMask whole = test::LabelledCube(48, 1, ball);
  EXPECT_EQ(Closed(whole, 5).Voxels, whole.Voxels);
  const VoxelMask split =
    test::LabelledCube(48, 1, [&](const Vector3& p) { return std::abs(p[0]) < 2 ? 0 : ball(p); });
  EXPECT_LT(VolumeOf(split), 0.85 * VolumeOf(whole));
  // All but a groove along the rim.
  EXPECT_GT(VolumeOf(Closed(split, 5)), 0.95 * VolumeOf(whole));
  EXPECT_LE(VolumeOf(Closed(split, 5)), VolumeOf(whole));
}

TEST(VoxelMask, HolesAreWhatAirDoesNotReach)
{
  const VoxelMask shell =
    test::LabelledCube(30, 1, [](const Vector3& p) { return Norm(p) < 12 && Norm(p) > 8 ? 1 : 0; });
  const VoxelMask ball =
    test::LabelledCube(30, 1, [](const Vector3& p) { return Norm(p) < 12 ? 1 : 0; });
  EXPECT_EQ(WithoutHoles(shell).Voxels, ball.Voxels);
  const VoxelMask open = test::LabelledCube(30, 1,
    [](const Vector3& p)
    { return Norm(p) < 12 && Norm(p) > 8 && !(std::abs(p[1]) < 1 && std::abs(p[2]) < 1) ? 1 : 0; });
  EXPECT_EQ(WithoutHoles(open).Voxels, open.Voxels);
}
}
