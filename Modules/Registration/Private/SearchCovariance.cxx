// SPDX-License-Identifier: Apache-2.0
#include "Private/SearchCovariance.h"

#include <Eigen/Dense>
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace mammoray
{
namespace
{
bool IsOf(const SearchUnknown& parameter, std::size_t mammogram)
{
  return std::find(parameter.Mammograms.begin(), parameter.Mammograms.end(), mammogram) !=
    parameter.Mammograms.end();
}

/// Parameters that are held, but not known: those with a prior, a shared one once.
std::vector<SearchUnknown> Considered(const JointSearch& search)
{
  std::vector<SearchUnknown> considered;
  for (std::size_t mammogram = 0; mammogram < search.Mammograms.size(); ++mammogram)
  {
    for (int index = 0; index < ParameterCount; ++index)
    {
      const RegistrationParameter& parameter =
        search.Mammograms[mammogram].Result.Parameters[index];
      if (parameter.Fixed && parameter.PriorSigma > 0 && (mammogram == 0 || !IsShared(index)))
      {
        considered.push_back(
          { index, search.MammogramsOf(index, mammogram), 0, 0, parameter.PriorSigma });
      }
    }
  }
  return considered;
}

/// d residuals / d parameters in units of their scales, at the evaluator's point.
Eigen::MatrixXd ColumnsOf(RegistrationEvaluator& evaluator,
  const std::vector<SearchUnknown>& parameters)
{
  Eigen::MatrixXd columns =
    Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(evaluator.Residuals.size()),
      static_cast<Eigen::Index>(parameters.size()));
  std::size_t first = 0;
  for (std::size_t mammogram = 0; mammogram < evaluator.Mammograms.size(); ++mammogram)
  {
    std::vector<int> wanted;
    std::vector<Eigen::Index> places;
    for (std::size_t index = 0; index < parameters.size(); ++index)
    {
      const std::vector<std::size_t>& mammograms = parameters[index].Mammograms;
      if (std::find(mammograms.begin(), mammograms.end(), mammogram) != mammograms.end())
      {
        wanted.push_back(parameters[index].Parameter);
        places.push_back(static_cast<Eigen::Index>(index));
      }
    }
    const RegistrationResiduals::Jacobian jacobian =
      evaluator.Mammograms[mammogram]->Differentiate(wanted);
    for (std::size_t index = 0; index < wanted.size(); ++index)
    {
      const std::vector<double>& column = jacobian.Columns[wanted[index]];
      columns.col(places[index])
        .segment(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(column.size())) =
        parameters[static_cast<std::size_t>(places[index])].Scale *
        Eigen::Map<const Eigen::VectorXd>(column.data(), static_cast<Eigen::Index>(column.size()));
    }
    first += evaluator.Mammograms[mammogram]->Residuals.size();
  }
  return columns;
}

/// The covariance of the unknowns and of what is considered, in units of their scales and priors:
/// an error c of the latter moves the minimum by S c, S = -(J^T W J)^-1 J^T W J_c (consider
/// covariance, Schmidt 1966; Tapley, Schutz and Born 2004, section 6.2).
Eigen::MatrixXd ConsiderCovariance(RegistrationEvaluator& evaluator,
  const std::vector<SearchUnknown>& considered, const std::vector<double>& ofUnknowns)
{
  const std::vector<SearchUnknown>& unknowns = evaluator.Unknowns;
  const auto count = static_cast<Eigen::Index>(unknowns.size());
  const auto held = static_cast<Eigen::Index>(considered.size());
  const std::vector<double> weights = evaluator.Weights();
  Eigen::MatrixXd jacobian(static_cast<Eigen::Index>(weights.size()), count);
  for (Eigen::Index u = 0; u < count; ++u)
  {
    jacobian.col(u) = Eigen::Map<const Eigen::VectorXd>(
      evaluator.Jacobian[static_cast<std::size_t>(u)].data(), jacobian.rows());
  }
  const Eigen::MatrixXd weighted = jacobian.transpose() *
    Eigen::Map<const Eigen::VectorXd>(weights.data(), jacobian.rows()).asDiagonal();
  const Eigen::MatrixXd shift =
    -(weighted * jacobian).ldlt().solve(weighted * ColumnsOf(evaluator, considered));
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(count + held, count + held);
  for (Eigen::Index i = 0; i < count; ++i)
  {
    for (Eigen::Index j = 0; j < count; ++j)
    {
      covariance(i, j) = ofUnknowns[static_cast<std::size_t>(i * count + j)] /
        (unknowns[static_cast<std::size_t>(i)].Scale * unknowns[static_cast<std::size_t>(j)].Scale);
    }
  }
  covariance.topLeftCorner(count, count) += shift * shift.transpose();
  covariance.topRightCorner(count, held) = shift;
  covariance.bottomLeftCorner(held, count) = shift.transpose();
  return covariance;
}

/// Needs the covariance of the unknowns.
void KeepConsidered(RegistrationEvaluator& evaluator, JointSearch& search)
{
  const std::vector<SearchUnknown> considered = Considered(search);
  const Eigen::MatrixXd covariance = ConsiderCovariance(evaluator, considered, search.Covariance);
  std::vector<SearchUnknown> all = evaluator.Unknowns;
  all.insert(all.end(), considered.begin(), considered.end());
  for (std::size_t mammogram = 0; mammogram < search.Mammograms.size(); ++mammogram)
  {
    std::vector<double>& kept = search.Mammograms[mammogram].Result.ConsideredCovariance;
    kept.assign(std::size_t{ ParameterCount } * ParameterCount, 0.0);
    for (std::size_t i = 0; i < all.size(); ++i)
    {
      for (std::size_t j = 0; IsOf(all[i], mammogram) && j < all.size(); ++j)
      {
        if (IsOf(all[j], mammogram))
        {
          kept[all[i].Parameter * ParameterCount + all[j].Parameter] = all[i].Scale * all[j].Scale *
            covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
        }
      }
    }
  }
}

/// The parts of the unknowns' covariance that belong to each mammogram.
void KeepParts(const std::vector<SearchUnknown>& unknowns, JointSearch& search)
{
  const std::size_t n = unknowns.size();
  for (std::size_t mammogram = 0; mammogram < search.Mammograms.size(); ++mammogram)
  {
    RegistrationResult& result = search.Mammograms[mammogram].Result;
    result.Covariance.assign(std::size_t{ ParameterCount } * ParameterCount, 0.0);
    for (std::size_t i = 0; i < n; ++i)
    {
      if (!IsOf(unknowns[i], mammogram))
      {
        continue;
      }
      for (std::size_t j = 0; j < n; ++j)
      {
        if (IsOf(unknowns[j], mammogram))
        {
          result.Covariance[unknowns[i].Parameter * ParameterCount + unknowns[j].Parameter] =
            search.Covariance[i * n + j];
        }
      }
      result.StandardDeviations[unknowns[i].Parameter] = std::sqrt(search.Covariance[i * (n + 1)]);
    }
  }
}
}

void KeepCovariance(ceres::Problem& problem, RegistrationEvaluator& evaluator, JointSearch& search)
{
  evaluator.ReturnTo(search.States());
  ceres::Covariance covariance{ ceres::Covariance::Options() };
  const std::vector<const double*> blocks{ evaluator.Block.data() };
  if (!covariance.Compute(blocks, &problem))
  {
    return;
  }
  const std::vector<SearchUnknown>& unknowns = evaluator.Unknowns;
  const std::size_t n = unknowns.size();
  search.Covariance.resize(n * n);
  covariance.GetCovarianceBlock(evaluator.Block.data(), evaluator.Block.data(),
    search.Covariance.data());
  for (std::size_t i = 0; i < n; ++i)
  {
    for (std::size_t j = 0; j < n; ++j)
    {
      search.Covariance[i * n + j] *= unknowns[i].Scale * unknowns[j].Scale;
    }
  }
  KeepParts(unknowns, search);
  KeepConsidered(evaluator, search);
}
}
