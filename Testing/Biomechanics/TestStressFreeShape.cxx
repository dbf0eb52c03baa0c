// SPDX-License-Identifier: Apache-2.0
// The shape without load of a column that its own weight stretches or presses by a fifth.
#include "EveryElement.h"
#include "TestMeshes.h"
#include "mammoray/Biomechanics/Private/StressFreeShape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace
{
using namespace mammoray;

/**
 * A column that cannot widen, F = diag(1, s, 1), held at y = 0 and free at its other end: P(s) =
 * psi'(s) = rho g (L - Y) at the undeformed place Y, L the undeformed length, and y, the integral
 * of s from 0 to Y, is (c(s(0)) - c(s(Y))) / (rho g) with c = s P - psi. At the free end s = 1 and
 * c = 0. Nothing is linearised.
 */
class ConfinedColumn
{
public:
  ConfinedColumn(const ElasticMaterial& material, double weightKPaPerMm, double lengthMm)
    : Mu(material.ShearModulusKPa())
    , Kappa(material.BulkModulusKPa())
    , Weight(weightKPaPerMm)
    , Fixed(Weight * lengthMm)
  {
  }
  double RestLength() const { return this->Stress(this->StretchWhere(this->Fixed)) / this->Weight; }
  /// The undeformed place of a deformed one.
  double RestOf(double y) const
  {
    const double stretch = this->StretchWhere(this->Fixed - this->Weight * y);
    return this->RestLength() - this->Stress(stretch) / this->Weight;
  }

private:
  // psi = mu / 2 (s^(-2/3) (s^2 + 2) - 3) + kappa / 2 (s - 1)^2
  double Stress(double s) const
  {
    return this->Mu * 2 / 3 * (std::cbrt(s) - std::pow(s, -5 / 3.0)) + this->Kappa * (s - 1);
  }
  /// Where c has this value: c' = s P' is positive.
  double StretchWhere(double value) const
  {
    double low = 0.2, high = 5;
    for (int halving = 0; halving < 60; ++halving)
    {
      const double s = 0.5 * (low + high);
      const double energy = this->Mu / 2 * (std::pow(s, -2 / 3.0) * (s * s + 2) - 3) +
        this->Kappa / 2 * (s - 1) * (s - 1);
      (s * this->Stress(s) - energy < value ? low : high) = s;
    }
    return low;
  }

  double Mu;
  double Kappa;
  double Weight;
  /// c at the held end.
  double Fixed;
};

using ElementRestShape = test::EveryElement;
MAMMORAY_FOR_EVERY_ELEMENT(ElementRestShape);

TEST_P(ElementRestShape, OfAConfinedColumnMatchesTheClosedForm)
{
  const ElasticMaterial material{ 1.5, 0.2, 0, 1.05 };
  constexpr double length = 60;
  for (const double gravity : { 9.81, -9.81 }) // hanging, standing
  {
    double errors[2];
    for (int finer = 0; finer < 2; ++finer)
    {
      const int layers = finer ? 32 : 16;
      const TetrahedralMesh mesh =
        test::MakeBoxMesh({ 0, 0, 0 }, { 8, length, 8 }, { 2, layers, 2 });
      ElasticBody body(mesh, { {}, material }, {}, {}, GetParam());
      std::vector<bool> fixed(3 * body.NumberOfNodes());
      for (std::size_t c = 0; c < fixed.size(); ++c)
      {
        fixed[c] = c % 3 != 1 || body.RestPositions()[c] < 1e-9;
      }
      const std::vector<bool> held(mesh.NumberOfCells(), false);
      EquilibriumSolver solver(body, fixed, 1000);
      InverseEquilibrium inverse(body, nullptr, fixed, held, mesh.Points, { 0, gravity, 0 });
      StressFreeShape shape(inverse, solver, 1e-10);
      ASSERT_EQ(shape.Find(), 1);
      const ConfinedColumn column(material, 1.05e-3 * gravity, length);
      // By a fifth or so at the held end.
      EXPECT_GT(std::abs(column.RestLength() - length), 4);
      errors[finer] = 0;
      for (std::size_t c = 1; c < mesh.Points.size(); c += 3)
      {
        errors[finer] = std::max(errors[finer],
          std::abs(body.RestPositions()[c] - column.RestOf(mesh.Points[c])));
      }
    }
    // In cells of 3.75 and 1.9 mm. Sides at rest are straight, which is of second order; patches of
    // linear cells have one pressure each, in places that do not follow the stress: of first.
    const bool quadratic = GetParam() == ElementType::Quadratic;
    EXPECT_LT(errors[0], quadratic ? 2e-4 : 0.05) << gravity;
    EXPECT_LT(errors[1], (quadratic ? 0.25 : 0.6) * errors[0]) << gravity;
  }
}
}
