// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SparseCholesky_h
#define mammoray_SparseCholesky_h

#include "mammorayBiomechanicsModule.h"

#include <memory>
#include <vector>

namespace mammoray
{
/**
 * L L^T of symmetric positive definite matrices that share one pattern, ordered and analysed by
 * CHOLMOD once, factorised as often as wanted: by CHOLMOD's supernodal method, or, where that takes
 * a fifth of a second and more, by SupernodalFactor in single precision.
 */
class MAMMORAYBIOMECHANICS_EXPORT SparseCholesky
{
public:
  /**
   * Lower triangle by columns: rows of column c are rows[starts[c]] .. rows[starts[c + 1] - 1],
   * ascending, the diagonal first. The arrays must outlive the object.
   */
  SparseCholesky(const std::vector<int>& starts, const std::vector<int>& rows);
  ~SparseCholesky();

  /// Answers false where the matrix is not positive definite; the factor is unusable then.
  bool Factorize(const std::vector<double>& values);
  /// Solves for `columns` right-hand sides stored one after the other, in place, to the factor's
  /// precision.
  void Solve(std::vector<double>& columns);
  /// y = A x of the symmetric matrix with these values.
  void Multiply(const std::vector<double>& values, const double* x, double* y) const;
  /// Whether a factorisation takes as long as a score of solutions and more: 46,206 unknowns of a
  /// breast, 25 to 30; 12,318 of one, 13.
  bool Expensive() const;
  bool InSinglePrecision() const;
  bool Usable() const { return this->Valid; }
  /// Most memory taken so far for factor and working space, bytes.
  double PeakBytes() const;

private:
  struct Internals;
  std::unique_ptr<Internals> Internal;
  const std::vector<int>& Starts;
  const std::vector<int>& Rows;
  bool Valid = false;
};
}

#endif
