// SPDX-License-Identifier: Apache-2.0
#include "Private/ProjectionChecks.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/ParallelFor.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace mammoray
{
namespace
{
/// Number of values that one core checks in a tenth of a millisecond.
constexpr std::size_t ValuesAtOnce = 1u << 17;

/// Beyond these, doubles do not distinguish neighbouring pixels and the device's floats overflow.
constexpr double MostMm = 1e12;
constexpr double LeastStepMm = 1e-9;
/// Bounds of a direction's length, whose square is computed.
constexpr double LeastLength = 1e-100;
constexpr double MostLength = 1e100;

/// True if all coordinates (mm) are in the usable range; false for NaN.
bool IsWithinReach(const Vector3& vector)
{
  return std::abs(vector[0]) <= MostMm && std::abs(vector[1]) <= MostMm &&
    std::abs(vector[2]) <= MostMm;
}

bool IsStep(const Vector3& step)
{
  return IsWithinReach(step) && Norm(step) >= LeastStepMm;
}

std::string Text(const Vector3& vector)
{
  return "(" + NumberText(vector[0]) + ", " + NumberText(vector[1]) + ", " + NumberText(vector[2]) +
    ")";
}
}

void CheckGeometry(const XRaySource& source, const XRayDetector& detector)
{
  if (detector.Columns < 1 || detector.Rows < 1 || detector.Columns > 65535 ||
    detector.Rows > 65535)
  {
    throw InputError("detector: expected 1 to 65535 columns and rows, found " +
      std::to_string(detector.Columns) + " x " + std::to_string(detector.Rows));
  }
  if (detector.Samples < 1 || detector.Samples > 16)
  {
    throw InputError(
      "detector: expected 1 to 16 samples, found " + std::to_string(detector.Samples));
  }
  const Vector3 normal = Cross(detector.ColumnStep, detector.RowStep);
  const double area = Norm(normal);
  if (!IsWithinReach(detector.Origin) || !IsStep(detector.ColumnStep) ||
    !IsStep(detector.RowStep) ||
    !(area > 1e-9 * Norm(detector.ColumnStep) * Norm(detector.RowStep)))
  {
    throw InputError(
      "detector: expected coordinates up to 1e12 mm and steps from 1e-9 to 1e12 mm that span a "
      "plane, found origin " +
      Text(detector.Origin) + ", column step " + Text(detector.ColumnStep) + ", row step " +
      Text(detector.RowStep) + " mm");
  }
  if (source.Type == XRaySource::Kind::Point)
  {
    const double distance = Dot(source.Position - detector.Origin, normal) / area;
    const double step = std::max(Norm(detector.ColumnStep), Norm(detector.RowStep));
    if (!IsWithinReach(source.Position) || !(std::abs(distance) > 1e-6 * step))
    {
      throw InputError(
        "source: expected a position within 1e12 mm off the detector's plane, found " +
        Text(source.Position) + " mm");
    }
  }
  else
  {
    const double length = Norm(source.Direction);
    if (!(length >= LeastLength && length <= MostLength) ||
      !(std::abs(Dot(source.Direction, normal)) > 1e-9 * length * area))
    {
      throw InputError("source: expected a direction of a length from 1e-100 to 1e100 that crosses "
                       "the detector's plane, found " +
        Text(source.Direction));
    }
  }
}

void CheckPoints(const std::vector<double>& points, std::size_t pointCount)
{
  if (points.size() != 3 * pointCount)
  {
    throw InputError("projector: expected " + std::to_string(3 * pointCount) +
      " coordinates of the surface's points, found " + std::to_string(points.size()));
  }
  for (std::size_t index = 0; index < points.size(); ++index)
  {
    if (!(std::abs(points[index]) <= MostMm))
    {
      throw InputError("projector: point " + std::to_string(index / 3) +
        ": expected coordinates up to 1e12 mm, found " + NumberText(points[index]));
    }
  }
}

void CheckVelocities(const VectorFields& fields, std::size_t pointCount)
{
  const std::vector<double>& velocities = fields.Values;
  if (velocities.empty() || fields.Length != 3 * pointCount ||
    velocities.size() % fields.Length != 0)
  {
    throw InputError("projector: expected velocities of " + std::to_string(pointCount) +
      " points in at least one field, 3 values each, found " + std::to_string(velocities.size()) +
      " values in fields of " + std::to_string(fields.Length));
  }
  // The error names the first value that is too large or NaN.
  ParallelRanges(velocities.size(), ValuesAtOnce,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t index = begin; index < end; ++index)
      {
        if (!(std::abs(velocities[index]) <= MostMm))
        {
          throw InputError("projector: field " + std::to_string(index / (3 * pointCount)) +
            ", point " + std::to_string(index / 3 % pointCount) +
            ": expected a velocity up to 1e12 mm per unit, found " + NumberText(velocities[index]));
        }
      }
    });
}

double LargestLoss(const std::vector<float>& lossByLength, std::size_t pixels,
  std::size_t materials)
{
  if (lossByLength.size() != pixels * materials)
  {
    throw InputError("gradient: expected the loss's derivatives with respect to " +
      std::to_string(pixels * materials) + " path lengths (" + std::to_string(materials) +
      " materials), found " + std::to_string(lossByLength.size()));
  }
  double largest = 0;
  for (std::size_t index = pixels; index < lossByLength.size(); ++index)
  {
    const double size = std::abs(static_cast<double>(lossByLength[index]));
    if (!std::isfinite(size))
    {
      throw InputError("gradient: expected finite derivatives of the loss, found " +
        NumberText(lossByLength[index]) + " at " + std::to_string(index));
    }
    largest = std::max(largest, size);
  }
  return largest;
}
}
