// SPDX-License-Identifier: Apache-2.0
#include "Private/FactorCache.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mammoray
{
namespace
{
/// Smallest share of the positive definite matrix that is worth adding.
constexpr double SmallestShare = 1.0 / 64;
/// Use of a factor as preconditioner: largest distance, mm, relative residual to reach, and largest
/// number of iterations, each of which costs one solution.
struct Reach
{
  double Mm;
  double Tolerance;
  int MostSteps;
};
constexpr Reach OfCheap{ FactorCache::NearMm, 1e-3, 6 };
/// At 0.3 to 0.6 mm, 1e-2 takes 8 to 10 iterations and 1e-3 takes 10 to 13 (the FDA's phantom).
constexpr Reach OfExpensive{ 0.5, 1e-2, 14 };
constexpr int MostRefinements = 8;
constexpr double RefinementTolerance = 1e-9;

/// Largest difference of a coordinate, mm; infinite if `positions` is empty.
double LargestDifference(const std::vector<double>& x, const std::vector<double>& positions)
{
  if (positions.size() != x.size())
  {
    return std::numeric_limits<double>::infinity();
  }
  double farthest = 0;
  for (std::size_t c = 0; c < x.size(); ++c)
  {
    farthest = std::max(farthest, std::abs(x[c] - positions[c]));
  }
  return farthest;
}
}

FactorCache::FactorCache(const SparsePattern& pattern)
  : Cholesky(pattern.Starts, pattern.Rows)
{
}

bool FactorCache::Factorize(const std::vector<double>& values, const std::vector<double>& x)
{
  this->Positions.clear();
  if (!this->Cholesky.Factorize(values))
  {
    return false;
  }
  this->Positions = x;
  this->Pure = true;
  return true;
}

bool FactorCache::FactorizeMixed(const std::vector<double>& values, const std::vector<double>& x,
  const std::function<std::vector<double>()>& projected, bool stiffer)
{
  // Add as little as needed of the projected matrix: all of it is far too stiff, and Newton's
  // method would converge slowly. The last share is a good guess.
  this->Positions.clear();
  if (stiffer)
  {
    this->MixedShare = std::clamp(8 * this->MixedShare, SmallestShare, 1.0);
  }
  else
  {
    this->MixedShare = this->MixedShare < 4 * SmallestShare ? 0 : 0.25 * this->MixedShare;
    this->Projected.clear();
  }
  std::vector<double> mixed;
  for (;; this->MixedShare = std::clamp(8 * this->MixedShare, SmallestShare, 1.0))
  {
    if (this->MixedShare == 0)
    {
      if (this->Factorize(values, x))
      {
        return true;
      }
      continue;
    }
    if (this->Projected.empty())
    {
      this->Projected = projected();
    }
    mixed = values;
    for (std::size_t k = 0; k < mixed.size(); ++k)
    {
      mixed[k] += this->MixedShare * (this->Projected[k] - mixed[k]);
    }
    if (this->Cholesky.Factorize(mixed))
    {
      this->Positions = x;
      this->Pure = false;
      return true;
    }
    if (this->MixedShare == 1)
    {
      return false;
    }
  }
}

double FactorCache::DistanceMm(const std::vector<double>& x) const
{
  return this->Pure ? LargestDifference(x, this->Positions)
                    : std::numeric_limits<double>::infinity();
}

bool FactorCache::SolveOwn(const std::vector<double>& values, const std::vector<double>& right,
  std::size_t count, std::vector<double>& solution)
{
  if (this->Pure && this->Cholesky.InSinglePrecision())
  {
    return this->RefineNearby(values, right, count, solution);
  }
  solution = right;
  this->Solve(solution);
  return true;
}

bool FactorCache::SolveNearby(const std::vector<double>& values, const std::vector<double>& x,
  const std::vector<double>& right, std::vector<double>& solution)
{
  const bool expensive = this->Cholesky.Expensive();
  const Reach& reach = expensive ? OfExpensive : OfCheap;
  if (!(this->Pure || expensive) || !(LargestDifference(x, this->Positions) < reach.Mm))
  {
    return false;
  }
  const auto size = static_cast<Eigen::Index>(right.size());
  const auto view = [size](std::vector<double>& v)
  { return Eigen::Map<Eigen::VectorXd>(v.data(), size); };
  std::vector<double> residual = right;
  std::vector<double> preconditioned = right;
  std::vector<double> direction;
  std::vector<double> product(right.size());
  solution.assign(right.size(), 0.0);
  const double enough = reach.Tolerance * view(residual).norm();
  double before = 0;
  for (int iteration = 0; iteration < reach.MostSteps; ++iteration)
  {
    this->Cholesky.Solve(preconditioned);
    const double now = view(residual).dot(view(preconditioned));
    if (iteration == 0)
    {
      direction = preconditioned;
    }
    else
    {
      view(direction) = view(preconditioned) + now / before * view(direction);
    }
    this->Cholesky.Multiply(values, direction.data(), product.data());
    const double curvature = view(direction).dot(view(product));
    if (!(curvature > 0))
    {
      return false;
    }
    view(solution) += now / curvature * view(direction);
    view(residual) -= now / curvature * view(product);
    if (view(residual).norm() <= enough)
    {
      return true;
    }
    preconditioned = residual;
    before = now;
  }
  return false;
}

bool FactorCache::RefineNearby(const std::vector<double>& values, const std::vector<double>& right,
  std::size_t count, std::vector<double>& solution)
{
  const std::size_t n = right.size() / count;
  const auto norm = [n](const std::vector<double>& columns, std::size_t p) {
    return Eigen::Map<const Eigen::VectorXd>(&columns[n * p], static_cast<Eigen::Index>(n)).norm();
  };
  solution.assign(right.size(), 0.0);
  std::vector<double> residual = right;
  for (int pass = 0; pass < MostRefinements; ++pass)
  {
    this->Cholesky.Solve(residual);
    for (std::size_t k = 0; k < solution.size(); ++k)
    {
      solution[k] += residual[k];
    }
    for (std::size_t p = 0; p < count; ++p)
    {
      this->Cholesky.Multiply(values, &solution[n * p], &residual[n * p]);
    }
    for (std::size_t k = 0; k < solution.size(); ++k)
    {
      residual[k] = right[k] - residual[k];
    }
    bool refined = true;
    for (std::size_t p = 0; p < count; ++p)
    {
      refined = refined && norm(residual, p) <= RefinementTolerance * norm(right, p);
    }
    if (refined)
    {
      return true;
    }
  }
  return false;
}
}
