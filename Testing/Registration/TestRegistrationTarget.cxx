// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Error.h"
#include "mammoray/Registration/RegistrationTarget.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace mammoray;

namespace
{
/// 12 columns towards +y, 8 rows towards -x as a left CC mammogram; distance = 0.5 x + 0.25 y.
RegistrationTarget LinearTarget()
{
  RegistrationTarget target;
  target.Grid.Columns = 12;
  target.Grid.Rows = 8;
  target.Grid.Origin = { 7, 1 };
  target.Grid.ColumnStep = { 0, 2 };
  target.Grid.RowStep = { -2, 0 };
  for (int row = 0; row < 8; ++row)
  {
    for (int column = 0; column < 12; ++column)
    {
      const ReceptorPoint point = target.Grid.PositionOf(column, row);
      target.SignedDistanceMm.push_back(static_cast<float>(0.5 * point[0] + 0.25 * point[1]));
      target.LogAttenuation.push_back(static_cast<float>(point[0] - point[1]));
      target.BreastMask.push_back(column < 5 ? 1 : 0);
    }
  }
  return target;
}
}

TEST(RegistrationTarget, DistanceIsExactForALinearField)
{
  const RegistrationTarget target = LinearTarget();
  for (const ReceptorPoint point : { ReceptorPoint{ 0.3, 5.7 }, ReceptorPoint{ 6.9, 1.1 },
         ReceptorPoint{ -6.99, 22.9 }, ReceptorPoint{ 7, 1 }, ReceptorPoint{ -7, 23 } })
  {
    // 1e-6: the stored distances are floats of size 10.
    EXPECT_NEAR(SignedDistanceAt(target, point), 0.5 * point[0] + 0.25 * point[1], 1e-6);
  }
  // Outside: the border's value and the distance to it.
  EXPECT_NEAR(SignedDistanceAt(target, { 0, 33 }), 0.25 * 23 + 10, 1e-6);
  EXPECT_NEAR(SignedDistanceAt(target, { 10, 5 }), 3.5 + 1.25 + 3, 1e-6);
}

TEST(RegistrationTarget, CoarseningKeepsPositionsAndMeans)
{
  RegistrationTarget target = LinearTarget();
  target.OutlineFromMm = 3;
  target.Warnings = { "assumed" };
  target.Disagreements = { "contradicted" };
  const RegistrationTarget coarse = Coarsen(target, 3);
  EXPECT_EQ(coarse.OutlineFromMm, 3);
  EXPECT_EQ(coarse.Warnings, target.Warnings);
  EXPECT_EQ(coarse.Disagreements, target.Disagreements);
  ASSERT_EQ(coarse.Grid.Columns, 4);
  ASSERT_EQ(coarse.Grid.Rows, 2);
  for (int row = 0; row < 2; ++row)
  {
    for (int column = 0; column < 4; ++column)
    {
      const ReceptorPoint point = coarse.Grid.PositionOf(column, row);
      const std::size_t index = row * 4 + column;
      // The mean of a linear field is its value in the middle.
      EXPECT_NEAR(coarse.LogAttenuation[index], point[0] - point[1], 1e-5);
      EXPECT_NEAR(coarse.SignedDistanceMm[index], 0.5 * point[0] + 0.25 * point[1], 1e-5);
      EXPECT_EQ(coarse.BreastMask[index], column < 1 ? 1 : 0);
    }
  }
}

TEST(RegistrationTarget, UnusableTargetsAreRefused)
{
  EXPECT_NO_THROW(ValidateTarget(LinearTarget()));
  EXPECT_THROW(ValidateTarget(RegistrationTarget{}), InputError);
  RegistrationTarget target = LinearTarget();
  target.BreastMask.assign(target.BreastMask.size(), 0);
  EXPECT_THROW(ValidateTarget(target), InputError);
  target = LinearTarget();
  target.Grid.RowStep = { 0, 4 };
  EXPECT_THROW(ValidateTarget(target), InputError);
  target = LinearTarget();
  target.SignedDistanceMm.pop_back();
  EXPECT_THROW(ValidateTarget(target), InputError);
}

TEST(RegistrationTarget, ChestWallCentreIsTheMaskMiddle)
{
  RegistrationTarget target = LinearTarget();
  EXPECT_NEAR(ChestWallCentre(target)[0], 0, 1e-12);
  for (int column = 0; column < 12; ++column)
  {
    target.BreastMask[column] = 0;      // x = 7
    target.BreastMask[12 + column] = 0; // x = 5
  }
  EXPECT_NEAR(ChestWallCentre(target)[0], -2, 1e-12);
  target.BreastMask.assign(target.BreastMask.size(), 0);
  EXPECT_THROW(ChestWallCentre(target), InputError);
  target.BreastMask.clear();
  EXPECT_THROW(ChestWallCentre(target), InputError);
}

TEST(RegistrationTarget, GradientAgreesWithDifferencesInsideAndOutside)
{
  RegistrationTarget target;
  target.Grid.Columns = 7;
  target.Grid.Rows = 9;
  target.Grid.Origin = { -4, 3 };
  // Turned and mirrored, as mammograms lie on the receptor.
  target.Grid.ColumnStep = { 0.6, 0.8 };
  target.Grid.RowStep = { -1.2, 0.9 };
  for (int pixel = 0; pixel < 63; ++pixel)
  {
    target.SignedDistanceMm.push_back(static_cast<float>(std::sin(0.37 * pixel * pixel)));
  }
  constexpr double step = 1e-6;
  for (const double column : { -2.3, 0.4, 3.7, 5.9, 8.2 })
  {
    for (const double row : { -1.6, 0.3, 4.8, 7.7, 9.1 })
    {
      const ReceptorPoint point = target.Grid.PositionOf(column, row);
      const ReceptorPoint gradient = SignedDistanceGradient(target, point);
      for (int axis = 0; axis < 2; ++axis)
      {
        ReceptorPoint plus = point;
        ReceptorPoint minus = point;
        plus[axis] += step;
        minus[axis] -= step;
        const double difference =
          (SignedDistanceAt(target, plus) - SignedDistanceAt(target, minus)) / (2 * step);
        EXPECT_NEAR(gradient[axis], difference, 1e-8) << column << ' ' << row << ' ' << axis;
      }
    }
  }
}
