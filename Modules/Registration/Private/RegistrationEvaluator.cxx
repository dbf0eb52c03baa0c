// SPDX-License-Identifier: Apache-2.0
#include "Private/RegistrationEvaluator.h"

#include "mammoray/Foundation/Error.h"

#include <Eigen/Dense>
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace mammoray
{
double TravelFrom(const CompressionState& state, const RegistrationModel& model,
  const std::vector<double>& values)
{
  const PlatePair plates = PlatesAt(model, PoseOf(values));
  return TravelMm(PlateMotion(SlidTowards(state.Plates, plates), plates));
}

ViewEvaluator::ViewEvaluator(EvaluatedView view, const ProgressCallback& progress)
  : View(std::move(view))
  , Compared(*this->View.Model, this->View.Target, this->View.Options)
  , Progress(progress)
  , StateIsAt(this->View.Values)
{
}

ViewEvaluator::Answer ViewEvaluator::Compress()
{
  if (this->View.Values == this->StateIsAt)
  {
    return Answer::Found;
  }
  const double travelMm = TravelFrom(this->View.State, *this->View.Model, this->View.Values);
  if (travelMm > this->LongestTravelMm)
  {
    return Answer::Refused; // costs nothing, and Ceres shortens its step or gives up
  }
  const auto begin = Clock::now();
  try
  {
    this->View.State = CompressAt(*this->View.Model, this->View.Values,
      travelMm > LongestWarmTravelMm ? nullptr : &this->View.State, this->Progress);
    this->StateIsAt = this->View.Values;
    ++this->Evaluations;
    this->MechanicsSeconds += SecondsSince(begin);
    this->LongestTravelMm = std::max(this->LongestTravelMm, 2 * travelMm);
    return Answer::Found;
  }
  catch (const Interrupted&)
  {
    return Answer::Stopped;
  }
  catch (const ConvergenceError&)
  {
    ++this->Evaluations;
    this->MechanicsSeconds += SecondsSince(begin);
    this->LongestTravelMm = travelMm > 0 ? 0.5 * travelMm : this->LongestTravelMm;
    return Answer::NoEquilibrium; // Ceres shortens its step
  }
}

void ViewEvaluator::Compare()
{
  const auto begin = Clock::now();
  this->Residuals = this->Compared.Evaluate(this->View.Values, this->View.State);
  this->ProjectionSeconds += SecondsSince(begin);
  ++this->Projections;
}

RegistrationResiduals::Jacobian ViewEvaluator::Differentiate(const std::vector<int>& wanted)
{
  const auto begin = Clock::now();
  RegistrationResiduals::Jacobian jacobian =
    this->Compared.Differentiate(this->View.Values, this->View.State, wanted);
  this->JacobianSeconds += SecondsSince(begin);
  return jacobian;
}

void ViewEvaluator::ReturnTo(const std::vector<double>& values, const CompressionState& state)
{
  this->View.State = state;
  this->StateIsAt = values;
}

std::vector<double> ViewEvaluator::Beside(const std::vector<double>& values) const
{
  const CompressionState state =
    CompressAt(*this->View.Model, values, &this->View.State, this->Progress);
  return this->Compared.Evaluate(values, state);
}

RegistrationEvaluator::RegistrationEvaluator(std::vector<EvaluatedView> views,
  std::vector<SearchUnknown> unknowns, const ProgressCallback& progress)
  : Unknowns(std::move(unknowns))
  , Selected(views.size())
  , Progress(progress)
{
  for (std::size_t unknown = 0; unknown < this->Unknowns.size(); ++unknown)
  {
    const SearchUnknown& free = this->Unknowns[unknown];
    this->Block.push_back(views[free.Views.front()].Values[free.Parameter] / free.Scale);
    for (const std::size_t view : free.Views)
    {
      this->Selected[view].Unknowns.push_back(unknown);
      this->Selected[view].Parameters.push_back(free.Parameter);
    }
  }
  for (EvaluatedView& view : views)
  {
    this->Views.push_back(std::make_unique<ViewEvaluator>(std::move(view), progress));
  }
  // The values as they come back from the block, so that the states are found to belong to them.
  for (std::size_t view = 0; view < this->Views.size(); ++view)
  {
    ViewEvaluator& evaluator = *this->Views[view];
    evaluator.View.Values = this->ValuesOf(view);
    evaluator.ReturnTo(evaluator.View.Values, evaluator.View.State);
    this->First.push_back(this->Robust.size());
    const std::size_t priors = evaluator.Compared.NumberOfPriors();
    this->Robust.insert(this->Robust.end(), evaluator.Compared.NumberOfResiduals() - priors, true);
    this->Robust.insert(this->Robust.end(), priors, false);
  }
}

std::vector<double> RegistrationEvaluator::ValuesOf(std::size_t view) const
{
  std::vector<double> values = this->Views[view]->View.Values;
  const Selection& selected = this->Selected[view];
  for (std::size_t index = 0; index < selected.Unknowns.size(); ++index)
  {
    const std::size_t unknown = selected.Unknowns[index];
    values[selected.Parameters[index]] = this->Block[unknown] * this->Unknowns[unknown].Scale;
  }
  return values;
}

void RegistrationEvaluator::PrepareForEvaluation(bool evaluateJacobians, bool /*newPoint*/)
{
  if (!this->Evaluated || this->Block != this->EvaluatedAt)
  {
    this->EvaluatedAt = this->Block;
    this->Evaluated = true;
    this->HasJacobian = false;
    this->Valid = this->EvaluateResiduals();
  }
  if (evaluateJacobians && this->Valid && !this->HasJacobian)
  {
    this->EvaluateJacobian();
  }
}

void RegistrationEvaluator::ReturnTo(const std::vector<CompressionState>& states)
{
  for (std::size_t view = 0; view < this->Views.size(); ++view)
  {
    this->Views[view]->ReturnTo(this->ValuesOf(view), states[view]);
  }
  this->Failures = 0;
}

std::vector<double> RegistrationEvaluator::Weights() const
{
  const double width = this->Views.front()->View.Options.RobustWidth;
  std::vector<double> weights(this->Residuals.size(), 1.0);
  for (std::size_t index = 0; index < weights.size(); ++index)
  {
    const double size = std::abs(this->Residuals[index]);
    if (this->Robust[index] && size > width)
    {
      weights[index] = width / size;
    }
  }
  return weights;
}

double RegistrationEvaluator::PredictedFall() const
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
  return 0.5 * gradient.dot(hessian.ldlt().solve(gradient));
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

bool RegistrationEvaluator::EvaluateResiduals()
{
  for (std::size_t view = 0; view < this->Views.size(); ++view)
  {
    this->Views[view]->View.Values = this->ValuesOf(view);
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
  std::vector<double> residuals;
  for (const std::unique_ptr<ViewEvaluator>& view : this->Views)
  {
    view->Compare();
    residuals.insert(residuals.end(), view->Residuals.begin(), view->Residuals.end());
  }
  this->Residuals = std::move(residuals);
  return true;
}

void RegistrationEvaluator::EvaluateJacobian()
{
  this->Jacobian.assign(this->Unknowns.size(), std::vector<double>(this->Robust.size(), 0.0));
  this->HasJacobian = true;
  if (this->Stopped)
  {
    return; // zeros; see Stop
  }
  if (this->Views.front()->View.Options.Derivatives == RegistrationDerivatives::CentralDifferences)
  {
    const auto begin = Clock::now();
    this->Valid = this->DifferentiateByDifferences();
    this->Views.front()->JacobianSeconds += SecondsSince(begin);
    return;
  }
  for (std::size_t view = 0; view < this->Views.size(); ++view)
  {
    const Selection& selected = this->Selected[view];
    const RegistrationResiduals::Jacobian jacobian =
      this->Views[view]->Differentiate(selected.Parameters);
    for (std::size_t index = 0; index < selected.Unknowns.size(); ++index)
    {
      const std::size_t unknown = selected.Unknowns[index];
      const double scale = this->Unknowns[unknown].Scale;
      const std::vector<double>& column = jacobian.Columns[selected.Parameters[index]];
      std::transform(column.begin(), column.end(),
        this->Jacobian[unknown].begin() + static_cast<std::ptrdiff_t>(this->First[view]),
        [scale](double entry) { return scale * entry; });
    }
  }
}

bool RegistrationEvaluator::operator()(const double* const* offsets, double* residuals) const
{
  std::copy(this->Residuals.begin(), this->Residuals.end(), residuals);
  for (std::size_t view = 0; view < this->Views.size(); ++view)
  {
    const Selection& selected = this->Selected[view];
    std::vector<double> beside = this->Views[view]->View.Values;
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
        const std::vector<double> found = this->Views[view]->Beside(beside);
        std::copy(found.begin(), found.end(), residuals + this->First[view]);
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
  steps.relative_step_size = this->Views.front()->View.Options.DifferenceStep;
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
  for (std::size_t view = 0; view < this->Views.size(); ++view)
  {
    const int solved = 2 * static_cast<int>(this->Selected[view].Unknowns.size());
    this->Views[view]->Evaluations += solved;
    this->Views[view]->Projections += solved;
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
