// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "Refusals.h"
#include "mammoray/Meshing/LabelMesher.h"
#include "mammoray/Meshing/MeshCheck.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <random>
#include <set>

namespace
{
using mammoray::test::RefusalOf;
using namespace mammoray;

/// A ball of 30 mm with muscle (3, held) behind y = -10 and a core of gland (2) in its fat (1).
LabelVolume Breast()
{
  return test::LabelledCube(34, 2,
    [](const Vector3& p)
    {
      const double radius = Norm(p);
      return radius > 30 ? 0 : p[1] < -10 ? 3 : radius < 8 ? 2 : 1;
    });
}

/// Half an ellipsoid, the front is -y, on muscle that reaches beyond it on all sides.
LabelVolume BreastOnWideMuscle()
{
  return test::LabelledCube(48, 2,
    [](const Vector3& p)
    {
      const double depth = (16 - p[1]) / 45;
      return depth < 0 ? (p[1] < 26 && std::hypot(p[0], p[2]) < 44 ? 3 : 0)
                       : (std::hypot(p[0] / 40, depth, p[2] / 36) <= 1 ? 1 : 0);
    });
}

/// Which parts of a cube make up the ragged patient below.
struct Raggedness
{
  double SpacingMm = 2;
  /// Part of the muscle's voxels that are fat, in clumps of this size.
  double Streaks = 0;
  double ClumpMm = 5;
  double FieldOfViewMm = 1000;
};

/**
 * Half an ellipsoid of 55 x 65 mm, 90 mm high, on a curved chest wall 30 mm thick whose front is
 * fat and muscle in clumps, with a layer of fat over the wall beside it, cut by the field of view;
 * label 1 fat, 2 gland, 3 muscle (held).
 */
LabelVolume RaggedPatient(const Raggedness& how)
{
  // Clumps: the sign of a sum of waves, the same for every spacing.
  std::mt19937 generator(11);
  std::normal_distribution<double> normal;
  std::vector<std::array<double, 4>> waves(60);
  for (auto& wave : waves)
  {
    for (double& value : wave)
    {
      value = normal(generator);
    }
  }
  const auto clumps = [&](const Vector3& p)
  {
    double sum = 0;
    for (const auto& [a, b, c, phase] : waves)
    {
      sum += std::cos((a * p[0] + b * p[1] + c * p[2]) / how.ClumpMm + 3 * phase);
    }
    return sum / std::sqrt(0.5 * static_cast<double>(waves.size()));
  };
  // The deviate that a part of a normal distribution lies above: 0.67 for a quarter.
  const double threshold = how.Streaks > 0 ? 0.67 + 2 * (0.25 - how.Streaks) : 1e9;
  const int n = static_cast<int>(190 / how.SpacingMm);
  return test::LabelledCube(n, how.SpacingMm,
    [&](const Vector3& p) -> int
    {
      if (std::abs(p[0]) > how.FieldOfViewMm)
      {
        return 0;
      }
      const double wall = -40 - p[0] * p[0] / 250;
      const double skin = wall + 14;
      const Vector3 q{ p[0] / 55, (p[1] + 40) / 90, p[2] / 65 };
      const bool breast = Norm(q) < 1;
      if (p[1] < wall - 30 || (p[1] > skin && !breast))
      {
        return 0;
      }
      if (p[1] < wall)
      {
        return p[1] > wall - 20 && clumps(p) > threshold ? 1 : 3;
      }
      // Islands of what was taken for muscle.
      return Norm(p - Vector3{ 10, 0, 20 }) < 5 ? 3 : Norm(q - Vector3{ 0, 0.4, 0 }) < 0.3 ? 2 : 1;
    });
}

double MeshedVolume(const TetrahedralMesh& mesh, int material)
{
  double volume = 0;
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    volume += mesh.Materials[cell] == material ? mesh.CellVolume(cell) : 0;
  }
  return volume;
}

TEST(SimulationMesh, NothingIsHeldInFrontOfTheHeldTissue)
{
  // Plates may stand up to there. The muscle's front is at y = 16; facets may leave the surface by
  // a sixth of a cell, voxels of the shape by an eighth.
  for (const double size : { 17.0, 9.0 })
  {
    const MeshingResult result =
      MeshForSimulation(BreastOnWideMuscle(), { false, false, false, true }, size);
    double foremost = 1e9;
    for (std::size_t cell = 0; cell < result.Mesh.NumberOfCells(); ++cell)
    {
      for (int corner = 0; corner < 4 && result.Mesh.Materials[cell] == 3; ++corner)
      {
        const std::size_t point = static_cast<std::size_t>(result.Mesh.Cells[4 * cell + corner]);
        foremost = std::min(foremost, result.Mesh.Points[3 * point + 1]);
      }
    }
    EXPECT_GT(foremost, 16 - 0.3 * size) << size;
    EXPECT_LT(foremost, 16 + size) << size;
  }
}

TEST(SimulationMesh, HasAsManyCellsHoweverRaggedTheVolume)
{
  const std::vector<bool> held{ false, false, false, true };
  const double smooth = MeshedVolume(MeshForSimulation(RaggedPatient({}), held, 0).Mesh, 1);
  for (const Raggedness& how :
    { Raggedness{ 1, 0.3 }, Raggedness{ 2, 0.4, 3 }, Raggedness{ 3, 0.3, 7 } })
  {
    SCOPED_TRACE(how.SpacingMm);
    SCOPED_TRACE(how.ClumpMm);
    const MeshingResult result = MeshForSimulation(RaggedPatient(how), held, 0);
    EXPECT_GT(result.Mesh.NumberOfCells(), 3000u);
    EXPECT_LT(result.Mesh.NumberOfCells(), 6000u);
    // One piece that moves, one that is held, and a border that is one sheet.
    EXPECT_EQ(result.Components, 2u);
    EXPECT_TRUE(CheckMesh(result.Mesh).Sound());
    for (const MaterialReport& report : result.Reports)
    {
      EXPECT_GT(report.SmallestDihedralDeg, 8);
    }
    // Fat between muscles belongs to the wall: the breast is as large as without, but for clumps of
    // fat behind its front that are larger than one and a half cells.
    EXPECT_NEAR(MeshedVolume(result.Mesh, 1) / smooth, 1, 0.05);
  }
}

TEST(SimulationMesh, TakesACutByTheFieldOfViewForAFace)
{
  const std::vector<bool> held{ false, false, false, true };
  const LabelVolume volume = RaggedPatient({ 2, 0.3, 5, 40 });
  const MeshingResult result = MeshForSimulation(volume, held, 0);
  EXPECT_GT(result.Mesh.NumberOfCells(), 3000u);
  EXPECT_LT(result.Mesh.NumberOfCells(), 6000u);
  for (const MaterialReport& report : result.Reports)
  {
    if (report.Material == 1)
    {
      // Edges and corners of the cut are rounded by a third of a cell.
      EXPECT_NEAR(report.VolumeOutMm3 / report.VolumeInMm3, 1, 0.02);
    }
  }
}

TEST(SimulationMesh, FollowsTheSkinAndTheHeldTissueOnly)
{
  const LabelVolume volume = Breast();
  const MeshingResult result = MeshForSimulation(volume, { false, false, false, true }, 10);
  EXPECT_NO_THROW(result.Mesh.Validate("mesh"));
  // Gland is no material of its own: fat is commoner.
  const std::set<int> found(result.Mesh.Materials.begin(), result.Mesh.Materials.end());
  EXPECT_EQ(found, (std::set<int>{ 1, 3 }));
  auto counts = volume.CountLabels();
  // Corners are rounded by a third of a cell of 10 mm.
  EXPECT_NEAR(MeshedVolume(result.Mesh, 1) / ((counts[1] + counts[2]) * 8.0), 1, 0.05);
  // A layer as deep as a cell behind a disc of 28 mm is left of what is held.
  EXPECT_NEAR(MeshedVolume(result.Mesh, 3) / (3.14 * 28 * 28 * 10), 1, 0.25);
}

TEST(SimulationMesh, TakesItsSizeFromTheVolume)
{
  const MeshingResult result = MeshForSimulation(Breast(), { false, false, false, true }, 0);
  EXPECT_GT(result.Mesh.NumberOfCells(), 3000u);
  EXPECT_LT(result.Mesh.NumberOfCells(), 6000u);
}

TEST(SimulationMesh, RefusesUnknownMaterialsAndSizes)
{
  EXPECT_EQ(RefusalOf(
              [] {
                MeshForSimulation(Breast(), { false, false, false }, 10);
              }),
    "simulation mesh: expected materials 0 to 2, found 3");
  EXPECT_EQ(RefusalOf(
              [] {
                MeshForSimulation(Breast(), { false, false, false, true }, -1);
              }),
    "simulation mesh: expected a cell size of at least 0 mm, found -1.000000");
  for (const double size : { 1e-3, 1e-9, 1e-300 })
  {
    EXPECT_THAT(RefusalOf(
                  [&] {
                    MeshForSimulation(Breast(), { false, false, false, true }, size);
                  }),
      test::Mentions("GB"));
  }
}
}
