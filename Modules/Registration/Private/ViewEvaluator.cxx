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
  const ScopeTimer timer(this->MechanicsSeconds);
  try
  {
    this->Current = this->Breast.At(this->Values,
      this->Breast.Body->Compress(this->Breast.Placement, PoseOf(this->Values),
        travelMm > LongestWarmTravelMm ? nullptr : &near, this->Progress));
    this->CurrentValues = this->Values;
    ++this->Evaluations;
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
    this->LongestTravelMm = travelMm > 0 ? 0.5 * travelMm : this->LongestTravelMm;
    return Answer::NoEquilibrium; // Ceres shortens its step
  }
}

void ViewEvaluator::AppendResiduals(std::vector<double>& residuals)
{
  const ScopeTimer timer(this->ProjectionSeconds);
  const int before = this->Current->NumberOfProjections();
  this->Compared.Append(*this->Current, residuals);
  this->Projections += this->Current->NumberOfProjections() - before;
}

RegistrationResiduals::Jacobian ViewEvaluator::Differentiate(const std::vector<int>& wanted)
{
  const ScopeTimer timer(this->JacobianSeconds);
  const int before = this->Current->NumberOfProjections();
  RegistrationResiduals::Jacobian jacobian = this->Compared.Differentiate(*this->Current, wanted);
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

std::vector<double> ViewEvaluator::WithEdges(double radiusMm)
{
  SearchedBreast breast = this->Breast;
  breast.Placement.Unit.EdgeRadiusMm = radiusMm;
  ++this->Evaluations;
  std::shared_ptr<PosedBreast> state;
  try
  {
    const ScopeTimer timer(this->MechanicsSeconds);
    state = breast.At(this->Values,
      breast.Body->Compress(breast.Placement, PoseOf(this->Values), &this->Current->State(),
        this->Progress));
  }
  catch (const Interrupted&)
  {
    return {}; // the result so far stays valid
  }
  catch (const ConvergenceError&)
  {
    return {}; // sharper edges can stop the elements
  }
  const ScopeTimer timer(this->ProjectionSeconds);
  std::vector<double> residuals = this->Compared.Evaluate(*state);
  this->Projections += state->NumberOfProjections();
  return residuals;
}
}
