// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Vector3.h"

#include <gtest/gtest.h>

#include <random>

namespace
{
using namespace mammoray;

TEST(Vector3, BasisVectorsTurnRightHanded)
{
  const Vector3 x{ 1, 0, 0 };
  const Vector3 y{ 0, 1, 0 };
  const Vector3 z{ 0, 0, 1 };
  EXPECT_EQ(Cross(x, y), z);
  EXPECT_EQ(Cross(y, z), x);
  EXPECT_EQ(Cross(z, x), y);
  EXPECT_EQ(Norm({ 2, 3, 6 }), 7);
  EXPECT_EQ(x + 2.0 * y - 3.0 * z, (Vector3{ 1, 2, -3 }));
}

TEST(Vector3, LagrangesIdentityHolds)
{
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int round = 0; round < 100; ++round)
  {
    const Vector3 a{ number(generator), number(generator), number(generator) };
    const Vector3 b{ number(generator), number(generator), number(generator) };
    // |a x b|^2 = |a|^2 |b|^2 - (a . b)^2, up to roundings of numbers below 9.
    EXPECT_NEAR(Dot(Cross(a, b), Cross(a, b)), Dot(a, a) * Dot(b, b) - Dot(a, b) * Dot(a, b),
      1e-14);
    EXPECT_NEAR(Dot(a, Cross(a, b)), 0, 1e-15);
  }
}

TEST(Extent, ReachesFromTheLowestToTheHighestPlace)
{
  Extent extent;
  EXPECT_LT(extent.Length(), 0); // of nothing
  extent.Add(3);
  EXPECT_EQ(extent.Length(), 0);
  extent.Add(-1);
  extent.Add(2);
  EXPECT_EQ(extent.Low, -1);
  EXPECT_EQ(extent.High, 3);
  EXPECT_EQ(extent.Length(), 4);
  EXPECT_EQ(extent.Middle(), 1);
}

TEST(Extent, OfPointsIsThatOfTheirProjections)
{
  const std::vector<double> points{ 1, 2, 3, -4, 5, 0 };
  const auto [along, across] =
    ExtentsAlong(std::array<Vector3, 2>{ { { 0, 0.6, 0.8 }, { -1, 0, 0 } } }, points);
  EXPECT_NEAR(along.Low, 3, 1e-15);
  EXPECT_NEAR(along.High, 3.6, 1e-15);
  EXPECT_EQ(across.Low, -1);
  EXPECT_EQ(across.High, 4);
}
}
