// SPDX-License-Identifier: Apache-2.0
#include "Private/SearchState.h"

#include <limits>
#include <numeric>

namespace mammoray
{
SearchState::SearchState(const RegistrationProblem& problem, const SearchObserver& observer)
  : Observer(observer)
{
  for (const View& view : problem.Views)
  {
    ViewSearch& search = this->Views.emplace_back();
    search.Input = &view;
    search.Model = problem.Model.get();
    search.Placement = problem.PlacementOf(view);
    ViewResult& result = search.Result;
    result.Parameters = view.Parameters;
    result.Values = view.From;
    for (const RegistrationParameter& parameter : view.Parameters)
    {
      if (view.From.empty())
      {
        result.Values.push_back(parameter.Start);
      }
    }
    result.StandardDeviations.assign(ParameterCount, std::numeric_limits<double>::quiet_NaN());
    // Holds unless there is something to search.
    result.StopReason = "nothing to optimise: every parameter is fixed";
    result.Converged = true;
  }
}

std::vector<std::size_t> SearchState::ViewsOf(int parameter, std::size_t view) const
{
  if (!IsShared(parameter))
  {
    return { view };
  }
  std::vector<std::size_t> all(this->Views.size());
  std::iota(all.begin(), all.end(), std::size_t{ 0 });
  return all;
}

std::vector<std::shared_ptr<PosedBreast>> SearchState::CurrentBreasts() const
{
  std::vector<std::shared_ptr<PosedBreast>> breasts;
  for (const ViewSearch& view : this->Views)
  {
    breasts.push_back(view.Current);
  }
  return breasts;
}

void SearchState::Observe() const
{
  if (!this->Observer)
  {
    return;
  }
  std::vector<SearchedView> searched;
  searched.reserve(this->Views.size());
  for (const ViewSearch& view : this->Views)
  {
    searched.push_back({ view.Result, *view.Current, view.Input->Levels.back() });
  }
  this->Observer(searched);
}

void SearchState::CollectFreeParameters()
{
  this->FreeParameters.clear();
  for (std::size_t view = 0; view < this->Views.size(); ++view)
  {
    for (int index = 0; index < ParameterCount; ++index)
    {
      const RegistrationParameter& parameter = this->Views[view].Result.Parameters[index];
      if (parameter.Fixed || (IsShared(index) && view > 0))
      {
        continue;
      }
      this->FreeParameters.push_back(
        { index, this->ViewsOf(index, view), parameter.Lower, parameter.Upper, parameter.Scale });
    }
  }
}
}
