// SPDX-License-Identifier: Apache-2.0
// Checks of a projector's input, before the device is used.
#ifndef mammoray_ProjectionChecks_h
#define mammoray_ProjectionChecks_h

#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayXRayModule.h"

#include <cstddef>
#include <vector>

namespace mammoray
{
/// Throws InputError on a degenerate detector, or a source from which it cannot be seen.
MAMMORAYXRAY_EXPORT void CheckGeometry(const XRaySource& source, const XRayDetector& detector);

/// Throws InputError unless there are coordinates up to 1e12 mm for `pointCount` points.
MAMMORAYXRAY_EXPORT void CheckPoints(const std::vector<double>& points, std::size_t pointCount);

/// Throws InputError unless there are velocities up to 1e12 mm per unit of `pointCount` points in 1
/// field or more.
MAMMORAYXRAY_EXPORT void CheckVelocities(const VectorFields& velocities, std::size_t pointCount);

/// The largest magnitude of the losses of materials other than air. Throws InputError unless there
/// is a finite one for each pixel and material.
MAMMORAYXRAY_EXPORT double LargestLoss(const std::vector<float>& lossByLength, std::size_t pixels,
  std::size_t materials);
}

#endif
