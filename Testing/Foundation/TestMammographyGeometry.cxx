// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/MammographyGeometry.h"

#include <gtest/gtest.h>

using namespace mammoray;

namespace
{
void ExpectNear(const Vector3& a, const Vector3& b)
{
  for (int d = 0; d < 3; ++d)
  {
    EXPECT_NEAR(a[d], b[d], 1e-12) << "component " << d;
  }
}
}

TEST(AnatomicalAxes, CodesAreReadAsDirectionsOfTheAxes)
{
  const AnatomicalAxes als = AnatomicalAxes::FromCode("ALS");
  ExpectNear(als.Anterior, { 1, 0, 0 });
  ExpectNear(als.Left, { 0, 1, 0 });
  ExpectNear(als.Superior, { 0, 0, 1 });
  const AnatomicalAxes lps = AnatomicalAxes::FromCode("LPS");
  ExpectNear(lps.Left, AnatomicalAxes{}.Left);
  ExpectNear(lps.Anterior, AnatomicalAxes{}.Anterior);
  ExpectNear(AnatomicalAxes::FromCode("RAS").Left, { -1, 0, 0 });
  for (const char* bad : { "", "LP", "LPP", "LLS", "XYZ", "LPSI", "lps" })
  {
    EXPECT_THROW(AnatomicalAxes::FromCode(bad), InputError) << bad;
  }
}

TEST(PlaceUnit, CranioCaudalViewLooksFromAbove)
{
  const AnatomicalAxes axes; // LPS
  MammographyUnit unit;
  unit.SourceToDetectorMm = 650;
  unit.SupportHeightMm = 2;
  BreastPose pose;
  pose.ThicknessMm = 50;
  const Vector3 anchor{ 5, 6, 7 };
  const VolumeFromGantry placed = PlaceUnit({ axes, anchor }, unit, pose);
  // The plates' mid-plane (z = 2 + 25) passes through the anchor.
  ExpectNear(placed.Point({ 0, 0, 27 }), anchor);
  ExpectNear(placed.Direction({ 1, 0, 0 }), { 1, 0, 0 });
  ExpectNear(placed.Direction({ 0, 1, 0 }), { 0, -1, 0 });
  ExpectNear(placed.Direction({ 0, 0, 1 }), { 0, 0, 1 });
  ExpectNear(placed.ToGantry(placed.Point({ 1, 2, 3 })), { 1, 2, 3 });
}

TEST(PlaceUnit, PositiveRollTurnsTheSourceTowardsTheLeft)
{
  BreastPose pose;
  pose.RollDeg = 90;
  pose.LateralMm = 3;
  const AnatomicalAxes axes;
  const VolumeFromGantry placed = PlaceUnit({ axes, { 0, 0, 0 } }, MammographyUnit{}, pose);
  ExpectNear(placed.Z, axes.Left);
  ExpectNear(placed.X, -1.0 * axes.Superior);
  EXPECT_NEAR(placed.ToGantry({ 0, 0, 0 })[0], -3, 1e-12);
}

TEST(PlaceUnit, TheFrameOfAPlacedUnitIsThatOfItsPose)
{
  const PoseFrame frame{ AnatomicalAxes::FromCode("ALS"), { 5, -6, 7 } };
  MammographyUnit unit;
  unit.SupportHeightMm = 13;
  const BreastPose pose{ .ThicknessMm = 47,
    .RollDeg = 48,
    .PitchDeg = -7,
    .YawDeg = 11,
    .LateralMm = 9,
    .AnteriorMm = -4,
    .VerticalMm = 3 };
  const PoseFrame found = FrameOf(PlaceUnit(frame, unit, pose), unit, pose);
  ExpectNear(found.Axes.Left, frame.Axes.Left);
  ExpectNear(found.Axes.Anterior, frame.Axes.Anterior);
  ExpectNear(found.Axes.Superior, frame.Axes.Superior);
  ExpectNear(found.Anchor, frame.Anchor);
}

TEST(FindPoseFrame, UsesTheFrontOfTheHeldTissue)
{
  LabelVolume volume;
  volume.Size = { 6, 4, 2 }; // ALS axes: i anterior, j left, k superior
  volume.Spacing = { 2, 1, 1 };
  volume.Voxels.assign(48, 0);
  for (int k = 0; k < 2; ++k)
  {
    for (int j = 1; j < 4; ++j)
    {
      for (int i = 0; i < 5; ++i)
      {
        volume.Voxels[volume.Index(i, j, k)] = i < 2 ? 2 : 1;
      }
    }
  }
  const AnatomicalAxes axes = AnatomicalAxes::FromCode("ALS");
  // Held voxels end at i = 1: 2 mm + half a voxel. Tissue spans j = 0.5 ... 3.5, k = -0.5 ... 1.5.
  ExpectNear(FindPoseFrame(volume, { false, false, true }, axes).Anchor, { 3, 2, 0.5 });
  ExpectNear(FindPoseFrame(volume, { false, false, false }, axes).Anchor, { -1, 2, 0.5 });
  volume.Voxels.assign(48, 0);
  EXPECT_THROW(FindPoseFrame(volume, {}, axes), InputError);
}
