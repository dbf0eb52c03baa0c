// SPDX-License-Identifier: Apache-2.0
// Searches to compare the registration's own search with. They minimise what Register minimises for
// the first view, at its finest level and with the weights of the options.
#ifndef mammoray_Validation_OtherSearches_h
#define mammoray_Validation_OtherSearches_h

#include "mammoray/Registration/Registration.h"

#include <cstdint>

namespace mammoray
{
struct AnnealingOptions
{
  /// Number of equilibria to spend, including the first; at least 1.
  int Equilibria = 100;
  std::uint32_t Seed = 1;
  /// Temperature at the beginning, relative to the cost there, and at the end, absolute. Costs are
  /// half squares of standard deviations: at a temperature of 1 the walk samples the likely
  /// parameters.
  double FirstTemperature = 0.1;
  double LastTemperature = 0.5;
  /// Standard deviation of a step of each parameter in its scale, at the beginning; it falls with
  /// the square root of the temperature.
  double FirstStep = 1.0;
};

/**
 * Simulated annealing (Kirkpatrick, Gelatt and Vecchi 1983; normal steps, geometric cooling) from
 * View::From or the parameters' Start: a search without derivatives. Reports one iteration for
 * each better pose. A stop ends it with the best pose so far. Throws InputError on unusable
 * options, ConvergenceError where the start has no equilibrium.
 */
ViewResult Anneal(const RegistrationProblem& problem, const AnnealingOptions& annealing,
  const ProgressCallback& progress = {});

/**
 * Levenberg-Marquardt from the same start with central differences of re-solved equilibria in place
 * of exact derivatives, with steps of `step` scales of each parameter to both sides. Throws and
 * stops as Anneal.
 */
ViewResult SearchByDifferences(const RegistrationProblem& problem,
  const ProgressCallback& progress = {}, double step = 0.02);
}

#endif
