// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_EquilibriumReport_h
#define mammoray_EquilibriumReport_h

#include "mammoray/Foundation/Vector3.h"

#include <array>
#include <string>

namespace mammoray
{
/// Measures of a set of node positions. CompressionState states meaning and units.
struct EquilibriumReport
{
  bool Converged = false;
  int NewtonSteps = 0;
  /// The reason for a failure; empty if the solver converged.
  std::string Reason;
  /// The potential energy, kPa mm^3.
  double Energy = 0;
  double RelativeResidual = 0;
  double SupportForceN = 0;
  double PaddleForceN = 0;
  /// Tangential force of support and of paddle on the body, N.
  std::array<Vector3, 2> FrictionN{};
  double LargestPenetrationMm = 0;
  double LargestWallLiftMm = 0;
  double LargestWallGlideMm = 0;
  double SmallestJ = 1;
  double LargestJ = 1;
  double VolumeRatio = 1;
};
}

#endif
