// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_EquilibriumReport_h
#define mammoray_EquilibriumReport_h

#include "mammoray/Biomechanics/CompressionSimulation.h"

#include <array>
#include <string>

namespace mammoray
{
struct EquilibriumReport : EquilibriumMeasures
{
  bool Converged = false;
  int NewtonSteps = 0;
  /// The reason for a failure; empty if the solver converged.
  std::string Reason;
  /// The potential energy, kPa mm^3.
  double Energy = 0;
  /// Tangential force of support and of paddle on the body, N.
  std::array<Vector3, 2> FrictionN{};
};
}

#endif
