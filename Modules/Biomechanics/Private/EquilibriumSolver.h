// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_EquilibriumSolver_h
#define mammoray_EquilibriumSolver_h

#include "Private/EquilibriumEnergy.h"
#include "Private/EquilibriumReport.h"
#include "Private/EquilibriumSensitivities.h"
#include "Private/NewtonSolver.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayBiomechanicsModule.h"

#include <array>
#include <vector>

namespace mammoray
{
/**
 * Equilibria of a body between two plates as minima of its EquilibriumEnergy, found by
 * NewtonSolver, and their derivatives. Plates are given with each call; everything else stays until
 * it is set again. One thread at a time; it uses all cores itself.
 */
class MAMMORAYBIOMECHANICS_EXPORT EquilibriumSolver
{
public:
  /// `fixed`: 3 x nodeCount flags. The body must outlive the solver. `contactStiffness`: kPa /
  /// mm^2. Cells flagged in `leftOut` (empty: none) are rigid and take no part.
  EquilibriumSolver(const ElasticBody& body, const std::vector<bool>& fixed,
    double contactStiffness, const std::vector<bool>& leftOut = {});

  std::size_t NumberOfUnknowns() const { return this->Energy.Part().NumberOfUnknowns(); }
  /// To be called when the body's materials or its undeformed shape were changed.
  void BodyChanged();
  /// kPa / mm^2, positive; counts from the next call on.
  void SetContactStiffness(double stiffness) { this->Energy.SetContactStiffness(stiffness); }
  /// Forces that act whatever the deformation (dead loads), 3 x nodeCount, kPa mm^2; empty: none.
  void SetLoads(std::vector<double> loads) { this->Energy.SetLoads(std::move(loads)); }
  /// What attaches the body to the chest wall (null: nothing); must outlive its use; of this body.
  void SetAttachment(const AttachmentEnergy* attachment);
  /// Friction with the plates, its normal forces and anchors frozen; empty: none.
  void SetFriction(FrictionPoints points) { this->Energy.SetFriction(std::move(points)); }
  const FrictionPoints& Friction() const { return this->Energy.Friction().Points(); }
  /// Friction of this coefficient for the contact at `x` (FrictionOfContact).
  FrictionPoints FrictionAt(const std::vector<double>& x, const PlatePair& plates,
    double coefficient, const FrictionStart& before) const;

  /**
   * From the positions `x` (3 x nodeCount, mm; no cell inverted; fixed coordinates keep their
   * values) to equilibrium between the plates (none: null). Stops when the norm of the residual
   * forces falls below `tolerance` times the largest of the norms of the forces of contact, of the
   * chest wall, of the dead loads and at fixed coordinates. `x` holds the last positions with all
   * J > 0 when it fails.
   */
  EquilibriumReport Solve(std::vector<double>& x, const PlatePair* plates, double tolerance,
    int maximumSteps, const ProgressCallback& progress = {});

  /// True where the energy without plates is defined and its second derivative positive definite.
  bool IsStable(const std::vector<double>& x);
  /// True where no cell is inverted.
  bool Admissible(const std::vector<double>& x);
  /**
   * Solves from positions at which cells may be inverted, with the energy continued beyond J = 0
   * (ElasticEnergy::Domain), so that Newton's method turns them back. Where that succeeds `x` is
   * Admissible and near an equilibrium, though not one of the energy itself.
   */
  EquilibriumReport Untangle(std::vector<double>& x, const PlatePair* plates, double tolerance,
    int maximumSteps, const ProgressCallback& progress = {});
  /// Energy, forces and limits of positions as they stand. Throws ConvergenceError when a cell is
  /// inverted; so do the next two.
  EquilibriumReport Evaluate(const std::vector<double>& x, const PlatePair* plates);
  /**
   * Forces of the residual, 3 x nodeCount, kPa mm^2: the gradient of the energy, fixed coordinates
   * too (there minus the force that holds the body).
   */
  std::vector<double> Gradient(const std::vector<double>& x, const PlatePair* plates);
  /// The derivative of Gradient along `direction` (3 x nodeCount), zero at fixed coordinates.
  std::vector<double> HessianProduct(const std::vector<double>& x, const PlatePair* plates,
    const std::vector<double>& direction);
  /// Pressure of the plates at each node, kPa: means around corners of the boundary, between them
  /// at the middles of sides, 0 inside the body.
  std::vector<double> ContactPressures(const std::vector<double>& x, const PlatePair& plates);

  /**
   * dx/dp of an equilibrium for parameters that move the plates, then for those that change the
   * materials, then what holds and loads the body; 3 x nodeCount each, zero at fixed coordinates.
   * Friction's normal forces and anchors stay as they are; its anchors move with the plates. Throws
   * ConvergenceError where the stiffness matrix is not positive definite.
   */
  std::vector<std::vector<double>> Sensitivities(const std::vector<double>& x,
    const PlatePair& plates, const EquilibriumVelocities& velocities);
  /// Rate of the paddle's force with a parameter that moves the plates by `velocity` and the nodes
  /// by `nodeVelocities` (of Sensitivities), N per unit.
  double PaddleForceRate(const std::vector<double>& x, const PlatePair& plates,
    const PlatePairVelocity& velocity, const std::vector<double>& nodeVelocities);
  /**
   * The same as Sensitivities for one motion of the plates, to first order only and at the price of
   * one back-substitution: by the factor at hand as it is, when it belongs to positions within 2
   * mm.
   */
  std::vector<double> TangentStep(const std::vector<double>& x, const PlatePair& plates,
    const PlatePairVelocity& motion);

  /// Smallest distance each plate must move against its normal for its layer to touch nothing, mm;
  /// support, paddle.
  std::array<double, 2> Opening(const std::vector<double>& x, const PlatePair& plates) const
  {
    return this->Energy.Contact().Opening(x, plates);
  }
  /// Most memory that the factorisation has taken so far, bytes.
  double PeakFactorBytes() const { return this->Newton.Factor().PeakBytes(); }

private:
  EquilibriumReport Minimize(std::vector<double>& x, double tolerance, int maximumSteps,
    const ProgressCallback& progress);
  Evaluation EvaluateAt(const std::vector<double>& x, const PlatePair* plates, EnergyOrder order);
  EquilibriumReport Report(const Evaluation& evaluation) const;

  EquilibriumEnergy Energy;
  NewtonSolver Newton;
};
}

#endif
