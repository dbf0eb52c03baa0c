// SPDX-License-Identifier: Apache-2.0
// The residual of the inverse problem and its Jacobian against differences of itself.
#include "EveryElement.h"
#include "TestMeshes.h"
#include "mammoray/Biomechanics/Private/InverseEquilibrium.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

namespace
{
using namespace mammoray;

constexpr double Downwards = 9.81;

/// A small breast of two materials, one of them with Fung's law, held or on an elastic wall.
struct HangingBody
{
  TetrahedralMesh Mesh = test::MakeHalfEllipsoidMesh(40, 45, 38, 4);
  std::vector<bool> FixedCells;
  ElasticBody Body;
  std::optional<AttachmentEnergy> Wall;
  std::vector<bool> Fixed;
  std::optional<InverseEquilibrium> Inverse;

  HangingBody(ElementType type, bool held)
    : Body(
        Mesh, { {}, { 2, 0.48, 1.5, 0.95 }, { 5, 0.49 }, { 6, 0.49, 0, 1.1 } },
        [](const Vector3& x) { return std::hypot(x[0], x[1] - 20, x[2]) < 17 ? 3 : 1; },
        { false, false, true, false }, type)
  {
    for (const std::int32_t material : this->Mesh.Materials)
    {
      this->FixedCells.push_back(material == 2);
    }
    this->Fixed.assign(3 * this->Body.NumberOfNodes(), false);
    for (std::size_t c = 0; held && c < this->Fixed.size(); ++c)
    {
      this->Fixed[c] = this->Body.RestPositions()[c - c % 3 + 1] < 1e-9;
    }
    if (!held)
    {
      this->Wall.emplace(this->Body, this->FixedCells, WallStiffness{ 20, 5 });
    }
    this->Inverse.emplace(this->Body, held ? nullptr : &*this->Wall, this->Fixed, this->FixedCells,
      this->Mesh.Points, Vector3{ 1, Downwards, -2 });
  }
};

using ElementInverse = test::EveryElement;
MAMMORAY_FOR_EVERY_ELEMENT(ElementInverse);

TEST_P(ElementInverse, JacobianMatchesCentralDifferences)
{
  for (const bool held : { true, false })
  {
    HangingBody hanging(GetParam(), held);
    InverseEquilibrium& inverse = *hanging.Inverse;
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> unit(-0.5, 0.5);
    std::vector<double> y = inverse.Unloaded();
    for (const std::int32_t coordinate : inverse.Coordinates())
    {
      y[coordinate] += unit(generator);
    }
    ASSERT_TRUE(inverse.Evaluate(y, true));
    const std::vector<double> jacobian = inverse.Jacobian();
    const SparsePattern& pattern = inverse.Pattern();
    double largest = 0;
    for (const double value : jacobian)
    {
      largest = std::max(largest, std::abs(value));
    }
    // Every column would be every evaluation; some dozen are of every kind of node.
    const auto count = static_cast<int>(inverse.Coordinates().size());
    for (int column = 0; column < count; column += count / 60)
    {
      constexpr double h = 1e-5;
      std::vector<double> sides[2];
      for (int side = 0; side < 2; ++side)
      {
        std::vector<double> moved = y;
        moved[inverse.Coordinates()[column]] += side ? h : -h;
        ASSERT_TRUE(inverse.Evaluate(moved, false));
        sides[side] = inverse.Forces();
      }
      std::vector<double> exact(count, 0.0);
      for (int k = pattern.Starts[column]; k < pattern.Starts[column + 1]; ++k)
      {
        exact[pattern.Rows[k]] = jacobian[k];
      }
      for (int row = 0; row < count; ++row)
      {
        // Roundoff of forces of 1e3 kPa mm^2 over h, and the third derivative.
        ASSERT_NEAR((sides[0][row] - sides[1][row]) / (2 * h), exact[row], 1e-7 * largest)
          << "held " << held << ", column " << column << ", row " << row;
      }
    }
  }
}

TEST_P(ElementInverse, WithoutLoadTheKnownShapeIsAtRest)
{
  HangingBody hanging(GetParam(), false);
  InverseEquilibrium& inverse = *hanging.Inverse;
  inverse.SetLoadedPart(0);
  ASSERT_TRUE(inverse.Evaluate(inverse.Unloaded(), false));
  for (const double force : inverse.Forces())
  {
    EXPECT_NEAR(force, 0, 1e-9);
  }
  EXPECT_NEAR(inverse.SmallestJ(), 1, 1e-12);
  std::vector<double> inverted = inverse.Unloaded();
  inverted[inverse.Coordinates()[inverse.Coordinates().size() / 4]] += 100;
  EXPECT_FALSE(inverse.Evaluate(inverted, true));
}
}
