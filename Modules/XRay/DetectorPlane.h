// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DetectorPlane_h
#define mammoray_DetectorPlane_h

#include "mammoray/Foundation/Vector3.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include <limits>

namespace mammoray
{
/// The position of a source relative to the plane of a detector with linearly independent steps.
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

  /// Unit normal of the plane, on the side of the source.
  Vector3 Normal{ 0, 0, 1 };
  /// Distance of a point source from the plane, mm; infinite for a parallel beam.
  double HeightMm = std::numeric_limits<double>::infinity();
  /// Foot of the perpendicular from a point source, pixels from the centre of column 0 and row 0.
  double FootColumn = 0;
  double FootRow = 0;
};
}

#endif
