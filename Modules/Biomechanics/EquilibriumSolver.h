// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_EquilibriumSolver_h
#define mammoray_EquilibriumSolver_h

#include "ElasticBody.h"
#include "PlateContact.h"
#include "Progress.h"
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
  double LargestPenetrationMm = 0;
  double SmallestJ = 1;
  double LargestJ = 1;
  double VolumeRatio = 1;
};

/**
 * Minimises the elastic energy of a body plus that of frictionless contact with two plates over the
 * coordinates that are not fixed, by Newton's method with a sparse Cholesky factorisation.
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
  /// mm^2.
  EquilibriumSolver(const ElasticBody& body, const std::vector<bool>& fixed,
    double contactStiffness);
  ~EquilibriumSolver();

  std::size_t NumberOfUnknowns() const;
  /// To be called when the body's materials were changed.
  void MaterialsChanged();
  /// kPa / mm^2, positive; counts from the next call on.
  void SetContactStiffness(double stiffness);
  /// Forces that act whatever the deformation (dead loads), 3 x nodeCount, kPa mm^2; empty: none.
  void SetLoads(std::vector<double> loads);

  /**
   * From the positions `x` (3 x nodeCount, mm; no cell inverted; fixed coordinates keep their
   * values) to equilibrium between the plates (none: null). Stops when the norm of the residual
   * forces falls below `tolerance` times the larger of the norms of the contact forces and of the
   * forces at fixed coordinates. `x` holds the last positions with all J > 0 when it fails.
   */
  EquilibriumReport Solve(std::vector<double>& x, const PlatePair* plates, double tolerance,
    int maximumSteps, const ProgressCallback& progress = {}) const;

  /// True where no cell is inverted.
  bool Admissible(const std::vector<double>& x) const;
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

  /**
   * dx/dp of an equilibrium for parameters that move the plates, then for those that change the
   * materials; 3 x nodeCount each, zero at fixed coordinates. The factor of the last Newton step is
   * refined to this state's own matrix when that is near, or made anew. Throws ConvergenceError
   * where that matrix is not positive definite.
   */
  std::vector<std::vector<double>> Sensitivities(const std::vector<double>& x,
    const PlatePair& plates, const std::vector<PlatePairVelocity>& velocities,
    const std::vector<MaterialVelocity>& materialVelocities = {}) const;

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

private:
  struct Internals;
  std::unique_ptr<Internals> Internal;
};
}

#endif
