// SPDX-License-Identifier: Apache-2.0
// Derivatives of equilibria by the implicit function theorem against states solved again.
#include "BreastBetweenPlates.h"
#include "EquilibriumChecks.h"
#include "EveryElement.h"
#include "TestMeshes.h"
#include "mammoray/Biomechanics/Private/EquilibriumSolver.h"
#include "mammoray/Foundation/Error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace
{
using namespace mammoray;
using test::Difference;
using test::DotOf;
using test::MakeBreast;
using test::MakePlates;
using test::NormOf;
using test::WithElement;

using ElementSensitivities = test::EveryElement;
MAMMORAY_FOR_EVERY_ELEMENT(ElementSensitivities);

TEST_P(ElementSensitivities, MatchCentralDifferences)
{
  const CompressionOptions options = WithElement(GetParam(), 1e-12);
  CompressionSimulation simulation = MakeBreast(options);
  const PlatePair plates = MakePlates(54, 3);
  const CompressionState state = simulation.Compress(plates);
  std::vector<PlatePairVelocity> velocities(3);
  velocities[0].Paddle.Linear = plates.Support.Normal;  // thickness
  velocities[1].Support.Angular = { 0, M_PI / 180, 0 }; // roll, 1/deg
  velocities[1].Paddle.Angular = velocities[1].Support.Angular;
  velocities[2].Support.Linear = velocities[2].Paddle.Linear = { 0, 1, 0 }; // depth
  const VectorFields exact = simulation.Sensitivities(state, velocities);
  for (std::size_t p = 0; p < velocities.size(); ++p)
  {
    double best = 1;
    for (const double h : { 1e-4, 1e-5, 1e-6 })
    {
      const CompressionState low =
        simulation.Compress(MovedPlates(plates, velocities[p], -h), &state);
      const CompressionState high =
        simulation.Compress(MovedPlates(plates, velocities[p], h), &state);
      double error = 0, size = 0;
      for (std::size_t c = 0; c < state.Positions.size(); ++c)
      {
        const double difference = (high.Positions[c] - low.Positions[c]) / (2 * h);
        error += std::pow(difference - exact[p][c], 2);
        size += difference * difference;
      }
      best = std::min(best, std::sqrt(error / size));
    }
    // Contact points that come and go and slide round the plates' edges bend the curve: small h is
    // best until the solver's 1e-12 / h takes over.
    EXPECT_LT(best, 1e-6) << "parameter " << p;
  }
}

TEST_P(ElementSensitivities, ToMaterialsMatchCentralDifferences)
{
  const CompressionOptions options = WithElement(GetParam(), 1e-12);
  const std::vector<ElasticMaterial> materials{ {}, { 5, 0.48, 1 }, { 5, 0.49 }, { 15, 0.49, 2 } };
  CompressionSimulation simulation(
    test::MakeHalfEllipsoidMesh(40, 45, 38, 4), materials, { false, false, true, false },
    [](const Vector3& x) { return std::hypot(x[0], x[1] - 20, x[2]) < 17 ? 3 : 1; }, options);
  const PlatePair plates = MakePlates(58);
  const CompressionState state = simulation.Compress(plates);
  // The ratio gland / fat, both Poisson's ratios together (in hundredths: kappa bends with nu), the
  // exponent of the fat.
  const std::vector<MaterialDerivative> velocities{ { {}, {}, {}, { 5, 0, 0 } },
    { {}, { 0, 0.01, 0 }, {}, { 0, 0.01, 0 } }, { {}, { 0, 0, 1 }, {}, {} } };
  PlatePairVelocity thickness;
  thickness.Paddle.Linear = plates.Support.Normal;
  const VectorFields exact = simulation.Sensitivities(state, { thickness }, velocities);
  ASSERT_EQ(exact.Count(), 4u);
  const std::vector<double> alone = simulation.Sensitivities(state, { thickness }).Values;
  for (std::size_t c = 0; c < alone.size(); ++c)
  {
    EXPECT_NEAR(exact[0][c], alone[c], 1e-7); // refined to 1e-9 of the forces
  }
  for (std::size_t p = 0; p < velocities.size(); ++p)
  {
    double best = 1;
    for (const double h : { 1e-3, 1e-4, 1e-5 })
    {
      CompressionState sides[2];
      for (int side = 0; side < 2; ++side)
      {
        std::vector<ElasticMaterial> moved = materials;
        for (std::size_t m = 0; m < moved.size(); ++m)
        {
          const double by = side ? h : -h;
          moved[m].YoungsModulusKPa += by * velocities[p][m].YoungsModulusKPa;
          moved[m].PoissonRatio += by * velocities[p][m].PoissonRatio;
          moved[m].FungExponent += by * velocities[p][m].FungExponent;
        }
        simulation.SetMaterials(moved);
        sides[side] = simulation.Compress(plates, &state);
      }
      double error = 0, size = 0;
      for (std::size_t c = 0; c < state.Positions.size(); ++c)
      {
        const double difference = (sides[1].Positions[c] - sides[0].Positions[c]) / (2 * h);
        error += std::pow(difference - exact[p + 1][c], 2);
        size += difference * difference;
      }
      best = std::min(best, std::sqrt(error / size));
    }
    // See above.
    EXPECT_LT(best, 1e-6) << "parameter " << p;
  }
  simulation.SetMaterials(materials);
  EXPECT_THROW(simulation.Sensitivities(state, {}, { { {}, {} } }), InputError);
}

TEST_P(ElementSensitivities, BackwardIsTheirTransposeAndMatchesCentralDifferences)
{
  TetrahedralMesh mesh = test::MakeHalfEllipsoidMesh(40, 45, 38, 4);
  std::vector<ElasticMaterial> materials{ {}, { 6, 0.48, 1 }, { 5, 0.49 } };
  std::vector<bool> fixed{ false, false, true };
  // Some cells have a material of their own.
  std::vector<std::size_t> cells;
  for (std::size_t cell = 3; cell < mesh.NumberOfCells(); cell += 11)
  {
    if (mesh.Materials[cell] == 1)
    {
      mesh.Materials[cell] = static_cast<std::int32_t>(materials.size());
      materials.push_back({ 12, 0.48, 1 });
      fixed.push_back(false);
      cells.push_back(cell);
    }
  }
  ASSERT_GT(cells.size(), 3u);
  for (const ChestWallMode mode : { ChestWallMode::Fixed, ChestWallMode::Elastic })
  {
    CompressionOptions options = WithElement(GetParam(), 1e-10);
    options.ChestWall = mode;
    CompressionSimulation simulation(mesh, materials, fixed, {}, options);
    const PlatePair plates = MakePlates(58);
    const CompressionState state = simulation.Compress(plates);
    std::mt19937 generator(5);
    std::normal_distribution<double> number;
    std::vector<double> loss(state.Positions.size());
    std::generate(loss.begin(), loss.end(), [&] { return number(generator); });
    std::vector<PlatePairVelocity> motions(2);
    motions[0].Paddle.Linear = plates.Support.Normal;
    motions[1].Support.Linear = motions[1].Paddle.Linear = { 0, 1, 0 };
    const auto gradient = simulation.Backward(state, loss, motions);

    std::vector<MaterialDerivative> stiffer(materials.size(), MaterialDerivative(materials.size()));
    for (std::size_t m = 0; m < materials.size(); ++m)
    {
      stiffer[m][m].YoungsModulusKPa = materials[m].YoungsModulusKPa;
    }
    const VectorFields forward = simulation.Sensitivities(state, motions, stiffer);
    const auto expect = [&](double found, std::size_t field, const char* what)
    {
      // Both solve to 1e-9 of their forces.
      EXPECT_NEAR(found, DotOf(forward[field], loss), 1e-6 * NormOf(forward[field]) * NormOf(loss))
        << what << " " << field;
    };
    expect(gradient.Plates[0], 0, "plates");
    expect(gradient.Plates[1], 1, "plates");
    std::vector<double> sums(materials.size(), 0.0);
    for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
    {
      sums[mesh.Materials[cell]] += gradient.Cells[cell];
    }
    const double largest = std::abs(gradient.Materials[1]);
    for (std::size_t m = 1; m < materials.size(); ++m)
    {
      expect(gradient.Materials[m], 2 + m, "material");
      EXPECT_NEAR(sums[m], gradient.Materials[m], 1e-9 * largest) << m;
    }
    EXPECT_EQ(sums[2], 0) << "fixed";
    for (const std::size_t cell : { cells[0], cells[cells.size() / 2], cells.back() })
    {
      double sides[2];
      for (int side = 0; side < 2; ++side)
      {
        std::vector<ElasticMaterial> moved = materials;
        moved[mesh.Materials[cell]].YoungsModulusKPa *= side ? 1 + 1e-4 : 1 - 1e-4;
        simulation.SetMaterials(moved);
        sides[side] = DotOf(simulation.Compress(plates, &state).Positions, loss);
      }
      simulation.SetMaterials(materials);
      EXPECT_NEAR((sides[1] - sides[0]) / 2e-4, gradient.Cells[cell],
        1e-4 * std::abs(gradient.Cells[cell]) + 1e-6 * largest)
        << cell;
    }
    EXPECT_THROW(simulation.Backward(state, { 1.0 }), InputError);
  }
}

TEST_P(ElementSensitivities, RateOfTheForceMatchesCentralDifferences)
{
  const CompressionOptions options = WithElement(GetParam(), 1e-12);
  CompressionSimulation simulation = MakeBreast(options);
  const PlatePair plates = MakePlates(54, 3);
  const CompressionState state = simulation.Compress(plates);
  PlatePairVelocity closing, tilting;
  closing.Paddle.Linear = plates.Paddle.Normal;
  tilting.Paddle.Angular = { 0.01, 0, 0 };
  for (const PlatePairVelocity& velocity : { closing, tilting })
  {
    const double exact = simulation.PaddleForceDerivative(state, velocity);
    double best = 1;
    for (const double h : { 1e-3, 1e-4, 1e-5 })
    {
      const double difference =
        (simulation.Compress(MovedPlates(plates, velocity, h), &state).PaddleForceN -
          simulation.Compress(MovedPlates(plates, velocity, -h), &state).PaddleForceN) /
        (2 * h);
      best = std::min(best, std::abs(difference / exact - 1));
    }
    EXPECT_LT(best, 1e-6); // as for the positions
  }
}

TEST(EquilibriumSensitivities, WithFrictionAreThoseOfTheLastStepWithFrozenNormalForces)
{
  test::PressedBlock block(ElementType::Quadratic);
  std::vector<bool> fixed(block.Positions.size(), false);
  for (std::size_t c = 0; c < fixed.size(); ++c)
  {
    fixed[c] = block.Body.RestPositions()[c - c % 3 + 1] < 1e-9;
  }
  EquilibriumSolver solver(block.Body, fixed, 1000);
  std::vector<double> x = block.Body.RestPositions();
  ASSERT_TRUE(solver.Solve(x, &block.Plates, 1e-12, 50).Converged);
  PlatePairVelocity turn;
  turn.Paddle = { { 0.2, 0.3, -0.4 }, { 0.01, 0.005, 0.01 } };
  const PlatePair plates = MovedPlates(block.Plates, turn, 1);
  const FrictionStart before{ {}, x, block.Plates };
  solver.Energy().SetFriction(solver.FrictionAt(x, block.Plates, 0.5, before));
  ASSERT_TRUE(solver.Solve(x, &plates, 1e-12, 50).Converged);
  PlatePairVelocity velocity;
  velocity.Paddle = { { 0.5, 0.2, -0.1 }, { 0.02, -0.01, 0.01 } };
  velocity.Support.Linear = { 0.3, 0.1, 0 };
  SupportDerivative rougher;
  rougher.Friction = 0.1;
  const auto exact = solver.Sensitivities(x, plates, { { velocity }, {}, { rougher } });
  const double rate = solver.PaddleForceDerivative(x, plates, velocity,
    std::vector<double>(exact[0].begin(), exact[0].end()));
  const FrictionPoints points = solver.Energy().Friction().Points();
  for (int p = 0; p < 2; ++p)
  {
    double best = 1, bestForce = 1;
    for (const double h : { 1e-4, 1e-5, 1e-6 })
    {
      std::vector<double> sides[2];
      double forces[2];
      for (int side = 0; side < 2; ++side)
      {
        const double by = side ? h : -h;
        const PlatePair moved = p == 0 ? MovedPlates(plates, velocity, by) : plates;
        FrictionPoints changed = points;
        for (FrictionPoint& point : changed)
        {
          point.SlidingForce += p == 1 ? by * 0.1 * point.NormalForce : 0;
        }
        solver.Energy().SetFriction(changed);
        sides[side] = x;
        const EquilibriumReport report = solver.Solve(sides[side], &moved, 1e-13, 50);
        forces[side] = report.PaddleForceN;
      }
      std::vector<double> difference = Difference(sides[1], sides[0]);
      for (double& value : difference)
      {
        value /= 2 * h;
      }
      best = std::min(best, NormOf(Difference(difference, exact[p])) / NormOf(difference));
      bestForce = std::min(bestForce, std::abs((forces[1] - forces[0]) / (2 * h) / rate - 1));
    }
    // Contact points that come and go bend the curve; for small h the solver's 1e-13 / h counts.
    EXPECT_LT(best, 1e-6) << p;
    if (p == 0)
    {
      EXPECT_LT(bestForce, 1e-6);
    }
  }
}
}
