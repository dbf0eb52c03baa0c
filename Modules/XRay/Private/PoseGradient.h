// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PoseGradient_h
#define mammoray_PoseGradient_h

#include "mammoray/XRay/PathLengthProjector.h"

#include <vector>

namespace mammoray
{
/// The gradient of a loss with respect to where source and detector are.
struct PoseGradient
{
  /// With respect to the position of a point source, or the direction of a parallel beam.
  Vector3 Source{ 0, 0, 0 };
  Vector3 Origin{ 0, 0, 0 };
  Vector3 ColumnStep{ 0, 0, 0 };
  Vector3 RowStep{ 0, 0, 0 };
};

/**
 * The pose's gradient from that of the points. A ray that moves by v where it hits a triangle
 * changes the hit as the triangle's motion by -v does. With the share tau of the way from the
 * source S to the pixel P, v = (1 - tau) dS + tau dP. For a flat detector tau, and tau times the
 * pixel's column or row, are affine functions of the hit x, so that sums over hits follow from the
 * sums of (gradient of a point) (x, 1) over all points. The rays' own lengths add (L / |P - S|)
 * d(|P - S|).
 *
 * `points`: 3 x pointCount, of which `gradient` is that of PathLengthProjector::Backward for these
 * losses; `image`: path lengths for the same source and detector, which has one sample per pixel.
 */
PoseGradient PoseGradientOf(const std::vector<double>& points, const std::vector<double>& gradient,
  const XRaySource& source, const XRayDetector& detector, const PathLengthImage& image,
  const std::vector<float>& lossByLength);
}

#endif
