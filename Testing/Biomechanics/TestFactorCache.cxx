// SPDX-License-Identifier: Apache-2.0
#include "GridMatrix.h"
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
  std::vector<double> product(2 * n);
  cache.Multiply(near, &solution[0], &product[0]);
  cache.Multiply(near, &solution[n], &product[n]);
  for (int k = 0; k < 2 * n; ++k)
  {
    EXPECT_NEAR(product[k], right[k], 1e-9 * (k < n ? 1 : 1e4));
  }
  const std::vector<double> exact = solution;
  ASSERT_TRUE(cache.SolveNearby(near, x, { right.begin(), right.begin() + n }, solution));
  for (int k = 0; k < n; ++k)
  {
    EXPECT_NEAR(solution[k], exact[k], 1e-3);
  }
  cache.Forget();
  EXPECT_TRUE(std::isinf(cache.DistanceMm(x)));
}

TEST(FactorCache, AnExpensiveFactorServesFromFartherAway)
{
  for (const int side : { 12, 44 })
  {
    const bool expensive = side == 44;
    const SparsePattern pattern = GridPattern(side);
    const std::vector<double> other = GridMatrix(pattern, 0.2);
    const std::vector<double> values = GridMatrix(pattern, 0.1);
    FactorCache cache(pattern);
    const std::vector<double> at(pattern.Starts.size() - 1, 1.0);
    const std::vector<double> away(at.size(), 1.4);
    std::vector<double> right(at.size(), 0.0);
    right[at.size() / 2] = 1;
    std::vector<double> solution, product(at.size());
    EXPECT_FALSE(cache.SolveNearby(values, at, right, solution)) << "of a factor that is not there";
    const auto residual = [&](const std::vector<double>& of)
    {
      cache.Multiply(of, solution.data(), product.data());
      double squares = 0;
      for (std::size_t k = 0; k < product.size(); ++k)
      {
        squares += (product[k] - right[k]) * (product[k] - right[k]);
      }
      return std::sqrt(squares);
    };

    ASSERT_TRUE(cache.Factorize(other, at));
    ASSERT_TRUE(cache.SolveOwn(other, right, 1, solution));
    EXPECT_LT(residual(other), 1e-8);
    EXPECT_EQ(cache.SolveNearby(values, away, right, solution), expensive);
    EXPECT_TRUE(!expensive || residual(values) < 1e-2);
    EXPECT_FALSE(cache.SolveNearby(values, std::vector<double>(at.size(), 1.6), right, solution));

    // So does that of a mixed matrix, but nothing else is told of its positions.
    std::vector<double> indefinite = values;
    indefinite[0] = -1;
    ASSERT_TRUE(cache.FactorizeMixed(indefinite, at, [&] { return other; }));
    EXPECT_GT(cache.Share(), 0);
    EXPECT_TRUE(std::isinf(cache.DistanceMm(at)));
    EXPECT_EQ(cache.SolveNearby(values, at, right, solution), expensive);
    right.assign(at.size(), 0.0);
    right[0] = 1;
    EXPECT_FALSE(cache.SolveNearby(indefinite, at, right, solution)) << "indefinite";
  }
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
