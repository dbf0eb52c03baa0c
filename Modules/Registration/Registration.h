// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Registration_h
#define mammoray_Registration_h

#include "mammoray/Foundation/Progress.h"
#include "mammoray/Registration/RegistrationProblem.h"
#include "mammoray/Registration/RegistrationResult.h"
#include "mammorayRegistrationModule.h"

#include <functional>
#include <vector>

namespace mammoray
{
/// Where the search of a view stands. References hold during the observer's call.
struct SearchedView
{
  /// Parameters, Values and Iterations so far.
  const ViewResult& Result;
  /// The breast at these values, and the mammogram in the smallest of the compared pixels.
  PosedBreast& Breast;
  const RegistrationTarget& Target;
};

/// Called by Register's thread at the start of each level of a search and for each accepted step.
using SearchObserver = std::function<void(const std::vector<SearchedView>& views)>;

/**
 * Finds the poses and compressions whose synthetic mammograms match the views, by Ceres
 * (Levenberg-Marquardt). Each view has its own pose and compression; a shared parameter has one
 * value, bounds and prior (those of the first view), and one search minimises the sum of all costs.
 *
 * A start thinner than the model can be compressed to is opened until there is an equilibrium, with
 * a warning. Throws InputError on bad input, among it a shared parameter that is not free in all
 * views or none, and a View::From in some views only; ConvergenceError when no start has an
 * equilibrium; Interrupted when stopped before the search. A stop during the search ends it with
 * the best poses so far (StopReason says so).
 */
MAMMORAYREGISTRATION_EXPORT RegistrationResult Register(const RegistrationProblem& problem,
  const ProgressCallback& progress = {}, const SearchObserver& observer = {});
}

#endif
