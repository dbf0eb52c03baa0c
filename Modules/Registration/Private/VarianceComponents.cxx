// SPDX-License-Identifier: Apache-2.0
#include "Private/VarianceComponents.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace mammoray
{
namespace
{
/// Pairs of so many residuals are looked at.
constexpr Eigen::Index MostCompared = 2000;
/// Beyond this no autocorrelation is looked for, mm.
constexpr double LongestLagMm = 80;
/// Autocorrelations below this are as likely those of noise; in a plane they would count with their
/// distance.
constexpr double Unlike = 0.1;
/// Relative; sigmas are wanted to a hundredth.
constexpr double Settled = 1e-3;
constexpr int MostRounds = 50;
/// No residuals are smaller, in their unit: nothing is known without an error.
constexpr double LeastSigma = 1e-6;
/// Unknowns in comparable units have normal equations of a condition of 1e4 at worst.
constexpr double LeastCondition = 1e-12;
}

double IntegralScale(const ResidualGroup& group)
{
  const Eigen::Index count = group.Residuals.size();
  const Eigen::Index stride = std::max<Eigen::Index>(1, (count + MostCompared - 1) / MostCompared);
  const double step = group.Dimension == 1 ? group.Extent : std::sqrt(group.Extent);
  std::vector<double> products(static_cast<std::size_t>(LongestLagMm / step) + 1, 0.0);
  std::vector<double> pairs(products.size(), 0.0);
  double square = 0;
  double compared = 0;
  for (Eigen::Index i = 0; i < count; i += stride)
  {
    const std::array<double, 2>& here = group.Places[static_cast<std::size_t>(i)];
    square += group.Residuals[i] * group.Residuals[i];
    compared += 1;
    for (Eigen::Index j = i + stride; j < count; j += stride)
    {
      const std::array<double, 2>& there = group.Places[static_cast<std::size_t>(j)];
      const auto lag = static_cast<std::size_t>(
        std::lround(std::hypot(here[0] - there[0], here[1] - there[1]) / step));
      if (lag < products.size())
      {
        products[lag] += group.Residuals[i] * group.Residuals[j];
        pairs[lag] += 1;
      }
    }
  }
  double scale = group.Extent;
  for (std::size_t lag = 1; lag < products.size() && square > 0; ++lag)
  {
    if (pairs[lag] == 0)
    {
      continue; // between two samples of a thinned group
    }
    const double correlation = products[lag] / pairs[lag] * compared / square;
    if (correlation < Unlike)
    {
      break;
    }
    const double shell = group.Dimension == 1
      ? 2 * step
      : 2 * std::numbers::pi * static_cast<double>(lag) * step * step;
    scale += shell * correlation;
  }
  return scale;
}

double VarianceComponents::Weight(const std::vector<ResidualGroup>& groups, std::size_t group) const
{
  return groups[group].Share * groups[group].Extent /
    std::max(groups[group].LeastCovariance,
      this->Correlated[group] * this->Sigmas[group] * this->Sigmas[group]);
}

VarianceComponents EstimateVariances(const std::vector<ResidualGroup>& groups,
  const Eigen::MatrixXd& precision)
{
  VarianceComponents found;
  std::vector<Eigen::MatrixXd> normals;
  for (const ResidualGroup& group : groups)
  {
    found.Correlated.push_back(IntegralScale(group));
    normals.emplace_back(group.Jacobian.transpose() * group.Jacobian);
    found.Sigmas.push_back(std::max(LeastSigma,
      std::sqrt(group.Residuals.squaredNorm() / static_cast<double>(group.Residuals.size()))));
  }
  const auto invert = [&]()
  {
    Eigen::MatrixXd normal = precision;
    for (std::size_t group = 0; group < groups.size(); ++group)
    {
      normal += found.Weight(groups, group) * normals[group];
    }
    const Eigen::LDLT<Eigen::MatrixXd> factor(normal);
    found.Determined = factor.info() == Eigen::Success && factor.rcond() > LeastCondition;
    found.Covariance = factor.solve(Eigen::MatrixXd::Identity(normal.rows(), normal.cols()));
  };
  invert();
  for (int round = 0; round < MostRounds; ++round)
  {
    double change = 0;
    for (std::size_t group = 0; group < groups.size(); ++group)
    {
      const double independent =
        groups[group].Share * groups[group].Extent / found.Correlated[group];
      const double told = found.Weight(groups, group) * (found.Covariance * normals[group]).trace();
      const double left =
        std::max(1.0, independent * static_cast<double>(groups[group].Residuals.size()) - told);
      const double sigma =
        std::max(LeastSigma, std::sqrt(independent * groups[group].Residuals.squaredNorm() / left));
      change = std::max(change, std::abs(sigma / found.Sigmas[group] - 1));
      found.Sigmas[group] = sigma;
    }
    invert();
    if (change < Settled)
    {
      break;
    }
  }
  return found;
}

Eigen::MatrixXd SmoothCovariance(const std::vector<std::array<double, 2>>& places,
  const Eigen::MatrixXd& scores, double alikeMm)
{
  struct Cell
  {
    Eigen::VectorXd Score;
    std::array<double, 2> PlaceSum{ 0, 0 };
    double Count = 0;
  };
  std::map<std::array<long, 2>, Cell> cells;
  for (std::size_t index = 0; index < places.size(); ++index)
  {
    const std::array<double, 2>& place = places[index];
    Cell& cell =
      cells[{ std::lround(8 * place[0] / alikeMm), std::lround(8 * place[1] / alikeMm) }];
    if (cell.Count == 0)
    {
      cell.Score = Eigen::VectorXd::Zero(scores.cols());
    }
    cell.Score += scores.row(static_cast<Eigen::Index>(index)).transpose();
    cell.PlaceSum = { cell.PlaceSum[0] + place[0], cell.PlaceSum[1] + place[1] };
    ++cell.Count;
  }
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(scores.cols(), scores.cols());
  for (const auto& [key, here] : cells)
  {
    Eigen::VectorXd alike = Eigen::VectorXd::Zero(scores.cols());
    for (const auto& [other, there] : cells)
    {
      alike += std::exp(-std::hypot(here.PlaceSum[0] / here.Count - there.PlaceSum[0] / there.Count,
                          here.PlaceSum[1] / here.Count - there.PlaceSum[1] / there.Count) /
                 alikeMm) *
        there.Score;
    }
    scatter += here.Score * alike.transpose();
  }
  return scatter;
}

WeightedEstimate::WeightedEstimate(const std::vector<ResidualGroup>& groups,
  const std::vector<double>& weights, const VarianceComponents& variances,
  const Eigen::MatrixXd& precision)
{
  Eigen::MatrixXd normal = precision;
  Eigen::MatrixXd scatter = precision;
  for (std::size_t group = 0; group < groups.size(); ++group)
  {
    const Eigen::MatrixXd squares = groups[group].Jacobian.transpose() * groups[group].Jacobian;
    normal += weights[group] * squares;
    scatter += weights[group] * weights[group] / variances.Weight(groups, group) * squares;
  }
  this->Inverse = normal.ldlt().solve(Eigen::MatrixXd::Identity(normal.rows(), normal.cols()));
  this->Covariance = this->Inverse * scatter * this->Inverse;
}
}
