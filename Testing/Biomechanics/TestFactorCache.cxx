// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Biomechanics/Private/FactorCache.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace
{
using namespace mammoray;

TEST(FactorCache, SolvesForMatricesNearby)
{
  // Second differences, and the same stiffened by up to a hundredth.
  SparsePattern pattern;
  std::vector<double> values, near;
  constexpr int n = 20;
  for (int c = 0; c < n; ++c)
  {
    pattern.Rows.push_back(c);
    values.push_back(2.5);
    near.push_back(2.5 + 0.01 * c / n);
    if (c + 1 < n)
    {
      pattern.Rows.push_back(c + 1);
      values.push_back(-1);
      near.push_back(-1);
    }
    pattern.Starts.push_back(static_cast<int>(pattern.Rows.size()));
  }
  FactorCache cache(pattern);
  const std::vector<double> x(n, 1.0);
  EXPECT_TRUE(std::isinf(cache.DistanceMm(x)));
  ASSERT_TRUE(cache.Factorize(values, x));
  EXPECT_EQ(cache.DistanceMm(std::vector<double>(n, 1.25)), 0.25);
  std::vector<double> right(2 * n, 0.0);
  right[3] = 1;
  right[n + 11] = 1e4;
  std::vector<double> solution;
  ASSERT_TRUE(cache.RefineNearby(near, right, 2, solution));
  std::vector<double> exact = right;
  FactorCache direct(pattern);
  ASSERT_TRUE(direct.Factorize(near, x));
  direct.Solve(exact);
  for (int k = 0; k < 2 * n; ++k)
  {
    EXPECT_NEAR(solution[k], exact[k], 1e-9 * (k < n ? 1 : 1e4));
  }
  ASSERT_TRUE(cache.SolveNearby(near, { right.begin(), right.begin() + n }, solution));
  for (int k = 0; k < n; ++k)
  {
    EXPECT_NEAR(solution[k], exact[k], 1e-3);
  }
  cache.Forget();
  EXPECT_TRUE(std::isinf(cache.DistanceMm(x)));
}

TEST(FactorCache, MixesInAsLittleAsNeeded)
{
  SparsePattern pattern;
  pattern.Rows = { 0, 1 };
  pattern.Starts = { 0, 1, 2 };
  FactorCache cache(pattern);
  const auto projected = [] { return std::vector<double>{ 1, 1 }; };
  EXPECT_TRUE(cache.FactorizeMixed({ 1, 1 }, { 0, 0 }, projected));
  EXPECT_EQ(cache.Share(), 0);
  // Shares of 1/64, 1/8 and 1: -0.5 needs a third.
  EXPECT_TRUE(cache.FactorizeMixed({ 1, -0.1 }, { 0, 0 }, projected));
  EXPECT_EQ(cache.Share(), 1 / 8.0);
  EXPECT_TRUE(std::isinf(cache.DistanceMm({ 0, 0 })));
  EXPECT_TRUE(cache.FactorizeMixed({ 1, -0.5 }, { 0, 0 }, projected));
  EXPECT_EQ(cache.Share(), 1);
  EXPECT_FALSE(cache.Factorize({ 1, -0.5 }, { 0, 0 }));
  EXPECT_FALSE(cache.FactorizeMixed({ 1, -2 }, { 0, 0 },
    [] {
      return std::vector<double>{ 1, -1 };
    }));
}
}
