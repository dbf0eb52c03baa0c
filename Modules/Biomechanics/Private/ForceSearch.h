// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ForceSearch_h
#define mammoray_ForceSearch_h

#include "mammoray/Biomechanics/CompressionSimulation.h"

namespace mammoray
{
/// Implements CompressionSimulation::CompressToForce, which documents the arguments. `hasFriction`
/// is true if the simulation has friction.
CompressionState FindForce(CompressionSimulation& simulation, bool hasFriction,
  const PlatePair& plates, const PlatePairVelocity& closing, double forceN,
  const ProgressCallback& progress);
}

#endif
