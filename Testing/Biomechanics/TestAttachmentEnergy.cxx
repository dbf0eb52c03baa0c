// SPDX-License-Identifier: Apache-2.0
#include "EnergyChecks.h"
#include "EquilibriumChecks.h"
#include "TestMeshes.h"
#include "mammoray/Biomechanics/Private/AttachmentEnergy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace
{
using namespace mammoray;
using test::CellsOfMaterial;
using test::PressedBlock;
using test::Shaken;

/// Half an ellipsoid on a chest wall that bulges forwards.
struct Breast
{
  TetrahedralMesh Mesh = test::MakeHalfEllipsoidMesh(40, 45, 38, 6);
  ElasticBody Body{ Mesh, { {}, { 6, 0.49 }, { 5, 0.49 } } };
  AttachmentEnergy Wall{ Body, CellsOfMaterial(Mesh, 2), { 20, 3 } };
};

TEST(AttachmentEnergy, HeightOverAPlaneIsItsDistance)
{
  const PressedBlock block(ElementType::Quadratic);
  const AttachmentEnergy wall(block.Body, CellsOfMaterial(PressedBlock::Mesh(), 2), { 3, 0 });
  EXPECT_EQ(wall.Nodes().size(), 25u); // 2 x 2 squares of two quadratic triangles
  double area = 0;
  for (std::size_t n = 0; n < wall.Nodes().size(); ++n)
  {
    const double* rest = &block.Body.RestPositions()[3 * wall.Nodes()[n]];
    EXPECT_EQ(rest[1], 10);
    const Vector3 lifted{ rest[0], rest[1] + 2, rest[2] };
    const AttachmentEnergy::Terms terms = wall.NodeTerms(n, lifted, { 3, 0 });
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

TEST(AttachmentEnergy, DerivativesOfTheHeightMatchCentralDifferences)
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

TEST(AttachmentEnergy, ANodeThatGlidesRoundACurvedWallKeepsItsHeight)
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
  const AttachmentEnergy wall(body, CellsOfMaterial(mesh, 2), { 1, 0 });
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

TEST(AttachmentEnergy, DerivativesMatchCentralDifferences)
{
  const Breast breast;
  const test::DerivativeErrors errors =
    test::FindDerivativeErrors(breast.Wall, Shaken(breast.Body.RestPositions(), 2, 7), 1e-4);
  EXPECT_GT(errors.Measures.WallLift, 1);
  EXPECT_GT(errors.Measures.WallGlide, 1);
  // h^2 times third derivatives of the height, 1 / mm^2 at most, and roundoff over h.
  EXPECT_LT(errors.Gradient, 1e-7 * errors.GradientSize);
  EXPECT_LT(errors.Hessian, 1e-7 * errors.HessianSize);
}

TEST(AttachmentEnergy, HasAProjectedHessianWithoutNegativeCurvature)
{
  const Breast breast;
  const std::vector<double> x = Shaken(breast.Body.RestPositions(), 3, 11);
  bool projects = false;
  for (std::size_t n = 0; n < breast.Wall.NumberOfPieces(); ++n)
  {
    const auto exact = test::EvaluatePiece(breast.Wall, n, x, EnergyOrder::Hessian);
    const auto projected = test::EvaluatePiece(breast.Wall, n, x, EnergyOrder::ProjectedHessian);
    projects = projects || exact.Hessian != projected.Hessian;
    for (unsigned seed = 1; seed <= 20; ++seed)
    {
      const std::vector<double> v = Shaken({ 0, 0, 0 }, 1, seed);
      double curvature = 0;
      for (int i = 0; i < 9; ++i)
      {
        curvature += v[i / 3] * v[i % 3] * projected.Hessian[i];
      }
      EXPECT_GE(curvature, -1e-10);
    }
  }
  EXPECT_TRUE(projects);
}
}
