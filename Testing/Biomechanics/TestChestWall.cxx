// SPDX-License-Identifier: Apache-2.0
#include "EquilibriumChecks.h"
#include "EveryElement.h"
#include "TestMeshes.h"
#include "mammoray/Biomechanics/ChestWall.h"
#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/EquilibriumSolver.h"
#include "mammoray/Foundation/Error.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
using namespace mammoray;
using test::Difference;
using test::DotOf;
using test::NormOf;
using test::PressedBlock;
using test::Shaken;

std::vector<bool> CellsOfMaterial(const TetrahedralMesh& mesh, int material)
{
  std::vector<bool> cells;
  for (const int found : mesh.Materials)
  {
    cells.push_back(found == material);
  }
  return cells;
}

/// Half an ellipsoid on a chest wall that bulges forwards.
struct Breast
{
  TetrahedralMesh Mesh = test::MakeHalfEllipsoidMesh(40, 45, 38, 6);
  ElasticBody Body{ Mesh, { {}, { 6, 0.49 }, { 5, 0.49 } } };
  ChestWall Wall{ Body, CellsOfMaterial(Mesh, 2) };
};

TEST(ChestWall, HeightOverAPlaneIsItsDistance)
{
  const PressedBlock block(ElementType::Quadratic);
  const ChestWall wall(block.Body, CellsOfMaterial(PressedBlock::Mesh(), 2));
  EXPECT_NEAR(wall.AreaMm2(), 400, 1e-10);
  EXPECT_EQ(wall.Nodes().size(), 25u); // 2 x 2 squares of two quadratic triangles
  double area = 0;
  for (std::size_t n = 0; n < wall.Nodes().size(); ++n)
  {
    const double* rest = &block.Body.RestPositions()[3 * wall.Nodes()[n]];
    EXPECT_EQ(rest[1], 10);
    const Vector3 lifted{ rest[0], rest[1] + 2, rest[2] };
    const ChestWall::Terms terms = wall.NodeTerms(n, lifted, { 3, 0 });
    EXPECT_NEAR(terms.LiftMm, 2, 1e-12);
    EXPECT_NEAR(terms.GlideMm, 0, 1e-12);
    area += terms.Energy / 6; // 3 / 2 * 2^2
  }
  EXPECT_NEAR(area, 400, 1e-9);
  // Beside and far beyond the wall too.
  for (const Vector3& x : { Vector3{ 3, 12.5, 4 }, { -40, 11, 90 }, { 300, -7, 2 } })
  {
    const SurfaceHeight height = wall.HeightAt(x);
    EXPECT_NEAR(height.Value, x[1] - 10, 1e-10);
    EXPECT_NEAR(Norm(height.Gradient - Vector3{ 0, 1, 0 }), 0, 1e-10);
  }
}

TEST(ChestWall, DerivativesOfTheHeightMatchCentralDifferences)
{
  const Breast breast;
  for (const Vector3& x : { Vector3{ 3, 7, 4 }, { -25, 6, 12 }, { 38, 1, -20 }, { 0, 30, 60 } })
  {
    const SurfaceHeight height = breast.Wall.HeightAt(x);
    constexpr double h = 1e-4;
    for (int i = 0; i < 3; ++i)
    {
      Vector3 low = x, high = x;
      low[i] -= h;
      high[i] += h;
      const SurfaceHeight below = breast.Wall.HeightAt(low), above = breast.Wall.HeightAt(high);
      // h^2 times third derivatives below 1 / mm^2; roundoff of the height, 1e-14, over h.
      EXPECT_NEAR((above.Value - below.Value) / (2 * h), height.Gradient[i], 1e-8);
      for (int j = 0; j < 3; ++j)
      {
        EXPECT_NEAR((above.Gradient[j] - below.Gradient[j]) / (2 * h), height.Hessian[i][j], 1e-8);
        EXPECT_NEAR(height.Hessian[i][j], height.Hessian[j][i], 1e-15);
      }
    }
  }
}

TEST(ChestWall, ANodeThatGlidesRoundACurvedWallKeepsItsHeight)
{
  // A shell of held cells round the origin, radius 30 to 40 mm: the tissue inside may turn freely.
  TetrahedralMesh mesh = test::MakeBoxMesh({ -1, -1, -1 }, { 1, 1, 1 }, { 8, 8, 8 });
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    double largest = 0;
    for (int corner = 0; corner < 4; ++corner)
    {
      for (const double c : mesh.Point(mesh.Cells[4 * cell + corner]))
      {
        largest = std::max(largest, std::abs(c));
      }
    }
    mesh.Materials[cell] = largest > 0.8 ? 2 : 1;
  }
  // Every cube about the origin becomes a sphere.
  TetrahedralMesh surface = mesh;
  std::vector<double> sizes;
  for (std::size_t p = 0; p < mesh.NumberOfPoints(); ++p)
  {
    const Vector3 point = mesh.Point(p);
    sizes.push_back(std::max({ std::abs(point[0]), std::abs(point[1]), std::abs(point[2]), 1e-9 }));
    for (int axis = 0; axis < 3; ++axis)
    {
      surface.Points[3 * p + axis] /= sizes.back();
    }
  }
  test::MapCubeToBall(surface, 40, 40, 40);
  for (std::size_t c = 0; c < mesh.Points.size(); ++c)
  {
    mesh.Points[c] = sizes[c / 3] * surface.Points[c];
  }
  const ElasticBody body(mesh, { {}, { 5, 0.49 }, { 5, 0.49 } });
  const ChestWall wall(body, CellsOfMaterial(mesh, 2));
  double largest = 0;
  for (std::size_t n = 0; n < wall.Nodes().size(); ++n)
  {
    const double* rest = &body.RestPositions()[3 * wall.Nodes()[n]];
    const double c = std::cos(0.4), s = std::sin(0.4);
    const Vector3 turned{ c * rest[0] - s * rest[1], s * rest[0] + c * rest[1], rest[2] };
    largest = std::max(largest, std::abs(wall.NodeTerms(n, turned, { 1, 0 }).LiftMm));
  }
  // A radian's four tenths of 30 mm: a plane would be left by 2.4 mm; triangles of 8 mm leave the
  // sphere by 8^2 / (8 * 30) = 0.27 mm, and middles of their sides are that far inside.
  EXPECT_LT(largest, 0.35);
}

class LoadedElement : public test::EveryElement
{
};
MAMMORAY_FOR_EVERY_ELEMENT(LoadedElement);

TEST_P(LoadedElement, DerivativesOnAnElasticWallWithFrictionMatchCentralDifferences)
{
  const PressedBlock block(GetParam());
  const TetrahedralMesh mesh = PressedBlock::Mesh();
  const std::vector<bool> held = CellsOfMaterial(mesh, 2);
  const ChestWall wall(block.Body, held);
  const std::size_t size = block.Positions.size();
  EquilibriumSolver solver(block.Body, std::vector<bool>(size, false), 1000, held);
  solver.SetWall(&wall, { 7, 2 });
  solver.SetLoads(Shaken(std::vector<double>(size, 0.0), 0.1, 5));
  // Points that stick and points that slide: 0.02 to 0.2 mm from their anchors.
  EquilibriumSolver::FrictionStart before{ {}, Shaken(block.Positions, 0.1, 3), block.Plates };
  solver.SetFriction(solver.FrictionAt(block.Positions, block.Plates, 0.5, before));
  ASSERT_GT(solver.Friction().size(), 20u);
  const EquilibriumReport report = solver.Evaluate(block.Positions, &block.Plates);
  ASSERT_GT(Norm(report.FrictionN[0]), 1e-3);
  ASSERT_GT(report.LargestWallLiftMm, 0.1);
  test::ExpectExactDerivatives(solver, block.Positions, block.Plates);
}

TEST_P(LoadedElement, WallAndFrictionTurnWithBodyAndPlates)
{
  // The same body made in two frames; the plates' friction turned along.
  PlatePairVelocity turn;
  turn.Support.Angular = turn.Paddle.Angular = { 0.4, -0.3, 0.9 };
  const auto turned = [&](const Vector3& v)
  {
    const double length = Norm(v);
    Plate along;
    along.Normal = (1 / length) * v;
    return length > 0 ? length * MovedPlate(along, turn.Support, 1).Normal : v;
  };
  const auto turnedAll = [&](std::vector<double> values)
  {
    for (std::size_t n = 0; n < values.size(); n += 3)
    {
      const Vector3 v = turned({ values[n], values[n + 1], values[n + 2] });
      std::copy(v.begin(), v.end(), &values[n]);
    }
    return values;
  };
  const PressedBlock block(GetParam());
  TetrahedralMesh mesh = PressedBlock::Mesh();
  const std::vector<bool> held = CellsOfMaterial(mesh, 2);
  const auto gradientOf = [&](const ElasticBody& body, const std::vector<double>& x,
                            const PlatePair& plates, const std::vector<double>& xBefore)
  {
    const ChestWall wall(body, held);
    EquilibriumSolver solver(body, std::vector<bool>(x.size(), false), 1000, held);
    solver.SetWall(&wall, { 7, 2 });
    solver.SetFriction(solver.FrictionAt(x, plates, 0.5, { {}, xBefore, plates }));
    return solver.Gradient(x, &plates);
  };
  const std::vector<double> xBefore = Shaken(block.Positions, 0.1, 3);
  const std::vector<double> expected =
    turnedAll(gradientOf(block.Body, block.Positions, block.Plates, xBefore));
  mesh.Points = turnedAll(mesh.Points);
  const ElasticBody body(mesh, block.Body.Materials(), {}, { false, false, true }, GetParam());
  PlatePair plates = MovedPlates(block.Plates, turn, 1);
  plates.Support.Edge = turned(block.Plates.Support.Edge);
  plates.Paddle.Edge = turned(block.Plates.Paddle.Edge);
  const std::vector<double> found =
    gradientOf(body, turnedAll(block.Positions), plates, turnedAll(xBefore));
  // 1e-11: roundoff of positions, 1e-15 of 20 mm, over the contact layer of 0.05 mm.
  EXPECT_LT(NormOf(Difference(found, expected)), 1e-11 * NormOf(expected));
}

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
  const CompressionSimulation simulation(mesh, Soft, { false, false, true }, {}, options);
  const CompressionState state = simulation.Compress(WidePlates(60)); // touches nothing
  EXPECT_EQ(state.PaddleForceN, 0);
  // The wall alone balances the pull: the mean of its displacement is force over stiffness.
  const ElasticBody body(mesh, Soft);
  const ChestWall wall(body, CellsOfMaterial(mesh, 2));
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
  const TetrahedralMesh mesh = BlockOnAWall(3);
  const auto spread = [&](const CompressionSimulation& simulation)
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
  // to the waves of the contact layer. Held, it differs by a multiple of that.
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
  const CompressionSimulation held(mesh, materials, { false, false, true });
  const CompressionState expected = held.Compress(plates);
  double last = 0;
  for (const double stiffness : { 1e3, 1e4 })
  {
    CompressionOptions options;
    options.ChestWall = ChestWallMode::Elastic;
    options.Wall = { stiffness, stiffness };
    const CompressionSimulation elastic(mesh, materials, { false, false, true }, {}, options);
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

TEST_P(LoadedElement, SensitivitiesToTheLoadingMatchCentralDifferences)
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
  const CompressionSimulation simulation(mesh, materials, { false, false, true }, {}, options);
  const CompressionState state = simulation.Compress(plates);
  std::vector<LoadingVelocity> velocities(4);
  velocities[0].Wall.Normal = 10;
  velocities[1].Wall.Tangential = 1;
  velocities[2].PullN = { 0, 1, 0.2 };
  velocities[3].GravityMPerS2 = { 1, 0, 3 };
  const auto exact = simulation.Sensitivities(state, {}, {}, velocities);
  ASSERT_EQ(exact.size(), 4u);
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
  EXPECT_THROW(CompressionSimulation(mesh, weightless, { false, false, true }), InputError);
}
}
