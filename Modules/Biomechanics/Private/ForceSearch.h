// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ForceSearch_h
#define mammoray_ForceSearch_h

#include "mammoray/Biomechanics/CompressionSimulation.h"

namespace mammoray
{
/**
 * The state in which the paddle presses with `forceN`: see CompressionSimulation::CompressToForce,
 * whose arguments these are. `rubs`: whether the simulation has friction.
 */
CompressionState FindForce(const CompressionSimulation& simulation, bool rubs,
  const PlatePair& plates, const PlatePairVelocity& closing, double forceN,
  const ProgressCallback& progress);
}

#endif
