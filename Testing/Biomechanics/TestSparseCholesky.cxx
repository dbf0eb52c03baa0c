// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Biomechanics/Private/SparseCholesky.h"

#include <gtest/gtest.h>

#include <vector>

namespace
{
using namespace mammoray;

/// [4 1 0; 1 3 1; 0 1 2], its lower triangle by columns.
struct Matrix
{
  std::vector<int> Starts{ 0, 2, 4, 5 };
  std::vector<int> Rows{ 0, 1, 1, 2, 2 };
  std::vector<double> Values{ 4, 1, 3, 1, 2 };
};

TEST(SparseCholesky, SolvesWhatItMultiplies)
{
  const Matrix matrix;
  SparseCholesky cholesky(matrix.Starts, matrix.Rows);
  ASSERT_TRUE(cholesky.Factorize(matrix.Values));
  const std::vector<double> x{ 1, -2, 3, 0, 5, 0.5 }; // two columns
  std::vector<double> y(6);
  cholesky.Multiply(matrix.Values, &x[0], &y[0]);
  cholesky.Multiply(matrix.Values, &x[3], &y[3]);
  EXPECT_EQ(y, (std::vector<double>{ 2, -2, 4, 5, 15.5, 6 }));
  cholesky.Solve(y);
  for (std::size_t k = 0; k < x.size(); ++k)
  {
    EXPECT_NEAR(y[k], x[k], 1e-14);
  }
  EXPECT_GT(cholesky.PeakBytes(), 0);
}

TEST(SparseCholesky, TellsAnIndefiniteMatrixAndServesOn)
{
  const Matrix matrix;
  SparseCholesky cholesky(matrix.Starts, matrix.Rows);
  EXPECT_FALSE(cholesky.Factorize({ 4, 1, -3, 1, 2 }));
  EXPECT_FALSE(cholesky.Usable());
  EXPECT_TRUE(cholesky.Factorize(matrix.Values));
  EXPECT_TRUE(cholesky.Usable());
}
}
