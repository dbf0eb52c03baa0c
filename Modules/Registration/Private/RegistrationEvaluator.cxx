// SPDX-License-Identifier: Apache-2.0
#include "Private/RegistrationEvaluator.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace mammoray
{
RegistrationEvaluator::RegistrationEvaluator(std::vector<std::unique_ptr<ViewEvaluator>> views,
  std::vector<FreeParameter> free, const ProgressCallback& progress)
  : FreeParameters(std::move(free))
  , Views(std::move(views))
  , First{ 0 }
  , Selected(this->Views.size())
  , Progress(progress)
{
  for (std::size_t number = 0; number < this->FreeParameters.size(); ++number)
  {
    const FreeParameter& parameter = this->FreeParameters[number];
    this->Block.push_back(
      this->Views[parameter.Views.front()]->Values[parameter.Parameter] / parameter.Scale);
    for (const std::size_t view : parameter.Views)
    {
      this->Selected[view].Numbers.push_back(number);
      this->Selected[view].Parameters.push_back(parameter.Parameter);
    }
  }
  // The values as they come back from the block, so that the states are found to belong to them.
  for (std::size_t view = 0; view < this->Views.size(); ++view)
  {
    ViewEvaluator& evaluator = *this->Views[view];
    evaluator.Values = this->ValuesAt(view);
    evaluator.ReturnTo(evaluator.Values, evaluator.Current);
    const std::vector<double> widths = evaluator.Compared.RobustWidths();
    this->RobustWidths.insert(this->RobustWidths.end(), widths.begin(), widths.end());
    this->First.push_back(this->RobustWidths.size());
  }
}

std::span<const double> RegistrationEvaluator::ResidualsOf(std::size_t view) const
{
  return std::span(this->Residuals).subspan(this->First[view], this->NumberOfResiduals(view));
}

std::vector<double> RegistrationEvaluator::ValuesAt(std::size_t view) const
{
  std::vector<double> values = this->Views[view]->Values;
  const Selection& selected = this->Selected[view];
  for (std::size_t index = 0; index < selected.Numbers.size(); ++index)
  {
    const std::size_t unknown = selected.Numbers[index];
    values[selected.Parameters[index]] = this->Block[unknown] * this->FreeParameters[unknown].Scale;
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

void RegistrationEvaluator::ReturnTo(const std::vector<std::shared_ptr<PosedBreast>>& states)
{
  for (std::size_t view = 0; view < this->Views.size(); ++view)
  {
    this->Views[view]->ReturnTo(this->ValuesAt(view), states[view]);
  }
  this->Failures = 0;
}

double RegistrationEvaluator::Weight(std::size_t residual) const
{
  const double size = std::abs(this->Residuals[residual]);
  const double width = this->RobustWidths[residual];
  return size > width ? width / size : 1.0;
}

void RegistrationEvaluator::Weigh(const std::vector<std::vector<double>>& factors)
{
  std::vector<double> changes;
  for (std::size_t view = 0; view < this->Views.size(); ++view)
  {
    const std::vector<double> own = this->Views[view]->Compared.Weigh(factors[view]);
    changes.insert(changes.end(), own.begin(), own.end());
  }
  std::transform(this->Residuals.begin(), this->Residuals.end(), changes.begin(),
    this->Residuals.begin(), std::multiplies<>());
  const Eigen::Map<const Eigen::ArrayXd> factor(changes.data(), this->Jacobian.rows());
  this->Jacobian.array().colwise() *= factor;
}

RegistrationEvaluator::Bottom RegistrationEvaluator::PredictedBottom() const
{
  const auto count = static_cast<Eigen::Index>(this->FreeParameters.size());
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(count);
  Eigen::VectorXd row(count);
  for (std::size_t index = 0; index < this->Residuals.size(); ++index)
  {
    row = this->Jacobian.row(static_cast<Eigen::Index>(index)).transpose();
    const double weight = this->Weight(index);
    hessian += weight * row * row.transpose();
    gradient += weight * this->Residuals[index] * row;
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

bool RegistrationEvaluator::IsStoppedByBound(std::size_t unknown, double slope) const
{
  const FreeParameter& free = this->FreeParameters[unknown];
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
  for (std::size_t view = 0; view < this->Views.size(); ++view)
  {
    this->Views[view]->Values = this->ValuesAt(view);
  }
  for (const std::unique_ptr<ViewEvaluator>& view : this->Views)
  {
    if (this->Failures >= LargestNumberOfFailures)
    {
      return false;
    }
    switch (view->Compress())
    {
      case ViewEvaluator::Answer::Found:
        break;
      case ViewEvaluator::Answer::NoEquilibrium:
        ++this->Failures;
        return false;
      case ViewEvaluator::Answer::Refused:
        return false;
      case ViewEvaluator::Answer::Stopped:
        return this->Stop();
    }
  }
  if (this->Stopped || (this->Progress && !this->Progress(0, "project")))
  {
    return this->Stop();
  }
  if (withJacobian)
  {
    this->EvaluateJacobian(); // its pass gives the pictures, too
  }
  std::vector<double> residuals;
  residuals.reserve(this->RobustWidths.size());
  for (const std::unique_ptr<ViewEvaluator>& view : this->Views)
  {
    view->AppendResiduals(residuals);
  }
  this->Residuals = std::move(residuals);
  return true;
}

void RegistrationEvaluator::EvaluateJacobian()
{
  this->Jacobian.setZero(static_cast<Eigen::Index>(this->RobustWidths.size()),
    static_cast<Eigen::Index>(this->FreeParameters.size()));
  this->HasJacobian = true;
  if (this->Stopped)
  {
    return; // zeros; see Stop
  }
  for (const std::unique_ptr<ViewEvaluator>& view : this->Views)
  {
    view->Accept(); // Ceres asks for the Jacobian where it takes a step
  }
  for (std::size_t view = 0; view < this->Views.size(); ++view)
  {
    const Selection& selected = this->Selected[view];
    const RegistrationResiduals::Jacobian jacobian =
      this->Views[view]->Differentiate(selected.Parameters);
    for (std::size_t index = 0; index < selected.Numbers.size(); ++index)
    {
      const std::size_t unknown = selected.Numbers[index];
      const std::vector<double>& column = jacobian.Columns[selected.Parameters[index]];
      const auto rows = static_cast<Eigen::Index>(column.size());
      this->Jacobian.col(static_cast<Eigen::Index>(unknown))
        .segment(static_cast<Eigen::Index>(this->First[view]), rows) =
        this->FreeParameters[unknown].Scale *
        Eigen::Map<const Eigen::VectorXd>(column.data(), rows);
    }
  }
}
}
