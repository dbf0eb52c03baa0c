// SPDX-License-Identifier: Apache-2.0
#include "Private/RegistrationEvaluator.h"

#include "mammoray/Foundation/Error.h"

#include <Eigen/Dense>
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace mammoray
{
RegistrationEvaluator::RegistrationEvaluator(std::vector<SearchedMammogram> mammograms,
  std::vector<SearchUnknown> unknowns, const ProgressCallback& progress)
  : Unknowns(std::move(unknowns))
  , Selected(mammograms.size())
  , Progress(progress)
{
  for (std::size_t unknown = 0; unknown < this->Unknowns.size(); ++unknown)
  {
    const SearchUnknown& free = this->Unknowns[unknown];
    this->Block.push_back(mammograms[free.Mammograms.front()].Values[free.Parameter] / free.Scale);
    for (const std::size_t mammogram : free.Mammograms)
    {
      this->Selected[mammogram].Unknowns.push_back(unknown);
      this->Selected[mammogram].Parameters.push_back(free.Parameter);
    }
  }
  for (SearchedMammogram& mammogram : mammograms)
  {
    this->Mammograms.push_back(
      std::make_unique<MammogramEvaluator>(std::move(mammogram), progress));
  }
  // The values as they come back from the block, so that the states are found to belong to them.
  for (std::size_t mammogram = 0; mammogram < this->Mammograms.size(); ++mammogram)
  {
    MammogramEvaluator& evaluator = *this->Mammograms[mammogram];
    evaluator.Mammogram.Values = this->ValuesAt(mammogram);
    evaluator.ReturnTo(evaluator.Mammogram.Values, evaluator.Mammogram.Here);
    this->First.push_back(this->RobustWidths.size());
    const std::vector<double> widths = evaluator.Compared.RobustWidths();
    this->RobustWidths.insert(this->RobustWidths.end(), widths.begin(), widths.end());
  }
}

std::vector<double> RegistrationEvaluator::ValuesAt(std::size_t mammogram) const
{
  std::vector<double> values = this->Mammograms[mammogram]->Mammogram.Values;
  const Selection& selected = this->Selected[mammogram];
  for (std::size_t index = 0; index < selected.Unknowns.size(); ++index)
  {
    const std::size_t unknown = selected.Unknowns[index];
    values[selected.Parameters[index]] = this->Block[unknown] * this->Unknowns[unknown].Scale;
  }
  return values;
}

void RegistrationEvaluator::PrepareForEvaluation(bool evaluateJacobians, bool /*newPoint*/)
{
  if (!this->IsEvaluated || this->Block != this->EvaluatedAt)
  {
    this->EvaluatedAt = this->Block;
    this->IsEvaluated = true;
    this->HasJacobian = false;
    this->Valid = this->Evaluate(evaluateJacobians);
  }
  if (evaluateJacobians && this->Valid && !this->HasJacobian)
  {
    this->EvaluateJacobian();
  }
}

void RegistrationEvaluator::ReturnTo(const std::vector<std::shared_ptr<EvaluatedState>>& states)
{
  for (std::size_t mammogram = 0; mammogram < this->Mammograms.size(); ++mammogram)
  {
    this->Mammograms[mammogram]->ReturnTo(this->ValuesAt(mammogram), states[mammogram]);
  }
  this->Failures = 0;
}

std::vector<double> RegistrationEvaluator::Weights() const
{
  std::vector<double> weights(this->Residuals.size(), 1.0);
  for (std::size_t index = 0; index < weights.size(); ++index)
  {
    const double size = std::abs(this->Residuals[index]);
    if (size > this->RobustWidths[index])
    {
      weights[index] = this->RobustWidths[index] / size;
    }
  }
  return weights;
}

void RegistrationEvaluator::Weigh(const std::vector<std::vector<double>>& factors)
{
  std::vector<double> changes;
  for (std::size_t mammogram = 0; mammogram < this->Mammograms.size(); ++mammogram)
  {
    const std::vector<double> own = this->Mammograms[mammogram]->Weigh(factors[mammogram]);
    changes.insert(changes.end(), own.begin(), own.end());
  }
  const auto multiply = [&changes](std::vector<double>& values)
  {
    std::transform(values.begin(), values.end(), changes.begin(), values.begin(),
      std::multiplies<>());
  };
  multiply(this->Residuals);
  std::for_each(this->Jacobian.begin(), this->Jacobian.end(), multiply);
}

RegistrationEvaluator::Bottom RegistrationEvaluator::PredictedBottom() const
{
  const auto count = static_cast<Eigen::Index>(this->Unknowns.size());
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(count);
  const std::vector<double> weights = this->Weights();
  Eigen::VectorXd row(count);
  for (std::size_t index = 0; index < this->Residuals.size(); ++index)
  {
    for (Eigen::Index u = 0; u < count; ++u)
    {
      row[u] = this->Jacobian[static_cast<std::size_t>(u)][index];
    }
    hessian += weights[index] * row * row.transpose();
    gradient += weights[index] * this->Residuals[index] * row;
  }
  for (Eigen::Index u = 0; u < count; ++u)
  {
    if (this->IsStoppedByBound(static_cast<std::size_t>(u), gradient[u]))
    {
      gradient[u] = 0;
      hessian.row(u).setZero();
      hessian.col(u).setZero();
      hessian(u, u) = 1;
    }
  }
  Bottom bottom;
  bottom.Step = -hessian.ldlt().solve(gradient);
  bottom.Fall = -0.5 * gradient.dot(bottom.Step);
  return bottom;
}

bool RegistrationEvaluator::IsExact() const
{
  return this->Mammograms.front()->Mammogram.Options.Derivatives == RegistrationDerivatives::Exact;
}

bool RegistrationEvaluator::IsStoppedByBound(std::size_t unknown, double slope) const
{
  const SearchUnknown& free = this->Unknowns[unknown];
  const double value = this->Block[unknown] * free.Scale;
  const double near = 1e-6 * free.Scale;
  return (slope > 0 && value < free.Lower + near) || (slope < 0 && value > free.Upper - near);
}

/// The answer to Ceres: with stale residuals it must not take the stop for a failure; the recorder
/// ends the search.
bool RegistrationEvaluator::Stop()
{
  this->Stopped = true;
  return !this->Residuals.empty();
}

bool RegistrationEvaluator::Evaluate(bool withJacobian)
{
  for (std::size_t mammogram = 0; mammogram < this->Mammograms.size(); ++mammogram)
  {
    this->Mammograms[mammogram]->Mammogram.Values = this->ValuesAt(mammogram);
  }
  for (const std::unique_ptr<MammogramEvaluator>& mammogram : this->Mammograms)
  {
    if (this->Failures >= LargestNumberOfFailures)
    {
      return false;
    }
    switch (mammogram->Compress())
    {
      case MammogramEvaluator::Answer::Found:
        break;
      case MammogramEvaluator::Answer::NoEquilibrium:
        ++this->Failures;
        return false;
      case MammogramEvaluator::Answer::Refused:
        return false;
      case MammogramEvaluator::Answer::Stopped:
        return this->Stop();
    }
  }
  if (this->Stopped || (this->Progress && !this->Progress(0, "project")))
  {
    return this->Stop();
  }
  if (withJacobian && this->IsExact())
  {
    this->EvaluateJacobian(); // its pass gives the pictures, too
  }
  std::vector<double> residuals;
  for (const std::unique_ptr<MammogramEvaluator>& mammogram : this->Mammograms)
  {
    mammogram->Compare();
    residuals.insert(residuals.end(), mammogram->Residuals.begin(), mammogram->Residuals.end());
  }
  this->Residuals = std::move(residuals);
  return true;
}

void RegistrationEvaluator::EvaluateJacobian()
{
  this->Jacobian.assign(this->Unknowns.size(), std::vector<double>(this->RobustWidths.size(), 0.0));
  this->HasJacobian = true;
  if (this->Stopped)
  {
    return; // zeros; see Stop
  }
  for (const std::unique_ptr<MammogramEvaluator>& mammogram : this->Mammograms)
  {
    mammogram->Accept(); // Ceres asks for the Jacobian where it takes a step
  }
  if (!this->IsExact())
  {
    const auto begin = Clock::now();
    this->Valid = this->DifferentiateByDifferences();
    this->Mammograms.front()->JacobianSeconds += SecondsSince(begin);
    return;
  }
  for (std::size_t mammogram = 0; mammogram < this->Mammograms.size(); ++mammogram)
  {
    const Selection& selected = this->Selected[mammogram];
    const RegistrationResiduals::Jacobian jacobian =
      this->Mammograms[mammogram]->Differentiate(selected.Parameters);
    for (std::size_t index = 0; index < selected.Unknowns.size(); ++index)
    {
      const std::size_t unknown = selected.Unknowns[index];
      const double scale = this->Unknowns[unknown].Scale;
      const std::vector<double>& column = jacobian.Columns[selected.Parameters[index]];
      std::transform(column.begin(), column.end(),
        this->Jacobian[unknown].begin() + static_cast<std::ptrdiff_t>(this->First[mammogram]),
        [scale](double entry) { return scale * entry; });
    }
  }
}

bool RegistrationEvaluator::operator()(const double* const* offsets, double* residuals) const
{
  std::copy(this->Residuals.begin(), this->Residuals.end(), residuals);
  for (std::size_t mammogram = 0; mammogram < this->Mammograms.size(); ++mammogram)
  {
    const Selection& selected = this->Selected[mammogram];
    std::vector<double> beside = this->Mammograms[mammogram]->Mammogram.Values;
    bool moved = false;
    for (std::size_t index = 0; index < selected.Unknowns.size(); ++index)
    {
      const std::size_t unknown = selected.Unknowns[index];
      moved = moved || offsets[0][unknown] != 1;
      beside[selected.Parameters[index]] +=
        (offsets[0][unknown] - 1) * this->Unknowns[unknown].Scale;
    }
    if (moved)
    {
      try
      {
        const std::vector<double> found = this->Mammograms[mammogram]->Beside(beside);
        std::copy(found.begin(), found.end(), residuals + this->First[mammogram]);
      }
      catch (const ConvergenceError&)
      {
        return false;
      }
    }
  }
  return true;
}

/// False where a point beside this one has no equilibrium.
bool RegistrationEvaluator::DifferentiateByDifferences()
{
  ceres::NumericDiffOptions steps;
  steps.relative_step_size = this->Mammograms.front()->Mammogram.Options.DifferenceStep;
  ceres::DynamicNumericDiffCostFunction<RegistrationEvaluator, ceres::CENTRAL> differences(this,
    ceres::DO_NOT_TAKE_OWNERSHIP, steps);
  const std::size_t unknowns = this->Unknowns.size();
  const std::size_t count = this->Residuals.size();
  differences.AddParameterBlock(static_cast<int>(unknowns));
  differences.SetNumResiduals(static_cast<int>(count));
  const std::vector<double> here(unknowns, 1.0);
  const double* const block = here.data();
  std::vector<double> residuals(count);
  std::vector<double> matrix(count * unknowns);
  double* rows = matrix.data();
  try
  {
    if (!differences.Evaluate(&block, residuals.data(), &rows))
    {
      return false;
    }
  }
  catch (const Interrupted&)
  {
    return this->Stop();
  }
  for (std::size_t mammogram = 0; mammogram < this->Mammograms.size(); ++mammogram)
  {
    const int solved = 2 * static_cast<int>(this->Selected[mammogram].Unknowns.size());
    this->Mammograms[mammogram]->Evaluations += solved;
    this->Mammograms[mammogram]->Projections += solved;
  }
  for (std::size_t index = 0; index < count; ++index)
  {
    for (std::size_t u = 0; u < unknowns; ++u)
    {
      this->Jacobian[u][index] = matrix[index * unknowns + u];
    }
  }
  return true;
}
}
