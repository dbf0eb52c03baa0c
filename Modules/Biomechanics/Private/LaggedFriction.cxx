// SPDX-License-Identifier: Apache-2.0
#include "Private/LaggedFriction.h"

#include <algorithm>
#include <cstdio>
#include <limits>

namespace mammoray
{
namespace
{
/// Largest relative residual with updated normal forces at the end and on the way, and the largest
/// number of updates. Friction is known to a few per cent at best.
constexpr double FrictionTolerance = 1e-4;
constexpr double IntermediateFrictionTolerance = 5e-2;
constexpr int MostFrictionUpdates = 60;
/// If the residual does not fall below this fraction of the last one, updates are damped, down to
/// the second value.
constexpr double StalledFriction = 0.95;
constexpr double SmallestFrictionPart = 1.0 / 16;
}

LaggedFriction::LaggedFriction(EquilibriumSolver& solver, const ElasticBody& body,
  double coefficient, const std::vector<double>& x, const PlatePair& plates,
  const FrictionPoints* points)
  : Solver(solver)
  , Body(body)
  , Coefficient(coefficient)
  , Previous{ {}, x, plates }
{
  if (points)
  {
    this->Previous.Dragged = DraggedTo(body, x, plates, *points);
  }
}

std::vector<double> LaggedFriction::Begin(const std::vector<double>& x, const PlatePair& plates,
  const LoadStep& step)
{
  this->Solver.Energy().SetContactStiffness(step.ContactStiffness);
  this->Previous.Positions = x;
  this->Previous.Plates = plates;
  this->Solver.Energy().SetFriction(this->Coefficient > 0
      ? this->Solver.FrictionAt(x, plates, this->Coefficient, this->Previous)
      : FrictionPoints());
  const std::vector<double> way =
    this->Solver.TangentStep(x, plates, PlateMotion(plates, step.Plates));
  std::vector<double> guess = x;
  for (std::size_t c = 0; c < guess.size(); ++c)
  {
    guess[c] += way[c];
  }
  return this->Solver.Admissible(guess) ? guess : x;
}

EquilibriumReport LaggedFriction::Solve(std::vector<double>& x, const std::vector<double>& last,
  const PlatePair& lastPlates, const LoadStep& step, const ProgressCallback& progress)
{
  const auto solveFrozen = [&] {
    return this->Solver.Solve(x, &step.Plates, step.Tolerance, step.MaximumNewtonSteps, progress);
  };
  this->Solver.Energy().SetContactStiffness(step.ContactStiffness);
  if (this->Coefficient == 0)
  {
    return solveFrozen();
  }
  this->Solver.Energy().SetFriction(
    this->Solver.FrictionAt(last, lastPlates, this->Coefficient, this->Previous));
  const double wanted = step.Tolerance < LoadStep::IntermediateTolerance
    ? FrictionTolerance
    : IntermediateFrictionTolerance;
  int newtonSteps = 0;
  double part = 0.5;
  double residualBefore = std::numeric_limits<double>::infinity();
  for (int update = 0;; ++update)
  {
    EquilibriumReport report = solveFrozen();
    newtonSteps += report.NewtonSteps;
    report.NewtonSteps = newtonSteps;
    if (!report.Converged)
    {
      return report;
    }
    FrictionPoints used = this->Solver.Energy().Friction().Points();
    const FrictionPoints found =
      this->Solver.FrictionAt(x, step.Plates, this->Coefficient, this->Previous);
    this->Solver.Energy().SetFriction(found);
    const double residual = this->Solver.Evaluate(x, &step.Plates).RelativeResidual;
    if (residual <= wanted)
    {
      this->Solver.Energy().SetFriction(std::move(used));
      return report;
    }
    if (update == MostFrictionUpdates)
    {
      char reason[128];
      std::snprintf(reason, sizeof reason,
        "relative residual %.2g after %d updates of friction, expected at most %.2g", residual,
        update, wanted);
      report.Converged = false;
      report.Reason = reason;
      return report;
    }
    // A full update overshoots: growing friction reduces its own contact force.
    part = residual > StalledFriction * residualBefore ? std::max(0.5 * part, SmallestFrictionPart)
                                                       : part;
    residualBefore = residual;
    this->Solver.Energy().SetFriction(BlendedFriction(std::move(used), found, part));
  }
}

void LaggedFriction::Arrived(const std::vector<double>& x, const PlatePair& plates)
{
  this->Previous.Dragged =
    DraggedTo(this->Body, x, plates, this->Solver.Energy().Friction().Points());
}

int LaggedFriction::Untangle(std::vector<double>& x, const LoadStep& step,
  const ProgressCallback& progress)
{
  this->Solver.Energy().SetContactStiffness(step.ContactStiffness);
  return this->Solver.Admissible(x)
    ? 0
    : this->Solver.Untangle(x, &step.Plates, step.Tolerance, step.MaximumNewtonSteps, progress)
        .NewtonSteps;
}
}
