// SPDX-License-Identifier: Apache-2.0
#include "EquilibriumChecks.h"
#include "HangingBody.h"
#include "TestMeshes.h"
#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/Embedding.h"
#include "mammoray/Foundation/Error.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
using namespace mammoray;

const std::vector<bool> Fixed{ false, false, true };

TEST(Gravity, AColumnStretchesUnderItsOwnWeight)
{
  // Held at the top (y < 0), hanging along +y; with nu = 0 there is no lateral strain, and the
  // closed form of small strain is u(y) = rho g (L y - y^2 / 2) / E, which quadratic cells hold
  // exactly: the tip moves by rho g L^2 / (2 E).
  TetrahedralMesh mesh = test::MakeBoxMesh({ 0, -5, 0 }, { 10, 60, 10 }, { 1, 13, 1 });
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    mesh.Materials[cell] = cell < mesh.NumberOfCells() / 13 ? 2 : 1;
  }
  // Bricks are numbered along x, then y: the first six cells of each layer of bricks.
  const ElasticMaterial soft{ 400, 0, 0, 1.05 };
  CompressionOptions options;
  options.GravityMPerS2 = { 0, StandardGravityMPerS2, 0 };
  CompressionSimulation simulation(mesh, { {}, soft, soft }, Fixed, {}, options);
  const CompressionState state = simulation.Compress(test::OpenPlates());
  const double weight = 1.05e-3 * StandardGravityMPerS2; // kPa / mm
  const double strain = weight * 60 / 400;               // at the top
  for (std::size_t c = 0; c < mesh.Points.size(); c += 3)
  {
    const double y = std::max(0.0, mesh.Points[c + 1]);
    const double expected = weight * (60 * y - 0.5 * y * y) / 400;
    // Relative error of small strain: a few times the strain, 0.15 %.
    EXPECT_NEAR(state.Positions[c + 1] - mesh.Points[c + 1], expected,
      3 * strain * expected + 1e-9);
    EXPECT_NEAR(state.Positions[c], mesh.Points[c], 1e-4);
  }
  EXPECT_EQ(state.PaddleForceN, 0);
}

/// A breast of 40 x 45 x 38 mm, as soft as soft fat.
struct SoftBreast
{
  TetrahedralMesh Mesh = test::MakeHalfEllipsoidMesh(40, 45, 38, 6);
  std::vector<ElasticMaterial> Materials{ {}, { 1, 0.49, 0, 0.95 }, { 5, 0.49 } };
};
const AnatomicalAxes Axes = AnatomicalAxes::FromCode("LAS");
const Vector3 Prone = GravityIn(PatientPosition::Prone, Axes);

TEST(Gravity, UnloadingAndLoadingGiveTheImageBack)
{
  const SoftBreast breast;
  for (int kind = 0; kind < 6; ++kind)
  {
    CompressionOptions options;
    options.ChestWall = static_cast<ChestWallMode>(kind % 3);
    options.Element = kind < 3 ? ElementType::Quadratic : ElementType::PatchAveragedLinear;
    options.Wall = { 20, 5 };
    options.GravityMPerS2 = Prone; // as in the image
    CompressionSimulation simulation(breast.Mesh, breast.Materials, Fixed, {}, options);
    simulation.Unload(Prone);
    const std::vector<double> rest = test::CornersOf(simulation.RestPositions(), breast.Mesh);
    // It hung down by millimetres; without load the nipple lies nearer to the chest wall.
    EXPECT_GT(test::LargestDifference(rest, breast.Mesh.Points), 2);
    const CompressionState loaded = simulation.Compress(test::OpenPlates());
    EXPECT_LE(
      test::LargestDifference(test::CornersOf(loaded.Positions, breast.Mesh), breast.Mesh.Points),
      CompressionSimulation::UnloadToleranceMm + 1e-6);
    // A residual of 1e-8 from two starts.
    EXPECT_LE(test::LargestDifference(simulation.ImagePositions(), loaded.Positions), 1e-4);
  }
}

TEST(Gravity, UnloadingUndoesLoading)
{
  const SoftBreast breast;
  CompressionOptions options;
  options.GravityMPerS2 = Prone;
  CompressionSimulation forth(breast.Mesh, breast.Materials, Fixed, {}, options);
  TetrahedralMesh image = breast.Mesh;
  image.Points = test::CornersOf(forth.Compress(test::OpenPlates()).Positions, breast.Mesh);
  CompressionSimulation back(image, breast.Materials, Fixed);
  back.Unload(Prone);
  // The tolerance of the loaded shape; a shape without load differs as much where it is stiff, by
  // some times that at the tip of the breast.
  EXPECT_LT(
    test::LargestDifference(test::CornersOf(back.RestPositions(), breast.Mesh), breast.Mesh.Points),
    5 * CompressionSimulation::UnloadToleranceMm);
}

TEST(Gravity, PointsFollowFromTheImageToTheCompressedBreast)
{
  const SoftBreast breast;
  CompressionOptions options;
  options.GravityMPerS2 = GravityIn(PatientPosition::Upright, Axes);
  CompressionSimulation simulation(breast.Mesh, breast.Materials, Fixed, {}, options);
  simulation.Unload(Prone);
  const Embedding embedding(simulation, breast.Mesh.Points);
  const CompressionState state = simulation.Compress(test::OpenPlates());
  const std::vector<double> moved =
    embedding.Map(test::Difference(state.Positions, simulation.ImagePositions()));
  for (std::size_t c = 0; c < moved.size(); ++c)
  {
    EXPECT_NEAR(breast.Mesh.Points[c] + moved[c], state.Positions[c],
      CompressionSimulation::UnloadToleranceMm);
  }
}

TEST(Gravity, UnloadingRefusesWhatIsNoGravityAndStopsWhenAsked)
{
  const TetrahedralMesh mesh = test::MakeHalfEllipsoidMesh(40, 45, 38, 4);
  CompressionSimulation simulation(mesh, { {}, { 1, 0.49 }, { 5, 0.49 } }, Fixed);
  EXPECT_THROW(simulation.Unload({ 0, std::nan(""), 0 }), InputError);
  EXPECT_THROW(simulation.Unload(Prone, [](double, const char*) { return false; }), Interrupted);
  EXPECT_EQ(test::CornersOf(simulation.RestPositions(), mesh), mesh.Points);
}
}
