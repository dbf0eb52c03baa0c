// SPDX-License-Identifier: Apache-2.0
#include "Private/NewtonSolver.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

namespace mammoray
{
namespace
{
/// Largest coordinate of a Newton step that is accepted without trying a stiffer matrix, mm: about
/// half a cell.
constexpr double LargestStepMm = 5;
constexpr int MostHalvings = 30;
/// Fraction of the predicted decrease of the energy that a step must achieve (Armijo).
constexpr double SufficientDecrease = 1e-4;
/// Relative residual and number of Newton steps for a part that is relaxed alone.
constexpr double PartTolerance = 1e-2;
constexpr int PartNewtonSteps = 10;

double LargestMagnitude(const std::vector<double>& v)
{
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()))
    .lpNorm<Eigen::Infinity>();
}
}

NewtonSolver::NewtonSolver(Objective& objective)
  : Function(objective)
  , Cache(objective.Pattern())
{
}

const Evaluation& NewtonSolver::EvaluateAt(const std::vector<double>& x)
{
  if (!this->Current.Valid || this->CurrentVersion != this->Function.Version() ||
    this->CurrentPositions != x)
  {
    this->Function.Evaluate(x, EnergyOrder::Hessian, this->Current);
    this->CurrentPositions = x;
    this->CurrentVersion = this->Function.Version();
  }
  return this->Current;
}

bool NewtonSolver::FactorizeAt(const std::vector<double>& x, bool stiffer)
{
  const Evaluation& current = this->EvaluateAt(x);
  const auto projected = [&]
  {
    Evaluation evaluation;
    this->Function.Evaluate(x, EnergyOrder::ProjectedHessian, evaluation);
    return std::move(evaluation.Hessian);
  };
  return current.Valid && this->Cache.FactorizeMixed(current.Hessian, x, projected, stiffer);
}

std::optional<double> NewtonSolver::FindStep(const std::vector<double>& x,
  std::vector<double>& step)
{
  const std::vector<std::int32_t>& coordinates = this->Function.Coordinates();
  std::vector<double> force(coordinates.size());
  for (std::size_t u = 0; u < force.size(); ++u)
  {
    force[u] = -this->Current.Gradient[coordinates[u]];
  }
  if (this->Cache.SolveNearby(this->Current.Hessian, x, force, step) &&
    LargestMagnitude(step) <= LargestStepMm)
  {
    return 0.0;
  }
  // A huge step comes from a nearly singular matrix. A stiffer matrix leads farther than a small
  // fraction of that step.
  for (bool stiffer = false;; stiffer = true)
  {
    if (!this->FactorizeAt(x, stiffer))
    {
      return std::nullopt;
    }
    if (!this->Cache.SolveOwn(this->Current.Hessian, force, 1, step))
    {
      step = force;
      this->Cache.Solve(step);
    }
    if (this->Cache.Share() == 1 || LargestMagnitude(step) <= LargestStepMm)
    {
      return this->Cache.Share();
    }
  }
}

bool NewtonSolver::SearchAlong(const std::vector<double>& step, std::vector<double>& x,
  double& length)
{
  const std::vector<std::int32_t>& coordinates = this->Function.Coordinates();
  double slope = 0;
  for (std::size_t u = 0; u < step.size(); ++u)
  {
    slope += step[u] * this->Current.Gradient[coordinates[u]];
  }
  const double noise = std::max(this->Function.Noise(), 1e-13 * std::abs(this->Current.Energy));
  for (int halving = 0; halving < MostHalvings; ++halving)
  {
    length = std::ldexp(1.0, -halving);
    this->Trial = x;
    for (std::size_t u = 0; u < step.size(); ++u)
    {
      this->Trial[coordinates[u]] += length * step[u];
    }
    this->Function.Evaluate(this->Trial, EnergyOrder::Value, this->Probe);
    if (this->Probe.Valid &&
      this->Probe.Energy <= this->Current.Energy + SufficientDecrease * length * slope + noise)
    {
      x.swap(this->Trial);
      return true;
    }
  }
  return false;
}

void NewtonSolver::RelaxWorstPart(std::vector<double>& x, const ProgressCallback& progress)
{
  if (const std::unique_ptr<Objective> part = this->Function.WorstPart(this->Current.Gradient))
  {
    NewtonSolver(*part).Minimize(x, PartTolerance, PartNewtonSteps, progress, Parts::Together);
  }
}

NewtonResult NewtonSolver::Minimize(std::vector<double>& x, double tolerance, int maximumSteps,
  const ProgressCallback& progress, Parts parts)
{
  NewtonResult result;
  if (!this->EvaluateAt(x).Valid)
  {
    result.Reason = "a cell is inverted at the start";
    return result;
  }
  std::vector<double> step;
  for (;; ++result.Steps)
  {
    const double residual = this->EvaluateAt(x).RelativeResidual();
    if (residual <= tolerance)
    {
      result.Converged = true;
      return result;
    }
    if (result.Steps == maximumSteps)
    {
      char reason[128];
      std::snprintf(reason, sizeof reason,
        "relative residual %.2g after %d Newton steps, expected at most %.2g", residual,
        result.Steps, tolerance);
      result.Reason = reason;
      return result;
    }
    ReportProgress(progress, 0, "equilibrium");
    const std::optional<double> share = this->FindStep(x, step);
    if (!share)
    {
      result.Reason = "the stiffness matrix is singular";
      return result;
    }
    double length = 1;
    if (!this->SearchAlong(step, x, length))
    {
      result.Reason = "no step lowers the energy";
      return result;
    }
    const bool struggles = *share > 0 || length < 1;
    if (parts == Parts::Relaxed && struggles && this->EvaluateAt(x).RelativeResidual() > tolerance)
    {
      this->RelaxWorstPart(x, progress);
    }
  }
}
}
