// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "Refusals.h"
#include "mammoray/Meshing/LabelMesher.h"
#include "mammoray/Meshing/Private/SimulationShape.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace
{
using namespace mammoray;
using test::RefusalOf;
using testing::HasSubstr;

/// Materials of what follows: 1 and 2 move, 3 is held.
const std::vector<bool> OnlyMuscleHeld{ false, false, false, true };

/// A ball of 24 mm; what lies below z = -8 mm is muscle.
int BallOnMuscle(const Vector3& p)
{
  return Norm(p) > 24 ? 0 : p[2] < -8 ? 3 : 1;
}

struct ShapeVolumes
{
  double Moving = 0;
  double Fixed = 0;
  /// The front of what is held, over the middle of the grid, mm in the volume frame.
  double Front = -1e9;
};

ShapeVolumes VolumesOf(const SimulationShape& shape)
{
  ShapeVolumes volumes;
  const LabelVolume& tissue = shape.Tissue;
  std::map<int, std::size_t> counts = tissue.CountLabels();
  volumes.Moving = static_cast<double>(counts[SimulationShape::Moving]) * tissue.VoxelVolume();
  volumes.Fixed = static_cast<double>(counts[SimulationShape::Fixed]) * tissue.VoxelVolume();
  const int i = tissue.Size[0] / 2;
  const int j = tissue.Size[1] / 2;
  for (int k = 0; k < tissue.Size[2]; ++k)
  {
    if (tissue.Voxels[tissue.Index(i, j, k)] == SimulationShape::Fixed)
    {
      volumes.Front = std::max(volumes.Front, tissue.PointAt(i, j, k + 0.5)[2]);
    }
  }
  return volumes;
}

/// The cap of a ball above z, by its radius: pi h^2 (3 r - h) / 3.
double CapVolume(double radius, double z)
{
  const double h = radius - z;
  return std::numbers::pi * h * h * (3 * radius - h) / 3;
}

TEST(SimulationShape, KeepsTheVolumeAndTheBorderOfSmoothBodies)
{
  const LabelVolume body = test::LabelledCube(52, 1, BallOnMuscle);
  const double edge = 6;
  const SimulationShape shape = ShapeForCells(body, OnlyMuscleHeld, edge);
  const double moving = CapVolume(24, -8);
  // Counted voxels of 1 mm: their stairs.
  EXPECT_NEAR(shape.MovingMm3 / moving, 1, 0.01);
  const ShapeVolumes volumes = VolumesOf(shape);
  // The outline keeps its volume; the rim beside the border, rounded by a third of an edge, may go
  // to either side: 2 pi 22 mm x 4 mm2.
  EXPECT_NEAR(volumes.Moving / moving, 1, 0.02);
  // A voxel of the shape, an eighth of an edge, and one of the volume.
  EXPECT_NEAR(volumes.Front, -8, 1.75);
  // Held is as deep as an edge, over a disc of 22.6 mm.
  EXPECT_NEAR(volumes.Fixed / (std::numbers::pi * 22.6 * 22.6 * edge), 1, 0.25);
}

TEST(SimulationShape, LiesOnTheVolumesAxesWhereverTheyPoint)
{
  LabelVolume body = test::LabelledCube(36, 1.5, BallOnMuscle);
  const SimulationShape straight = ShapeForCells(body, OnlyMuscleHeld, 8);
  body.Direction = { { { 0, 0.6, 0.8 }, { 1, 0, 0 }, { 0, 0.8, -0.6 } } };
  body.Origin = { 100, -50, 7 };
  const SimulationShape oblique = ShapeForCells(body, OnlyMuscleHeld, 8);
  EXPECT_EQ(oblique.Tissue.Voxels, straight.Tissue.Voxels);
  EXPECT_EQ(oblique.Tissue.Direction, body.Direction);
  EXPECT_DOUBLE_EQ(oblique.MovingMm3, straight.MovingMm3);
  // Every voxel lies at its own place: the same index in the body, as far as both go.
  const LabelVolume plain = test::LabelledCube(36, 1.5, BallOnMuscle);
  const Vector3 there = body.ContinuousIndex(oblique.Tissue.PointAt(3, 5, 7));
  const Vector3 here = plain.ContinuousIndex(straight.Tissue.PointAt(3, 5, 7));
  EXPECT_LT(Norm(there - here), 1e-9);
}

TEST(SimulationShape, IsCubicOnAnyVoxels)
{
  // The same ball on voxels of 1 x 1.5 x 3 mm.
  LabelVolume body;
  body.Size = { 52, 36, 18 };
  body.Spacing = { 1, 1.5, 3 };
  body.Origin = { -25.5, -26.25, -25.5 };
  for (int k = 0; k < 18; ++k)
  {
    for (int j = 0; j < 36; ++j)
    {
      for (int i = 0; i < 52; ++i)
      {
        body.Voxels.push_back(static_cast<std::uint16_t>(BallOnMuscle(body.PointAt(i, j, k))));
      }
    }
  }
  const SimulationShape shape = ShapeForCells(body, OnlyMuscleHeld, 8);
  EXPECT_EQ(shape.Tissue.Spacing, (Vector3{ 1, 1, 1 }));
  const ShapeVolumes volumes = VolumesOf(shape);
  // The slices of 3 mm.
  EXPECT_NEAR(volumes.Moving / CapVolume(24, -8), 1, 0.05);
  EXPECT_NEAR(volumes.Front, -8, 2.5);
}

TEST(SimulationShape, HolesFlapsAndIslandsDoNotMatter)
{
  const double edge = 6;
  const ShapeVolumes plain =
    VolumesOf(ShapeForCells(test::LabelledCube(60, 1, BallOnMuscle), OnlyMuscleHeld, edge));
  // A cavity of air, a sheet of 1 mm that stands out, a crumb apart, and an island of muscle.
  const ShapeVolumes ragged = VolumesOf(
    ShapeForCells(test::LabelledCube(60, 1,
                    [](const Vector3& p)
                    {
                      const bool cavity = Norm(p - Vector3{ 0, 0, 10 }) < 4;
                      const bool island = Norm(p - Vector3{ 8, 0, 5 }) < 3;
                      const bool sheet = std::abs(p[0]) < 0.6 && p[2] > 0 && Norm(p) < 29;
                      const bool crumb = Norm(p - Vector3{ 26, 26, 0 }) < 2;
                      return cavity ? 0 : island ? 3 : sheet || crumb ? 1 : BallOnMuscle(p);
                    }),
      OnlyMuscleHeld, edge));
  // The sheet's root is rounded: two of its grooves, a third of an edge wide.
  EXPECT_NEAR(ragged.Moving / plain.Moving, 1, 0.02);
  EXPECT_NEAR(ragged.Front, plain.Front, 0.75); // a voxel
  EXPECT_NEAR(ragged.Fixed / plain.Fixed, 1, 0.05);
}

TEST(SimulationShape, WithoutHeldTissueNothingIsHeld)
{
  // A cube: the ball does not reach its corners, which are no chest wall for that.
  for (const bool round : { true, false })
  {
    const LabelVolume body = test::LabelledCube(44, 1,
      [&](const Vector3& p)
      {
        const double far = std::max({ std::abs(p[0]), std::abs(p[1]), std::abs(p[2]) });
        return (round ? Norm(p) : far) < 19.8 ? 1 : 0;
      });
    const SimulationShape shape = ShapeForCells(body, OnlyMuscleHeld, 8);
    const ShapeVolumes volumes = VolumesOf(shape);
    EXPECT_EQ(volumes.Fixed, 0) << round;
    EXPECT_NEAR(volumes.Moving / static_cast<double>(body.CountLabels()[1]), 1, 0.05) << round;
  }
}

TEST(SimulationShape, RefusesWhereNothingMoves)
{
  const LabelVolume air = test::LabelledCube(8, 1, [](const Vector3&) { return 0; });
  EXPECT_NE(RefusalOf([&] { ShapeForCells(air, OnlyMuscleHeld, 5); }), test::NotRefused);
  const LabelVolume muscle =
    test::LabelledCube(30, 1, [](const Vector3& p) { return Norm(p) < 13 ? 3 : 0; });
  EXPECT_THAT(RefusalOf([&] { ShapeForCells(muscle, OnlyMuscleHeld, 5); }),
    test::Mentions("not fixed", "none"));
  // Whose size is to be taken from the volume, of which nothing moves.
  EXPECT_THAT(RefusalOf([&] { MeshForSimulation(muscle, OnlyMuscleHeld, 0); }),
    test::Mentions("not fixed", "none"));
}
}
