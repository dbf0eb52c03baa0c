// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_NewtonSolver_h
#define mammoray_NewtonSolver_h

#include "Private/FactorCache.h"
#include "Private/Objective.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayBiomechanicsModule.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
struct NewtonResult
{
  bool Converged = false;
  int Steps = 0;
  /// Why it did not converge; empty when it did.
  std::string Reason;
};

/**
 * Newton's method with a line search and a sparse Cholesky factorisation. Keeps the last evaluation
 * with its Hessian and the last factor for what comes next.
 */
class MAMMORAYBIOMECHANICS_EXPORT NewtonSolver
{
public:
  /// Whether the part of the unknowns with the largest residual is relaxed alone where Newton's
  /// method struggles.
  enum class Parts
  {
    Relaxed,
    Together
  };

  /// The objective must outlive the solver.
  explicit NewtonSolver(Objective& objective);

  /**
   * From the positions `x` (where the objective is defined) to a minimum; fixed coordinates keep
   * their values. Stops when the relative residual falls below `tolerance`. After a step that was
   * cut short or took a stiffer matrix, the objective's WorstPart is relaxed; its steps are not
   * counted. `x` holds the last positions when it fails. Throws Interrupted.
   */
  NewtonResult Minimize(std::vector<double>& x, double tolerance, int maximumSteps,
    const ProgressCallback& progress = {}, Parts parts = Parts::Relaxed);

  /// The objective at `x` with its Hessian; valid until the next call of a member.
  const Evaluation& At(const std::vector<double>& x);
  /// The factor at `x`, exact or of a stiffer matrix where that is indefinite. Answers false where
  /// there is none, or the objective is not defined.
  bool FactorizeAt(const std::vector<double>& x, bool stiffer = false);
  FactorCache& Factor() { return this->Cache; }
  const FactorCache& Factor() const { return this->Cache; }

private:
  /// Answers the share of a stiffer matrix that the step took; none where the matrix is singular.
  std::optional<double> FindStep(const std::vector<double>& x, std::vector<double>& step);
  bool SearchAlong(const std::vector<double>& step, std::vector<double>& x, double& length);
  /**
   * Minimises over the part with the largest residual, the others fixed. Tissue folds and slips at
   * the plates' edges in steps of some mm, and the whole body would wait for it at the price of a
   * factor each (nonlinear elimination: Lanzkron, Rose & Wilkes 1996; Cai & Li 2011). Never raises
   * the energy.
   */
  void RelaxWorstPart(std::vector<double>& x, const ProgressCallback& progress);

  Objective& Function;
  FactorCache Cache;
  Evaluation Current;
  /// What Current is of; empty: of nothing.
  std::vector<double> CurrentPositions;
  std::uint64_t CurrentVersion = 0;
  Evaluation Probe;
  std::vector<double> Trial;
};
}

#endif
