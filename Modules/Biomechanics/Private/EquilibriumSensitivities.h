// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_EquilibriumSensitivities_h
#define mammoray_EquilibriumSensitivities_h

#include "Private/EquilibriumEnergy.h"
#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Foundation/Meshes.h"

#include <vector>

namespace mammoray
{
/// Derivative of attachment, friction and loads with respect to a parameter, per unit of it.
struct SupportDerivative
{
  WallStiffness Wall;
  /// Derivative of the coefficient of friction.
  double Friction = 0;
  /// Derivatives of the dead loads, 3 x nodeCount, kPa mm^2; empty if they are zero.
  std::vector<double> Loads;
};

/// Velocity of the undeformed shape with respect to a parameter, per unit of it.
struct StressFreeVelocity
{
  /// Velocities of the undeformed positions, 3 x nodeCount, mm; empty if they are zero.
  std::vector<double> Positions;
  /// The resulting derivatives of the dead loads, 3 x nodeCount, kPa mm^2; empty if they are zero.
  std::vector<double> Loads;
};

/// Derivatives of a number, the loss, with respect to what an equilibrium depends on.
struct EquilibriumGradient
{
  /// With respect to a relative change of the stiffness of each cell, and of each material.
  std::vector<double> Cells;
  std::vector<double> Materials;
  /// With respect to parameters that move the plates, per unit of them.
  std::vector<double> Plates;
};

/// Derivatives that define the parameters of an equilibrium: first those that move the plates, then
/// those that change the materials, then those that change attachment and loads.
struct EquilibriumDerivatives
{
  std::vector<PlatePairVelocity> Plates;
  std::vector<MaterialDerivative> Materials;
  std::vector<SupportDerivative> Support;
  /// Velocities of the undeformed shape for each parameter of Materials, then of Support; empty if
  /// it is fixed.
  std::vector<StressFreeVelocity> Rest;
};

/// The scalar products of - d gradient / dp with a vector at the unknowns, where p is a relative
/// change of the stiffness of a cell; one per cell of the body, 0 for cells that cannot move.
std::vector<double> StiffnessProducts(const EquilibriumEnergy& energy, const std::vector<double>& x,
  const std::vector<double>& vector);

/// - d gradient / dp at the unknowns, one column per parameter, for parameters of the materials, of
///   attachment and loads, and of the plates.
std::vector<double> MaterialForces(const EquilibriumEnergy& energy, const std::vector<double>& x,
  const std::vector<MaterialDerivative>& velocities);
std::vector<double> SupportForces(const EquilibriumEnergy& energy, const std::vector<double>& x,
  const std::vector<SupportDerivative>& velocities);
std::vector<double> PlateForces(const EquilibriumEnergy& energy, const std::vector<double>& x,
  const std::vector<PlatePairVelocity>& velocities);
}

#endif
