// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DetectorPlane_h
#define mammoray_DetectorPlane_h

#include "mammoray/Foundation/Vector3.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include <limits>

namespace mammoray
{
/// How a source stands over the plane of a detector, whose steps are independent.
struct DetectorPlane
{
  DetectorPlane(const XRaySource& source, const XRayDetector& detector)
  {
    const Vector3 across = Cross(detector.ColumnStep, detector.RowStep);
    const double area = Norm(across);
    const bool isPoint = source.Type == XRaySource::Kind::Point;
    const Vector3 way = source.Position - detector.Origin;
    const double above = isPoint ? Dot(way, across) : -Dot(source.Direction, across);
    this->Normal = ((above < 0 ? -1 : 1) / area) * across;
    if (isPoint)
    {
      this->HeightMm = Dot(way, this->Normal);
      this->FootColumn = Dot(Cross(way, detector.RowStep), across) / (area * area);
      this->FootRow = Dot(Cross(detector.ColumnStep, way), across) / (area * area);
    }
  }

  /// Of length 1, towards where the rays come from.
  Vector3 Normal{ 0, 0, 1 };
  /// Of a point source over the plane, mm.
  double HeightMm = std::numeric_limits<double>::infinity();
  /// Where the ray of a point source meets the plane at right angles, in pixels from the middle of
  /// the first one.
  double FootColumn = 0;
  double FootRow = 0;
};
}

#endif
