// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ProjectionSeries_h
#define mammoray_ProjectionSeries_h

#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayXRayModule.h"

#include <array>
#include <optional>
#include <vector>

namespace mammoray
{
/// A straight line. The direction may have any length except zero.
struct AxisLine
{
  Vector3 Point{ 0, 0, 0 };
  Vector3 Direction{ 0, 0, 1 };
};

/// One of a series of projections of the same mesh, in the frame of the mesh.
struct ProjectionView
{
  double AngleDeg = 0;
  XRaySource Source;
  XRayDetector Detector;
};

/**
 * Tomography: the sample turns about an axis in front of a fixed source and detector. View i is at
 * i / number of the span, so that a span of 360 degrees has no view twice. Angles are right-handed
 * about the axis' direction. The views are in the sample's frame, in which source and detector turn
 * the other way. Throws InputError unless number is positive, the span finite and the
 * direction not zero.
 */
MAMMORAYXRAY_EXPORT std::vector<ProjectionView> TurnSample(const XRaySource& source,
  const XRayDetector& detector, const AxisLine& axis, int number, double spanDeg);

/**
 * Tomosynthesis: a point source turns about an axis while sample and detector are fixed, in equal
 * steps from minus half the span to half the span, both included. A single projection is at 0.
 * Throws InputError as TurnSample, and for a parallel source.
 */
MAMMORAYXRAY_EXPORT std::vector<ProjectionView> SweepSource(const XRaySource& source,
  const XRayDetector& detector, const AxisLine& axis, int number, double spanDeg);

/**
 * The columns at which the axis' shadow crosses the first and the last row, measured from the
 * centre of column 0: the centre of rotation of a reconstruction. No value if the shadow is
 * parallel to the rows or is a point.
 */
MAMMORAYXRAY_EXPORT std::optional<std::array<double, 2>> ShadowOfAxis(const XRaySource& source,
  const XRayDetector& detector, const AxisLine& axis);
}

#endif
