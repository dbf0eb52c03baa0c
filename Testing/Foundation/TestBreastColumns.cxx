// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/MammographyGeometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace
{
using namespace mammoray;

/// Fat (1) in front of muscle (2, held) that ends at y = -40, as high over it as `height` says of
/// lateral x and superior z; 2 mm voxels, RAS.
LabelVolume Body(const std::function<double(double, double)>& height)
{
  return test::LabelledCube(90, 2,
    [&](const Vector3& p) {
      return p[1] > -40 + height(p[0], p[2]) ? 0 : p[1] > -40 ? 1 : p[1] > -70 ? 2 : 0;
    });
}

Vector3 AnchorOf(const LabelVolume& volume)
{
  return FindPoseFrame(volume, { false, false, true }, AnatomicalAxes::FromCode("RAS")).Anchor;
}

/// Half an ellipsoid about (x, z) of half axes 40, 60 and 45 mm.
double Dome(double x, double z)
{
  return 60 * std::sqrt(std::max(0.0, 1 - x * x / 1600 - z * z / 2025));
}

TEST(BreastColumns, ABreastAloneCountsAsAWhole)
{
  LabelVolume volume = Body([](double x, double z) { return Dome(x - 13, z + 21); });
  for (std::uint16_t& voxel : volume.Voxels)
  {
    voxel = voxel == 2 ? 0 : voxel; // what is not behind the breast was no part of it
  }
  const Vector3 anchor = AnchorOf(volume);
  EXPECT_NEAR(anchor[0], 13, 1.01);
  EXPECT_NEAR(anchor[2], -21, 1.01);
}

TEST(BreastColumns, FlatTissueArmpitBellyAndTheOtherBreastDoNotCount)
{
  // 15 mm of fat all over, a second, lower breast, a belly below and a shoulder above.
  const auto height = [](double x, double z)
  {
    return std::max({ 15.0, 15 + Dome(x - 25, z - 5), 5 + Dome(x + 60, z - 5), 40.0 - (z + 88),
      45.0 - 1.5 * (88 - z) });
  };
  const Vector3 anchor = AnchorOf(Body(height));
  // The dome's slope counts until 3/8 of its height from where it is a quarter as high.
  EXPECT_NEAR(anchor[0], 25, 8);
  EXPECT_NEAR(anchor[1], -40, 1.01);
  EXPECT_NEAR(anchor[2], 5, 8);
}

TEST(BreastColumns, PosesStandSquareOnTheChestWall)
{
  // The wall comes forward by 0.3 mm per mm to the patient's right (x) and by 0.2 per mm to her
  // feet.
  const LabelVolume volume = test::LabelledCube(90, 2,
    [&](const Vector3& p)
    {
      const double wall = -30 + 0.3 * p[0] - 0.2 * p[2];
      return p[1] > wall + Dome(p[0] - 3, p[2] + 5) ? 0
        : p[1] > wall                               ? 1
        : p[1] > wall - 20                          ? 2
                                                    : 0;
    });
  const PoseFrame frame =
    FindPoseFrame(volume, { false, false, true }, AnatomicalAxes::FromCode("RAS"));
  const Vector3 square = (1 / std::sqrt(1.13)) * Vector3{ -0.3, 1, 0.2 };
  const auto& [left, anterior, superior] = frame.Axes;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    // Voxels of 2 mm over 80 mm.
    EXPECT_NEAR(anterior[axis], square[axis], 0.01) << axis;
  }
  // A rotation by the shortest way: about an axis in the frontal plane.
  EXPECT_NEAR(Norm(left), 1, 1e-12);
  EXPECT_NEAR(Norm(Cross(left, superior) - anterior), 0, 1e-12);
  EXPECT_NEAR(left[2], -superior[0], 1e-12);
  // The anchor lies on the wall, to a voxel.
  const Vector3 onWall{ frame.Anchor[0], -30 + 0.3 * frame.Anchor[0] - 0.2 * frame.Anchor[2],
    frame.Anchor[2] };
  EXPECT_NEAR(Dot(frame.Anchor - onWall, anterior), 0, 2);
  // What nothing holds has no wall to stand on.
  EXPECT_EQ(FindPoseFrame(volume, {}, AnatomicalAxes::FromCode("RAS")).Axes.Anterior,
    AnatomicalAxes::FromCode("RAS").Anterior);
}

TEST(BreastColumns, WhatIsNoBreastBecomesAir)
{
  const auto flat = [](double, double) { return 15.0; };
  const LabelVolume body =
    Body([&](double x, double z) { return flat(x, z) + Dome(x - 25, z - 5); });
  const std::vector<bool> held{ false, false, true };
  const AnatomicalAxes axes = AnatomicalAxes::FromCode("RAS");
  const LabelVolume kept = KeepBreast(body, held, axes);
  // Columns begin at the edge of the tissue that is there, and are 3 mm wide.
  EXPECT_LE(Norm(AnchorOf(kept) - AnchorOf(body)), 0.5);
  for (std::size_t voxel = 0; voxel < kept.Voxels.size(); ++voxel)
  {
    const auto i = static_cast<int>(voxel % 90);
    const auto j = static_cast<int>(voxel / 90 % 90);
    const auto k = static_cast<int>(voxel / 8100);
    const Vector3 p = kept.PointAt(i, j, k);
    const double way = std::hypot((p[0] - 25) / 40, (p[2] - 5) / 45);
    // All of the dome and what lies behind it; nothing that is farther than the slope of a breast.
    if (way < 0.98)
    {
      ASSERT_EQ(kept.Voxels[voxel], body.Voxels[voxel]);
    }
    else if (way > 2)
    {
      ASSERT_EQ(kept.Voxels[voxel], 0);
    }
  }
  LabelVolume air = body;
  air.Voxels.assign(air.Voxels.size(), 0);
  EXPECT_THROW(KeepBreast(air, held, axes), InputError);
}

TEST(BreastColumns, TwoBreastsAreToldFromOne)
{
  const std::vector<bool> held{ false, false, true };
  const AnatomicalAxes axes = AnatomicalAxes::FromCode("RAS");
  const auto midline = [&](const std::function<double(double, double)>& height)
  { return MidlineBetweenBreasts(Body(height), held, axes); };
  // Side by side, of two sizes and heights along the body, on 15 mm of fat; in RAS left is -x.
  const auto both = [](double x, double z) {
    return std::max({ 15.0, 15 + Dome(x - 48, z), 10 + 0.7 * Dome(x + 40, z - 12) });
  };
  const std::optional<double> between = midline(both);
  ASSERT_TRUE(between.has_value());
  EXPECT_NEAR(*between, -4, 4);
  // Turned about the body's axis: what was left is right.
  EXPECT_NEAR(midline([&](double x, double z) { return both(-x, z); }).value(), 4, 4);
  // One, alone and with a belly, an armpit's fold and the foot of the other one beside it.
  EXPECT_FALSE(midline([](double x, double z) { return Dome(x, z); }).has_value());
  EXPECT_FALSE(midline(
    [](double x, double z)
    {
      return std::max({ 15.0, 15 + Dome(x - 25, z - 5), 60.0 - (z + 88), 45.0 - 1.5 * (88 - z),
        15 + 0.3 * Dome(x + 60, z - 60), 40.0 - 1.5 * (x + 88) });
    }).has_value());
  // One above the other are no two breasts.
  EXPECT_FALSE(midline(
    [](double x, double z) {
      return std::max({ 15.0, 15 + Dome(x, z - 42), 15 + Dome(x - 9, z + 45) });
    }).has_value());
}

TEST(BreastColumns, StrayVoxelsOfMuscleMoveNothing)
{
  const auto height = [](double x, double z) { return std::max(15.0, 15 + Dome(x, z)); };
  const LabelVolume plain = Body(height);
  LabelVolume ragged = plain;
  std::mt19937 generator(2);
  for (std::size_t voxel = 0; voxel < ragged.Voxels.size(); ++voxel)
  {
    // Fat among the muscle near its front; specks of muscle in the breast's base.
    const int y = static_cast<int>(voxel / 90 % 90);
    if (ragged.Voxels[voxel] == 2 && y > 20 && generator() % 4 == 0)
    {
      ragged.Voxels[voxel] = 1;
    }
  }
  const Vector3 difference = AnchorOf(ragged) - AnchorOf(plain);
  EXPECT_LE(Norm(difference), 6);
}
}
