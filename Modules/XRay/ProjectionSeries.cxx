// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/ProjectionSeries.h"

#include "mammoray/Foundation/Error.h"

#include <cmath>
#include <numbers>
#include <string>

namespace mammoray
{
namespace
{
/// Right-handed about a line, by Rodrigues' formula.
struct Turn
{
  Turn(const AxisLine& line, double degrees)
    : Centre(line.Point)
    , Axis((1 / Norm(line.Direction)) * line.Direction)
    , Cosine(std::cos(degrees * std::numbers::pi / 180))
    , Sine(std::sin(degrees * std::numbers::pi / 180))
  {
  }

  Vector3 Direction(const Vector3& vector) const
  {
    return this->Cosine * vector + this->Sine * Cross(this->Axis, vector) +
      ((1 - this->Cosine) * Dot(this->Axis, vector)) * this->Axis;
  }
  Vector3 Point(const Vector3& point) const
  {
    return this->Centre + this->Direction(point - this->Centre);
  }

  Vector3 Centre;
  Vector3 Axis;
  double Cosine;
  double Sine;
};

void Check(const AxisLine& axis, int number, double spanDeg)
{
  if (number < 1)
  {
    throw InputError(
      "projections: expected a number of at least 1, found " + std::to_string(number));
  }
  if (!std::isfinite(spanDeg))
  {
    throw InputError("projections: expected a finite span");
  }
  const double length = Norm(axis.Direction);
  if (!(length > 0) || !std::isfinite(length))
  {
    throw InputError("axis: expected a direction, found a vector without length");
  }
}
}

std::vector<ProjectionView> TurnSample(const XRaySource& source, const XRayDetector& detector,
  const AxisLine& axis, int number, double spanDeg)
{
  Check(axis, number, spanDeg);
  std::vector<ProjectionView> views;
  for (int index = 0; index < number; ++index)
  {
    ProjectionView& view =
      views.emplace_back(ProjectionView{ spanDeg * index / number, source, detector });
    const Turn back(axis, -view.AngleDeg);
    view.Source.Position = back.Point(source.Position);
    view.Source.Direction = back.Direction(source.Direction);
    view.Detector.Origin = back.Point(detector.Origin);
    view.Detector.ColumnStep = back.Direction(detector.ColumnStep);
    view.Detector.RowStep = back.Direction(detector.RowStep);
  }
  return views;
}

std::vector<ProjectionView> SweepSource(const XRaySource& source, const XRayDetector& detector,
  const AxisLine& axis, int number, double spanDeg)
{
  Check(axis, number, spanDeg);
  if (source.Type != XRaySource::Kind::Point)
  {
    throw InputError("tomosynthesis: expected a point source, found a parallel beam");
  }
  std::vector<ProjectionView> views;
  for (int index = 0; index < number; ++index)
  {
    const double part = number > 1 ? static_cast<double>(index) / (number - 1) - 0.5 : 0.0;
    ProjectionView& view = views.emplace_back(ProjectionView{ spanDeg * part, source, detector });
    view.Source.Position = Turn(axis, view.AngleDeg).Point(source.Position);
  }
  return views;
}

std::optional<std::array<double, 2>> ShadowOfAxis(const XRaySource& source,
  const XRayDetector& detector, const AxisLine& axis)
{
  // The shadow is where the plane of the axis and the source (the beam) cuts the detector.
  const Vector3 normal = Cross(axis.Direction,
    source.Type == XRaySource::Kind::Point ? axis.Point - source.Position : source.Direction);
  const double perColumn = Dot(normal, detector.ColumnStep);
  const double perRow = Dot(normal, detector.RowStep);
  const double offset = Dot(normal, detector.Origin - axis.Point);
  if (!(std::abs(perColumn) > 1e-9 * Norm(normal) * Norm(detector.ColumnStep)))
  {
    return std::nullopt;
  }
  return std::array<double, 2>{ -offset / perColumn,
    -(offset + (detector.Rows - 1) * perRow) / perColumn };
}
}
