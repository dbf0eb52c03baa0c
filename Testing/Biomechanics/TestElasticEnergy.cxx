// SPDX-License-Identifier: Apache-2.0
#include "EnergyChecks.h"
#include "EquilibriumChecks.h"
#include "EveryElement.h"
#include "TestMeshes.h"
#include "mammoray/Biomechanics/Private/ElasticEnergy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace
{
using namespace mammoray;

using test::DerivativeErrors;
using test::EvaluatePiece;
using test::FindDerivativeErrors;
using test::FromModuli;
using test::PieceResult;
using test::Shaken;

using ElementEnergy = test::EveryElement;
MAMMORAY_FOR_EVERY_ELEMENT(ElementEnergy);

TEST_P(ElementEnergy, OfAnAffineMapIsItsClosedForm)
{
  const ElasticBody body(test::MakeBoxMesh({ 0, 0, 0 }, { 2, 3, 4 }, { 2, 2, 2 }),
    { {}, FromModuli(2, 300) }, {}, {}, GetParam());
  // F = diag(1.2, 0.9, 1.1) plus a shear, which changes tr F^T F but not det F.
  std::vector<double> x = body.RestPositions();
  for (std::size_t n = 0; n < x.size(); n += 3)
  {
    const double z = x[n + 2];
    x[n] = 1.2 * x[n] + 0.3 * z;
    x[n + 1] *= 0.9;
    x[n + 2] = 1.1 * z;
  }
  const double j = 1.2 * 0.9 * 1.1;
  const double trace = 1.2 * 1.2 + 0.9 * 0.9 + 1.1 * 1.1 + 0.3 * 0.3;
  const double density =
    2 / 2.0 * (std::pow(j, -2 / 3.0) * trace - 3) + 300 / 2.0 * (j - 1) * (j - 1);
  // 1e-12: roundoff of sums over 48 cells.
  EXPECT_NEAR(test::Value(ElasticEnergy(body), x) / (24 * density), 1, 1e-12);
}

TEST_P(ElementEnergy, GradientAndHessianMatchCentralDifferences)
{
  // kappa / mu below and above the ratio up to which volume counts point by point; both laws.
  for (const auto& [kappa, exponent] :
    { std::pair{ 30.0, 0.0 }, { 4000.0, 0.0 }, { 30.0, 5.0 }, { 4000.0, 5.0 } })
  {
    const ElasticBody body(test::MakeBoxMesh({ 0, 0, 0 }, { 2, 2, 4 }, { 1, 1, 2 }),
      { {}, FromModuli(3, kappa, exponent) }, {}, {}, GetParam());
    // h^2 = 1e-10 for truncation, eps / h = 2e-11 for roundoff, times factors of order 10.
    ElasticEnergy energy(body);
    DerivativeErrors errors =
      FindDerivativeErrors(energy, Shaken(body.RestPositions(), 0.06, 7), 1e-5);
    EXPECT_LT(errors.Gradient, 1e-8 * errors.GradientSize);
    EXPECT_LT(errors.Hessian, 1e-8 * errors.HessianSize);
    // Far enough for cells to be turned inside out, where only the extended energy is defined; its
    // third derivatives are ten times as large there.
    energy.SetDomain(ElasticEnergy::Domain::Extended);
    errors = FindDerivativeErrors(energy, Shaken(body.RestPositions(), 2, 7), 1e-5);
    EXPECT_LT(errors.Gradient, 1e-7 * errors.GradientSize);
    EXPECT_LT(errors.Hessian, 1e-7 * errors.HessianSize);
    EXPECT_LT(errors.Measures.SmallestJ, 0);
  }
}

TEST_P(ElementEnergy, IsTheSameInTheExtendedDomainWhereCellsKeepATenthOfTheirVolume)
{
  const ElasticBody body(test::MakeBoxMesh({ 0, 0, 0 }, { 2, 2, 4 }, { 1, 1, 2 }),
    { {}, FromModuli(3, 100) }, {}, {}, GetParam());
  const std::vector<double> x = Shaken(body.RestPositions(), 0.06, 7);
  const ElasticEnergy energy(body);
  ElasticEnergy continued(body);
  continued.SetDomain(ElasticEnergy::Domain::Extended);
  for (std::size_t element = 0; element < body.NumberOfElements(); ++element)
  {
    const PieceResult terms = EvaluatePiece(energy, element, x, EnergyOrder::Hessian);
    const PieceResult extended = EvaluatePiece(continued, element, x, EnergyOrder::Hessian);
    ASSERT_TRUE(terms.Valid && extended.Valid);
    ASSERT_GT(terms.Measures.SmallestJ, 0.1);
    EXPECT_EQ(terms.Value, extended.Value);
    EXPECT_EQ(terms.Gradient, extended.Gradient);
    EXPECT_EQ(terms.Hessian, extended.Hessian);
  }
}

TEST_P(ElementEnergy, HasAProjectedHessianWithoutNegativeCurvature)
{
  const ElasticBody body(test::MakeBoxMesh({ 0, 0, 0 }, { 1, 1, 1 }, { 1, 1, 1 }),
    { {}, FromModuli(1, 40) }, {}, {}, GetParam());
  // Squeezed flat: the true matrix is indefinite.
  std::vector<double> x = body.RestPositions();
  for (std::size_t n = 2; n < x.size(); n += 3)
  {
    x[n] *= 0.5;
  }
  x = Shaken(x, 0.02, 3);
  std::mt19937 generator(11);
  std::normal_distribution<double> normal;
  bool sawNegative = false;
  const ElasticEnergy energy(body);
  for (std::size_t element = 0; element < body.NumberOfElements(); ++element)
  {
    const PieceResult exact = EvaluatePiece(energy, element, x, EnergyOrder::Hessian);
    const PieceResult projected = EvaluatePiece(energy, element, x, EnergyOrder::ProjectedHessian);
    ASSERT_TRUE(exact.Valid && projected.Valid);
    const std::size_t unknowns = exact.Gradient.size();
    for (int trial = 0; trial < 500; ++trial)
    {
      // Powers of (s - H) pull the direction towards the lowest curvature.
      std::vector<double> v(unknowns);
      for (double& value : v)
      {
        value = normal(generator);
      }
      double curvature[2] = { 0, 0 };
      double size = 0;
      for (std::size_t r = 0; r < unknowns; ++r)
      {
        for (std::size_t c = 0; c < unknowns; ++c)
        {
          curvature[0] += v[r] * v[c] * exact.Hessian[unknowns * c + r];
          curvature[1] += v[r] * v[c] * projected.Hessian[unknowns * c + r];
          size += std::abs(v[r] * v[c] * projected.Hessian[unknowns * c + r]);
        }
      }
      EXPECT_GE(curvature[1], -1e-12 * size);
      // Projection only adds.
      EXPECT_GE(curvature[1], curvature[0] - 1e-12 * size);
      sawNegative = sawNegative || curvature[1] > curvature[0] + 1e-6 * size;
    }
  }
  EXPECT_TRUE(sawNegative) << "the state was meant to need projecting";
}

TEST_P(ElementEnergy, DoesNotSeeRotations)
{
  const ElasticBody body(test::MakeBoxMesh({ 0, 0, 0 }, { 2, 2, 2 }, { 2, 2, 2 }),
    { {}, FromModuli(3, 900) }, {}, {}, GetParam());
  const std::vector<double> x = Shaken(body.RestPositions(), 0.03, 5);
  std::vector<double> turned = x;
  const double c = std::cos(0.7), s = std::sin(0.7);
  for (std::size_t n = 0; n < x.size(); n += 3)
  {
    turned[n] = c * x[n] - s * x[n + 2] + 5;
    turned[n + 2] = s * x[n] + c * x[n + 2] - 3;
  }
  // 1e-11: det F near 1 loses digits in (J - 1)^2 * kappa.
  const ElasticEnergy energy(body);
  EXPECT_NEAR(test::Value(energy, turned) / test::Value(energy, x), 1, 1e-11);
}

TEST_P(ElementEnergy, RefusesInvertedCells)
{
  const ElasticBody body(test::MakeBoxMesh({ 0, 0, 0 }, { 1, 1, 1 }, { 1, 1, 1 }), { {}, {} }, {},
    {}, GetParam());
  std::vector<double> x = body.RestPositions();
  for (std::size_t n = 2; n < x.size(); n += 3)
  {
    x[n] *= -1;
  }
  EXPECT_FALSE(EvaluatePiece(ElasticEnergy(body), 0, x, EnergyOrder::Value).Valid);
}

TEST_P(ElementEnergy, GradientRateMatchesCentralDifferencesInTheMaterials)
{
  const TetrahedralMesh mesh = test::MakeBoxMesh({ 0, 0, 0 }, { 4, 4, 4 }, { 1, 1, 1 });
  // Mixed cells: two materials by the field, one of them so little compressible that part of its
  // kappa acts on the mean alone.
  const std::vector<ElasticMaterial> materials{ {}, FromModuli(1, 20, 2), FromModuli(4, 3000, 6) };
  ElasticBody body(
    mesh, materials, [](const Vector3& p) { return p[2] < 1.5 ? 2 : 1; }, {}, GetParam());
  const ElasticEnergy energy(body);
  const std::vector<double> x = Shaken(body.RestPositions(), 0.15, 9);
  const MaterialDerivative velocities[] = { { {}, { 1, 0, 0 }, {} }, { {}, {}, { 1, 0, 0 } },
    { {}, { 0, 1, 0 }, {} }, { {}, {}, { 0, 0.01, 0 } }, { {}, { 0, 0, 1 }, {} },
    { {}, { 2, 0.05, 1 }, { -1, 0.001, 2 } } };
  for (const MaterialDerivative& velocity : velocities)
  {
    for (std::size_t element = 0; element < body.NumberOfElements(); ++element)
    {
      body.SetMaterials(materials);
      const std::vector<double> exact = energy.GradientDerivative(element, x, velocity);
      const double h = 1e-5;
      PieceResult sides[2];
      for (int side = 0; side < 2; ++side)
      {
        std::vector<ElasticMaterial> moved = materials;
        for (std::size_t m = 0; m < moved.size(); ++m)
        {
          const double by = side ? h : -h;
          moved[m].YoungsModulusKPa += by * velocity[m].YoungsModulusKPa;
          moved[m].PoissonRatio += by * velocity[m].PoissonRatio;
          moved[m].FungExponent += by * velocity[m].FungExponent;
        }
        body.SetMaterials(moved);
        sides[side] = EvaluatePiece(energy, element, x, EnergyOrder::Gradient);
        ASSERT_TRUE(sides[side].Valid);
      }
      double error = 0, size = 0;
      for (std::size_t c = 0; c < exact.size(); ++c)
      {
        const double slope = (sides[1].Gradient[c] - sides[0].Gradient[c]) / (2 * h);
        error = std::max(error, std::abs(slope - exact[c]));
        size = std::max(size, std::abs(slope));
      }
      // h^2 = 1e-10 for truncation, times 1 / (1 - 2 nu)^2 = 6e5 of kappa's curvature in nu times
      // the rate squared; eps / h = 2e-11 for roundoff, times force over rate.
      EXPECT_LT(error, 1e-6 * size);
    }
  }
}
}
