// SPDX-License-Identifier: Apache-2.0
// Vectors of node values, and checks of the solver's derivatives.
#ifndef mammoray_Testing_EquilibriumChecks_h
#define mammoray_Testing_EquilibriumChecks_h

#include "TestMeshes.h"
#include "mammoray/Biomechanics/Private/EquilibriumSolver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <span>
#include <vector>

namespace mammoray::test
{
inline std::vector<double> Shaken(std::vector<double> x, double size, unsigned seed)
{
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> shake(-size, size);
  for (double& coordinate : x)
  {
    coordinate += shake(generator);
  }
  return x;
}

inline double DotOf(std::span<const double> a, std::span<const double> b)
{
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

inline double NormOf(std::span<const double> v)
{
  return std::sqrt(DotOf(v, v));
}

inline std::vector<double> Difference(std::span<const double> a, std::span<const double> b)
{
  std::vector<double> result(a.size());
  std::transform(a.begin(), a.end(), b.begin(), result.begin(), std::minus<>());
  return result;
}

/// A material with the given shear and bulk modulus.
inline ElasticMaterial FromModuli(double mu, double kappa, double fungExponent = 0)
{
  ElasticMaterial material;
  material.PoissonRatio = (3 * kappa - 2 * mu) / (2 * (3 * kappa + mu));
  material.YoungsModulusKPa = 2 * mu * (1 + material.PoissonRatio);
  material.FungExponent = fungExponent;
  return material;
}

/// One flag per cell.
inline std::vector<bool> CellsOfMaterial(const TetrahedralMesh& mesh, int material)
{
  std::vector<bool> cells;
  for (const int found : mesh.Materials)
  {
    cells.push_back(found == material);
  }
  return cells;
}

/// A block between plates whose edges end over its middle: faces, flat and round, all touch. Its
/// lowest layer in y is of material 2.
struct PressedBlock
{
  ElasticBody Body;
  PlatePair Plates;
  std::vector<double> Positions = Shaken(Body.RestPositions(), 0.3, 17);

  explicit PressedBlock(ElementType type)
    : Body(Mesh(), { {}, FromModuli(3, 100), FromModuli(3, 100) }, {}, { false, false, true }, type)
  {
    this->Plates.Support.Edge = { 0, 9, 0.3 };
    this->Plates.Paddle.Edge = { 0, 11, 19.7 };
    this->Plates.Paddle.Normal = { 0, 0, -1 };
  }
  static TetrahedralMesh Mesh()
  {
    TetrahedralMesh mesh = MakeBoxMesh({ 0, 0, 0 }, { 20, 20, 20 }, { 2, 2, 2 });
    for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
    {
      double middle = 0;
      for (int corner = 0; corner < 4; ++corner)
      {
        middle += 0.25 * mesh.Point(mesh.Cells[4 * cell + corner])[1];
      }
      mesh.Materials[cell] = middle < 10 ? 2 : 1;
    }
    return mesh;
  }
};

/// The energy with its derivatives at `x` between the plates, null for none.
inline Evaluation EvaluateAt(EquilibriumSolver& solver, const std::vector<double>& x,
  const PlatePair* plates, EnergyOrder order)
{
  solver.Energy().SetPlates(plates);
  Evaluation evaluation;
  solver.Energy().Evaluate(x, order, evaluation);
  EXPECT_TRUE(evaluation.Valid);
  return evaluation;
}

inline std::vector<double> GradientOf(EquilibriumSolver& solver, const std::vector<double>& x,
  const PlatePair* plates)
{
  return EvaluateAt(solver, x, plates, EnergyOrder::Gradient).Gradient;
}

/// The Hessian times `direction`; zero at fixed coordinates.
inline std::vector<double> HessianProduct(EquilibriumSolver& solver, const std::vector<double>& x,
  const PlatePair* plates, const std::vector<double>& direction)
{
  const std::vector<double> hessian = EvaluateAt(solver, x, plates, EnergyOrder::Hessian).Hessian;
  const std::vector<std::int32_t>& coordinates = solver.Energy().Coordinates();
  const SparsePattern& pattern = solver.Energy().Pattern();
  std::vector<double> product(x.size(), 0.0);
  for (std::size_t column = 0; column < coordinates.size(); ++column)
  {
    for (int k = pattern.Starts[column]; k < pattern.Starts[column + 1]; ++k)
    {
      const std::int32_t row = coordinates[pattern.Rows[k]];
      product[row] += hessian[k] * direction[coordinates[column]];
      if (row != coordinates[column])
      {
        product[coordinates[column]] += hessian[k] * direction[row];
      }
    }
  }
  return product;
}

/**
 * Gradient, stiffness and its symmetry at `x` in five random directions. 1e-7: h^2 for truncation
 * and eps / h for roundoff, 1e-9 at the best step, times the contact's stiffness over the tissue's,
 * 100. Only where no coordinate is fixed.
 */
inline void ExpectExactDerivatives(EquilibriumSolver& solver, const std::vector<double>& x,
  const PlatePair& plates)
{
  const std::size_t size = x.size();
  const std::vector<double> gradient = GradientOf(solver, x, &plates);
  for (unsigned seed = 1; seed <= 5; ++seed)
  {
    std::vector<double> direction = Shaken(std::vector<double>(size, 0.0), 1, seed);
    const std::vector<double> product = HessianProduct(solver, x, &plates, direction);
    double slopeError = 1, curvatureError = 1;
    for (const double h : { 1e-4, 1e-5, 1e-6 })
    {
      std::vector<double> low = x, high = x;
      for (std::size_t c = 0; c < size; ++c)
      {
        low[c] -= h * direction[c];
        high[c] += h * direction[c];
      }
      const double slope =
        (solver.Evaluate(high, &plates).Energy - solver.Evaluate(low, &plates).Energy) / (2 * h);
      slopeError =
        std::min(slopeError, std::abs(slope - DotOf(gradient, direction)) / NormOf(gradient));
      std::vector<double> difference =
        Difference(GradientOf(solver, high, &plates), GradientOf(solver, low, &plates));
      for (double& value : difference)
      {
        value /= 2 * h;
      }
      curvatureError =
        std::min(curvatureError, NormOf(Difference(difference, product)) / NormOf(product));
    }
    EXPECT_LT(slopeError, 1e-7);
    EXPECT_LT(curvatureError, 1e-7);
    const std::vector<double> other = Shaken(std::vector<double>(size, 0.0), 1, 100 + seed);
    const double forth = DotOf(other, product);
    const double back = DotOf(direction, HessianProduct(solver, x, &plates, other));
    EXPECT_NEAR(forth, back, 1e-12 * NormOf(product) * NormOf(other));
  }
}
}

#endif
