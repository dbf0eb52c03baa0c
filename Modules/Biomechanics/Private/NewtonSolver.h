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
  /// The reason for a failure; empty if the solver converged.
  std::string Reason;
};

/// Newton's method with a line search and a sparse Cholesky factorisation. It keeps the last
/// evaluation with its Hessian and the last factor for the next call.
class MAMMORAYBIOMECHANICS_EXPORT NewtonSolver
{
public:
  /// Relaxed: when Newton's method struggles, the part of the unknowns with the largest residual is
  /// solved alone. Together: never.
  enum class Parts
  {
    Relaxed,
    Together
  };

  /// The objective must outlive the solver.
  explicit NewtonSolver(Objective& objective);

  /**
   * Minimises from the positions `x`, where the objective must be defined; fixed coordinates keep
   * their values. Stops when the relative residual falls below `tolerance`. After a step that was
   * shortened or used a stiffer matrix, the objective's WorstPart is relaxed; those steps are not
   * counted. On failure `x` holds the last positions. Throws Interrupted.
   */
  NewtonResult Minimize(std::vector<double>& x, double tolerance, int maximumSteps,
    const ProgressCallback& progress = {}, Parts parts = Parts::Relaxed);

  /// The objective at `x` with its Hessian; valid until the next call of a member.
  const Evaluation& EvaluateAt(const std::vector<double>& x);
  /// Factorises the Hessian at `x`, or a stiffer matrix if that is indefinite. Returns false if
  /// neither works or the objective is not defined.
  bool FactorizeAt(const std::vector<double>& x, bool stiffer = false);
  FactorCache& Factor() { return this->Cache; }
  const FactorCache& Factor() const { return this->Cache; }

private:
  /// Computes a step and returns the share of the stiffer matrix that it used; nothing if the
  /// matrix is singular.
  std::optional<double> FindStep(const std::vector<double>& x, std::vector<double>& step);
  bool SearchAlong(const std::vector<double>& step, std::vector<double>& x, double& length);
  /**
   * Minimises over the part with the largest residual while the rest is fixed (nonlinear
   * elimination: Lanzkron, Rose & Wilkes 1996; Cai & Li 2011). Tissue folds and slips at the
   * plates' edges in steps of some millimetres; otherwise each of these steps would cost a
   * factorisation of the whole body. Never raises the energy.
   */
  void RelaxWorstPart(std::vector<double>& x, const ProgressCallback& progress);

  Objective& Function;
  FactorCache Cache;
  Evaluation Current;
  /// Positions of Current; empty if it is not valid.
  std::vector<double> CurrentPositions;
  std::uint64_t CurrentVersion = 0;
  Evaluation Probe;
  std::vector<double> Trial;
};
}

#endif
