// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Testing_DescribedProjection_h
#define mammoray_Testing_DescribedProjection_h

#include "mammoray/IO/MammogramSynthesis.h"

namespace mammoray::test
{
/// A unit at this roll around a breast in LPS; columns of 0.2 mm and rows of 0.3 mm.
inline Mammogram Describe(double rollDeg, char laterality, int columns = 7, int rows = 5)
{
  const AnatomicalAxes axes;
  const VolumeFromGantry gantry =
    PlaceUnit({ axes, { 10, -20, 30 } }, { .SourceToDetectorMm = 660 }, { .RollDeg = rollDeg });
  XRaySource source;
  source.Position = gantry.Point({ 0, 0, 660 });
  XRayDetector detector;
  detector.Columns = columns;
  detector.Rows = rows;
  detector.Origin = gantry.Point({ 40, 1, 0 });
  detector.ColumnStep = 0.2 * gantry.Y;
  detector.RowStep = -0.3 * gantry.X;
  return DescribeProjection(source, detector, axes, laterality);
}
}

#endif
