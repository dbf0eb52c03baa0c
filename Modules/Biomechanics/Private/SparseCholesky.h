// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SparseCholesky_h
#define mammoray_SparseCholesky_h

#include "mammorayBiomechanicsModule.h"

#include <memory>
#include <vector>

namespace mammoray
{
/// L L^T factorisation of symmetric positive definite matrices with one pattern. CHOLMOD orders and
/// analyses the pattern once. Factorisations use CHOLMOD's supernodal method or, if that takes more
/// than about 0.2 s, SupernodalFactor in single precision.
class MAMMORAYBIOMECHANICS_EXPORT SparseCholesky
{
public:
  /// The lower triangle by columns: column c has the rows rows[starts[c]] .. rows[starts[c + 1] -
  /// 1], ascending, the diagonal first. The arrays must outlive the object.
  SparseCholesky(const std::vector<int>& starts, const std::vector<int>& rows);
  ~SparseCholesky();

  /// Returns false if the matrix is not positive definite; there is no usable factor then.
  bool Factorize(const std::vector<double>& values);
  /// Solves in place for the right-hand sides stored one after the other in `columns`, to the
  /// factor's precision.
  void Solve(std::vector<double>& columns);
  /// y = A x for the symmetric matrix with these values.
  void Multiply(const std::vector<double>& values, const double* x, double* y) const;
  /// True if a factorisation takes as long as twenty solutions or more. For a breast it is 25 to 30
  /// solutions with 46,206 unknowns and 13 with 12,318.
  bool Expensive() const;
  bool InSinglePrecision() const;
  bool Usable() const { return this->Valid; }
  /// Largest memory of factor and working space so far, bytes.
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
