// SPDX-License-Identifier: Apache-2.0
#include "EquilibriumChecks.h"
#include "TestMeshes.h"
#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/Private/EquilibriumSolver.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
using namespace mammoray;
using test::Difference;
using test::NormOf;

/// A block of 20 x 20 x 10 mm on a held layer of 5 mm, pressed by a paddle that reaches over it.
struct ShearedBlock
{
  static constexpr double Coefficient = 0.4;
  TetrahedralMesh Mesh = MakeMesh();
  ElasticMaterial Material{ 20, 0.3 };
  CompressionSimulation Simulation = Make(Coefficient);

  static TetrahedralMesh MakeMesh()
  {
    TetrahedralMesh mesh = test::MakeBoxMesh({ 0, 0, -5 }, { 20, 20, 10 }, { 4, 4, 3 });
    for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
    {
      mesh.Materials[cell] = cell < mesh.NumberOfCells() / 3 ? 2 : 1; // layers from below
    }
    return mesh;
  }
  CompressionSimulation Make(double coefficient) const
  {
    CompressionOptions options;
    options.Friction = coefficient;
    return CompressionSimulation(this->Mesh, { {}, this->Material, this->Material },
      { false, false, true }, {}, options);
  }
  /// The paddle's face at z = `height`, shifted along +x.
  static PlatePair Plates(double height, double shift)
  {
    PlatePair plates;
    plates.Support.Edge = { 0, -500, -500 };
    plates.Paddle.Edge = { shift, -50, height };
    plates.Paddle.Normal = { 0, 0, -1 };
    return plates;
  }
  /// Force of the paddle along x, N: what the held layer takes up.
  double Shear(const CompressionState& state) const
  {
    const ElasticBody body(this->Mesh, { {}, this->Material, this->Material });
    EquilibriumSolver solver(body, std::vector<bool>(3 * body.NumberOfNodes(), false), 1);
    double force = 0;
    const std::vector<double> gradient = test::GradientOf(solver, state.Positions, nullptr);
    for (std::size_t c = 0; c < gradient.size(); c += 3)
    {
      force -= body.RestPositions()[c + 2] < 1e-9 ? gradient[c] : 0;
    }
    return 1e-3 * force;
  }
};

TEST(LaggedFriction, APressedBlockSticksBelowCoulombsForceAndSlipsAbove)
{
  ShearedBlock block;
  CompressionState state = block.Simulation.Compress(ShearedBlock::Plates(9.5, 0));
  EXPECT_GT(state.PaddleForceN, 0.2);
  // Symmetric but for the bricks' diagonals.
  EXPECT_NEAR(block.Shear(state), 0, 5e-3 * state.PaddleForceN);
  // The mean of the top's displacement along x.
  const auto top = [&](const CompressionState& of)
  {
    double sum = 0;
    int count = 0;
    for (std::size_t c = 0; c < of.Positions.size(); c += 3)
    {
      if (block.Simulation.RestPositions()[c + 2] > 10 - 1e-9)
      {
        sum += of.Positions[c] - block.Simulation.RestPositions()[c];
        ++count;
      }
    }
    return sum / count;
  };
  double lastForce = 0, lastShift = 0;
  bool stuck = false, slipped = false;
  for (const double shift : { 0.1, 0.2, 0.6, 1.2, 2.0, 3.0 })
  {
    const PlatePair plates = ShearedBlock::Plates(9.5, shift);
    state = block.Simulation.Compress(plates, &state);
    const double limit = ShearedBlock::Coefficient * state.PaddleForceN;
    const double force = block.Shear(state);
    // No more than Coulomb's force, but for the share of the residual.
    EXPECT_LT(force, limit * (1 + 1e-3)) << shift;
    if (force < 0.5 * limit)
    {
      stuck = true;
      // Sticks: the top keeps up with the paddle, less a part of the elastic slip, and its force
      // grows in proportion, as that of sheared rubber does.
      EXPECT_NEAR(top(state), shift, FrictionPoint::SlipMm) << shift;
      EXPECT_NEAR(force / shift, lastShift > 0 ? lastForce / lastShift : force / shift,
        0.1 * force / shift);
    }
    if (shift > 1.5)
    {
      slipped = true;
      // Slips: all of Coulomb's force, whatever the way. 1 %: normal forces follow friction's to
      // 1e-4 of the forces, and points at the rim come and go.
      EXPECT_NEAR(force / limit, 1, 0.01) << shift;
      EXPECT_LT(top(state), shift - 0.1);
    }
    lastForce = force;
    lastShift = shift;
  }
  EXPECT_TRUE(stuck && slipped);
  // Back: at first it sticks, then the force turns round.
  const CompressionState back = block.Simulation.Compress(ShearedBlock::Plates(9.5, 0.5), &state);
  EXPECT_LT(block.Shear(back), 0);
}

TEST(LaggedFriction, AStuckBlockIsShearedLikeABondedOne)
{
  // So rough that nothing slips; the reference has its top moved by hand.
  ShearedBlock block;
  CompressionSimulation rough = block.Make(20);
  const CompressionState pressed = rough.Compress(ShearedBlock::Plates(9.5, 0));
  const CompressionState sheared = rough.Compress(ShearedBlock::Plates(9.5, 0.4), &pressed);
  const ElasticBody body(block.Mesh, { {}, block.Material, block.Material });
  std::vector<bool> fixed(3 * body.NumberOfNodes(), false);
  std::vector<double> x = pressed.Positions;
  for (std::size_t c = 0; c < x.size(); c += 3)
  {
    const double z = body.RestPositions()[c + 2];
    if (z > 10 - 1e-9 || z < 1e-9)
    {
      fixed[c] = fixed[c + 1] = fixed[c + 2] = true;
      x[c] += z > 1 ? 0.4 : 0;
    }
  }
  EquilibriumSolver bonded(body, fixed, 1);
  ASSERT_TRUE(bonded.Solve(x, nullptr, 1e-8, 30).Converged);
  CompressionState reference;
  reference.Positions = x;
  // 3 %: the elastic slip, at this friction some thousandths of a millimetre in 0.4 mm, and the
  // give of the contact layer under the tilt.
  EXPECT_NEAR(block.Shear(sheared) / block.Shear(reference), 1, 0.03);
}

TEST(LaggedFriction, AStuckBlockDoesNotCreep)
{
  ShearedBlock block;
  const PlatePair plates = ShearedBlock::Plates(9.5, 0.1);
  const CompressionState pressed = block.Simulation.Compress(ShearedBlock::Plates(9.5, 0));
  const CompressionState first = block.Simulation.Compress(plates, &pressed);
  CompressionState state = first;
  for (int i = 0; i < 5; ++i)
  {
    state = block.Simulation.Compress(plates, &state);
  }
  // Normal forces fit to 1e-4 of the forces; the slip alone is 0.05 mm.
  EXPECT_LT(NormOf(Difference(state.Positions, first.Positions)) /
      std::sqrt(static_cast<double>(state.Positions.size())),
    1e-4);
}
}
