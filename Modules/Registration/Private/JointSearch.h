// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_JointSearch_h
#define mammoray_JointSearch_h

#include "Private/RegistrationEvaluator.h"
#include "Private/SearchStart.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace mammoray
{
/// The mammograms of a search, and what they have in common.
struct JointSearch
{
  std::vector<MammogramSearch> Mammograms;
  std::vector<SearchUnknown> Unknowns;
  /// See JointRegistrationResult.
  std::vector<double> Covariance;
  Clock::time_point Begin = Clock::now();
  /// May be empty.
  SearchObserver Observer;

  /// Where each mammogram's search stands.
  std::vector<std::shared_ptr<EvaluatedState>> States() const;

  /// Tells the observer, if there is one.
  void Observe() const;

  /// What is free, mammogram by mammogram; a shared parameter once, with the bounds of the first.
  void CollectUnknowns();
  /// The mammograms that have a parameter of one: all of them a shared one.
  std::vector<std::size_t> MammogramsOf(int parameter, std::size_t mammogram) const;
};
}

#endif
