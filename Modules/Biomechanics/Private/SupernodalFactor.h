// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SupernodalFactor_h
#define mammoray_SupernodalFactor_h

#include "mammorayBiomechanicsModule.h"

#include <cstddef>
#include <vector>

namespace mammoray
{
/**
 * Supernodes of a factor L: runs of columns with the same rows. Supernode s has the columns
 * FirstColumns[s] to FirstColumns[s + 1] - 1. Its rows start at Rows[RowStarts[s]], ascend, and
 * begin with these columns. Its values are a dense matrix by columns that starts at ValueStarts[s].
 */
struct Supernodes
{
  /// The matrix's column that became column k of the factor.
  std::vector<int> Order;
  std::vector<int> FirstColumns;
  std::vector<std::size_t> RowStarts;
  std::vector<std::size_t> ValueStarts;
  std::vector<int> Rows;
};

/**
 * L L^T factorisation in single precision of symmetric positive definite matrices with one pattern,
 * each scaled to a unit diagonal first; left-looking by supernodes (Ng & Peyton 1993). CHOLMOD has
 * single precision from version 5 on, which Debian 12 lacks. It takes half the time and memory of
 * double precision: a breast of more than 18,000 unknowns is compressed in 0.7 of the time.
 * Solutions are accurate to about 1e-7 times the condition number of the scaled matrix; refine them
 * where that is too little.
 */
class MAMMORAYBIOMECHANICS_EXPORT SupernodalFactor
{
public:
  /// `starts` and `rows` are the matrix's lower triangle by columns (see SparseCholesky), to which
  /// the supernodes belong. They must outlive the factor.
  SupernodalFactor(Supernodes supernodes, const std::vector<int>& starts,
    const std::vector<int>& rows);

  /// Returns false if the matrix is not positive definite in single precision; there is no usable
  /// factor then.
  bool Factorize(const std::vector<double>& values);
  /// Solves in place for the right-hand sides stored one after the other in `columns`.
  void Solve(std::vector<double>& columns) const;
  /// Memory of the factor and of its working space, bytes.
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
  /// Supernode of each column of the factor.
  std::vector<int> SupernodeOf;
  /// Position of each entry of the matrix among the values.
  std::vector<std::size_t> Places;
  std::vector<float> Values;
  /// 1 / sqrt of the matrix's diagonal.
  std::vector<double> Scale;
  /// Working space of Factorize: the row of a supernode's matrix for each row of the factor, the
  /// product to subtract, and linked lists of the supernodes that wait for each supernode, with the
  /// number of rows they have used.
  std::vector<int> RowInSupernode;
  std::vector<float> Product;
  std::vector<int> FirstWaiting;
  std::vector<int> NextWaiting;
  std::vector<int> RowsUsed;
};
}

#endif
