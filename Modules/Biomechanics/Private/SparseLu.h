// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SparseLu_h
#define mammoray_SparseLu_h

#include "mammorayBiomechanicsModule.h"

#include <memory>
#include <vector>

namespace mammoray
{
/**
 * L U of square matrices that share one pattern, symmetric as a pattern though not in its values,
 * by UMFPACK's multifrontal method (Davis 2004): ordered and analysed once, factorised as often as
 * wanted.
 */
class MAMMORAYBIOMECHANICS_EXPORT SparseLu
{
public:
  /// Rows of column c are rows[starts[c]] .. rows[starts[c + 1] - 1], ascending. The arrays must
  /// outlive the object. Throws ConvergenceError where memory is short, as Factorize does.
  SparseLu(const std::vector<int>& starts, const std::vector<int>& rows);
  ~SparseLu();

  /// Answers false where the matrix is singular; there is no factor then.
  bool Factorize(const std::vector<double>& values);
  /// Solves for one right-hand side or several stored one after the other, in place.
  void Solve(std::vector<double>& columns) const;
  /// y = A x of the matrix with these values.
  void Multiply(const std::vector<double>& values, const double* x, double* y) const;
  /// Whether there is a factor.
  bool Usable() const;
  /// Leaves no factor.
  void Forget();

private:
  struct Internals;
  std::unique_ptr<Internals> Internal;
  const std::vector<int>& Starts;
  const std::vector<int>& Rows;
};
}

#endif
