// SPDX-License-Identifier: Apache-2.0
#include "TestMeshes.h"
#include "mammoray/Registration/RegistrationResult.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace mammoray;

namespace
{
/// A box in front of the plates' edge, moved by a function of its points.
class MovedBox : public testing::Test
{
protected:
  template <typename Move>
  void MoveBy(const Move& move)
  {
    this->Result.Points = this->Box.Points;
    for (std::size_t index = 0; index < this->Box.Points.size(); index += 3)
    {
      const Vector3 moved = move(Vector3{ this->Box.Points[index], this->Box.Points[index + 1],
        this->Box.Points[index + 2] });
      std::copy(moved.begin(), moved.end(), &this->Result.Points[index]);
    }
  }

  TetrahedralMesh Box = test::MakeBoxMesh({ -20, 10, -10 }, { 20, 50, 10 }, { 4, 4, 2 });
  ViewResult Result;
};
}

TEST_F(MovedBox, RigidMotionsAreNoDeformation)
{
  const double c = std::cos(0.3);
  const double s = std::sin(0.3);
  const auto turned = [&](const Vector3& p) {
    return Vector3{ c * p[0] - s * p[1] + 4, s * p[0] + c * p[1] - 7, p[2] + 2 };
  };
  this->MoveBy(turned);
  const ModelError model(this->Box, this->Result.Points, { .Origin = { 0, -20, 0 } });
  // 1e-9: a motion fitted to numbers of size 50.
  EXPECT_NEAR(model.SigmaMm({ 3, 20, 5 }, turned({ 3, 20, 5 })), ModelErrorMm, 1e-9);
  // Off that motion by 5 mm.
  EXPECT_NEAR(model.SigmaMm({ 3, 20, 5 }, turned({ 3, 20, 5 }) + Vector3{ 3, 0, 4 }),
    std::hypot(ModelErrorMm, 5 * ModelErrorShare), 1e-9);
}

TEST_F(MovedBox, IsLessSureTowardsThePlatesEdge)
{
  this->MoveBy([](const Vector3& p) { return p; });
  const ModelError model(this->Box, this->Result.Points, { .Origin = { 0, 10, 0 } });
  const auto at = [&](double depthMm)
  {
    const Vector3 point{ 3, 10 + depthMm, 5 };
    return model.SigmaMm(point, point);
  };
  // 1e-9: as above.
  EXPECT_NEAR(at(ModelErrorEdgeMm), ModelErrorMm, 1e-9);
  EXPECT_NEAR(at(ModelErrorEdgeMm - 4), std::hypot(ModelErrorMm, 4 * ModelErrorEdgeShare), 1e-9);
  EXPECT_NEAR(at(-8), std::hypot(ModelErrorMm, (ModelErrorEdgeMm + 8) * ModelErrorEdgeShare), 1e-9);
}

TEST_F(MovedBox, ExpectsTheErrorThatItsCovarianceSays)
{
  this->MoveBy([](const Vector3& p) { return p; });
  this->Result.Placed.Origin = { 0, -10, 0 }; // all tissue lies well in front of the edge
  EXPECT_FALSE(ExpectedErrorOf(this->Box, this->Result)) << "there is no covariance";
  this->Result.Sensitivities = { this->Box.Points, {} };
  for (std::size_t index = 0; index < this->Box.Points.size(); ++index)
  {
    this->Result.Sensitivities[0][index] = index % 3 == 2 ? 1.0 : 0.0;
  }
  // Without deformation all points have the model's least error, each way: Maxwell's median and 95
  // % are 1.5382 and 2.7955 deviations.
  this->Result.Covariance.assign(4, 0.0);
  std::optional<ExpectedError> expected = ExpectedErrorOf(this->Box, this->Result);
  ASSERT_TRUE(expected);
  EXPECT_NEAR(expected->MedianMm, 1.5382 * ModelErrorMm, 1e-3 * ModelErrorMm);
  EXPECT_NEAR(expected->Most95Mm, 2.7955 * ModelErrorMm, 1e-3 * ModelErrorMm);
  // A parameter that shifts all points along z by 1 mm per unit, of 2 units' deviation; what is
  // considered goes before the covariance alone.
  this->Result.ConsideredCovariance = { 4, 0, 0, 9 };
  expected = ExpectedErrorOf(this->Box, this->Result);
  const double sigma = std::sqrt(4.0 / 3 + ModelErrorMm * ModelErrorMm);
  EXPECT_NEAR(expected->MedianMm, 1.5382 * sigma, 1e-3 * sigma);
  EXPECT_NEAR(expected->Most95Mm, 2.7955 * sigma, 1e-3 * sigma);
}

TEST_F(MovedBox, CountsTissueBetweenThePlates)
{
  this->MoveBy([](const Vector3& p) { return p; });
  // The plates' edge lies at y = 30 of the volume frame.
  const VolumeFromGantry placed{ .Origin = { 0, 30, 0 } };
  const ModelError model(this->Box, this->Result.Points, placed);
  EXPECT_EQ(model.CellsBetween().size(), this->Box.NumberOfCells() / 2);
  const VolumeFromGantry beyond{ .Origin = { 0, 100, 0 } };
  EXPECT_EQ(ModelError(this->Box, this->Result.Points, beyond).CellsBetween().size(),
    this->Box.NumberOfCells());
}
