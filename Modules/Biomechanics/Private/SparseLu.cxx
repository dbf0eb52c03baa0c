// SPDX-License-Identifier: Apache-2.0
#include "Private/SparseLu.h"

#include "Private/SingleThreaded.h"
#include "mammoray/Foundation/Error.h"

#include <umfpack.h>

#include <algorithm>
#include <new>
#include <string>

namespace mammoray
{
struct SparseLu::Internals
{
  double Control[UMFPACK_CONTROL] = {};
  void* Symbolic = nullptr;
  void* Numeric = nullptr;

  ~Internals()
  {
    umfpack_di_free_numeric(&this->Numeric);
    umfpack_di_free_symbolic(&this->Symbolic);
  }
};

namespace
{
void Check(int status, const char* what)
{
  if (status == UMFPACK_ERROR_out_of_memory)
  {
    throw std::bad_alloc();
  }
  if (status < UMFPACK_OK)
  {
    throw ConvergenceError(
      std::string("UMFPACK: ") + what + " ended with status " + std::to_string(status));
  }
}
}

SparseLu::SparseLu(const std::vector<int>& starts, const std::vector<int>& rows)
  : Internal(std::make_unique<Internals>())
  , Starts(starts)
  , Rows(rows)
{
  umfpack_di_defaults(this->Internal->Control);
  this->Internal->Control[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
  this->Internal->Control[UMFPACK_ORDERING] = UMFPACK_ORDERING_METIS;
  // Callers refine themselves, with the matrix they need.
  this->Internal->Control[UMFPACK_IRSTEP] = 0;
  const int size = static_cast<int>(starts.size()) - 1;
  Check(umfpack_di_symbolic(size, size, starts.data(), rows.data(), nullptr,
          &this->Internal->Symbolic, this->Internal->Control, nullptr),
    "the ordering");
}

SparseLu::~SparseLu() = default;

bool SparseLu::Usable() const
{
  return this->Internal->Numeric != nullptr;
}

void SparseLu::Forget()
{
  umfpack_di_free_numeric(&this->Internal->Numeric);
}

bool SparseLu::Factorize(const std::vector<double>& values)
{
  this->Forget();
  const SingleThreaded single;
  const int status = umfpack_di_numeric(this->Starts.data(), this->Rows.data(), values.data(),
    this->Internal->Symbolic, &this->Internal->Numeric, this->Internal->Control, nullptr);
  Check(status, "the factorisation");
  if (status != UMFPACK_OK)
  {
    this->Forget();
  }
  return this->Usable();
}

void SparseLu::Solve(std::vector<double>& columns) const
{
  const std::size_t n = this->Starts.size() - 1;
  std::vector<double> solution(n);
  for (std::size_t begin = 0; begin < columns.size(); begin += n)
  {
    Check(umfpack_di_solve(UMFPACK_A, this->Starts.data(), this->Rows.data(), nullptr,
            solution.data(), &columns[begin], this->Internal->Numeric, this->Internal->Control,
            nullptr),
      "the back-substitution");
    std::copy(solution.begin(), solution.end(), &columns[begin]);
  }
}

void SparseLu::Multiply(const std::vector<double>& values, const double* x, double* y) const
{
  const std::size_t n = this->Starts.size() - 1;
  std::fill(y, y + n, 0.0);
  for (std::size_t c = 0; c < n; ++c)
  {
    for (int k = this->Starts[c]; k < this->Starts[c + 1]; ++k)
    {
      y[this->Rows[k]] += values[k] * x[c];
    }
  }
}
}
