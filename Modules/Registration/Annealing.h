// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Annealing_h
#define mammoray_Annealing_h

#include "mammoray/Registration/Registration.h"
#include "mammorayRegistrationModule.h"

#include <cstdint>

namespace mammoray
{
struct AnnealingOptions
{
  /// Equilibria to spend, the first included; at least 1.
  int Equilibria = 100;
  std::uint32_t Seed = 1;
  /**
   * Temperature at the beginning, in shares of the cost there, and at the end. Costs are half
   * squares of standard deviations: at a temperature of 1 the walk goes where the parameters are
   * likely.
   */
  double FirstTemperature = 0.1;
  double LastTemperature = 0.5;
  /// Standard deviation of a step of each parameter in its scales, at the beginning; it falls with
  /// the square root of the temperature.
  double FirstStep = 1.0;
};

/**
 * Minimises what Register minimises, at its finest resolution, by simulated annealing (Kirkpatrick,
 * Gelatt and Vecchi 1983; normal steps, geometric cooling) from View::From or the parameters'
 * Start: a search without derivatives to compare with. One iteration is reported for each better
 * pose. Throws as Register, but ConvergenceError where the start has no equilibrium.
 */
MAMMORAYREGISTRATION_EXPORT ViewResult Anneal(const RegistrationProblem& problem,
  const AnnealingOptions& annealing, const ProgressCallback& progress = {});
}

#endif
