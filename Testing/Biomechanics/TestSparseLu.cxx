// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Biomechanics/Private/SparseLu.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace
{
using namespace mammoray;

TEST(SparseLu, SolvesAMatrixThatIsNotSymmetric)
{
  // A band of five diagonals, its entries drawn.
  constexpr int n = 40;
  std::vector<int> starts{ 0 };
  std::vector<int> rows;
  std::vector<double> values;
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int c = 0; c < n; ++c)
  {
    for (int r = std::max(0, c - 2); r <= std::min(n - 1, c + 2); ++r)
    {
      rows.push_back(r);
      values.push_back(unit(generator) + (r == c ? 3 : 0));
    }
    starts.push_back(static_cast<int>(rows.size()));
  }
  SparseLu lu(starts, rows);
  EXPECT_FALSE(lu.Usable());
  ASSERT_TRUE(lu.Factorize(values));
  std::vector<double> known(2 * n);
  std::vector<double> columns(2 * n);
  for (double& value : known)
  {
    value = unit(generator);
  }
  lu.Multiply(values, &known[0], &columns[0]);
  lu.Multiply(values, &known[n], &columns[n]);
  lu.Solve(columns);
  for (int k = 0; k < 2 * n; ++k)
  {
    EXPECT_NEAR(columns[k], known[k], 1e-13);
  }
  // A column of zeros.
  for (int k = starts[5]; k < starts[6]; ++k)
  {
    values[k] = 0;
  }
  EXPECT_FALSE(lu.Factorize(values));
  EXPECT_FALSE(lu.Usable());
}
}
