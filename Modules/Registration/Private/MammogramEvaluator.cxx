// SPDX-License-Identifier: Apache-2.0
#include "Private/MammogramEvaluator.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <functional>
#include <utility>

namespace mammoray
{
double TravelFrom(const CompressionState& state, const UnitPlacement& placement,
  const BreastPose& pose)
{
  const PlatePair plates = placement.PlatesAt(pose);
  return TravelMm(PlateMotion(SlidTowards(state.Plates, plates), plates));
}

std::shared_ptr<EvaluatedState> SearchedBreast::At(const std::vector<double>& values,
  CompressionState state) const
{
  return std::make_shared<EvaluatedState>(*this->Model, *this->Body, this->Placement,
    PoseOf(values), std::move(state));
}

std::vector<ComparedProjection> SearchedMammogram::Projections() const
{
  std::vector<ComparedProjection> projections{ { &this->Target, std::nullopt } };
  for (const Projection& other : this->Others)
  {
    projections.push_back({ &other.Target, other.FocalSpotMm });
  }
  return projections;
}

MammogramEvaluator::MammogramEvaluator(SearchedMammogram mammogram,
  const ProgressCallback& progress)
  : Mammogram(std::move(mammogram))
  , Compared(this->Mammogram.Projections(), this->Mammogram.Options)
  , Progress(progress)
  , Accepted(this->Mammogram.Here)
  , HereIsAt(this->Mammogram.Values)
{
}

MammogramEvaluator::Answer MammogramEvaluator::Compress()
{
  const std::vector<double>& values = this->Mammogram.Values;
  if (values == this->HereIsAt)
  {
    return Answer::Found;
  }
  const SearchedBreast& breast = this->Mammogram.Breast;
  const CompressionState& near = this->Accepted->State();
  const double travelMm = TravelFrom(near, breast.Placement, PoseOf(values));
  if (travelMm > this->LongestTravelMm)
  {
    return Answer::Refused; // costs nothing, and Ceres shortens its step or gives up
  }
  const auto begin = Clock::now();
  try
  {
    this->Mammogram.Here = breast.At(values,
      breast.Body->Compress(breast.Placement, PoseOf(values),
        travelMm > LongestWarmTravelMm ? nullptr : &near, this->Progress));
    this->HereIsAt = values;
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

void MammogramEvaluator::Compare()
{
  const auto begin = Clock::now();
  const int before = this->Mammogram.Here->NumberOfProjections();
  this->Residuals = this->Compared.Evaluate(*this->Mammogram.Here);
  this->ProjectionSeconds += SecondsSince(begin);
  this->Projections += this->Mammogram.Here->NumberOfProjections() - before;
}

RegistrationResiduals::Jacobian MammogramEvaluator::Differentiate(const std::vector<int>& wanted)
{
  const auto begin = Clock::now();
  const int before = this->Mammogram.Here->NumberOfProjections();
  RegistrationResiduals::Jacobian jacobian =
    this->Compared.Differentiate(*this->Mammogram.Here, wanted);
  this->JacobianSeconds += SecondsSince(begin);
  this->Projections += this->Mammogram.Here->NumberOfProjections() - before;
  return jacobian;
}

std::vector<double> MammogramEvaluator::Weigh(const std::vector<double>& factors)
{
  std::vector<double> changes = this->Compared.Weigh(factors);
  std::transform(this->Residuals.begin(), this->Residuals.end(), changes.begin(),
    this->Residuals.begin(), std::multiplies<>());
  return changes;
}

void MammogramEvaluator::ReturnTo(const std::vector<double>& values,
  std::shared_ptr<EvaluatedState> state)
{
  const bool same = ValuesOf(state->Pose()) == values;
  this->Mammogram.Here =
    same ? std::move(state) : this->Mammogram.Breast.At(values, state->State());
  this->HereIsAt = values;
  this->Accept();
}

std::shared_ptr<EvaluatedState> MammogramEvaluator::CompressBeside(const SearchedBreast& breast,
  const std::vector<double>& values) const
{
  return breast.At(values,
    breast.Body->Compress(breast.Placement, PoseOf(values), &this->Mammogram.Here->State(),
      this->Progress));
}

std::vector<double> MammogramEvaluator::Beside(const std::vector<double>& values)
{
  return this->Compared.Evaluate(*this->CompressBeside(this->Mammogram.Breast, values));
}

std::vector<double> MammogramEvaluator::WithEdges(double radiusMm)
{
  SearchedBreast breast = this->Mammogram.Breast;
  breast.Placement.Unit.EdgeRadiusMm = radiusMm;
  const auto begin = Clock::now();
  ++this->Evaluations;
  std::shared_ptr<EvaluatedState> state;
  try
  {
    state = this->CompressBeside(breast, this->Mammogram.Values);
  }
  catch (const Interrupted&)
  {
    // What has been found so far stays.
  }
  catch (const ConvergenceError&)
  {
    // Sharper edges can stop the elements.
  }
  this->MechanicsSeconds += SecondsSince(begin);
  if (!state)
  {
    return {};
  }
  const auto compressed = Clock::now();
  std::vector<double> residuals = this->Compared.Evaluate(*state);
  this->ProjectionSeconds += SecondsSince(compressed);
  this->Projections += state->NumberOfProjections();
  return residuals;
}
}
