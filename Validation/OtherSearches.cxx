// SPDX-License-Identifier: Apache-2.0
#include "OtherSearches.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Registration/Private/RegistrationResiduals.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <utility>

namespace mammoray
{
namespace
{
using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point begin)
{
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// A pose, its equilibrium and its residuals.
struct Place
{
  std::vector<double> Values;
  std::shared_ptr<PosedBreast> Breast;
  std::vector<double> Residuals;
  double Cost = 0;
};

/// Solves and compares, and keeps the best place and the counts.
class Walk
{
public:
  Walk(const RegistrationProblem& problem, const ProgressCallback& progress)
    : Options(problem.Options)
    , Searched(problem.Views.front())
    , Compared(this->Searched.Levels.back(), this->Searched.Parameters, problem.Options)
    , Progress(progress)
    , Model(*problem.Model)
    , Placement(problem.PlacementOf(this->Searched))
  {
    this->Result.Parameters = this->Searched.Parameters;
    this->Result.StandardDeviations.assign(ParameterCount,
      std::numeric_limits<double>::quiet_NaN());
    this->Result.HeaderThicknessMm = this->Searched.Target.HeaderThicknessMm;
    this->Result.Disagreements = this->Searched.Target.Disagreements;
  }

  Place Start()
  {
    std::vector<double> start = this->Searched.From;
    for (std::size_t index = start.size(); index < this->Searched.Parameters.size(); ++index)
    {
      start.push_back(this->Searched.Parameters[index].Start);
    }
    Place first = this->At(start, nullptr);
    this->Keep(first);
    return first;
  }

  /// Solved from another place if there is one. Throws ConvergenceError, Interrupted.
  Place At(const std::vector<double>& values, const PosedBreast* from)
  {
    Place place{ values, nullptr, {}, 0 };
    ++this->Result.Evaluations;
    const BreastPose pose = PoseOf(values);
    BreastBody& body = this->Model.Body();
    place.Breast = std::make_shared<PosedBreast>(this->Model, body, this->Placement, pose,
      body.Compress(this->Placement, pose, from ? &from->State() : nullptr, this->Progress));
    place.Residuals = this->Compared.Evaluate(*place.Breast);
    place.Cost = this->Compared.Costs(place.Residuals).Sum();
    ++this->Result.Projections;
    return place;
  }

  void Keep(const Place& best)
  {
    const RegistrationCosts costs = this->Compared.Costs(best.Residuals);
    RegistrationIteration& row = this->Result.Iterations.emplace_back();
    row.Number = static_cast<int>(this->Result.Iterations.size()) - 1;
    row.Parameters = best.Values;
    row.PixelSizeMm = this->Options.PixelSizesMm.back();
    row.Comparison = NameOf(this->Options.Comparison);
    row.Cost = costs.Sum();
    row.OutlineCost = costs.Outline;
    row.IntensityCost = costs.Intensity;
    row.PriorCost = costs.Prior;
    row.Seconds = SecondsSince(this->Begin);
    this->Result.Values = best.Values;
    this->Best = best.Breast;
  }

  ViewResult Finish(const std::string& reason, bool converged)
  {
    this->Result.StopReason = reason;
    this->Result.Converged = converged;
    this->Result.Pose = PoseOf(this->Result.Values);
    this->Result.State = this->Best->State();
    this->Result.After = this->SimilarityOfBest();
    this->Result.Trust = Assess(this->Result);
    this->Result.Seconds = SecondsSince(this->Begin);
    return std::move(this->Result);
  }

  const RegistrationOptions& Options;
  const View& Searched;
  const RegistrationResiduals Compared;
  const ProgressCallback& Progress;
  ViewResult Result;

private:
  Similarity SimilarityOfBest()
  {
    const RegistrationTarget& finest = this->Searched.Levels.back();
    return Compare(
      Synthesize(*this->Best, finest.Grid, ChestWallCentre(finest), this->Options.Samples), finest);
  }

  BreastModel& Model;
  UnitPlacement Placement;
  std::shared_ptr<PosedBreast> Best;
  Clock::time_point Begin = Clock::now();
};

constexpr const char* Stopped = "interrupted; this is the best pose so far";

/// A normal step of every free parameter, reflected at the bounds.
std::vector<double> NearbyValues(const std::vector<double>& values,
  const std::vector<RegistrationParameter>& parameters, double step, std::mt19937& generator)
{
  std::normal_distribution<double> normal;
  std::vector<double> nearby = values;
  for (std::size_t index = 0; index < parameters.size(); ++index)
  {
    const RegistrationParameter& parameter = parameters[index];
    if (parameter.Fixed)
    {
      continue;
    }
    double& value = nearby[index];
    value += step * parameter.Scale * normal(generator);
    value = value < parameter.Lower ? 2 * parameter.Lower - value : value;
    value = value > parameter.Upper ? 2 * parameter.Upper - value : value;
    value = std::clamp(value, parameter.Lower, parameter.Upper);
  }
  return nearby;
}

void AnnealFrom(Walk& walk, Place current, const AnnealingOptions& annealing)
{
  std::mt19937 generator(annealing.Seed);
  std::uniform_real_distribution<double> uniform;
  double least = current.Cost;
  const double hottest = std::max(annealing.FirstTemperature * least, annealing.LastTemperature);
  for (int number = 1; number < annealing.Equilibria; ++number)
  {
    const double part = static_cast<double>(number) / annealing.Equilibria;
    ReportProgress(walk.Progress, part, "anneal");
    const double temperature = hottest * std::pow(annealing.LastTemperature / hottest, part);
    const double step = annealing.FirstStep * std::sqrt(temperature / hottest);
    try
    {
      Place next = walk.At(NearbyValues(current.Values, walk.Searched.Parameters, step, generator),
        current.Breast.get());
      const double rise = next.Cost - current.Cost;
      if (rise <= 0 || uniform(generator) < std::exp(-rise / temperature))
      {
        current = std::move(next);
      }
    }
    catch (const ConvergenceError&)
    {
      // The walk stays.
    }
    if (current.Cost < least)
    {
      least = current.Cost;
      walk.Keep(current);
    }
  }
}

/**
 * All residuals as one cost function of the free parameters over their scales. Residuals beyond
 * their robust width are replaced by the root of Huber's loss, so that half of the sum of squares
 * is the cost.
 */
class DifferencesCost : public ceres::CostFunction
{
public:
  DifferencesCost(Walk& walk, Place start, double step)
    : Search(walk)
    , Accepted(std::move(start))
    , Step(step)
    , Widths(walk.Compared.RobustWidths())
  {
    for (std::size_t index = 0; index < walk.Searched.Parameters.size(); ++index)
    {
      if (!walk.Searched.Parameters[index].Fixed)
      {
        this->Free.push_back(index);
        double& value = this->Accepted.Values[index];
        this->Block.push_back(value / this->ScaleOf(index));
        value = this->Block.back() * this->ScaleOf(index); // as it comes back from Ceres
      }
    }
    this->Evaluated = this->Accepted;
    this->set_num_residuals(static_cast<int>(this->Widths.size()));
    this->mutable_parameter_block_sizes()->push_back(static_cast<int>(this->Free.size()));
  }

  bool Evaluate(double const* const* block, double* residuals, double** jacobians) const override
  {
    std::vector<double> values = this->Accepted.Values;
    for (std::size_t u = 0; u < this->Free.size(); ++u)
    {
      values[this->Free[u]] = block[0][u] * this->ScaleOf(this->Free[u]);
    }
    try
    {
      if (this->IsStopped)
      {
        return false;
      }
      if (values != this->Evaluated.Values)
      {
        this->Evaluated = this->Search.At(values, this->Accepted.Breast.get());
      }
      const std::vector<double> robust = this->Robust(this->Evaluated.Residuals);
      std::copy(robust.begin(), robust.end(), residuals);
      if (jacobians && jacobians[0])
      {
        this->Accepted = this->Evaluated; // Ceres asks for the Jacobian where it takes a step
        this->Differentiate(jacobians[0]);
      }
      return true;
    }
    catch (const Interrupted&)
    {
      this->IsStopped = true;
    }
    catch (const ConvergenceError&)
    {
      // Ceres shortens its step.
    }
    return false;
  }

  double ScaleOf(std::size_t parameter) const
  {
    return this->Search.Searched.Parameters[parameter].Scale;
  }

  Walk& Search;
  std::vector<std::size_t> Free;
  std::vector<double> Block;
  mutable Place Accepted;
  mutable bool IsStopped = false;

private:
  std::vector<double> Robust(std::vector<double> residuals) const
  {
    for (std::size_t index = 0; index < residuals.size(); ++index)
    {
      const double size = std::abs(residuals[index]);
      const double width = this->Widths[index];
      residuals[index] = size <= width
        ? residuals[index]
        : std::copysign(std::sqrt(width * (2 * size - width)), residuals[index]);
    }
    return residuals;
  }

  /// Row by row, as Ceres wants it.
  void Differentiate(double* jacobian) const
  {
    for (std::size_t u = 0; u < this->Free.size(); ++u)
    {
      const auto moved = [&](double step)
      {
        std::vector<double> values = this->Accepted.Values;
        values[this->Free[u]] += step * this->ScaleOf(this->Free[u]);
        return this->Robust(this->Search.At(values, this->Accepted.Breast.get()).Residuals);
      };
      const std::vector<double> above = moved(this->Step);
      const std::vector<double> below = moved(-this->Step);
      for (std::size_t index = 0; index < above.size(); ++index)
      {
        jacobian[index * this->Free.size() + u] = (above[index] - below[index]) / (2 * this->Step);
      }
    }
  }

  double Step;
  std::vector<double> Widths;
  mutable Place Evaluated;
};

/// Keeps the accepted places.
class PlaceRecorder : public ceres::IterationCallback
{
public:
  PlaceRecorder(const DifferencesCost& cost)
    : Cost(cost)
  {
  }

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override
  {
    if (summary.iteration > 0 && summary.step_is_successful)
    {
      this->Cost.Search.Keep(this->Cost.Accepted);
    }
    return this->Cost.IsStopped ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }

private:
  const DifferencesCost& Cost;
};
}

ViewResult Anneal(const RegistrationProblem& problem, const AnnealingOptions& annealing,
  const ProgressCallback& progress)
{
  if (annealing.Equilibria < 1 || !(annealing.FirstTemperature > 0) ||
    !(annealing.LastTemperature > 0) || !(annealing.FirstStep > 0))
  {
    throw InputError("annealing: expected at least one equilibrium, and positive temperatures and "
                     "steps");
  }
  Walk walk(problem, progress);
  const Place first = walk.Start();
  try
  {
    AnnealFrom(walk, first, annealing);
  }
  catch (const Interrupted&)
  {
    return walk.Finish(Stopped, false);
  }
  return walk.Finish("the equilibria are spent", false);
}

ViewResult SearchByDifferences(const RegistrationProblem& problem, const ProgressCallback& progress,
  double step)
{
  Walk walk(problem, progress);
  DifferencesCost cost(walk, walk.Start(), step);
  ceres::Problem::Options owned;
  owned.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem search(owned);
  search.AddResidualBlock(&cost, nullptr, cost.Block.data());
  for (std::size_t u = 0; u < cost.Free.size(); ++u)
  {
    const RegistrationParameter& parameter = walk.Searched.Parameters[cost.Free[u]];
    search.SetParameterLowerBound(cost.Block.data(), static_cast<int>(u),
      parameter.Lower / parameter.Scale);
    search.SetParameterUpperBound(cost.Block.data(), static_cast<int>(u),
      parameter.Upper / parameter.Scale);
  }
  PlaceRecorder recorder(cost);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  // The registration's own limits: residuals are in standard deviations.
  options.function_tolerance = 1e-3;
  options.parameter_tolerance = 1e-3;
  options.initial_trust_region_radius = 1e2;
  options.max_num_iterations = problem.Options.MaximumIterations;
  options.max_num_line_search_step_size_iterations = 0;
  options.callbacks.push_back(&recorder);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &search, &summary);
  return walk.Finish(cost.IsStopped ? Stopped : summary.message,
    !cost.IsStopped && summary.termination_type == ceres::CONVERGENCE);
}
}
