// SPDX-License-Identifier: Apache-2.0
#include "SurfaceMeasures.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/LabelSurface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace
{
using namespace mammoray;
using test::IsClosed;
using test::MaterialVolumes;

/// Two cells of 2 x 3 x 4 mm side by side along i, of materials 1 and 2.
LabelVolume TwoVoxels()
{
  LabelVolume volume;
  volume.Size = { 2, 1, 1 };
  volume.Spacing = { 2, 3, 4 };
  volume.Voxels = { 1, 2 };
  return volume;
}

/// A ball of material 2, radius 9 voxels, in a cube of material 1.
LabelVolume BallInCube()
{
  LabelVolume volume;
  volume.Size = { 30, 30, 30 };
  for (int k = 0; k < 30; ++k)
  {
    for (int j = 0; j < 30; ++j)
    {
      for (int i = 0; i < 30; ++i)
      {
        const double squared =
          std::pow(i - 14.5, 2) + std::pow(j - 14.5, 2) + std::pow(k - 14.5, 2);
        volume.Voxels.push_back(squared < 81 ? 2 : 1);
      }
    }
  }
  return volume;
}
}

TEST(LabelSurface, FacesBetweenVoxelsHaveBothMaterials)
{
  const QuadMesh mesh = ExtractInterfaces(TwoVoxels(), 0);
  EXPECT_EQ(mesh.Quads.size(), 11u); // 2 x 6, one of them shared
  const SurfaceMesh surface = mesh.Triangulate(22);
  EXPECT_TRUE(IsClosed(surface));
  const auto volumes = MaterialVolumes(surface);
  EXPECT_NEAR(volumes[1], 24, 1e-12);
  EXPECT_NEAR(volumes[2], 24, 1e-12);
}

TEST(LabelSurface, LeftHandedGridsKeepTheirSides)
{
  LabelVolume volume = TwoVoxels();
  volume.Direction[2] = { 0, 0, -1 };
  const auto volumes = MaterialVolumes(ExtractInterfaces(volume, 0).Triangulate(22));
  EXPECT_NEAR(volumes[1], 24, 1e-12);
  EXPECT_NEAR(volumes[2], 24, 1e-12);
}

TEST(LabelSurface, EveryEvenCountCanBeHad)
{
  const QuadMesh mesh = ExtractInterfaces(TwoVoxels(), 0);
  for (std::size_t count = 22; count <= 90; count += 2)
  {
    const SurfaceMesh surface = mesh.Triangulate(count);
    ASSERT_EQ(surface.NumberOfTriangles(), count);
    ASSERT_TRUE(IsClosed(surface)) << count;
    ASSERT_NEAR(MaterialVolumes(surface)[1], 24, 1e-12) << count;
  }
  EXPECT_THROW(mesh.Triangulate(23), InputError);
  EXPECT_THROW(mesh.Triangulate(20), InputError);
}

TEST(LabelSurface, SmoothingRoundsWithinTheVoxel)
{
  const LabelVolume volume = BallInCube();
  const QuadMesh rough = ExtractInterfaces(volume, 0);
  const QuadMesh smooth = ExtractInterfaces(volume, 10);
  ASSERT_EQ(rough.Points.size(), smooth.Points.size());
  for (std::size_t point = 0; point < rough.Points.size(); ++point)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      // Half a voxel, and its rounding to float at 30.
      ASSERT_LE(std::abs(smooth.Points[point][axis] - rough.Points[point][axis]), 0.5 + 2e-6);
    }
  }
  const auto spread = [](const QuadMesh& mesh)
  {
    double least = 100;
    double most = 0;
    for (std::size_t quad = 0; quad < mesh.Quads.size(); ++quad)
    {
      if (mesh.FrontMaterials[quad] != 0 && mesh.BackMaterials[quad] != 0)
      {
        const Vector3& point = mesh.Points[mesh.Quads[quad][0]];
        const double radius = Norm(point - Vector3{ 14.5, 14.5, 14.5 });
        least = std::min(least, radius);
        most = std::max(most, radius);
      }
    }
    return most - least;
  };
  EXPECT_GT(spread(rough), 1.0);  // corners of voxels, up to half a diagonal off on either side
  EXPECT_LT(spread(smooth), 0.5); // the ball's own rounding to voxels is what is left
  const SurfaceMesh surface = smooth.Triangulate(2 * smooth.Quads.size());
  EXPECT_TRUE(IsClosed(surface));
  std::size_t voxels = 0;
  for (const std::uint16_t label : volume.Voxels)
  {
    voxels += label == 2 ? 1 : 0;
  }
  // Ten steps of a mean over an edge length h shrink a ball by about 10 h^2 / 4 * 2 / r / 2, 0.28
  // of 9 voxels, 9 % of its volume.
  EXPECT_NEAR(MaterialVolumes(surface)[2], static_cast<double>(voxels), 0.1 * voxels);
}

TEST(LabelSurface, AirAloneIsRefused)
{
  LabelVolume volume = TwoVoxels();
  volume.Voxels = { 0, 0 };
  EXPECT_THROW(ExtractInterfaces(volume, 0), InputError);
}
