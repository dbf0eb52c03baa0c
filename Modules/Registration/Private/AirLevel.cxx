// SPDX-License-Identifier: Apache-2.0
#include "Private/AirLevel.h"

#include "Private/RobustStatistics.h"
#include "mammoray/Foundation/Error.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
constexpr double BlockMm = 10;
/// Fewer pixels of air in a block say little.
constexpr std::size_t LeastInBlock = 8;
/// Length over which scatter spreads, which is also how far the remainder of a block counts.
constexpr double SpreadMm = 12;
/// Standard deviations of what is expected of the level, in contrasts of the breast, per 100 mm and
/// per its square: a heel of 20 % over 200 mm is 0.11 in the logarithm, a tenth of what an average
/// breast absorbs; the inverse square at 120 mm beside the source's foot 0.03.
constexpr double PriorSlope = 0.15;
constexpr double PriorCurvature = 0.05;
/// Scatter beside the breast, in contrasts, and the distance over which it falls to 1/e, mm: a
/// tenth of the primary without a grid.
constexpr double Glow = 0.04;
constexpr double GlowMm = 15;
/// No air is smooth to more than this, in contrasts.
constexpr double LeastScatter = 0.001;
constexpr double HuberLimit = 1.5;

using Terms = Eigen::Matrix<double, 6, 1>;

Terms TermsAt(double x, double y)
{
  return (Terms() << 1, x, y, x * x, x * y, y * y).finished();
}
}

AirLevel::AirLevel(const PixelGrid& grid, const std::vector<float>& values, const PixelMask& air,
  double contrast)
  : Grid(grid)
{
  this->BlockColumns = std::max(4, static_cast<int>(std::lround(BlockMm / grid.ColumnSpacing)));
  this->BlockRows = std::max(4, static_cast<int>(std::lround(BlockMm / grid.RowSpacing)));
  this->CountAcross = (grid.Columns + this->BlockColumns - 1) / this->BlockColumns;
  this->CountDown = (grid.Rows + this->BlockRows - 1) / this->BlockRows;
  this->GatherBlocks(values, air);
  this->FitPolynomial(contrast);
  this->GatherBlocks(values, air); // a slope within a block is no noise
  this->SpreadRemainders();
}

double AirLevel::ColumnToX(double column) const
{
  return (column - 0.5 * (this->Grid.Columns - 1)) * this->Grid.ColumnSpacing / 100;
}

double AirLevel::RowToY(double row) const
{
  return (row - 0.5 * (this->Grid.Rows - 1)) * this->Grid.RowSpacing / 100;
}

void AirLevel::MeasureBlock(int across, int down, const std::vector<float>& values,
  const PixelMask& air, std::vector<float>& found, Block& block) const
{
  const int lastColumn = std::min((across + 1) * this->BlockColumns, this->Grid.Columns);
  const int lastRow = std::min((down + 1) * this->BlockRows, this->Grid.Rows);
  found.clear();
  double sumX = 0;
  double sumY = 0;
  for (int row = down * this->BlockRows; row < lastRow; ++row)
  {
    for (int column = across * this->BlockColumns; column < lastColumn; ++column)
    {
      const std::size_t pixel = this->Grid.Index(column, row);
      if (air[pixel])
      {
        found.push_back(static_cast<float>(values[pixel] - this->At(column, row)));
        sumX += this->ColumnToX(column);
        sumY += this->RowToY(row);
      }
    }
  }
  if (!found.empty())
  {
    block.X = sumX / static_cast<double>(found.size());
    block.Y = sumY / static_cast<double>(found.size());
    block.Remainder = Median(found);
  }
}

void AirLevel::GatherBlocks(const std::vector<float>& values, const PixelMask& air)
{
  this->Blocks.clear();
  std::vector<Block> all(static_cast<std::size_t>(this->CountAcross) * this->CountDown);
  std::vector<std::size_t> counts;
  std::vector<double> deviations;
  std::vector<float> found;
  PixelMask whole(all.size());
  for (std::size_t i = 0; i < all.size(); ++i)
  {
    this->MeasureBlock(static_cast<int>(i) % this->CountAcross,
      static_cast<int>(i) / this->CountAcross, values, air, found, all[i]);
    counts.push_back(found.size());
    whole[i] = 2 * found.size() > static_cast<std::size_t>(this->BlockColumns) * this->BlockRows;
    deviations.push_back(
      found.empty() ? 0 : RobustSigma(found, static_cast<float>(all[i].Remainder)));
  }
  const PixelGrid blocks{ this->CountAcross, this->CountDown,
    this->BlockColumns * this->Grid.ColumnSpacing, this->BlockRows * this->Grid.RowSpacing };
  const std::vector<float> away = DistanceToClear(blocks, whole);
  // Blocks with little air are left out, unless all have little.
  const std::size_t most = *std::max_element(counts.begin(), counts.end());
  std::vector<double> counted;
  for (std::size_t i = 0; i < all.size(); ++i)
  {
    if (counts[i] > 0 && counts[i] >= std::min(LeastInBlock, most))
    {
      all[i].Away = away[i];
      this->Blocks.push_back(all[i]);
      counted.push_back(deviations[i]);
    }
  }
  if (this->Blocks.empty())
  {
    throw InputError("mammogram: expected air beside the breast, found none");
  }
  this->Deviation = Median(counted);
}

void AirLevel::FitPolynomial(double contrast)
{
  std::vector<double> levels(this->Blocks.size());
  std::transform(this->Blocks.begin(), this->Blocks.end(), levels.begin(),
    [](const Block& block) { return block.Remainder; });
  const double base = Median(levels);
  Terms precision; // of the prior
  precision << 0, 1, 1, 1, 1, 1;
  precision.segment<2>(1) /= std::pow(PriorSlope * contrast, 2);
  precision.segment<3>(3) /= std::pow(PriorCurvature * contrast, 2);
  Terms found = Terms::Zero(); // above the base
  constexpr int Rounds = 20;
  for (int round = 0; round < Rounds; ++round)
  {
    std::vector<double> remainders;
    for (const Block& block : this->Blocks)
    {
      remainders.push_back(block.Remainder - base - TermsAt(block.X, block.Y).dot(found));
    }
    const double scale = std::max(RobustSigma(remainders, 0.0), LeastScatter * contrast);
    Eigen::Matrix<double, 6, 6> normal = precision.asDiagonal();
    Terms right = Terms::Zero();
    for (std::size_t i = 0; i < this->Blocks.size(); ++i)
    {
      const Block& block = this->Blocks[i];
      const Terms terms = TermsAt(block.X, block.Y);
      const double sigma = std::hypot(scale, Glow * contrast * std::exp(-block.Away / GlowMm));
      const double standardised = std::abs(remainders[i]) / sigma;
      const double weight =
        (standardised > HuberLimit ? HuberLimit / standardised : 1) / (sigma * sigma);
      normal += weight * terms * terms.transpose();
      right += weight * terms * (block.Remainder - base);
    }
    const Terms next = normal.ldlt().solve(right);
    const bool settled = (next - found).cwiseAbs().maxCoeff() < 1e-3 * LeastScatter * contrast;
    found = next;
    if (settled)
    {
      break;
    }
  }
  std::copy(found.begin(), found.end(), this->Coefficients.begin());
  this->Coefficients[0] += base;
}

void AirLevel::SpreadRemainders()
{
  // Far from air nothing is known, and the smooth level stands: weight that stands for no
  // remainder.
  constexpr double WeightOfNone = 1e-3;
  constexpr double Spread = SpreadMm / 100;
  this->Remainders.assign(static_cast<std::size_t>(this->CountAcross) * this->CountDown, 0.0);
  for (std::size_t i = 0; i < this->Remainders.size(); ++i)
  {
    const int across = static_cast<int>(i) % this->CountAcross;
    const int down = static_cast<int>(i) / this->CountAcross;
    const double x = this->ColumnToX((across + 0.5) * this->BlockColumns - 0.5);
    const double y = this->RowToY((down + 0.5) * this->BlockRows - 0.5);
    double sum = 0;
    double weights = WeightOfNone;
    for (const Block& block : this->Blocks)
    {
      const double square = std::pow(block.X - x, 2) + std::pow(block.Y - y, 2);
      const double weight = std::exp(-0.5 * square / (Spread * Spread));
      sum += weight * block.Remainder;
      weights += weight;
    }
    this->Remainders[i] = sum / weights;
  }
}

double AirLevel::Polynomial(double x, double y) const
{
  const std::array<double, 6>& c = this->Coefficients;
  return c[0] + c[1] * x + c[2] * y + c[3] * x * x + c[4] * x * y + c[5] * y * y;
}

double AirLevel::At(int column, int row) const
{
  return this->Polynomial(this->ColumnToX(column), this->RowToY(row));
}

double AirLevel::LocalAt(int column, int row) const
{
  // Linear between the blocks' centres, constant outside them.
  const double across =
    std::clamp((column + 0.5) / this->BlockColumns - 0.5, 0.0, this->CountAcross - 1.0);
  const double down = std::clamp((row + 0.5) / this->BlockRows - 0.5, 0.0, this->CountDown - 1.0);
  const int left = std::min(static_cast<int>(across), std::max(0, this->CountAcross - 2));
  const int top = std::min(static_cast<int>(down), std::max(0, this->CountDown - 2));
  const int right = std::min(left + 1, this->CountAcross - 1);
  const int bottom = std::min(top + 1, this->CountDown - 1);
  const auto remainder = [&](int i, int j)
  { return this->Remainders[static_cast<std::size_t>(j) * this->CountAcross + i]; };
  const double u = across - left;
  const double v = down - top;
  return this->At(column, row) +
    (1 - v) * ((1 - u) * remainder(left, top) + u * remainder(right, top)) +
    v * ((1 - u) * remainder(left, bottom) + u * remainder(right, bottom));
}
}
