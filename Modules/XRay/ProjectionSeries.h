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
/// A straight line; the direction has any length but zero.
struct AxisLine
{
  Vector3 Point{ 0, 0, 0 };
  Vector3 Direction{ 0, 0, 1 };
};

/// One of a series of projections of the same mesh; in the mesh's frame.
struct ProjectionView
{
  double AngleDeg = 0;
  XRaySource Source;
  XRayDetector Detector;
};

/**
 * Tomography: the sample turns about an axis before a source and a detector that stand still, to i
 * / number of the span for i from 0 on, so that 360 degrees repeat nothing. Angles are right-handed
 * about the axis' direction. In the sample's frame, which the views are of, source and detector
 * turn the other way. Throws InputError unless number is positive, the span finite and the
 * direction not zero.
 */
MAMMORAYXRAY_EXPORT std::vector<ProjectionView> TurnSample(const XRaySource& source,
  const XRayDetector& detector, const AxisLine& axis, int number, double spanDeg);

/**
 * Tomosynthesis: a point source goes about an axis while sample and detector stand still, in equal
 * steps from minus half the span to half of it, both included; one projection is at 0. Throws
 * InputError as TurnSample, and of a parallel source.
 */
MAMMORAYXRAY_EXPORT std::vector<ProjectionView> SweepSource(const XRaySource& source,
  const XRayDetector& detector, const AxisLine& axis, int number, double spanDeg);

/**
 * The columns at which the axis' shadow crosses the first and the last row, counted from the centre
 * of column 0; what a reconstruction calls the centre of rotation. Nothing where the shadow runs
 * along the rows or is a point.
 */
MAMMORAYXRAY_EXPORT std::optional<std::array<double, 2>> ShadowOfAxis(const XRaySource& source,
  const XRayDetector& detector, const AxisLine& axis);
}

#endif
