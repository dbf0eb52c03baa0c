// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SeriesOptions_h
#define mammoray_SeriesOptions_h

#include "OptionList.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/XRay/ProjectionSeries.h"

#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// Options of 'mammoray project' that ask for more than one projection.
struct SeriesArguments
{
  int Turn = 0;
  int Tomosynthesis = 0;
  std::optional<double> SpanDeg;
  std::vector<std::string> Axis;
  std::optional<Vector3> AxisPoint;
  double PivotHeightMm = 0;
  int FlatFields = 0;

  bool IsAsked() const { return this->Turn > 0 || this->Tomosynthesis > 0; }
  int Number() const { return this->Turn > 0 ? this->Turn : this->Tomosynthesis; }
};

void DeclareSeries(const OptionList& add, SeriesArguments& arguments);

/// Refuses options that do not go together, and outputs that cannot hold a series.
void CheckSeries(const SeriesArguments& arguments, const std::string& output);

/// What stands beside a stack: "scan.tif" has "scan.json" and "scan_flat.tif".
std::string SeriesDescriptionPath(const std::string& output);
std::string FlatFieldPath(const std::string& output);

/// A series' places, and the axis they go about.
struct ProjectionSeries
{
  AxisLine Axis;
  std::vector<ProjectionView> Views;
};

/**
 * The places of an unturned source and detector. `middle`: of the mesh, which a turned sample's
 * axis goes through where no other point is given; `gantry`: of the unit, about whose y axis a
 * source is swept. Throws InputError.
 */
ProjectionSeries MakeSeries(const SeriesArguments& arguments, const XRaySource& source,
  const XRayDetector& detector, const Vector3& middle, const VolumeFromGantry& gantry);

/// JSON with the angles, the place of source and detector of each projection and the axis, and
/// where its shadow is; mm, degrees, frame of the mesh.
std::string DescribeSeries(const SeriesArguments& arguments, const ProjectionSeries& series,
  const XRaySource& source, const XRayDetector& detector);
}

#endif
