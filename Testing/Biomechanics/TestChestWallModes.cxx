// SPDX-License-Identifier: Apache-2.0
// Compressions with a chest wall that is not fixed, gravity and pull.
#include "EquilibriumChecks.h"
#include "EveryElement.h"
#include "TestMeshes.h"
#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/Private/AttachmentEnergy.h"
#include "mammoray/Foundation/Error.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace
{
using namespace mammoray;
using test::CellsOfMaterial;
using test::Difference;
using test::NormOf;

/// A block of 20 mm on a chest wall of 5 mm at y < 0, of one soft material.
TetrahedralMesh BlockOnAWall(int bricks)
{
  TetrahedralMesh mesh = test::MakeBoxMesh({ 0, -5, 0 }, { 20, 20, 20 }, { bricks, 5, bricks });
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    double middle = 0;
    for (int corner = 0; corner < 4; ++corner)
    {
      middle += 0.25 * mesh.Point(mesh.Cells[4 * cell + corner])[1];
    }
    mesh.Materials[cell] = middle < 0 ? 2 : 1;
  }
  return mesh;
}

/// Plates about z = 10 that reach far over the block.
PlatePair WidePlates(double thicknessMm)
{
  PlatePair plates;
  plates.Support.Edge = { 0, -100, 10 - 0.5 * thicknessMm };
  plates.Paddle.Edge = { 0, -100, 10 + 0.5 * thicknessMm };
  plates.Paddle.Normal = { 0, 0, -1 };
  return plates;
}

const std::vector<ElasticMaterial> Soft{ {}, { 5, 0.45 }, { 5, 0.45 } };

TEST(CompressionSimulation, AnElasticWallGivesWayByForceOverStiffness)
{
  CompressionOptions options;
  options.ChestWall = ChestWallMode::Elastic;
  options.Wall = { 4, 0.5 };
  options.PullN = { 0.05, 0.3, 0.1 };
  options.RelativeTolerance = 1e-10;
  const TetrahedralMesh mesh = BlockOnAWall(3);
  CompressionSimulation simulation(mesh, Soft, { false, false, true }, {}, options);
  const CompressionState state = simulation.Compress(WidePlates(60)); // touches nothing
  EXPECT_EQ(state.PaddleForceN, 0);
  // The wall alone balances the pull: the mean of its displacement is force over stiffness.
  const ElasticBody body(mesh, Soft);
  const AttachmentEnergy wall(body, CellsOfMaterial(mesh, 2), { 1, 0 });
  Vector3 mean{ 0, 0, 0 };
  for (std::size_t n = 0; n < wall.Nodes().size(); ++n)
  {
    const std::size_t c = 3 * static_cast<std::size_t>(wall.Nodes()[n]);
    const double* to = &state.Positions[c];
    const double* from = &simulation.RestPositions()[c];
    // Energy of the unit stiffness: half of area times the square of the lift of 1 mm.
    const double area = 2 * wall.NodeTerms(n, { from[0], from[1] + 1, from[2] }, { 1, 0 }).Energy;
    mean = mean + (area / 400) * Vector3{ to[0] - from[0], to[1] - from[1], to[2] - from[2] };
  }
  EXPECT_NEAR(mean[0], 1e3 * 0.05 / 400 / 0.5, 1e-8);
  EXPECT_NEAR(mean[1], 1e3 * 0.3 / 400 / 4, 1e-8);
  EXPECT_NEAR(mean[2], 1e3 * 0.1 / 400 / 0.5, 1e-8);
  EXPECT_GT(state.LargestWallGlideMm, 0.5);
  EXPECT_GT(state.LargestWallLiftMm, 0.18);
}

TEST(CompressionSimulation, OnASlidingWallABlockIsCompressedUniaxially)
{
  CompressionOptions options;
  options.ChestWall = ChestWallMode::Sliding;
  // The closed form is that of a wall that does not hold at all along itself.
  options.SlidingStiffness = 0.01;
  const TetrahedralMesh mesh = BlockOnAWall(3);
  const auto spread = [&](CompressionSimulation simulation)
  {
    const CompressionState state = simulation.Compress(WidePlates(16));
    const std::vector<CellMeasures> measures = simulation.MeasuresOf(state);
    double low = 1e9, high = 0;
    for (std::size_t cell = 0; cell < measures.size(); ++cell)
    {
      if (mesh.Materials[cell] == 1)
      {
        low = std::min(low, measures[cell].VonMisesKPa);
        high = std::max(high, measures[cell].VonMisesKPa);
      }
    }
    return std::array<double, 3>{ low, high, 1e3 * state.PaddleForceN };
  };
  const auto sliding =
    spread(CompressionSimulation(mesh, Soft, { false, false, true }, {}, options));
  const auto held = spread(CompressionSimulation(mesh, Soft, { false, false, true }));
  // One stress everywhere: a hundredth of it is left to the remaining stiffness along the wall and
  // to the waves of the contact layer. Fixed, it differs by a multiple of that.
  EXPECT_LT(sliding[1] / sliding[0], 1.02);
  EXPECT_GT(held[1] / held[0], 1.5);
  // Uniaxial compression to 0.8: Cauchy stress times deformed area over the stretch, as von Mises'
  // measure is the axial stress. The faces rest 0.04 mm in front of either plate.
  const double stretch = (16 - 2 * 0.045) / 20, e = 5, mu = e / 2.9, kappa = e / 0.3;
  double lateralLow = 1, lateralHigh = 1.3;
  for (int i = 0; i < 100; ++i)
  {
    const double l = 0.5 * (lateralLow + lateralHigh), j = stretch * l * l;
    const double trace = stretch * stretch + 2 * l * l;
    const double stress =
      mu * std::pow(j, -2 / 3.0) * (l - trace / (3 * l)) + kappa * (j - 1) * stretch * l;
    (stress > 0 ? lateralHigh : lateralLow) = l;
  }
  const double l = lateralLow, j = stretch * l * l, trace = stretch * stretch + 2 * l * l;
  const double force = -400 *
    (mu * std::pow(j, -2 / 3.0) * (stretch - trace / (3 * stretch)) + kappa * (j - 1) * l * l);
  EXPECT_NEAR(sliding[2] / force, 1, 0.01); // 0.01 mm of the layer is 0.3 % of the force
}

TEST(CompressionSimulation, AStiffElasticWallHolds)
{
  const TetrahedralMesh mesh = test::MakeHalfEllipsoidMesh(40, 45, 38, 4);
  const std::vector<ElasticMaterial> materials{ {}, { 6, 0.49 }, { 5, 0.49 } };
  const PlatePair plates = [&]
  {
    PlatePair pair = WidePlates(56);
    for (Plate* plate : { &pair.Support, &pair.Paddle })
    {
      plate->Edge = plate->Edge + Vector3{ 0, 120, -10 };
    }
    return pair;
  }();
  CompressionSimulation held(mesh, materials, { false, false, true });
  const CompressionState expected = held.Compress(plates);
  double last = 0;
  for (const double stiffness : { 1e3, 1e4 })
  {
    CompressionOptions options;
    options.ChestWall = ChestWallMode::Elastic;
    options.Wall = { stiffness, stiffness };
    CompressionSimulation elastic(mesh, materials, { false, false, true }, {}, options);
    const CompressionState state = elastic.Compress(plates);
    const double off = NormOf(Difference(state.Positions, expected.Positions));
    if (last > 0)
    {
      // Its give is inverse to its stiffness.
      EXPECT_NEAR(last / off, 10, 0.5);
    }
    last = off;
    // 1.3 % less at 1e3 kPa/mm.
    EXPECT_NEAR(state.PaddleForceN / expected.PaddleForceN, 1, 15 / stiffness);
  }
}

class ElementChestWall : public test::EveryElement
{
};
MAMMORAY_FOR_EVERY_ELEMENT(ElementChestWall);

TEST_P(ElementChestWall, SensitivitiesToTheLoadingMatchCentralDifferences)
{
  const TetrahedralMesh mesh = test::MakeHalfEllipsoidMesh(40, 45, 38, 4);
  const std::vector<ElasticMaterial> materials{ {}, { 6, 0.49, 0, 1.1 }, { 5, 0.49 } };
  CompressionOptions options;
  options.RelativeTolerance = 1e-12;
  options.Element = GetParam();
  options.ChestWall = ChestWallMode::Elastic;
  options.Wall = { 20, 2 };
  options.GravityMPerS2 = { 0, 0, -9.81 };
  options.PullN = { 0, 1, 0 };
  PlatePair plates = WidePlates(60);
  for (Plate* plate : { &plates.Support, &plates.Paddle })
  {
    plate->Edge = plate->Edge + Vector3{ 0, 115, -10 };
  }
  CompressionSimulation simulation(mesh, materials, { false, false, true }, {}, options);
  const CompressionState state = simulation.Compress(plates);
  std::vector<LoadingDerivative> velocities(4);
  velocities[0].Wall.Normal = 10;
  velocities[1].Wall.Tangential = 1;
  velocities[2].PullN = { 0, 1, 0.2 };
  velocities[3].GravityMPerS2 = { 1, 0, 3 };
  const auto exact = simulation.Sensitivities(state, {}, {}, velocities);
  ASSERT_EQ(exact.Count(), 4u);
  for (std::size_t p = 0; p < velocities.size(); ++p)
  {
    double best = 1;
    for (const double h : { 1e-3, 1e-4, 1e-5 })
    {
      std::vector<double> sides[2];
      for (int side = 0; side < 2; ++side)
      {
        const double by = side ? h : -h;
        CompressionOptions moved = options;
        moved.Wall.Normal += by * velocities[p].Wall.Normal;
        moved.Wall.Tangential += by * velocities[p].Wall.Tangential;
        moved.PullN = moved.PullN + by * velocities[p].PullN;
        moved.GravityMPerS2 = moved.GravityMPerS2 + by * velocities[p].GravityMPerS2;
        sides[side] = CompressionSimulation(mesh, materials, { false, false, true }, {}, moved)
                        .Compress(plates, &state)
                        .Positions;
      }
      std::vector<double> difference = Difference(sides[1], sides[0]);
      for (double& value : difference)
      {
        value /= 2 * h;
      }
      best = std::min(best, NormOf(Difference(difference, exact[p])) / NormOf(difference));
    }
    // Contact points that come and go bend the curve; for small h the solver's 1e-12 / h counts.
    EXPECT_LT(best, 1e-6) << "parameter " << p;
  }
}

/// What lies beyond the block's end away from the wall.
bool BeyondTheBlock(const Vector3& place)
{
  return place[1] > 20;
}

/// The block's wall, and a layer beyond its other end that is held, too.
TetrahedralMesh BlockBetweenWalls(int bricks)
{
  TetrahedralMesh mesh = test::MakeBoxMesh({ 0, -5, 0 }, { 20, 25, 20 }, { bricks, 6, bricks });
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    double middle = 0;
    for (int corner = 0; corner < 4; ++corner)
    {
      middle += 0.25 * mesh.Point(mesh.Cells[4 * cell + corner])[1];
    }
    mesh.Materials[cell] = middle < 0 || middle > 20 ? 2 : 1;
  }
  return mesh;
}

TEST(CompressionSimulation, HoldsWhatWasCutAsAHeldBodyBehindItWould)
{
  CompressionOptions options;
  options.PullN = { 0.1, 0, 0.2 };
  const std::vector<bool> held{ false, false, true };
  const TetrahedralMesh block = BlockOnAWall(3), between = BlockBetweenWalls(3);
  CompressionSimulation cut(block, Soft, held, {}, options, BeyondTheBlock);
  CompressionSimulation whole(between, Soft, held, {}, options);
  const CompressionState state = cut.Compress(WidePlates(17));
  const CompressionState expected = whole.Compress(WidePlates(17));
  EXPECT_NEAR(state.PaddleForceN, expected.PaddleForceN, 1e-6 * expected.PaddleForceN);
  std::size_t compared = 0;
  for (std::size_t a = 0; a < cut.NumberOfNodes(); ++a)
  {
    for (std::size_t b = 0; b < whole.NumberOfNodes(); ++b)
    {
      const auto at = [](const std::vector<double>& x, std::size_t node) {
        return Vector3{ x[3 * node], x[3 * node + 1], x[3 * node + 2] };
      };
      if (Norm(at(cut.RestPositions(), a) - at(whole.RestPositions(), b)) < 1e-9)
      {
        // Forces to 1e-8 of their scale, on tissue of 5 kPa and 20 mm.
        EXPECT_LT(Norm(at(state.Positions, a) - at(expected.Positions, b)), 1e-5);
        ++compared;
      }
    }
  }
  EXPECT_EQ(compared, cut.NumberOfNodes());
}

TEST(CompressionSimulation, NeitherGlidesNorHangsFreeWhereItWasCut)
{
  CompressionOptions options;
  options.ChestWall = ChestWallMode::Sliding;
  options.GravityMPerS2 = { 0, 0, -9.81 };
  const TetrahedralMesh mesh = BlockOnAWall(3);
  CompressionSimulation simulation(mesh, Soft, { false, false, true }, {}, options, BeyondTheBlock);
  simulation.Unload({ 0, 9.81, 0 });
  const CompressionState state = simulation.Compress(WidePlates(18));
  double largest = 0, across = 0;
  for (std::size_t node = 0; node < simulation.NumberOfNodes(); ++node)
  {
    const double* image = &simulation.ImagePositions()[3 * node];
    const double* now = &state.Positions[3 * node];
    const Vector3 way{ now[0] - image[0], now[1] - image[1], now[2] - image[2] };
    if (node < mesh.NumberOfPoints() && mesh.Point(static_cast<std::int32_t>(node))[1] == 20)
    {
      // Its place in the image, at rest and between the plates.
      EXPECT_EQ(Norm(way), 0) << node;
      EXPECT_EQ(simulation.RestPositions()[3 * node + 1], 20);
    }
    largest = std::max(largest, Norm(way));
    across = std::max(across, std::abs(way[0]));
  }
  EXPECT_GT(largest, 0.5); // plates that come 1 mm nearer on either side
  EXPECT_GT(across, 0.1);  // the faces at the sides have grown: they are free
  EXPECT_GT(state.LargestWallGlideMm, 0.05);
}

TEST(CompressionSimulation, RefusesBadLoading)
{
  const TetrahedralMesh mesh = BlockOnAWall(1);
  const auto make = [&](const auto& change)
  {
    CompressionOptions options;
    change(options);
    return CompressionSimulation(mesh, Soft, { false, false, true }, {}, options);
  };
  EXPECT_NO_THROW(make([](CompressionOptions&) {}));
  EXPECT_THROW(make([](CompressionOptions& o) { o.Friction = -0.1; }), InputError);
  EXPECT_THROW(make([](CompressionOptions& o) { o.Wall.Normal = 0; }), InputError);
  EXPECT_THROW(make([](CompressionOptions& o) { o.Wall.Tangential = -1; }), InputError);
  EXPECT_THROW(make([](CompressionOptions& o) { o.PullN[1] = std::nan(""); }), InputError);
  std::vector<ElasticMaterial> weightless = Soft;
  weightless[1].DensityGPerCm3 = 0;
  EXPECT_NO_THROW(CompressionSimulation(mesh, weightless, { false, false, true }));
  CompressionOptions standing;
  standing.GravityMPerS2[2] = -StandardGravityMPerS2;
  CompressionSimulation unknown(mesh, weightless, { false, false, true }, {}, standing);
  EXPECT_THROW(unknown.Compress(WidePlates(60)), InputError);
  weightless[1].DensityGPerCm3 = -1;
  EXPECT_THROW(CompressionSimulation(mesh, weightless, { false, false, true }), InputError);
}
}
