// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_TargetImage_h
#define mammoray_TargetImage_h

#include "mammoray/Registration/RegistrationTarget.h"
#include "mammoray/Registration/Silhouette.h"
#include "mammorayRegistrationModule.h"

#include <vector>

namespace mammoray
{
/// Throws InputError unless the target's arrays fit its size, it holds a breast and its grid is
/// regular.
MAMMORAYREGISTRATION_EXPORT void ValidateTarget(const RegistrationTarget& target);

/**
 * The target with factor x factor pixels averaged into one (rest at the far borders dropped). A
 * coarse pixel is breast when all of its pixels are, and excluded when one of them is. Signed
 * distances are averaged.
 */
MAMMORAYREGISTRATION_EXPORT RegistrationTarget Coarsen(const RegistrationTarget& target,
  int factor);

/// The target in pixels of about `pixelSizeMm`, no smaller than its own.
MAMMORAYREGISTRATION_EXPORT RegistrationTarget CoarsenTo(const RegistrationTarget& target,
  double pixelSizeMm);

/// Gantry x, y of a continuous pixel position (pixel centres at whole numbers).
MAMMORAYREGISTRATION_EXPORT ReceptorPoint PixelPosition(const RegistrationTarget& target,
  double column, double row);

/// The continuous column and row of a point: the inverse of PixelPosition.
MAMMORAYREGISTRATION_EXPORT std::array<double, 2> PixelOf(const RegistrationTarget& target,
  const ReceptorPoint& point);

/**
 * Signed distance, mm, at a receptor point: bilinear between pixels; outside the image the value at
 * the nearest border pixel plus the distance to it.
 */
MAMMORAYREGISTRATION_EXPORT double SignedDistanceAt(const RegistrationTarget& target,
  const ReceptorPoint& point);

/// Its gradient, without unit, where it has one (not on the lines between pixels).
MAMMORAYREGISTRATION_EXPORT ReceptorPoint SignedDistanceGradient(const RegistrationTarget& target,
  const ReceptorPoint& point);

/// True inside the image, at least `marginMm` away from its borders.
MAMMORAYREGISTRATION_EXPORT bool Contains(const RegistrationTarget& target,
  const ReceptorPoint& point, double marginMm);

/// Middle of the breast mask across, on the receptor's chest-wall edge: (x, 0). Throws InputError
/// on an empty mask.
MAMMORAYREGISTRATION_EXPORT ReceptorPoint ChestWallCentre(const RegistrationTarget& target);
}

#endif
