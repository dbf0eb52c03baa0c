// SPDX-License-Identifier: Apache-2.0
#include "EnergyChecks.h"
#include "EquilibriumChecks.h"
#include "EveryElement.h"
#include "TestMeshes.h"
#include "mammoray/Biomechanics/Private/LoadEnergy.h"
#include "mammoray/Foundation/Error.h"

#include <gtest/gtest.h>

namespace
{
using namespace mammoray;
using test::PressedBlock;
using test::Shaken;

using ElementLoads = test::EveryElement;
MAMMORAY_FOR_EVERY_ELEMENT(ElementLoads);

TEST(LoadEnergy, IsMinusTheWorkOfItsForces)
{
  const PressedBlock block(ElementType::Quadratic);
  const std::vector<double> forces = Shaken(std::vector<double>(block.Positions.size(), 0.0), 1, 5);
  LoadEnergy loads(block.Body);
  EXPECT_EQ(loads.NumberOfPieces(), 0u);
  loads.SetForces(forces);
  const std::vector<double> way = test::Difference(block.Positions, block.Body.RestPositions());
  EXPECT_NEAR(test::Value(loads, block.Positions), -test::DotOf(forces, way), 1e-12);
  const auto errors = test::FindDerivativeErrors(loads, block.Positions, 1e-3);
  EXPECT_LT(errors.Gradient, 1e-10);
  EXPECT_EQ(errors.Hessian, 0);
  EXPECT_THROW(loads.SetForces({ 1, 2, 3 }), InputError);
}

TEST_P(ElementLoads, BodyForcesSumToWeightAndPull)
{
  // 4000 of 8000 mm^3 are held; the rest weighs 1.2 g/cm^3.
  const TetrahedralMesh mesh = PressedBlock::Mesh();
  const ElasticBody body(mesh, { {}, { 5, 0.4, 0, 1.2 }, { 5, 0.4 } }, {}, { false, false, true },
    GetParam());
  const std::vector<bool> held = test::CellsOfMaterial(mesh, 2);
  const Vector3 gravity{ 1, -2, -9.81 }, pull{ 0.1, 0.5, 0 };
  const std::vector<double> forces = BodyForces(body, held, gravity, pull);
  Vector3 sum{ 0, 0, 0 };
  for (std::size_t c = 0; c < forces.size(); ++c)
  {
    sum[c % 3] += forces[c];
  }
  // 4.8 g; kPa mm^2 are mN.
  EXPECT_NEAR(Norm(sum - (4.8 * gravity + 1e3 * pull)), 0, 1e-9);
  EXPECT_TRUE(BodyForces(body, held, { 0, 0, 0 }, { 0, 0, 0 }).empty());
}
}
