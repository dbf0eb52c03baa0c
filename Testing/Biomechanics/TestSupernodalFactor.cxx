// SPDX-License-Identifier: Apache-2.0
#include "GridMatrix.h"
#include "mammoray/Biomechanics/Private/SparseCholesky.h"
#include "mammoray/Biomechanics/Private/SupernodalFactor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace
{
using namespace mammoray;

/// [4 1 0 1; 1 3 1 0; 0 1 2 0; 1 0 0 5], its lower triangle by columns.
const std::vector<int> Starts{ 0, 3, 5, 6, 7 };
const std::vector<int> Rows{ 0, 1, 3, 1, 2, 2, 3 };
const std::vector<double> Values{ 4, 1, 1, 3, 1, 2, 5 };

/// Column 3 of the matrix first, then 2, then 0 and 1 together: the first two each give to one row
/// of the last.
Supernodes Three()
{
  return { { 3, 2, 0, 1 }, { 0, 1, 2, 4 }, { 0, 2, 4, 6 }, { 0, 2, 4, 8 }, { 0, 2, 1, 3, 2, 3 } };
}

TEST(SupernodalFactor, SolvesInAnyOrderOfColumns)
{
  SupernodalFactor factor(Three(), Starts, Rows);
  EXPECT_EQ(factor.Bytes(), 8 * sizeof(float));
  ASSERT_TRUE(factor.Factorize(Values));
  EXPECT_GT(factor.Bytes(), 8 * sizeof(float)) << "with its products";
  // A times (1, -2, 3, 4), the same 1e-60 times, nothing.
  const std::vector<double> right{ 6, -2, 4, 21, 6e-60, -2e-60, 4e-60, 21e-60, 0, 0, 0, 0 };
  const std::vector<double> exact{ 1, -2, 3, 4 };
  std::vector<double> columns = right;
  factor.Solve(columns);
  std::vector<double> one(right.begin(), right.begin() + 4);
  factor.Solve(one);
  for (int k = 0; k < 4; ++k)
  {
    // Single precision's 6e-8, times a condition of 4 and some operations.
    EXPECT_NEAR(columns[k], exact[k], 2e-6);
    EXPECT_NEAR(columns[4 + k], 1e-60 * exact[k], 2e-66);
    EXPECT_EQ(columns[8 + k], 0);
    EXPECT_NEAR(one[k], exact[k], 2e-6);
  }
}

TEST(SupernodalFactor, TellsAnIndefiniteMatrixAndServesOn)
{
  SupernodalFactor factor(Three(), Starts, Rows);
  EXPECT_FALSE(factor.Factorize({ 4, 1, 1, 3, 1, -2, 5 })) << "on the diagonal";
  EXPECT_FALSE(factor.Factorize({ 4, 1, 9, 3, 1, 2, 5 })) << "of two columns together";
  EXPECT_FALSE(factor.Factorize({ 4, std::nan(""), 1, 3, 1, 2, 5 }));
  // Numbers beyond single precision's range.
  std::vector<double> large = Values;
  for (double& value : large)
  {
    value *= 1e50;
  }
  ASSERT_TRUE(factor.Factorize(large));
  std::vector<double> columns{ 6e50, -2e50, 4e50, 21e50 };
  factor.Solve(columns);
  EXPECT_NEAR(columns[3], 4, 1e-5);
}

/// Many supernodes of all sizes.
TEST(SupernodalFactor, ServesWhereAFactorIsExpensive)
{
  const SparsePattern pattern = GridPattern(44);
  std::vector<double> values = GridMatrix(pattern, 0.1);
  const std::size_t n = pattern.Starts.size() - 1;
  SparseCholesky cholesky(pattern.Starts, pattern.Rows);
  ASSERT_TRUE(cholesky.Expensive());
  ASSERT_TRUE(cholesky.Factorize(values));
  EXPECT_TRUE(cholesky.Usable());
  std::vector<double> exact(2 * n), columns(2 * n);
  for (std::size_t k = 0; k < exact.size(); ++k)
  {
    exact[k] = std::sin(0.1 * static_cast<double>(k));
  }
  cholesky.Multiply(values, exact.data(), columns.data());
  cholesky.Multiply(values, &exact[n], &columns[n]);
  std::vector<double> one(columns.begin() + static_cast<std::ptrdiff_t>(n), columns.end());
  cholesky.Solve(columns);
  cholesky.Solve(one);
  double farthest = 0, apart = 0;
  for (std::size_t k = 0; k < columns.size(); ++k)
  {
    farthest = std::max(farthest, std::abs(columns[k] - exact[k]));
    apart = std::max(apart, k < n ? 0 : std::abs(columns[k] - one[k - n]));
  }
  // The condition is at most 121, single precision's rounding 6e-8.
  EXPECT_LT(farthest, 1e-5);
  EXPECT_LT(apart, 1e-5);
  EXPECT_GT(farthest, 1e-12) << "double precision";
  values[0] = 0.05;
  EXPECT_FALSE(cholesky.Factorize(values));
  EXPECT_FALSE(cholesky.Usable());
}
}
