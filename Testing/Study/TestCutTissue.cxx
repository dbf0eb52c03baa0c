// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "Refusals.h"
#include "mammoray/Study/LabelSource.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

using namespace mammoray;
using namespace mammoray::test;
using testing::HasSubstr;

namespace
{
MaterialTable FatAndSkin()
{
  MaterialTable table;
  table.Name = "test";
  table.Materials = { { .Name = "air" }, { .Name = "fat" }, { .Name = "skin", .Thin = true },
    { .Name = "muscle", .Fixed = true } };
  return table;
}

/// A ball of radius 18 in a skin of 2 mm, which the plane y = 9 cuts; 1 mm voxels.
int CutBall(const Vector3& p)
{
  return p[1] > 9 || Norm(p) > 20 ? 0 : Norm(p) > 18 ? 2 : 1;
}
}

TEST(CutTissue, GoesOnBehindAPlaneAndNotBehindSkin)
{
  const LabelVolume ball = test::LabelledCube(50, 1, CutBall);
  const MaterialTable table = FatAndSkin();
  const LabelVolume cut = CutTissue(ball, ball, table, GridSides());
  int inside = 0;
  cut.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      const Vector3 at = cut.PointAt(i, j, k);
      // Voxels' middles lie at halves.
      const bool expected = at[1] > 9 && Norm({ at[0], 8.5, at[2] }) <= 18;
      ASSERT_EQ(cut.Voxels[voxel], expected ? 1 : 0) << at[0] << " " << at[1] << " " << at[2];
      inside += expected ? 1 : 0;
    });
  // A cylinder as thick as the cut and 20 mm long; stairs of its border.
  EXPECT_NEAR(inside, M_PI * (18 * 18 - 8.5 * 8.5) * 20, 0.02 * inside);
  // All that touches the other five sides is skin; at one of these nothing was cut.
  const BodyField at = InCutTissue(ball, table, { "j-", "i+" });
  EXPECT_FALSE(at({ 0, -21, 0 }));
  EXPECT_FALSE(at({ 21, 0, 0 }));
  EXPECT_FALSE(at({ 0, 10, 0 }));
  EXPECT_TRUE(InCutTissue(ball, table, { "j+" })({ 0, 10, 0 }));
  EXPECT_FALSE(InCutTissue(ball, table, {}));
}

TEST(CutTissue, IsWhatWasNotKept)
{
  const LabelVolume ball = test::LabelledCube(50, 1, CutBall);
  LabelVolume kept = ball;
  kept.ForEachVoxel([&](int i, int j, int k, std::size_t voxel)
    { kept.Voxels[voxel] = kept.PointAt(i, j, k)[0] > 5 ? 0 : kept.Voxels[voxel]; });
  const LabelVolume cut = CutTissue(ball, kept, FatAndSkin(), {});
  ball.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      const Vector3 at = ball.PointAt(i, j, k);
      ASSERT_EQ(cut.LabelAt(at), at[0] > 5 ? ball.Voxels[voxel] : 0);
    });
}

TEST(CutTissue, RefusesWhatIsNoSideAndNoGridOfItsOwn)
{
  const LabelVolume ball = test::LabelledCube(30, 1, CutBall);
  const MaterialTable table = FatAndSkin();
  EXPECT_THAT(RefusalOf([&] { CutTissue(ball, ball, table, { "x+" }); }),
    HasSubstr("expected i-, i+, j-, j+, k- or k+, found 'x+'"));
  EXPECT_THAT(RefusalOf([&] { CutTissue(ball, test::LabelledCube(20, 1, CutBall), table, {}); }),
    HasSubstr("on one grid"));
  EXPECT_THAT(RefusalOf([&] { InCutTissue(ball, table, { "j" }); }), HasSubstr("found 'j'"));
}
