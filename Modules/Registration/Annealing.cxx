// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/Annealing.h"

#include "Private/ValidateRegistration.h"
#include "Private/ViewEvaluator.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Registration/RegistrationTarget.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <utility>

namespace mammoray
{
namespace
{
/// Where the walk is.
struct Place
{
  std::vector<double> Values;
  std::shared_ptr<PosedBreast> Breast;
  RegistrationCosts Costs;
};

class Walk
{
public:
  Walk(const SearchedBreast& breast, const View& view, const RegistrationOptions& options,
    ViewResult& result, const ProgressCallback& progress)
    : Breast(breast)
    , Compared(view.Levels.back(), view.Parameters, options)
    , PixelSizeMm(options.PixelSizesMm.back())
    , Comparison(NameOf(options.Comparison))
    , Result(result)
    , Progress(progress)
  {
  }

  /// Solved from another place where there is one. Throws ConvergenceError.
  Place At(const std::vector<double>& values, const PosedBreast* from)
  {
    Place place;
    place.Values = values;
    ++this->Result.Evaluations;
    const auto compressing = Clock::now();
    try
    {
      place.Breast = this->Breast.At(values,
        this->Breast.Body->Compress(this->Breast.Placement, PoseOf(values),
          from ? &from->State() : nullptr, this->Progress));
    }
    catch (const ConvergenceError&)
    {
      this->Result.MechanicsSeconds += SecondsSince(compressing);
      throw;
    }
    this->Result.MechanicsSeconds += SecondsSince(compressing);
    const auto projecting = Clock::now();
    place.Costs = this->Compared.Costs(this->Compared.Evaluate(*place.Breast));
    this->Result.ProjectionSeconds += SecondsSince(projecting);
    ++this->Result.Projections;
    return place;
  }

  void Keep(const Place& best)
  {
    RegistrationIteration row;
    row.Number = static_cast<int>(this->Result.Iterations.size());
    row.Parameters = best.Values;
    row.PixelSizeMm = this->PixelSizeMm;
    row.Comparison = this->Comparison;
    row.Cost = best.Costs.Sum();
    row.OutlineCost = best.Costs.Outline;
    row.IntensityCost = best.Costs.Intensity;
    row.PriorCost = best.Costs.Prior;
    row.Seconds = SecondsSince(this->Begin);
    this->Result.Iterations.push_back(row);
    this->Result.Values = best.Values;
    this->Best = best.Breast;
  }

  /// What was kept last.
  PosedBreast& Kept() { return *this->Best; }

private:
  SearchedBreast Breast;
  std::shared_ptr<PosedBreast> Best;
  const RegistrationResiduals Compared;
  double PixelSizeMm;
  std::string Comparison;
  ViewResult& Result;
  const ProgressCallback& Progress;
  Clock::time_point Begin = Clock::now();
};

/// A normal step of every free parameter, thrown back at the bounds.
std::vector<double> Beside(const std::vector<double>& values,
  const std::vector<RegistrationParameter>& parameters, double step, std::mt19937& generator)
{
  std::normal_distribution<double> normal;
  std::vector<double> beside = values;
  for (std::size_t index = 0; index < parameters.size(); ++index)
  {
    const RegistrationParameter& parameter = parameters[index];
    if (parameter.Fixed)
    {
      continue;
    }
    double& value = beside[index];
    value += step * parameter.Scale * normal(generator);
    value = value < parameter.Lower ? 2 * parameter.Lower - value : value;
    value = value > parameter.Upper ? 2 * parameter.Upper - value : value;
    value = std::clamp(value, parameter.Lower, parameter.Upper);
  }
  return beside;
}

void AnnealFrom(Walk& walk, Place here, const std::vector<RegistrationParameter>& parameters,
  const AnnealingOptions& annealing, const ProgressCallback& progress)
{
  std::mt19937 generator(annealing.Seed);
  std::uniform_real_distribution<double> uniform;
  double least = here.Costs.Sum();
  const double hottest = std::max(annealing.FirstTemperature * least, annealing.LastTemperature);
  for (int number = 1; number < annealing.Equilibria; ++number)
  {
    const double part = static_cast<double>(number) / annealing.Equilibria;
    ReportProgress(progress, part, "anneal");
    const double temperature = hottest * std::pow(annealing.LastTemperature / hottest, part);
    const double step = annealing.FirstStep * std::sqrt(temperature / hottest);
    try
    {
      Place beside = walk.At(Beside(here.Values, parameters, step, generator), here.Breast.get());
      const double rise = beside.Costs.Sum() - here.Costs.Sum();
      if (rise <= 0 || uniform(generator) < std::exp(-rise / temperature))
      {
        here = std::move(beside);
      }
    }
    catch (const ConvergenceError&)
    {
      // The walk stays.
    }
    if (here.Costs.Sum() < least)
    {
      least = here.Costs.Sum();
      walk.Keep(here);
    }
  }
}
}

ViewResult Anneal(const RegistrationProblem& problem, const AnnealingOptions& annealing,
  const ProgressCallback& progress)
{
  ValidateProblem(problem);
  const View& view = problem.Views.front();
  const RegistrationOptions& options = problem.Options;
  if (annealing.Equilibria < 1 || !(annealing.FirstTemperature > 0) ||
    !(annealing.LastTemperature > 0) || !(annealing.FirstStep > 0))
  {
    throw InputError("annealing: expected at least one equilibrium, and positive temperatures and "
                     "steps");
  }
  const auto begin = Clock::now();
  ViewResult result;
  result.Parameters = view.Parameters;
  std::vector<double> start = view.From;
  if (start.empty())
  {
    for (const RegistrationParameter& parameter : view.Parameters)
    {
      start.push_back(parameter.Start);
    }
  }
  result.StandardDeviations.assign(ParameterCount, std::numeric_limits<double>::quiet_NaN());
  const RegistrationTarget& finest = view.Levels.back();
  Walk walk({ problem.Model.get(), &problem.Model->Body(), problem.PlacementOf(view) }, view,
    options, result, progress);
  const Place first = walk.At(start, nullptr);
  walk.Keep(first);
  result.Before =
    Compare(Synthesize(walk.Kept(), finest.Grid, ChestWallCentre(finest), options.Samples), finest);
  result.StopReason = "the equilibria are spent";
  try
  {
    AnnealFrom(walk, first, view.Parameters, annealing, progress);
  }
  catch (const Interrupted&)
  {
    result.StopReason = "interrupted; this is the best pose so far";
  }
  result.Pose = PoseOf(result.Values);
  result.State = walk.Kept().State();
  result.After =
    Compare(Synthesize(walk.Kept(), finest.Grid, ChestWallCentre(finest), options.Samples), finest);
  result.HeaderThicknessMm = view.Target.HeaderThicknessMm;
  result.Disagreements = view.Target.Disagreements;
  result.Trust = Assess(result);
  result.Seconds = SecondsSince(begin);
  return result;
}
}
