// SPDX-License-Identifier: Apache-2.0
#include "ElasticBody.h"
#include "EquilibriumChecks.h"
#include "EquilibriumSolver.h"
#include "Error.h"
#include "TestMeshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace
{
using namespace mammoray;

using test::Difference;
using test::FromModuli;
using test::NormOf;
using test::PressedBlock;
using test::Shaken;

double Energy(const ElasticBody& body, const std::vector<double>& x)
{
  double energy = 0;
  ElasticBody::Terms terms;
  for (std::size_t cell = 0; cell < body.NumberOfCells(); ++cell)
  {
    EXPECT_TRUE(body.CellTerms(cell, x, ElasticBody::Order::Energy, terms));
    energy += terms.Energy;
  }
  return energy;
}

TEST(ElasticBody, EnergyOfAnAffineMapIsItsClosedForm)
{
  const ElasticBody body(test::MakeBoxMesh({ 0, 0, 0 }, { 2, 3, 4 }, { 2, 2, 2 }),
    { {}, FromModuli(2, 300) });
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
  EXPECT_NEAR(Energy(body, x) / (24 * density), 1, 1e-12);
}

TEST(ElasticBody, GradientAndHessianMatchCentralDifferences)
{
  // kappa / mu below and above the ratio up to which volume counts point by point; both laws.
  for (const auto& [kappa, exponent] :
    { std::pair{ 30.0, 0.0 }, { 4000.0, 0.0 }, { 30.0, 5.0 }, { 4000.0, 5.0 } })
  {
    const ElasticBody body(test::MakeBoxMesh({ 0, 0, 0 }, { 2, 2, 2 }, { 1, 1, 1 }),
      { {}, FromModuli(3, kappa, exponent) });
    const std::vector<double> x = Shaken(body.RestPositions(), 0.06, 7);
    ElasticBody::Terms terms;
    for (std::size_t cell = 0; cell < body.NumberOfCells(); ++cell)
    {
      ASSERT_TRUE(body.CellTerms(cell, x, ElasticBody::Order::Hessian, terms));
      double gradientError = 0, gradientSize = 0, hessianError = 0, hessianSize = 0;
      for (int c = 0; c < 30; ++c)
      {
        const double h = 1e-5;
        ElasticBody::Terms sides[2];
        for (int side = 0; side < 2; ++side)
        {
          std::vector<double> moved = x;
          moved[3 * body.Cells()[10 * cell + c / 3] + c % 3] += side ? h : -h;
          ASSERT_TRUE(body.CellTerms(cell, moved, ElasticBody::Order::Gradient, sides[side]));
        }
        const double slope = (sides[1].Energy - sides[0].Energy) / (2 * h);
        gradientError = std::max(gradientError, std::abs(slope - terms.Gradient[c]));
        gradientSize = std::max(gradientSize, std::abs(slope));
        for (int r = 0; r < 30; ++r)
        {
          const double curvature = (sides[1].Gradient[r] - sides[0].Gradient[r]) / (2 * h);
          hessianError = std::max(hessianError, std::abs(curvature - terms.Hessian[30 * c + r]));
          hessianSize = std::max(hessianSize, std::abs(curvature));
          EXPECT_DOUBLE_EQ(terms.Hessian[30 * c + r], terms.Hessian[30 * r + c]);
        }
      }
      // h^2 = 1e-10 for truncation, eps / h = 2e-11 for roundoff, times factors of order 10.
      EXPECT_LT(gradientError, 1e-8 * gradientSize);
      EXPECT_LT(hessianError, 1e-8 * hessianSize);
    }
  }
}

TEST(ElasticBody, ProjectedHessianHasNoNegativeCurvature)
{
  const ElasticBody body(test::MakeBoxMesh({ 0, 0, 0 }, { 1, 1, 1 }, { 1, 1, 1 }),
    { {}, FromModuli(1, 40) });
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
  for (std::size_t cell = 0; cell < body.NumberOfCells(); ++cell)
  {
    ElasticBody::Terms exact, projected;
    ASSERT_TRUE(body.CellTerms(cell, x, ElasticBody::Order::Hessian, exact));
    ASSERT_TRUE(body.CellTerms(cell, x, ElasticBody::Order::ProjectedHessian, projected));
    for (int trial = 0; trial < 500; ++trial)
    {
      // Powers of (s - H) pull the direction towards the lowest curvature.
      double v[30];
      for (double& value : v)
      {
        value = normal(generator);
      }
      double curvature[2] = { 0, 0 };
      double size = 0;
      for (int r = 0; r < 30; ++r)
      {
        for (int c = 0; c < 30; ++c)
        {
          curvature[0] += v[r] * v[c] * exact.Hessian[30 * c + r];
          curvature[1] += v[r] * v[c] * projected.Hessian[30 * c + r];
          size += std::abs(v[r] * v[c] * projected.Hessian[30 * c + r]);
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

TEST(ElasticBody, EnergyDoesNotSeeRotations)
{
  const ElasticBody body(test::MakeBoxMesh({ 0, 0, 0 }, { 2, 2, 2 }, { 2, 2, 2 }),
    { {}, FromModuli(3, 900) });
  const std::vector<double> x = Shaken(body.RestPositions(), 0.03, 5);
  std::vector<double> turned = x;
  const double c = std::cos(0.7), s = std::sin(0.7);
  for (std::size_t n = 0; n < x.size(); n += 3)
  {
    turned[n] = c * x[n] - s * x[n + 2] + 5;
    turned[n + 2] = s * x[n] + c * x[n + 2] - 3;
  }
  // 1e-11: det F near 1 loses digits in (J - 1)^2 * kappa.
  EXPECT_NEAR(Energy(body, turned) / Energy(body, x), 1, 1e-11);
}

TEST(ElasticBody, RefusesInvertedCells)
{
  const ElasticBody body(test::MakeBoxMesh({ 0, 0, 0 }, { 1, 1, 1 }, { 1, 1, 1 }), { {}, {} });
  std::vector<double> x = body.RestPositions();
  for (std::size_t n = 2; n < x.size(); n += 3)
  {
    x[n] *= -1;
  }
  ElasticBody::Terms terms;
  EXPECT_FALSE(body.CellTerms(0, x, ElasticBody::Order::Energy, terms));
}

TEST(ElasticBody, AveragesTheFieldAroundQuadraturePoints)
{
  const TetrahedralMesh mesh = test::MakeBoxMesh({ 0, 0, 0 }, { 4, 4, 4 }, { 1, 1, 1 });
  const std::vector<ElasticMaterial> materials{ {}, FromModuli(1, 20), FromModuli(3, 60),
    FromModuli(100, 2000) };
  // Material 2 where z < 2, air elsewhere: there the cell's own material 1 counts.
  const ElasticBody half(mesh, materials, [](const Vector3& p) { return p[2] < 2 ? 2 : 0; });
  double mu = 0;
  for (std::size_t cell = 0; cell < half.NumberOfCells(); ++cell)
  {
    mu += half.CellShearModulus(cell) / static_cast<double>(half.NumberOfCells());
  }
  // 2 % of the difference of 2: the lattice has 220 points in a cell, quadrature points a quarter
  // each.
  EXPECT_NEAR(mu, 2, 0.04);
  // An ignored material counts as the cell's own.
  const ElasticBody ignoring(mesh, materials, [](const Vector3&) { return 3; },
    { false, false, false, true });
  EXPECT_DOUBLE_EQ(ignoring.CellShearModulus(0), materials[1].ShearModulusKPa());
  EXPECT_THROW(ElasticBody(mesh, materials, [](const Vector3&) { return 9; }), InputError);
}

TEST(ElasticBody, GradientRateMatchesCentralDifferencesInTheMaterials)
{
  const TetrahedralMesh mesh = test::MakeBoxMesh({ 0, 0, 0 }, { 4, 4, 4 }, { 1, 1, 1 });
  // Mixed cells: two materials by the field, one of them so little compressible that part of its
  // kappa acts on the mean alone.
  const std::vector<ElasticMaterial> materials{ {}, FromModuli(1, 20, 2), FromModuli(4, 3000, 6) };
  ElasticBody body(mesh, materials, [](const Vector3& p) { return p[2] < 1.5 ? 2 : 1; });
  const std::vector<double> x = Shaken(body.RestPositions(), 0.15, 9);
  const MaterialVelocity velocities[] = { { {}, { 1, 0, 0 }, {} }, { {}, {}, { 1, 0, 0 } },
    { {}, { 0, 1, 0 }, {} }, { {}, {}, { 0, 0.01, 0 } }, { {}, { 0, 0, 1 }, {} },
    { {}, { 2, 0.05, 1 }, { -1, 0.001, 2 } } };
  for (const MaterialVelocity& velocity : velocities)
  {
    for (std::size_t cell = 0; cell < body.NumberOfCells(); ++cell)
    {
      body.SetMaterials(materials);
      const auto exact = body.GradientRate(cell, x, velocity);
      const double h = 1e-5;
      ElasticBody::Terms sides[2];
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
        ASSERT_TRUE(body.CellTerms(cell, x, ElasticBody::Order::Gradient, sides[side]));
      }
      double error = 0, size = 0;
      for (int c = 0; c < 30; ++c)
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

TEST(ElasticBody, RefusesBadMaterials)
{
  const TetrahedralMesh mesh = test::MakeBoxMesh({ 0, 0, 0 }, { 1, 1, 1 }, { 1, 1, 1 });
  EXPECT_THROW(ElasticBody(mesh, { {}, { 5, 0.5 } }), InputError);
  EXPECT_THROW(ElasticBody(mesh, { {}, { -1, 0.4 } }), InputError);
  EXPECT_THROW(ElasticBody(mesh, { {}, { 5, 0.4, -1 } }), InputError);
  EXPECT_THROW(ElasticBody(mesh, { {}, { 5, 0.4, 51 } }), InputError);
  ElasticBody body(mesh, { {}, { 5, 0.4 } });
  EXPECT_THROW(body.SetMaterials({ {} }), InputError);
  EXPECT_THROW(ElasticBody(mesh, { {} }), InputError) << "material 1 is not in the table";
}

TEST(EquilibriumSolver, PatchTestReproducesAffineMaps)
{
  const ElasticBody body(test::MakeBoxMesh({ 0, 0, 0 }, { 3, 3, 3 }, { 3, 3, 3 }),
    { {}, FromModuli(2, 2000) });
  std::vector<double> affine = body.RestPositions();
  std::vector<bool> fixed(affine.size(), false);
  for (std::size_t n = 0; n < affine.size(); n += 3)
  {
    const double x = affine[n], y = affine[n + 1], z = affine[n + 2];
    for (int axis = 0; axis < 3; ++axis)
    {
      const double c = affine[n + axis];
      if (c < 1e-9 || c > 3 - 1e-9)
      {
        fixed[n] = fixed[n + 1] = fixed[n + 2] = true;
      }
    }
    affine[n] = 1.1 * x + 0.2 * y;
    affine[n + 1] = 0.95 * y - 0.1 * z;
    affine[n + 2] = 0.05 * x + 0.97 * z;
  }
  std::vector<double> start = Shaken(affine, 0.03, 2);
  for (std::size_t c = 0; c < affine.size(); ++c)
  {
    start[c] = fixed[c] ? affine[c] : start[c];
  }
  EquilibriumSolver solver(body, fixed, 1);
  const EquilibriumReport report = solver.Solve(start, nullptr, 1e-13, 30);
  EXPECT_TRUE(report.Converged) << report.Reason << " " << report.RelativeResidual;
  // 1e-11 of 3 mm: roundoff through a matrix of condition 1e5 at most.
  EXPECT_LT(NormOf(Difference(start, affine)), 3e-11);
}

/// Nominal stress of a bar along the first of the stretches (a, b, b) or along one of the others.
double BarStress(const ElasticMaterial& material, double a, double b, bool alongFirst)
{
  const double mu = material.ShearModulusKPa(), kappa = material.BulkModulusKPa();
  const double j = a * b * b, trace = a * a + 2 * b * b;
  const double stretch = alongFirst ? a : b;
  const double growth = std::exp(material.FungExponent * (std::pow(j, -2 / 3.0) * trace - 3));
  return mu * growth * std::pow(j, -2 / 3.0) * (stretch - trace / (3 * stretch)) +
    kappa * (j - 1) * j / stretch;
}

double SolveLateralStretch(const ElasticMaterial& material, double axial)
{
  double low = 0.5, high = 3;
  for (int i = 0; i < 200; ++i)
  {
    const double middle = 0.5 * (low + high);
    (BarStress(material, axial, middle, false) > 0 ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

TEST(EquilibriumSolver, UniaxialCompressionMatchesTheClosedForm)
{
  constexpr double mu = 2;
  for (const auto& [ratio, exponent] : { std::pair{ 10.0, 0.0 }, { 100.0, 0.0 }, { 1e3, 0.0 },
         { 1e4, 0.0 }, { 100.0, 3.0 }, { 1e3, 1e-9 } })
  {
    const ElasticMaterial material = FromModuli(mu, ratio * mu, exponent);
    const ElasticBody body(test::MakeBoxMesh({ 0, 0, 0 }, { 4, 4, 4 }, { 2, 2, 2 }),
      { {}, material });
    // Symmetry planes at 0, the top pushed down to 0.6 of the height, four sides free.
    std::vector<double> x = body.RestPositions();
    std::vector<bool> fixed(x.size(), false);
    for (std::size_t n = 0; n < x.size(); n += 3)
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        fixed[n + axis] = x[n + axis] < 1e-9 || (axis == 2 && x[n + axis] > 4 - 1e-9);
      }
      x[n] *= 1.2;
      x[n + 1] *= 1.2;
      x[n + 2] *= 0.6;
    }
    EquilibriumSolver solver(body, fixed, 1);
    // From a start far from the solution in the interior as well.
    std::vector<double> start = x;
    const std::vector<double> shaken = Shaken(x, 0.05, 4);
    for (std::size_t c = 0; c < x.size(); ++c)
    {
      start[c] = fixed[c] ? x[c] : shaken[c];
    }
    const EquilibriumReport report = solver.Solve(start, nullptr, 2e-11, 60);
    ASSERT_TRUE(report.Converged) << report.Reason << " " << report.RelativeResidual;
    const double lateral = SolveLateralStretch(material, 0.6);
    double largest = 0;
    for (std::size_t n = 0; n < start.size(); n += 3)
    {
      const double* rest = &body.RestPositions()[n];
      largest = std::max({ largest, std::abs(start[n] - lateral * rest[0]),
        std::abs(start[n + 1] - lateral * rest[1]), std::abs(start[n + 2] - 0.6 * rest[2]) });
    }
    EXPECT_LT(largest, 4e-9) << "kappa / mu = " << ratio; // 1e-9 of the block's 4 mm

    // The force: first Piola-Kirchhoff stress along the axis times the undeformed area.
    const double stress = BarStress(material, 0.6, lateral, true);
    double force = 0;
    const std::vector<double> gradient = solver.Gradient(start, nullptr);
    for (std::size_t n = 2; n < start.size(); n += 3)
    {
      force += body.RestPositions()[n] > 4 - 1e-9 ? gradient[n] : 0;
    }
    EXPECT_NEAR(force / (16 * stress), 1, 1e-9) << "kappa / mu = " << ratio;
  }
}

TEST(EquilibriumSolver, CooksMembraneNearlyIncompressible)
{
  // Simo and Armero (1992): a tapered panel in plane strain, mu = 80.1938, kappa = 400889.8, held
  // at one end and sheared at the other by 6.25 per area; its upper corner rises by 6.9.
  TetrahedralMesh mesh = test::MakeBoxMesh({ 0, 0, 0 }, { 1, 1, 2 }, { 18, 18, 1 });
  for (std::size_t p = 0; p < mesh.Points.size(); p += 3)
  {
    const double u = mesh.Points[p], v = mesh.Points[p + 1];
    mesh.Points[p] = 48 * u;
    mesh.Points[p + 1] = 44 * u + v * (44 - 28 * u);
  }
  const ElasticBody body(mesh, { {}, FromModuli(80.1938, 400889.8) });
  std::vector<double> x = body.RestPositions();
  std::vector<bool> fixed(x.size(), false);
  std::size_t tip = 0;
  for (std::size_t n = 0; n < x.size(); n += 3)
  {
    fixed[n] = fixed[n + 1] = x[n] < 1e-9;
    fixed[n + 2] = true;
    tip = x[n] + x[n + 1] > x[tip] + x[tip + 1] ? n : tip;
  }
  // An even traction on a six-node triangle: a third of it on each middle, none on the corners.
  std::vector<double> loads(x.size(), 0.0);
  for (const ElasticBody::BoundaryFace& face : body.Faces())
  {
    const std::int32_t* nodes = &body.Cells()[ElasticBody::NodesPerCell * face.Cell];
    bool loaded = true;
    for (const int local : face.LocalNodes)
    {
      loaded = loaded && x[3 * nodes[local]] > 48 - 1e-9;
    }
    for (int a = 3; a < 6 && loaded; ++a)
    {
      loads[3 * nodes[face.LocalNodes[a]] + 1] += 6.25 * face.Area / 3;
    }
  }
  EquilibriumSolver solver(body, fixed, 1);
  solver.SetLoads(loads);
  const EquilibriumReport report = solver.Solve(x, nullptr, 1e-7, 100);
  ASSERT_TRUE(report.Converged) << report.Reason;
  // 2 % is left to the mesh, which nears the reference from below: 6.72 on 10 x 10 bricks, 6.86 on
  // 24 x 24.
  EXPECT_NEAR(x[tip + 1] - body.RestPositions()[tip + 1], 6.9, 0.02 * 6.9);
}

TEST(EquilibriumSolver, ForceAndStiffnessWithContactMatchCentralDifferences)
{
  const PressedBlock block;
  const std::size_t size = block.Positions.size();
  const EquilibriumSolver solver(block.Body, std::vector<bool>(size, false), 1000);
  const EquilibriumReport report = solver.Evaluate(block.Positions, &block.Plates);
  ASSERT_GT(report.PaddleForceN, 0.01);
  ASSERT_GT(report.SupportForceN, 0.01);
  test::ExpectExactDerivatives(solver, block.Positions, block.Plates);
}

TEST(EquilibriumSolver, ForcesTurnWithBodyAndPlates)
{
  const PressedBlock block;
  const EquilibriumSolver solver(block.Body, std::vector<bool>(block.Positions.size(), false),
    1000);
  PlatePairVelocity turn;
  turn.Support.Angular = turn.Paddle.Angular = { 0.4, -0.3, 0.9 };
  // Both plates about the origin; a vector turns as the plates' normals do.
  const auto turned = [&](const Vector3& v)
  {
    const double length = Norm(v);
    Plate along;
    along.Normal = (1 / length) * v;
    return length * MovedPlate(along, turn.Support, 1).Normal;
  };
  PlatePair plates = MovedPlates(block.Plates, turn, 1);
  plates.Support.Edge = turned(block.Plates.Support.Edge);
  plates.Paddle.Edge = turned(block.Plates.Paddle.Edge);
  const auto turnedAll = [&](std::vector<double> values)
  {
    for (std::size_t n = 0; n < values.size(); n += 3)
    {
      const Vector3 v = turned({ values[n], values[n + 1], values[n + 2] });
      std::copy(v.begin(), v.end(), &values[n]);
    }
    return values;
  };
  const std::vector<double> expected = turnedAll(solver.Gradient(block.Positions, &block.Plates));
  const std::vector<double> found = solver.Gradient(turnedAll(block.Positions), &plates);
  // 1e-11: roundoff of positions, 1e-15 of 20 mm, over the contact layer of 0.05 mm.
  EXPECT_LT(NormOf(Difference(found, expected)), 1e-11 * NormOf(expected));
}

TEST(EquilibriumSolver, BlockUnderPartialLoadMatchesReeseWriggersAndReddy)
{
  // Reese, Wriggers and Reddy (2000), section 4: a quarter of a block of 2 x 2 x 1, its bottom held
  // along the normal, its top within the plane, nu = 0.4999 (mu = 80.194, p0 = 4, dead load).
  // Pressed over the middle 1 x 1 of the top. Compression at the middle, quadratic elements.
  constexpr int count = 4;
  const ElasticBody body(test::MakeBoxMesh({ 0, 0, 0 }, { 1, 1, 1 }, { count, count, count }),
    { {}, FromModuli(80.194, 400889.806) });
  std::vector<double> x = body.RestPositions();
  std::vector<bool> fixed(x.size(), false);
  std::size_t middle = 0;
  for (std::size_t n = 0; n < x.size(); n += 3)
  {
    const bool top = x[n + 2] > 1 - 1e-9;
    fixed[n] = x[n] < 1e-9 || top;
    fixed[n + 1] = x[n + 1] < 1e-9 || top;
    fixed[n + 2] = x[n + 2] < 1e-9;
    middle = x[n] + x[n + 1] < 1e-9 && top ? n + 2 : middle;
  }
  std::vector<double> unitLoads(x.size(), 0.0);
  for (const ElasticBody::BoundaryFace& face : body.Faces())
  {
    const std::int32_t* nodes = &body.Cells()[ElasticBody::NodesPerCell * face.Cell];
    const bool pressed = std::all_of(face.LocalNodes.begin(), face.LocalNodes.end(),
      [&](int local)
      {
        const double* p = &body.RestPositions()[3 * nodes[local]];
        return p[2] > 1 - 1e-9 && p[0] < 0.5 + 1e-9 && p[1] < 0.5 + 1e-9;
      });
    for (int a = 3; a < 6 && pressed; ++a)
    {
      unitLoads[3 * nodes[face.LocalNodes[a]] + 2] -= 4 * face.Area / 3;
    }
  }
  EquilibriumSolver solver(body, fixed, 1);
  constexpr double published[4] = { 0.220, 0.424, 0.584, 0.691 };
  for (int level = 1; level <= 4; ++level)
  {
    std::vector<double> loads = unitLoads;
    for (double& load : loads)
    {
      load *= 20 * level;
    }
    solver.SetLoads(loads);
    const EquilibriumReport report = solver.Solve(x, nullptr, 1e-6, 100);
    ASSERT_TRUE(report.Converged) << report.Reason;
    // 3 %: what is left to the mesh, 2.9 % at the least load and below 1 % at the largest.
    EXPECT_NEAR((1 - x[middle]) / published[level - 1], 1, 0.03) << "p / p0 = " << 20 * level;
  }
}
}
