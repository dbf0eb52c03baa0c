// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_EquilibriumSolver_h
#define mammoray_EquilibriumSolver_h

#include "Private/EquilibriumEnergy.h"
#include "Private/EquilibriumReport.h"
#include "Private/EquilibriumSensitivities.h"
#include "Private/NewtonSolver.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayBiomechanicsModule.h"

#include <vector>

namespace mammoray
{
/// Finds equilibria of a body between two plates as minima of its EquilibriumEnergy, by
/// NewtonSolver, and their derivatives. The plates are an argument of each call; all other settings
/// persist. One thread may use it at a time; it uses all cores itself.
class MAMMORAYBIOMECHANICS_EXPORT EquilibriumSolver
{
public:
  /// `fixed` are 3 x nodeCount flags of coordinates that do not move. `contactStiffness` is in kPa
  /// / mm^2. Cells flagged in `leftOut` (empty for none) are rigid and are not assembled. The body
  /// must outlive the solver.
  EquilibriumSolver(const ElasticBody& body, const std::vector<bool>& fixed,
    double contactStiffness, const std::vector<bool>& leftOut = {});

  /// The energy that is minimised; its contact stiffness, loads and friction may be set.
  EquilibriumEnergy& Energy() { return this->Objective; }
  const EquilibriumEnergy& Energy() const { return this->Objective; }
  /// Call this after the body's materials or its undeformed shape have changed.
  void BodyChanged();
  /// Sets the attachment to the chest wall, of the same body; null for none. It must outlive its
  /// use.
  void SetAttachment(const AttachmentEnergy* attachment);
  /// Friction points of this coefficient for the contact at `x`; see FrictionOfContact.
  FrictionPoints FrictionAt(const std::vector<double>& x, const PlatePair& plates,
    double coefficient, const FrictionStart& before) const;

  /**
   * Solves for equilibrium between the plates (null for none), starting at the positions `x`: 3 x
   * nodeCount, mm, without inverted cells; fixed coordinates keep their values. Stops when the norm
   * of the residual force falls below `tolerance` times the largest of the norms of the forces of
   * contact, of the chest wall, of the dead loads and at fixed coordinates. On failure `x` holds
   * the last positions with J > 0 everywhere.
   */
  EquilibriumReport Solve(std::vector<double>& x, const PlatePair* plates, double tolerance,
    int maximumSteps, const ProgressCallback& progress = {});

  /// True if the energy without plates is defined at `x` and its Hessian is positive definite.
  bool IsStable(const std::vector<double>& x);
  /// True if no quadrature point is inverted.
  bool Admissible(const std::vector<double>& x);
  /// Solves from positions with inverted cells. The energy is continued beyond J = 0
  /// (ElasticEnergy::Domain), so that Newton's method can turn these cells back. On success `x` is
  /// admissible and near an equilibrium, but is not an equilibrium of the original energy.
  EquilibriumReport Untangle(std::vector<double>& x, const PlatePair* plates, double tolerance,
    int maximumSteps, const ProgressCallback& progress = {});
  /// Energy, forces and measures at the positions `x`. Throws ConvergenceError if a cell is
  /// inverted.
  EquilibriumReport Evaluate(const std::vector<double>& x, const PlatePair* plates);

  /// Velocities dx/dp of the nodes at the equilibrium `x`, in the order of EquilibriumDerivatives;
  /// zero at fixed coordinates. The implicit function theorem costs one back-substitution per
  /// parameter, by the factor at hand with iterative refinement or by a new one. Friction's normal
  /// forces are frozen, and its anchors move with the plates. Throws InputError, and
  /// ConvergenceError if the stiffness matrix is not positive definite.
  VectorFields Sensitivities(const std::vector<double>& x, const PlatePair& plates,
    const EquilibriumDerivatives& velocities);
  /// The gradient of a loss whose derivatives with respect to the nodes at the equilibrium `x` are
  /// `loss` (3 x nodeCount), by one back-substitution. The undeformed shape is taken for constant.
  /// Otherwise as Sensitivities.
  EquilibriumGradient Backward(const std::vector<double>& x, const PlatePair& plates,
    const std::vector<double>& loss, const std::vector<PlatePairVelocity>& motions);
  /// Derivative of the paddle's force, N per unit of a parameter that moves the plates by
  /// `velocity` and the nodes by `nodeVelocities` (from Sensitivities).
  double PaddleForceDerivative(const std::vector<double>& x, const PlatePair& plates,
    const PlatePairVelocity& velocity, const std::vector<double>& nodeVelocities);
  /// The velocities for one motion of the plates to first order, at the cost of one
  /// back-substitution: it uses the factor at hand without refinement if that belongs to positions
  /// within 2 mm.
  std::vector<double> TangentStep(const std::vector<double>& x, const PlatePair& plates,
    const PlatePairVelocity& motion);

  /// Largest memory of the factorisation so far, bytes.
  double PeakFactorBytes() const { return this->Newton.Factor().PeakBytes(); }

private:
  /// Solves with the stiffness matrix at `x` for `count` columns of unknowns.
  std::vector<double> SolveAt(const std::vector<double>& x, const std::vector<double>& right,
    std::size_t count);
  EquilibriumReport Report(const Evaluation& evaluation) const;

  EquilibriumEnergy Objective;
  NewtonSolver Newton;
};
}

#endif
