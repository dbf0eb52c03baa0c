// SPDX-License-Identifier: Apache-2.0
// All energies together; TestEquilibriumSolver has elastic energy and contact alone.
#include "EquilibriumChecks.h"
#include "EveryElement.h"
#include "TestMeshes.h"
#include "mammoray/Biomechanics/Private/EquilibriumSolver.h"

#include <gtest/gtest.h>

namespace
{
using namespace mammoray;
using test::CellsOfMaterial;
using test::Difference;
using test::NormOf;
using test::PressedBlock;
using test::Shaken;

class LoadedElement : public test::EveryElement
{
};
MAMMORAY_FOR_EVERY_ELEMENT(LoadedElement);

TEST_P(LoadedElement, DerivativesOnAnElasticWallWithFrictionMatchCentralDifferences)
{
  const PressedBlock block(GetParam());
  const TetrahedralMesh mesh = PressedBlock::Mesh();
  const std::vector<bool> held = CellsOfMaterial(mesh, 2);
  const AttachmentEnergy wall(block.Body, held, { 7, 2 });
  const std::size_t size = block.Positions.size();
  EquilibriumSolver solver(block.Body, std::vector<bool>(size, false), 1000, held);
  solver.SetAttachment(&wall);
  solver.Energy().SetLoads(Shaken(std::vector<double>(size, 0.0), 0.1, 5));
  // Points that stick and points that slide: 0.02 to 0.2 mm from their anchors.
  FrictionStart before{ {}, Shaken(block.Positions, 0.1, 3), block.Plates };
  solver.Energy().SetFriction(solver.FrictionAt(block.Positions, block.Plates, 0.5, before));
  ASSERT_GT(solver.Energy().Friction().Points().size(), 20u);
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
    const AttachmentEnergy wall(body, held, { 7, 2 });
    EquilibriumSolver solver(body, std::vector<bool>(x.size(), false), 1000, held);
    solver.SetAttachment(&wall);
    solver.Energy().SetFriction(solver.FrictionAt(x, plates, 0.5, { {}, xBefore, plates }));
    return test::GradientOf(solver, x, &plates);
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
}
