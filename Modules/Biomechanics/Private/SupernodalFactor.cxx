// SPDX-License-Identifier: Apache-2.0
#include "Private/SupernodalFactor.h"

#include <cblas.h>

#include <algorithm>
#include <cmath>
#include <utility>

extern "C" void spotrf_(const char* triangle, const int* n, float* a, const int* lda, int* info,
  std::size_t triangleLength);

namespace mammoray
{
namespace
{
/// Factorises the first `width` rows; returns false if they are not positive definite. OpenBLAS
/// does not report NaN.
bool FactorizeBlock(float* block, int width, int height)
{
  int info = 0;
  spotrf_("L", &width, block, &height, &info, 1);
  for (std::size_t i = 0; info == 0 && i < static_cast<std::size_t>(width); ++i)
  {
    info = block[i * (static_cast<std::size_t>(height) + 1)] > 0 ? 0 : 1;
  }
  return info == 0;
}
}

SupernodalFactor::SupernodalFactor(Supernodes supernodes, const std::vector<int>& starts,
  const std::vector<int>& rows)
  : Nodes(std::move(supernodes))
  , Starts(starts)
  , MatrixRows(rows)
  , Values(Nodes.ValueStarts.back())
  , Scale(Nodes.Order.size())
  , RowInSupernode(Nodes.Order.size())
{
  this->MakePlaces();
}

void SupernodalFactor::MakePlaces()
{
  const Supernodes& nodes = this->Nodes;
  const std::size_t n = nodes.Order.size();
  std::vector<int> columnOf(n);
  for (std::size_t k = 0; k < n; ++k)
  {
    columnOf[nodes.Order[k]] = static_cast<int>(k);
  }
  this->SupernodeOf.resize(n);
  for (int s = 0; s < this->NumberOfSupernodes(); ++s)
  {
    std::fill_n(&this->SupernodeOf[nodes.FirstColumns[s]], this->ColumnsOf(s), s);
  }
  this->Places.resize(this->MatrixRows.size());
  for (std::size_t c = 0; c < n; ++c)
  {
    for (int k = this->Starts[c]; k < this->Starts[c + 1]; ++k)
    {
      const auto [column, row] = std::minmax(columnOf[c], columnOf[this->MatrixRows[k]]);
      const int s = this->SupernodeOf[column];
      const int* first = this->RowIndices(s);
      const std::size_t height = this->RowsOf(s);
      this->Places[k] = nodes.ValueStarts[s] +
        height * static_cast<std::size_t>(column - nodes.FirstColumns[s]) +
        static_cast<std::size_t>(std::lower_bound(first, first + height, row) - first);
    }
  }
}

/// Returns false if a diagonal entry is not positive.
bool SupernodalFactor::Scatter(const std::vector<double>& values)
{
  for (std::size_t c = 0; c < this->Scale.size(); ++c)
  {
    const double diagonal = values[this->Starts[c]];
    if (!(diagonal > 0))
    {
      return false;
    }
    this->Scale[c] = 1 / std::sqrt(diagonal);
  }
  std::fill(this->Values.begin(), this->Values.end(), 0.0F);
  for (std::size_t c = 0; c < this->Scale.size(); ++c)
  {
    for (int k = this->Starts[c]; k < this->Starts[c + 1]; ++k)
    {
      this->Values[this->Places[k]] =
        static_cast<float>(values[k] * this->Scale[c] * this->Scale[this->MatrixRows[k]]);
    }
  }
  return true;
}

/// Subtracts the contribution of an earlier supernode, whose rows `from` to `to` - 1 are among this
/// supernode's columns.
void SupernodalFactor::Subtract(int descendant, int from, int to, int supernode)
{
  const int depth = this->ColumnsOf(descendant);
  const int height = this->RowsOf(descendant);
  const int across = to - from;
  const int down = height - from;
  const std::size_t size = static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
  if (this->Product.size() < size)
  {
    this->Product.resize(size);
  }
  const float* block = &this->Values[this->Nodes.ValueStarts[descendant]] + from;
  float* product = this->Product.data();
  cblas_ssyrk(CblasColMajor, CblasLower, CblasNoTrans, across, depth, 1, block, height, 0, product,
    down);
  if (down > across)
  {
    cblas_sgemm(CblasColMajor, CblasNoTrans, CblasTrans, down - across, across, depth, 1,
      block + across, height, block, height, 0, product + across, down);
  }
  const int* rows = this->RowIndices(descendant) + from;
  const std::size_t stride = this->RowsOf(supernode);
  float* values = &this->Values[this->Nodes.ValueStarts[supernode]];
  for (int j = 0; j < across; ++j)
  {
    // The first rows of a supernode are its columns.
    float* column = values + stride * this->RowInSupernode[rows[j]];
    const float* given = product + static_cast<std::size_t>(down) * j;
    for (int i = j; i < down; ++i)
    {
      column[this->RowInSupernode[rows[i]]] -= given[i];
    }
  }
}

bool SupernodalFactor::Factorize(const std::vector<double>& values)
{
  if (!this->Scatter(values))
  {
    return false;
  }
  const int count = this->NumberOfSupernodes();
  this->FirstWaiting.assign(count, -1);
  this->NextWaiting.assign(count, -1);
  this->RowsUsed.assign(count, 0);
  const auto wait = [&](int s)
  {
    if (this->RowsUsed[s] < this->RowsOf(s))
    {
      int& first = this->FirstWaiting[this->SupernodeOf[this->RowIndices(s)[this->RowsUsed[s]]]];
      this->NextWaiting[s] = std::exchange(first, s);
    }
  };
  for (int s = 0; s < count; ++s)
  {
    const int* rows = this->RowIndices(s);
    const int height = this->RowsOf(s);
    const int width = this->ColumnsOf(s);
    for (int i = 0; i < height; ++i)
    {
      this->RowInSupernode[rows[i]] = i;
    }
    for (int d = this->FirstWaiting[s]; d >= 0;)
    {
      const int next = this->NextWaiting[d];
      const int* begin = this->RowIndices(d);
      const int from = this->RowsUsed[d];
      const int to = static_cast<int>(
        std::lower_bound(begin + from, begin + this->RowsOf(d), this->Nodes.FirstColumns[s + 1]) -
        begin);
      this->Subtract(d, from, to, s);
      this->RowsUsed[d] = to;
      wait(d);
      d = next;
    }
    float* block = &this->Values[this->Nodes.ValueStarts[s]];
    if (!FactorizeBlock(block, width, height))
    {
      return false;
    }
    if (height > width)
    {
      cblas_strsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, height - width,
        width, 1, block, height, block + width, height);
    }
    this->RowsUsed[s] = width;
    wait(s);
  }
  return true;
}

/// A substitution is limited by reading the factor; several right-hand sides share the reading.
void SupernodalFactor::SolveForwards(std::vector<float>& columns, int count) const
{
  const int n = static_cast<int>(this->Scale.size());
  std::vector<float> below;
  for (int s = 0; s < this->NumberOfSupernodes(); ++s)
  {
    const int width = this->ColumnsOf(s);
    const int height = this->RowsOf(s);
    const int rest = height - width;
    const float* block = &this->Values[this->Nodes.ValueStarts[s]];
    float* own = &columns[this->Nodes.FirstColumns[s]];
    below.resize(static_cast<std::size_t>(rest) * count);
    if (count == 1)
    {
      cblas_strsv(CblasColMajor, CblasLower, CblasNoTrans, CblasNonUnit, width, block, height, own,
        1);
      cblas_sgemv(CblasColMajor, CblasNoTrans, rest, width, 1, block + width, height, own, 1, 0,
        below.data(), 1);
    }
    else
    {
      cblas_strsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, width, count, 1,
        block, height, own, n);
      cblas_sgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, rest, count, width, 1, block + width,
        height, own, n, 0, below.data(), std::max(rest, 1));
    }
    const int* rows = this->RowIndices(s) + width;
    for (std::size_t p = 0; p < static_cast<std::size_t>(count); ++p)
    {
      for (int i = 0; i < rest; ++i)
      {
        columns[n * p + rows[i]] -= below[rest * p + i];
      }
    }
  }
}

void SupernodalFactor::SolveBackwards(std::vector<float>& columns, int count) const
{
  const int n = static_cast<int>(this->Scale.size());
  std::vector<float> below;
  for (int s = this->NumberOfSupernodes() - 1; s >= 0; --s)
  {
    const int width = this->ColumnsOf(s);
    const int height = this->RowsOf(s);
    const int rest = height - width;
    const float* block = &this->Values[this->Nodes.ValueStarts[s]];
    float* own = &columns[this->Nodes.FirstColumns[s]];
    below.resize(static_cast<std::size_t>(rest) * count);
    const int* rows = this->RowIndices(s) + width;
    for (std::size_t p = 0; p < static_cast<std::size_t>(count); ++p)
    {
      for (int i = 0; i < rest; ++i)
      {
        below[rest * p + i] = columns[n * p + rows[i]];
      }
    }
    if (count == 1)
    {
      cblas_sgemv(CblasColMajor, CblasTrans, rest, width, -1, block + width, height, below.data(),
        1, 1, own, 1);
      cblas_strsv(CblasColMajor, CblasLower, CblasTrans, CblasNonUnit, width, block, height, own,
        1);
    }
    else
    {
      cblas_sgemm(CblasColMajor, CblasTrans, CblasNoTrans, width, count, rest, -1, block + width,
        height, below.data(), std::max(rest, 1), 1, own, n);
      cblas_strsm(CblasColMajor, CblasLeft, CblasLower, CblasTrans, CblasNonUnit, width, count, 1,
        block, height, own, n);
    }
  }
}

void SupernodalFactor::Solve(std::vector<double>& columns) const
{
  const std::size_t n = this->Scale.size();
  const std::size_t count = n ? columns.size() / n : 0;
  std::vector<float> work(columns.size());
  // Scale the right-hand sides, so that small numbers stay in single precision's range.
  std::vector<double> largest(count, 0.0);
  for (std::size_t p = 0; p < count; ++p)
  {
    for (std::size_t k = 0; k < n; ++k)
    {
      largest[p] = std::max(largest[p], std::abs(columns[n * p + k] * this->Scale[k]));
    }
    for (std::size_t k = 0; k < n && largest[p] > 0; ++k)
    {
      const int c = this->Nodes.Order[k];
      work[n * p + k] = static_cast<float>(columns[n * p + c] * this->Scale[c] / largest[p]);
    }
  }
  this->SolveForwards(work, static_cast<int>(count));
  this->SolveBackwards(work, static_cast<int>(count));
  for (std::size_t p = 0; p < count; ++p)
  {
    for (std::size_t k = 0; k < n; ++k)
    {
      const int c = this->Nodes.Order[k];
      columns[n * p + c] = work[n * p + k] * largest[p] * this->Scale[c];
    }
  }
}
}
