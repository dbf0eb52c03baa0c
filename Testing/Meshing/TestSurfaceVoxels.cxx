// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "Refusals.h"
#include "SurfaceShapes.h"
#include "mammoray/Meshing/LabelMesher.h"
#include "mammoray/Meshing/MeshCheck.h"
#include "mammoray/Meshing/SurfaceMesher.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

using mammoray::test::RefusalOf;
using namespace mammoray;
using namespace shapes;
using namespace mammoray::test;

TEST(SurfaceVoxels, OverlappingPiecesAreJoined)
{
  // Rows of voxels run exactly through edges, corners and diagonals of the second box.
  SurfaceMesh surfaces;
  AddBox(surfaces, { 0, 0, 0 }, { 4, 4, 4 }, 1);
  AddBox(surfaces, { 2.5, 2.5, 2.5 }, { 6.5, 6.5, 6.5 }, 1);
  const LabelVolume grid = LabelSurfaces(surfaces, 1);
  EXPECT_EQ(grid.Size, (std::array<int, 3>{ 9, 9, 9 }));
  // Centres 0.5 to 3.5 and 2.5 to 5.5: 64 voxels each, 8 of them in both.
  EXPECT_EQ(grid.CountLabels().at(1), 120u);
  EXPECT_EQ(grid.LabelAt({ 3.5, 3.5, 3.5 }), 1);
  EXPECT_EQ(grid.LabelAt({ 5.5, 3.5, 0.5 }), 0);

  const MeshingResult result = MeshMaterials(grid, MeshingOptions::Anatomy({}));
  EXPECT_TRUE(CheckMesh(result.Mesh).Sound());
  EXPECT_EQ(result.Components, 1u);
}

TEST(SurfaceVoxels, TheMaterialThatEnclosesLeastCounts)
{
  SurfaceMesh surfaces;
  AddBox(surfaces, { 2, 2, 2 }, { 5, 5, 5 }, 2);
  AddBox(surfaces, { 0, 0, 0 }, { 9, 9, 9 }, 1);
  AddBox(surfaces, { 6, 6, 6 }, { 8, 8, 8 }, 0, 1); // a cavity of the outer one
  const std::map<int, std::size_t> counts = LabelSurfaces(surfaces, 0.5).CountLabels();
  // Volumes in voxels of 0.125 mm^3.
  EXPECT_EQ(counts.at(2), 8u * 27);
  EXPECT_EQ(counts.at(1), 8u * (729 - 27 - 8));
}

TEST(SurfaceVoxels, SpheresThatCutEachOther)
{
  const Vector3 centres[3] = { { 0, 0, 0 }, { 3, 1, -2 }, { -1, 4, 2.5 } };
  constexpr double radius = 5;
  SurfaceMesh surfaces;
  for (const Vector3& centre : centres)
  {
    AddSphere(surfaces, centre, radius, 4, 3);
  }
  const LabelVolume grid = LabelSurfaces(surfaces, 0.3);
  std::size_t compared = 0;
  for (int k = 0; k < grid.Size[2]; ++k)
  {
    for (int j = 0; j < grid.Size[1]; ++j)
    {
      for (int i = 0; i < grid.Size[0]; ++i)
      {
        double depth = -1e9;
        for (const Vector3& centre : centres)
        {
          depth = std::max(depth, radius - Norm(grid.PointAt(i, j, k) - centre));
        }
        // Triangles of the sphere lie within 0.03 mm of it.
        if (std::abs(depth) > 0.03)
        {
          ++compared;
          ASSERT_EQ(grid.Voxels[grid.Index(i, j, k)], depth > 0 ? 3 : 0)
            << i << ' ' << j << ' ' << k;
        }
      }
    }
  }
  EXPECT_GT(compared, 20000u);
}

TEST(SurfaceVoxels, RefusesWhatItCannotLabel)
{
  SurfaceMesh surfaces;
  AddBox(surfaces, { 0, 0, 0 }, { 4, 4, 4 }, 1);
  for (const double size : { 0.0, -1.0, std::nan("") })
  {
    EXPECT_THAT(RefusalOf([&] { LabelSurfaces(surfaces, size); }),
      test::Mentions("voxels", "positive"));
  }
  EXPECT_THAT(RefusalOf([&] { LabelSurfaces(surfaces, 1e-3); }), test::Mentions("1e9", "0.001 mm"));
  surfaces.Triangles.resize(surfaces.Triangles.size() - 3);
  surfaces.FrontMaterials.pop_back();
  surfaces.BackMaterials.pop_back();
  EXPECT_THAT(RefusalOf([&] { LabelSurfaces(surfaces, 1); }), test::Mentions("closed", "1 holes"));
}
