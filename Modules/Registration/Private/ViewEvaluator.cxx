// SPDX-License-Identifier: Apache-2.0
#include "Private/ViewEvaluator.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <utility>

namespace mammoray
{
double TravelFrom(const CompressionState& state, const UnitPlacement& placement,
  const BreastPose& pose)
{
  const PlatePair plates = placement.PlatesAt(pose);
  return TravelMm(PlateMotion(SlidTowards(state.Plates, plates), plates));
}

std::shared_ptr<PosedBreast> SearchedBreast::At(const std::vector<double>& values,
  CompressionState state) const
{
  return std::make_shared<PosedBreast>(*this->Model, *this->Body, this->Placement, PoseOf(values),
    std::move(state));
}

ViewEvaluator::ViewEvaluator(const SearchedBreast& breast, RegistrationResiduals compared,
  std::vector<double> values, std::shared_ptr<PosedBreast> current,
  const ProgressCallback& progress)
  : Breast(breast)
  , Values(std::move(values))
  , Current(std::move(current))
  , Compared(std::move(compared))
  , Progress(progress)
  , Accepted(this->Current)
  , CurrentValues(this->Values)
{
}

ViewEvaluator::Answer ViewEvaluator::Compress()
{
  if (this->Values == this->CurrentValues)
  {
    return Answer::Found;
  }
  const CompressionState& near = this->Accepted->State();
  const double travelMm = TravelFrom(near, this->Breast.Placement, PoseOf(this->Values));
  if (travelMm > this->LongestTravelMm)
  {
    return Answer::Refused; // costs nothing, and Ceres shortens its step or gives up
  }
  const auto begin = Clock::now();
  try
  {
    this->Current = this->Breast.At(this->Values,
      this->Breast.Body->Compress(this->Breast.Placement, PoseOf(this->Values),
        travelMm > LongestWarmTravelMm ? nullptr : &near, this->Progress));
    this->CurrentValues = this->Values;
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

void ViewEvaluator::AppendResiduals(std::vector<double>& residuals)
{
  const auto begin = Clock::now();
  const int before = this->Current->NumberOfProjections();
  this->Compared.Append(*this->Current, residuals);
  this->ProjectionSeconds += SecondsSince(begin);
  this->Projections += this->Current->NumberOfProjections() - before;
}

RegistrationResiduals::Jacobian ViewEvaluator::Differentiate(const std::vector<int>& wanted)
{
  const auto begin = Clock::now();
  const int before = this->Current->NumberOfProjections();
  RegistrationResiduals::Jacobian jacobian = this->Compared.Differentiate(*this->Current, wanted);
  this->JacobianSeconds += SecondsSince(begin);
  this->Projections += this->Current->NumberOfProjections() - before;
  return jacobian;
}

void ViewEvaluator::ReturnTo(const std::vector<double>& values, std::shared_ptr<PosedBreast> state)
{
  const bool same = ValuesOf(state->Pose()) == values;
  this->Current = same ? std::move(state) : this->Breast.At(values, state->State());
  this->CurrentValues = values;
  this->Accept();
}

std::shared_ptr<PosedBreast> ViewEvaluator::CompressBeside(const SearchedBreast& breast,
  const std::vector<double>& values) const
{
  return breast.At(values,
    breast.Body->Compress(breast.Placement, PoseOf(values), &this->Current->State(),
      this->Progress));
}

std::vector<double> ViewEvaluator::WithEdges(double radiusMm)
{
  SearchedBreast breast = this->Breast;
  breast.Placement.Unit.EdgeRadiusMm = radiusMm;
  const auto begin = Clock::now();
  ++this->Evaluations;
  std::shared_ptr<PosedBreast> state;
  try
  {
    state = this->CompressBeside(breast, this->Values);
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
