// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "mammoray/Meshing/Private/LabelField.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace
{
using namespace mammoray;

/// Part of random points in the whole volume that are of a material.
double SharedVolume(const LabelField& field, const LabelVolume& volume, int material)
{
  std::mt19937 generator(9);
  std::uniform_real_distribution<double> unit(0, 1);
  constexpr int points = 200000;
  int hits = 0;
  for (int point = 0; point < points; ++point)
  {
    const double x = unit(generator) * (volume.Size[0] - 1) * volume.Spacing[0];
    const double y = unit(generator) * (volume.Size[1] - 1) * volume.Spacing[1];
    const double z = unit(generator) * (volume.Size[2] - 1) * volume.Spacing[2];
    hits += field.MaterialAt(x, y, z) == material ? 1 : 0;
  }
  return static_cast<double>(hits) / points * (volume.Size[0] - 1) * (volume.Size[1] - 1) *
    (volume.Size[2] - 1) * volume.VoxelVolume();
}

TEST(LabelField, VoxelCentresKeepTheirMaterial)
{
  LabelVolume mosaic = test::Mosaic(16, 1, 8, 80, 5, 4);
  mosaic.Spacing = { 0.6, 1, 1.7 };
  for (const double smoothing : { 0.0, 0.5, 1.0, 2.0 })
  {
    const LabelField field(mosaic, smoothing);
    // Those at the border are air's margin in use, and not balanced.
    for (int k = 1; k < 15; ++k)
    {
      for (int j = 1; j < 15; ++j)
      {
        for (int i = 1; i < 15; ++i)
        {
          ASSERT_EQ(field.MaterialAt(0.6 * i, 1.0 * j, 1.7 * k),
            mosaic.Voxels[mosaic.Index(i, j, k)])
            << smoothing << ' ' << i << ' ' << j << ' ' << k;
        }
      }
    }
  }
}

TEST(LabelField, ThinLayersAndSinglePartsAreNotBlurredAway)
{
  // A layer one voxel thick, and one voxel alone.
  const LabelVolume volume = test::LabelledCube(21, 1,
    [](const Vector3& p) {
      return p[2] == 4 ? 2 : Norm(p - Vector3{ 0, 0, -4 }) < 0.5 ? 3 : 1;
    });
  const LabelField field(volume, 2);
  EXPECT_EQ(field.MaterialAt(10, 10, 14), 2);
  EXPECT_EQ(field.MaterialAt(10, 10, 6), 3);
  // Between the centres of a layer there is the layer, too.
  EXPECT_EQ(field.MaterialAt(10.5, 10.5, 14), 2);
  EXPECT_EQ(field.MaterialAt(10, 10, 15), 1);
}

TEST(LabelField, OutsideIsAir)
{
  const LabelVolume full = test::LabelledCube(4, 2, [](const Vector3&) { return 7; });
  const LabelField field(full, 1);
  EXPECT_EQ(field.MaterialAt(3, 3, 3), 7);
  EXPECT_EQ(field.MaterialAt(0, 0, 0), 7);
  EXPECT_EQ(field.MaterialAt(6, 6, 6), 7); // the last centre
  EXPECT_EQ(field.MaterialAt(6.01, 3, 3), 0);
  EXPECT_EQ(field.MaterialAt(3, -0.01, 3), 0);
  EXPECT_EQ(field.MaterialAt(3, 3, std::nan("")), 0);
}

TEST(LabelField, APlaneStaysAPlane)
{
  // Half 1, half 2, the face between the centres 9 and 10.
  const LabelVolume halves =
    test::LabelledCube(20, 0.5, [](const Vector3& p) { return p[0] < 0 ? 1 : 2; });
  for (const double smoothing : { 0.0, 1.0, 2.0 })
  {
    const LabelField field(halves, smoothing);
    std::mt19937 generator(1);
    std::uniform_real_distribution<double> across(1, 8);
    for (int n = 0; n < 500; ++n)
    {
      const double y = across(generator);
      const double z = across(generator);
      // The face lies at 4.75 mm; rounding of floats, and of the balance of volumes (0.02).
      EXPECT_EQ(field.MaterialAt(4.72, y, z), 1) << smoothing;
      EXPECT_EQ(field.MaterialAt(4.78, y, z), 2) << smoothing;
    }
  }
}

TEST(LabelField, KeepsVolumesAndSmoothsTheSurface)
{
  const LabelVolume ball =
    test::LabelledCube(32, 1, [](const Vector3& p) { return Norm(p) < 10 ? 1 : 0; });
  const double volume = static_cast<double>(ball.CountLabels()[1]);
  for (const double smoothing : { 0.5, 1.0, 2.0 })
  {
    const LabelField field(ball, smoothing);
    // Blurring alone shrinks the ball by its curvature: sigma^2 / 10 mm, 12 % at 2 voxels. Points:
    // 200000 of 29791 mm3, 0.7 % of the ball.
    EXPECT_NEAR(SharedVolume(field, ball, 1) / volume, 1, 0.02) << smoothing;
  }
  // The stairs of the voxels: how far from the sphere the surface lies along rays, in voxels.
  const LabelField rough(ball, 0);
  const LabelField smooth(ball, 1);
  const auto roughness = [](const LabelField& field)
  {
    double sum = 0;
    for (int n = 0; n < 400; ++n)
    {
      // Rays all over, by the golden angle.
      const double up = 1 - (2 * n + 1) / 400.0;
      const double angle = n * std::numbers::pi * (3 - std::sqrt(5.0));
      const double flat = std::sqrt(1 - up * up);
      double r = 5;
      while (field.MaterialAt(15.5 + r * flat * std::cos(angle), 15.5 + r * flat * std::sin(angle),
               15.5 + r * up) == 1)
      {
        r += 0.01;
      }
      sum += (r - 10) * (r - 10);
    }
    return std::sqrt(sum / 400);
  };
  EXPECT_LT(roughness(smooth), 0.25);
  EXPECT_LT(roughness(smooth), roughness(rough));
}
}
