// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_EquilibriumSensitivities_h
#define mammoray_EquilibriumSensitivities_h

#include "Private/EquilibriumEnergy.h"
#include "Private/NewtonSolver.h"
#include "mammoray/Biomechanics/ElasticMaterial.h"
#include "mammoray/Biomechanics/Plates.h"
#include "mammoray/Biomechanics/WallAttachment.h"

#include <vector>

namespace mammoray
{
/// Rate of change of what the body is held and loaded by with a parameter, per unit of it.
struct HoldingVelocity
{
  WallStiffness Wall;
  /// Rate of the coefficient of friction.
  double Friction = 0;
  /// Rates of the dead loads, 3 x nodeCount, kPa mm^2; empty: none.
  std::vector<double> Loads;
};

/// Rate of change of the undeformed shape with a parameter, per unit of it.
struct RestVelocity
{
  /// 3 x nodeCount, mm; empty: none.
  std::vector<double> Positions;
  /// What this does to the dead loads, 3 x nodeCount, kPa mm^2; empty: nothing.
  std::vector<double> Loads;
};

/// Parameters of an equilibrium: those that move the plates, those that change the materials, those
/// that change what holds and loads the body.
struct EquilibriumVelocities
{
  std::vector<PlatePairVelocity> Plates;
  std::vector<MaterialVelocity> Materials;
  std::vector<HoldingVelocity> Holding;
  /// How the undeformed shape changes along with the materials, then with what holds and loads, one
  /// for each of both; empty: not at all.
  std::vector<RestVelocity> Rest;
};

/// - d Gradient / dp at the unknowns, one column for each velocity, for parameters of the
/// materials, of what holds and loads the body, and for those that move the plates.
std::vector<double> MaterialForces(const EquilibriumEnergy& energy, const std::vector<double>& x,
  const std::vector<MaterialVelocity>& velocities);
std::vector<double> HoldingForces(const EquilibriumEnergy& energy, const std::vector<double>& x,
  const std::vector<HoldingVelocity>& velocities);
std::vector<double> PlateForces(const EquilibriumEnergy& energy, const std::vector<double>& x,
  const std::vector<PlatePairVelocity>& velocities);

/**
 * dx/dp by the implicit function theorem at the equilibrium `x` of `energy`, 3 x nodeCount for each
 * velocity, zero at fixed coordinates: one back-substitution each, by the factor at hand, refined,
 * or a new one. Throws InputError, and ConvergenceError where the energy's second derivative is not
 * positive definite.
 */
std::vector<std::vector<double>> EquilibriumSensitivities(const EquilibriumEnergy& energy,
  NewtonSolver& newton, const std::vector<double>& x, const EquilibriumVelocities& velocities);

/// Rate of the paddle's force with a parameter that moves the plates by `velocity` and the nodes by
/// `nodeVelocities`, N per unit.
double PaddleForceRateOf(const EquilibriumEnergy& energy, const std::vector<double>& x,
  const PlatePairVelocity& velocity, const std::vector<double>& nodeVelocities);
}

#endif
