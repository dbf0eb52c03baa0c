// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SupernodalFactor_h
#define mammoray_SupernodalFactor_h

#include "mammorayBiomechanicsModule.h"

#include <cstddef>
#include <vector>

namespace mammoray
{
/**
 * Supernodes of a factor L: runs of columns that share their rows, FirstColumns[s] to
 * FirstColumns[s + 1] - 1. Rows[RowStarts[s]] and on are ascending and begin with the columns
 * themselves; the supernode's values form a dense matrix by columns, from ValueStarts[s] on.
 */
struct Supernodes
{
  /// The matrix's column that is column k of the factor.
  std::vector<int> Order;
  std::vector<int> FirstColumns;
  std::vector<std::size_t> RowStarts;
  std::vector<std::size_t> ValueStarts;
  std::vector<int> Rows;
};

/**
 * L L^T in single precision of symmetric positive definite matrices that share one pattern, each
 * scaled to a diagonal of ones first: by supernodes, looking to the left (Ng & Peyton 1993). Half
 * of the time and of the memory of double precision; a solution is right to some 1e-7 times the
 * condition of the scaled matrix, and is to be refined where that does not do.
 */
class MAMMORAYBIOMECHANICS_EXPORT SupernodalFactor
{
public:
  /// `starts`, `rows`: the matrix's lower triangle by columns (SparseCholesky), of which the
  /// supernodes are; they must outlive the factor.
  SupernodalFactor(Supernodes supernodes, const std::vector<int>& starts,
    const std::vector<int>& rows);

  /// Answers false where the matrix is not positive definite, as far as single precision tells; the
  /// factor is unusable then.
  bool Factorize(const std::vector<double>& values);
  /// Solves for `columns` right-hand sides stored one after the other, in place.
  void Solve(std::vector<double>& columns) const;
  /// Memory of the factor and of the products made so far, bytes.
  double Bytes() const
  {
    return sizeof(float) * static_cast<double>(this->Values.size() + this->Product.size());
  }

private:
  int NumberOfSupernodes() const { return static_cast<int>(this->Nodes.FirstColumns.size()) - 1; }
  int ColumnsOf(int s) const
  {
    return this->Nodes.FirstColumns[s + 1] - this->Nodes.FirstColumns[s];
  }
  int RowsOf(int s) const
  {
    return static_cast<int>(this->Nodes.RowStarts[s + 1] - this->Nodes.RowStarts[s]);
  }
  const int* RowIndices(int s) const { return &this->Nodes.Rows[this->Nodes.RowStarts[s]]; }
  void MakePlaces();
  bool Scatter(const std::vector<double>& values);
  void Subtract(int descendant, int from, int to, int supernode);
  void SolveForwards(std::vector<float>& columns, int count) const;
  void SolveBackwards(std::vector<float>& columns, int count) const;

  const Supernodes Nodes;
  const std::vector<int>& Starts;
  const std::vector<int>& MatrixRows;
  /// The supernode of each column of the factor.
  std::vector<int> SupernodeOf;
  /// Where each entry of the matrix goes among the values.
  std::vector<std::size_t> Places;
  std::vector<float> Values;
  /// 1 / sqrt of the matrix's diagonal.
  std::vector<double> Scale;
  /// While factorising: the row of a supernode's matrix for each row of the factor; the product
  /// that is subtracted; supernodes that wait for the one which their row after the last used one
  /// is of.
  std::vector<int> RowInSupernode;
  std::vector<float> Product;
  std::vector<int> FirstWaiting;
  std::vector<int> NextWaiting;
  std::vector<int> RowsUsed;
};
}

#endif
