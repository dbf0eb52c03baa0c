// SPDX-License-Identifier: Apache-2.0
#include "Private/SparseCholesky.h"

#include "Private/SingleThreaded.h"
#include "Private/SupernodalFactor.h"
#include "mammoray/Foundation/Error.h"

#include <cholmod.h>

#include <algorithm>
#include <new>
#include <optional>
#include <string>

namespace mammoray
{
namespace
{
/// Operation count above which single precision and several threads are faster: about 18,000
/// unknowns of quadratic cells (a breast's equilibrium in 0.7 of the time).
constexpr double OperationsForSinglePrecision = 4e9;
/// Operation count above which the last factor is reused from farther away: 35,000 unknowns of
/// quadratic cells (46,206 of linear ones need 8e10).
constexpr double ManyOperations = 2e10;
}

struct SparseCholesky::Internals
{
  cholmod_common Common{};
  cholmod_factor* Factor = nullptr;
  cholmod_dense* Solution = nullptr;
  cholmod_dense* Work = nullptr;
  cholmod_dense* MoreWork = nullptr;
  /// Operations of one factorisation.
  double Operations = 0;
  /// Factor in single precision, if the matrix is large; analysed by Factor.
  std::optional<SupernodalFactor> Single;

  Internals() { cholmod_start(&this->Common); }
  ~Internals()
  {
    cholmod_free_dense(&this->Solution, &this->Common);
    cholmod_free_dense(&this->Work, &this->Common);
    cholmod_free_dense(&this->MoreWork, &this->Common);
    cholmod_free_factor(&this->Factor, &this->Common);
    cholmod_finish(&this->Common);
  }
  Internals(const Internals&) = delete;
  Internals& operator=(const Internals&) = delete;

  void Check(const char* what) const
  {
    if (this->Common.status == CHOLMOD_OUT_OF_MEMORY)
    {
      throw std::bad_alloc();
    }
    if (this->Common.status < CHOLMOD_OK)
    {
      throw ConvergenceError(std::string("CHOLMOD: ") + what + " ended with status " +
        std::to_string(this->Common.status));
    }
  }
};

namespace
{
/// CHOLMOD's view of these arrays, to which it does not write.
cholmod_sparse View(const std::vector<int>& starts, const std::vector<int>& rows,
  const double* values)
{
  cholmod_sparse matrix{};
  matrix.nrow = matrix.ncol = starts.size() - 1;
  matrix.nzmax = rows.size();
  matrix.p = const_cast<int*>(starts.data());
  matrix.i = const_cast<int*>(rows.data());
  matrix.x = const_cast<double*>(values);
  matrix.stype = -1;
  matrix.itype = CHOLMOD_INT;
  matrix.xtype = values ? CHOLMOD_REAL : CHOLMOD_PATTERN;
  matrix.dtype = CHOLMOD_DOUBLE;
  matrix.sorted = 1;
  matrix.packed = 1;
  return matrix;
}

/// The supernodes that CHOLMOD's analysis found.
Supernodes Copied(const cholmod_factor& factor)
{
  const auto copy = [](auto& target, const void* source, std::size_t size)
  {
    const auto* values = static_cast<const int*>(source);
    target.assign(values, values + size);
  };
  Supernodes nodes;
  copy(nodes.Order, factor.Perm, factor.n);
  copy(nodes.FirstColumns, factor.super, factor.nsuper + 1);
  copy(nodes.RowStarts, factor.pi, factor.nsuper + 1);
  copy(nodes.ValueStarts, factor.px, factor.nsuper + 1);
  copy(nodes.Rows, factor.s, factor.ssize);
  return nodes;
}
}

SparseCholesky::SparseCholesky(const std::vector<int>& starts, const std::vector<int>& rows)
  : Internal(std::make_unique<Internals>())
  , Starts(starts)
  , Rows(rows)
{
  cholmod_common& common = this->Internal->Common;
  common.supernodal = CHOLMOD_SUPERNODAL;
  common.print = 0;
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_METIS;
  common.postorder = 1;
  cholmod_sparse matrix = View(starts, rows, nullptr);
  this->Internal->Factor = cholmod_analyze(&matrix, &common);
  this->Internal->Check("the ordering");
  this->Internal->Operations = common.fl;
  if (common.fl >= OperationsForSinglePrecision)
  {
    this->Internal->Single.emplace(Copied(*this->Internal->Factor), starts, rows);
    cholmod_free_factor(&this->Internal->Factor, &common);
  }
}

SparseCholesky::~SparseCholesky() = default;

bool SparseCholesky::Factorize(const std::vector<double>& values)
{
  if (this->Internal->Single)
  {
    this->Valid = this->Internal->Single->Factorize(values);
    return this->Valid;
  }
  cholmod_sparse matrix = View(this->Starts, this->Rows, values.data());
  cholmod_common& common = this->Internal->Common;
  const SingleThreaded single;
  cholmod_factorize(&matrix, this->Internal->Factor, &common);
  this->Internal->Check("the factorisation");
  this->Valid = common.status != CHOLMOD_NOT_POSDEF &&
    this->Internal->Factor->minor == this->Internal->Factor->n;
  return this->Valid;
}

bool SparseCholesky::InSinglePrecision() const
{
  return this->Internal->Single.has_value();
}

bool SparseCholesky::Expensive() const
{
  return this->Internal->Operations >= ManyOperations;
}

void SparseCholesky::Solve(std::vector<double>& columns)
{
  const SingleThreaded single;
  if (this->Internal->Single)
  {
    this->Internal->Single->Solve(columns);
    return;
  }
  const std::size_t n = this->Starts.size() - 1;
  cholmod_dense right{};
  right.nrow = n;
  right.ncol = n ? columns.size() / n : 0;
  right.nzmax = columns.size();
  right.d = n;
  right.x = columns.data();
  right.xtype = CHOLMOD_REAL;
  right.dtype = CHOLMOD_DOUBLE;
  Internals& internal = *this->Internal;
  cholmod_solve2(CHOLMOD_A, internal.Factor, &right, nullptr, &internal.Solution, nullptr,
    &internal.Work, &internal.MoreWork, &internal.Common);
  internal.Check("the back-substitution");
  const auto* solution = static_cast<const double*>(internal.Solution->x);
  std::copy(solution, solution + columns.size(), columns.begin());
}

void SparseCholesky::Multiply(const std::vector<double>& values, const double* x, double* y) const
{
  const std::size_t n = this->Starts.size() - 1;
  std::fill(y, y + n, 0.0);
  for (std::size_t c = 0; c < n; ++c)
  {
    double sum = 0;
    for (int k = this->Starts[c]; k < this->Starts[c + 1]; ++k)
    {
      const auto r = static_cast<std::size_t>(this->Rows[k]);
      sum += values[k] * x[r];
      if (r != c)
      {
        y[r] += values[k] * x[c];
      }
    }
    y[c] += sum;
  }
}

double SparseCholesky::PeakBytes() const
{
  return static_cast<double>(this->Internal->Common.memory_usage) +
    (this->Internal->Single ? this->Internal->Single->Bytes() : 0);
}
}
