// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SparseLu_h
#define mammoray_SparseLu_h

#include "mammorayBiomechanicsModule.h"

#include <memory>
#include <vector>

namespace mammoray
{
/// L U factorisation of square matrices with one pattern, which is symmetric although the values
/// are not, by UMFPACK's multifrontal method (Davis 2004). The pattern is ordered and analysed
/// once.
class MAMMORAYBIOMECHANICS_EXPORT SparseLu
{
public:
  /// Column c has the rows rows[starts[c]] .. rows[starts[c + 1] - 1], ascending. The arrays must
  /// outlive the object. Like Factorize, throws ConvergenceError if memory is short.
  SparseLu(const std::vector<int>& starts, const std::vector<int>& rows);
  ~SparseLu();

  /// Returns false if the matrix is singular; there is no factor then.
  bool Factorize(const std::vector<double>& values);
  /// Solves in place for the right-hand sides stored one after the other in `columns`.
  void Solve(std::vector<double>& columns) const;
  /// y = A x for the matrix with these values.
  void Multiply(const std::vector<double>& values, const double* x, double* y) const;
  /// True if there is a factor.
  bool Usable() const;
  /// Discards the factor.
  void Forget();

private:
  struct Internals;
  std::unique_ptr<Internals> Internal;
  const std::vector<int>& Starts;
  const std::vector<int>& Rows;
};
}

#endif
