// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_EquilibriumSolver_h
#define mammoray_EquilibriumSolver_h

#include "mammoray/Biomechanics/ChestWall.h"
#include "mammoray/Biomechanics/ElasticBody.h"
#include "mammoray/Biomechanics/PlateContact.h"
#include "mammoray/Biomechanics/PlateFriction.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayBiomechanicsModule.h"

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace mammoray
{
/// What is known of a set of node positions; see CompressionState for the meaning and the units.
struct EquilibriumReport
{
  bool Converged = false;
  int NewtonSteps = 0;
  /// Why it did not converge; empty when it did.
  std::string Reason;
  /// kPa mm^3; elastic and contact.
  double Energy = 0;
  double RelativeResidual = 0;
  double SupportForceN = 0;
  double PaddleForceN = 0;
  /// Tangential force of support and paddle on the body, N.
  std::array<Vector3, 2> FrictionN{};
  double LargestPenetrationMm = 0;
  double LargestWallLiftMm = 0;
  double LargestWallGlideMm = 0;
  double SmallestJ = 1;
  double LargestJ = 1;
  double VolumeRatio = 1;
};

/// Rate of change of what the body is held and loaded by with a parameter, per unit of it.
struct HoldingVelocity
{
  WallStiffness Wall;
  /// Of the coefficient of friction.
  double Friction = 0;
  /// Of the dead loads, 3 x nodeCount, kPa mm^2; empty: none.
  std::vector<double> Loads;
};

/**
 * Minimises the elastic energy of a body plus that of contact and friction with two plates, of the
 * chest wall's elastic layer and of dead loads over the coordinates that are not fixed, by Newton's
 * method with a sparse Cholesky factorisation.
 *
 * Contact: in front of each plate lies a layer of ContactLayerMm. A boundary point g > 0 deep in it
 * feels the pressure stiffness * g^2 as far as the plate and in the plate the tangent of that
 * parabola, on which Newton's method does not creep; the energy is C2. Points are the middles of 64
 * equal parts of every boundary triangle that has a free node.
 *
 * One solver is not to be used by two threads at a time; it uses all cores itself.
 */
class MAMMORAYBIOMECHANICS_EXPORT EquilibriumSolver
{
public:
  static constexpr double ContactLayerMm = 0.05;

  /// `fixed`: 3 x nodeCount flags. The body must outlive the solver. `contactStiffness`: kPa /
  /// mm^2. Cells flagged in `leftOut` (empty: none) are rigid and take no part.
  EquilibriumSolver(const ElasticBody& body, const std::vector<bool>& fixed,
    double contactStiffness, const std::vector<bool>& leftOut = {});
  ~EquilibriumSolver();

  std::size_t NumberOfUnknowns() const;
  /// To be called when the body's materials or its undeformed shape were changed.
  void BodyChanged();
  /// kPa / mm^2, positive; counts from the next call on.
  void SetContactStiffness(double stiffness);
  /// Forces that act whatever the deformation (dead loads), 3 x nodeCount, kPa mm^2; empty: none.
  void SetLoads(std::vector<double> loads);
  /// The body is held by this wall (null: by none), which must outlive its use; of this body.
  void SetWall(const ChestWall* wall, const WallStiffness& stiffness);
  /// Friction with the plates, its normal forces and anchors frozen; empty: none.
  void SetFriction(FrictionPoints points);
  const FrictionPoints& Friction() const;

  /// Where friction comes from: a state before, its anchors dragged to it.
  struct FrictionStart
  {
    FrictionPoints Dragged;
    std::vector<double> Positions;
    PlatePair Plates;
  };
  /**
   * Friction of this coefficient for the contact at `x`: points that touched in the state before
   * keep their anchors, others have theirs where they were then.
   */
  FrictionPoints FrictionAt(const std::vector<double>& x, const PlatePair& plates,
    double coefficient, const FrictionStart& before) const;
  /// `points` with their anchors dragged to the positions `x`.
  FrictionPoints DraggedTo(const std::vector<double>& x, const PlatePair& plates,
    FrictionPoints points) const;

  /**
   * From the positions `x` (3 x nodeCount, mm; no cell inverted; fixed coordinates keep their
   * values) to equilibrium between the plates (none: null). Stops when the norm of the residual
   * forces falls below `tolerance` times the largest of the norms of the forces of contact, of the
   * chest wall, of the dead loads and at fixed coordinates. After a step that was cut short or took
   * a stiffer matrix, the part of the body with the largest residual forces is relaxed alone; its
   * steps are not counted. `x` holds the last positions with all J > 0 when it fails.
   */
  EquilibriumReport Solve(std::vector<double>& x, const PlatePair* plates, double tolerance,
    int maximumSteps, const ProgressCallback& progress = {}) const;

  /// True where no cell is inverted.
  bool Admissible(const std::vector<double>& x) const;
  /**
   * The same from positions at which cells may be inverted, with the energy continued beyond J = 0
   * (ElasticBody::Domain), so that Newton's method turns them back. Where that succeeds `x` is
   * Admissible and near an equilibrium, though not one of the energy itself.
   */
  EquilibriumReport Untangle(std::vector<double>& x, const PlatePair* plates, double tolerance,
    int maximumSteps, const ProgressCallback& progress = {}) const;
  /// Energy, forces and limits of positions as they stand. Throws ConvergenceError when a cell is
  /// inverted.
  EquilibriumReport Evaluate(const std::vector<double>& x, const PlatePair* plates) const;

  /**
   * Forces of the residual, 3 x nodeCount, kPa mm^2: the gradient of the energy, fixed coordinates
   * too (there minus the force that holds the body).
   */
  std::vector<double> Gradient(const std::vector<double>& x, const PlatePair* plates) const;
  /// The derivative of Gradient along `direction` (3 x nodeCount), zero at fixed coordinates.
  std::vector<double> HessianProduct(const std::vector<double>& x, const PlatePair* plates,
    const std::vector<double>& direction) const;
  /// Pressure of the plates at each node, kPa: means around corners of the boundary, between them
  /// at the middles of sides, 0 inside the body.
  std::vector<double> ContactPressures(const std::vector<double>& x, const PlatePair& plates) const;

  /**
   * dx/dp of an equilibrium for parameters that move the plates, then for those that change the
   * materials, then what holds and loads the body; 3 x nodeCount each, zero at fixed coordinates.
   * Friction's normal forces and anchors stay as they are; its anchors move with the plates. The
   * factor of the last Newton step is refined to this state's own matrix when that is near, or made
   * anew. Throws ConvergenceError where that matrix is not positive definite.
   */
  std::vector<std::vector<double>> Sensitivities(const std::vector<double>& x,
    const PlatePair& plates, const std::vector<PlatePairVelocity>& velocities,
    const std::vector<MaterialVelocity>& materialVelocities = {},
    const std::vector<HoldingVelocity>& holdingVelocities = {}) const;

  /// Rate of the paddle's force with a parameter that moves the plates by `velocity` and the nodes
  /// by `nodeVelocities` (of Sensitivities), N per unit.
  double PaddleForceRate(const std::vector<double>& x, const PlatePair& plates,
    const PlatePairVelocity& velocity, const std::vector<double>& nodeVelocities) const;

  /**
   * The same as Sensitivities for one motion of the plates, to first order only and at the price of
   * one back-substitution: by the factor at hand as it is, when it belongs to positions within 2
   * mm.
   */
  std::vector<double> Predict(const std::vector<double>& x, const PlatePair& plates,
    const PlatePairVelocity& motion) const;

  /// Smallest distance each plate must move against its normal for its layer to touch nothing, mm;
  /// support, paddle.
  std::array<double, 2> Opening(const std::vector<double>& x, const PlatePair& plates) const;

  /// Most memory that the factorisation has taken so far, bytes.
  double PeakFactorBytes() const;

private:
  struct Internals;
  std::unique_ptr<Internals> Internal;
};
}

#endif
