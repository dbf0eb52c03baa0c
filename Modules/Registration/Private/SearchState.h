// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SearchState_h
#define mammoray_SearchState_h

#include "Private/ViewEvaluator.h"
#include "mammoray/Registration/Registration.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace mammoray
{
/// One of the views of a search, and what is found of it so far.
struct ViewSearch
{
  const View* Input = nullptr;
  BreastModel* Model = nullptr;
  UnitPlacement Placement;
  ViewResult Result;
  /// The breast at Result.Values, or, where it is moved to its outline, at a pose near them.
  std::shared_ptr<PosedBreast> Current;

  /// The breast with the model's body, or with its predictor.
  SearchedBreast Breast(bool predicted = false) const
  {
    return { this->Model, predicted ? this->Model->Predictor() : &this->Model->Body(),
      this->Placement };
  }
};

/// The views of a search, and what they have in common.
struct SearchState
{
  /// All views at their starts.
  SearchState(const RegistrationProblem& problem, const SearchObserver& observer);

  std::vector<ViewSearch> Views;
  std::vector<FreeParameter> FreeParameters;
  /// See RegistrationResult.
  std::vector<double> Covariance;
  Clock::time_point Begin = Clock::now();
  /// May be empty.
  SearchObserver Observer;

  /// The breasts where each view's search stands.
  std::vector<std::shared_ptr<PosedBreast>> CurrentBreasts() const;

  /// Calls the observer, if there is one.
  void Observe() const;

  /// Collects what is free, view by view; a shared parameter once, with the bounds of the first.
  void CollectFreeParameters();
  /// Numbers of the views that have a parameter of one of them: all have a shared one.
  std::vector<std::size_t> ViewsOf(int parameter, std::size_t view) const;
};
}

#endif
