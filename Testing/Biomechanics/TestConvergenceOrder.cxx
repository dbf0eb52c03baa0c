// SPDX-License-Identifier: Apache-2.0
// Order of convergence of both elements against a manufactured solution.
#include "EveryElement.h"
#include "TestMeshes.h"
#include "mammoray/Biomechanics/Private/CellPatches.h"
#include "mammoray/Biomechanics/Private/EquilibriumSolver.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace
{
using namespace mammoray;

constexpr double Side = 10; // mm, of a cube whose boundary does not move

/**
 * The manufactured deformation x = X + curl(0, 0, phi), phi = a sin^2(p X) sin^2(p Y) sin^2(p Z)
 * with p = pi / Side: zero displacement at the boundary and, to first order in a, no change of
 * volume.
 */
struct Exact
{
  Eigen::Vector3d Displacement;
  Eigen::Matrix3d F;

  /// `amplitude`: a, mm^2; 2 makes strains of up to 0.4.
  Exact(const Eigen::Vector3d& x, double amplitude)
  {
    constexpr double p = std::numbers::pi / Side;
    double s[3];
    double first[3];
    double second[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      s[axis] = std::pow(std::sin(p * x[axis]), 2);
      first[axis] = p * std::sin(2 * p * x[axis]);
      second[axis] = 2 * p * p * std::cos(2 * p * x[axis]);
    }
    this->Displacement =
      amplitude * Eigen::Vector3d(s[0] * first[1] * s[2], -first[0] * s[1] * s[2], 0);
    this->F = Eigen::Matrix3d::Identity();
    this->F.row(0) += amplitude *
      Eigen::RowVector3d(first[0] * first[1] * s[2], s[0] * second[1] * s[2],
        s[0] * first[1] * first[2]);
    this->F.row(1) -= amplitude *
      Eigen::RowVector3d(second[0] * s[1] * s[2], first[0] * first[1] * s[2],
        first[0] * s[1] * first[2]);
  }
};

/// First Piola-Kirchhoff stress of the neo-Hookean law, kPa.
Eigen::Matrix3d Stress(const ElasticMaterial& material, const Eigen::Matrix3d& f)
{
  const double j = f.determinant();
  const Eigen::Matrix3d inverse = f.inverse().transpose();
  return material.ShearModulusKPa() * std::pow(j, -2.0 / 3) * (f - f.squaredNorm() / 3 * inverse) +
    material.BulkModulusKPa() * (j - 1) * j * inverse;
}

/// A point of a tetrahedron in barycentric coordinates, and its share of the volume.
struct VolumePoint
{
  Eigen::Vector4d Lambda;
  double Weight;
};

/// A conical product of Gauss rules with four points, exact to degree 5 at least.
std::vector<VolumePoint> VolumePoints()
{
  constexpr double nodes[4] = { -0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
    0.8611363115940526 };
  constexpr double weights[4] = { 0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
    0.3478548451374538 };
  std::vector<VolumePoint> points;
  for (int i = 0; i < 4; ++i)
  {
    for (int j = 0; j < 4; ++j)
    {
      for (int k = 0; k < 4; ++k)
      {
        const double u = 0.5 * (1 + nodes[i]);
        const double v = 0.5 * (1 + nodes[j]);
        const double w = 0.5 * (1 + nodes[k]);
        const double b = u;
        const double c = v * (1 - u);
        const double d = w * (1 - u) * (1 - v);
        // 6: shares of the reference tetrahedron's volume, 1 / 6.
        points.push_back({ { 1 - b - c - d, b, c, d },
          6 * weights[i] * weights[j] * weights[k] / 8 * (1 - u) * (1 - u) * (1 - v) });
      }
    }
  }
  return points;
}

/// Shape functions of a cell and their gradients, one column per node.
struct Shape
{
  Eigen::VectorXd Values;
  Eigen::Matrix3Xd Gradients;

  Shape(const ElasticBody& body, std::size_t cell, const Eigen::Vector4d& l)
    : Values(body.NodesPerCell())
    , Gradients(3, body.NodesPerCell())
  {
    const Eigen::Map<const Eigen::Matrix<double, 3, 4>> g(body.BarycentricGradientsOf(cell));
    if (body.Type() == ElementType::PatchAveragedLinear)
    {
      this->Values = l;
      this->Gradients = g;
      return;
    }
    for (int c = 0; c < 4; ++c)
    {
      this->Values[c] = l[c] * (2 * l[c] - 1);
      this->Gradients.col(c) = (4 * l[c] - 1) * g.col(c);
    }
    for (int e = 0; e < 6; ++e)
    {
      const int i = CellEdges[e][0];
      const int j = CellEdges[e][1];
      this->Values[4 + e] = 4 * l[i] * l[j];
      this->Gradients.col(4 + e) = 4 * (l[i] * g.col(j) + l[j] * g.col(i));
    }
  }
};

/// Norms of the error of the displacement, mm^2.5, and of its gradient, mm^1.5.
struct Errors
{
  double Displacement = 0;
  double Gradient = 0;
};

/// A material and the amplitude of the deformation.
struct Case
{
  ElasticMaterial Material;
  double Amplitude;
};
const Case Compressible{ { 5, 0.3 }, 2 };
/// Most of the bulk modulus acts on the mean volume of an element. The deformation is small, since
/// its change of volume, of second order, makes a pressure.
const Case NearlyIncompressible{ { 5, 0.497 }, 0.1 };

/// Solves on a cube of 6 n^3 cells.
Errors SolveManufactured(ElementType type, const Case& solved, int n)
{
  const ElasticBody body(test::MakeBoxMesh({ 0, 0, 0 }, { Side, Side, Side }, { n, n, n }),
    { {}, solved.Material }, {}, {}, type);
  const std::vector<double>& rest = body.RestPositions();
  const std::vector<VolumePoint> points = VolumePoints();
  const auto visit = [&](const auto& function)
  {
    for (std::size_t cell = 0; cell < body.NumberOfCells(); ++cell)
    {
      const std::int32_t* nodes = &body.Cells()[body.NodesPerCell() * cell];
      for (const VolumePoint& point : points)
      {
        Eigen::Vector3d x = Eigen::Vector3d::Zero();
        for (int c = 0; c < 4; ++c)
        {
          x += point.Lambda[c] * Eigen::Map<const Eigen::Vector3d>(&rest[3 * nodes[c]]);
        }
        function(nodes, Shape(body, cell, point.Lambda), Exact(x, solved.Amplitude),
          point.Weight * body.CellVolume(cell));
      }
    }
  };
  // Loads under which the exact deformation is in equilibrium: f_a = integral of P grad N_a.
  std::vector<double> loads(rest.size(), 0.0);
  visit(
    [&](const std::int32_t* nodes, const Shape& shape, const Exact& exact, double weight)
    {
      const Eigen::Matrix3Xd forces = weight * Stress(solved.Material, exact.F) * shape.Gradients;
      for (int a = 0; a < body.NodesPerCell(); ++a)
      {
        Eigen::Map<Eigen::Vector3d>(&loads[3 * nodes[a]]) += forces.col(a);
      }
    });
  std::vector<bool> fixed(rest.size(), false);
  for (std::size_t node = 0; node < body.NumberOfNodes(); ++node)
  {
    bool boundary = false;
    for (int axis = 0; axis < 3; ++axis)
    {
      const double place = rest[3 * node + axis];
      boundary = boundary || place < 1e-9 || place > Side - 1e-9;
    }
    std::fill_n(fixed.begin() + static_cast<std::ptrdiff_t>(3 * node), 3, boundary);
  }
  EquilibriumSolver solver(body, fixed, 1);
  solver.Energy().SetLoads(loads);
  std::vector<double> x = rest;
  const EquilibriumReport report = solver.Solve(x, nullptr, 1e-10, 50);
  EXPECT_TRUE(report.Converged) << report.Reason;

  Errors errors;
  visit(
    [&](const std::int32_t* nodes, const Shape& shape, const Exact& exact, double weight)
    {
      Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
      Eigen::Matrix3d f = Eigen::Matrix3d::Identity();
      for (int a = 0; a < body.NodesPerCell(); ++a)
      {
        const Eigen::Vector3d u = Eigen::Map<const Eigen::Vector3d>(&x[3 * nodes[a]]) -
          Eigen::Map<const Eigen::Vector3d>(&rest[3 * nodes[a]]);
        displacement += shape.Values[a] * u;
        f += u * shape.Gradients.col(a).transpose();
      }
      errors.Displacement += weight * (displacement - exact.Displacement).squaredNorm();
      errors.Gradient += weight * (f - exact.F).squaredNorm();
    });
  errors.Displacement = std::sqrt(errors.Displacement);
  errors.Gradient = std::sqrt(errors.Gradient);
  return errors;
}

/// Orders from halving the cells: log2 of the ratio of the errors.
Errors OrdersOf(ElementType type, const Case& solved, int n)
{
  const Errors coarse = SolveManufactured(type, solved, n);
  const Errors fine = SolveManufactured(type, solved, 2 * n);
  return { std::log2(coarse.Displacement / fine.Displacement),
    std::log2(coarse.Gradient / fine.Gradient) };
}
}

// Orders on these meshes are below the asymptotic ones: 3.05 and 1.81 for quadratic elements, 2.56
// and 1.57 (falling to 2 and 1) for constant pressure, 1.85 and 0.95 for linear elements.

TEST(ConvergenceOrder, QuadraticElementsAreOfThirdOrder)
{
  const Errors orders = OrdersOf(ElementType::Quadratic, Compressible, 4);
  EXPECT_GT(orders.Displacement, 2.8);
  EXPECT_GT(orders.Gradient, 1.75);
}

TEST(ConvergenceOrder, ConstantPressureLimitsQuadraticElementsToSecondOrder)
{
  const Errors orders = OrdersOf(ElementType::Quadratic, NearlyIncompressible, 4);
  EXPECT_GT(orders.Displacement, 1.8);
  EXPECT_GT(orders.Gradient, 0.9);
}

TEST(ConvergenceOrder, PatchAveragedLinearElementsAreOfSecondOrder)
{
  for (const Case& solved : { Compressible, NearlyIncompressible })
  {
    const Errors orders = OrdersOf(ElementType::PatchAveragedLinear, solved, 8);
    EXPECT_GT(orders.Displacement, 1.8) << solved.Material.PoissonRatio;
    EXPECT_GT(orders.Gradient, 0.9) << solved.Material.PoissonRatio;
  }
}
