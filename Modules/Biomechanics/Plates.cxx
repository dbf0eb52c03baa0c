// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Biomechanics/Plates.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mammoray
{
PlateDistance DistanceToPlate(const Plate& plate, const Vector3& x)
{
  // In the plane of Inward and Normal the plate is a quarter-plane whose corner is rounded about
  // the point `radius` below the face and `radius` behind the edge; u and v are measured from
  // there, towards the chest wall and out of the face.
  const Vector3 offset = x - plate.Edge;
  const double radius = plate.EdgeRadiusMm;
  const double u = radius - Dot(offset, plate.Inward);
  const double v = radius + Dot(offset, plate.Normal);
  PlateDistance result;
  if (u > 0 && v > 0)
  {
    // std::hypot is slower, and its protection against overflow is not needed for millimetres.
    const double length = std::sqrt(u * u + v * v);
    result.Distance = length - radius;
    result.Gradient = (-u / length) * plate.Inward + (v / length) * plate.Normal;
    result.Curvature = 1 / length;
    result.Tangent = (v / length) * plate.Inward + (u / length) * plate.Normal;
  }
  else if (v >= u)
  {
    result.Distance = v - radius;
    result.Gradient = plate.Normal;
  }
  else
  {
    result.Distance = u - radius;
    result.Gradient = -1.0 * plate.Inward;
  }
  return result;
}

Plate MovedPlate(const Plate& plate, const PlateVelocity& velocity, double amount)
{
  Plate moved = plate;
  const Vector3 rotation = amount * velocity.Angular;
  moved.Edge = plate.Edge + amount * velocity.Linear;
  moved.Normal = Rotated(plate.Normal, rotation);
  moved.Inward = Rotated(plate.Inward, rotation);
  return moved;
}

PlatePair MovedPlates(const PlatePair& plates, const PlatePairVelocity& velocity, double amount)
{
  return { MovedPlate(plates.Support, velocity.Support, amount),
    MovedPlate(plates.Paddle, velocity.Paddle, amount) };
}

PlateVelocity PlateMotion(const Plate& from, const Plate& to)
{
  PlateVelocity motion;
  motion.Linear = to.Edge - from.Edge;
  // R = sum of to_i from_i^T. Its skew part is sin(angle) * axis, its trace 1 + 2 cos(angle).
  const Vector3 a[3] = { from.Inward, from.Normal, Cross(from.Inward, from.Normal) };
  const Vector3 b[3] = { to.Inward, to.Normal, Cross(to.Inward, to.Normal) };
  Vector3 sine{ 0, 0, 0 };
  double trace = 0;
  for (int i = 0; i < 3; ++i)
  {
    sine = sine + 0.5 * Cross(a[i], b[i]);
    trace += Dot(a[i], b[i]);
  }
  const double length = Norm(sine);
  if (length > 0)
  {
    motion.Angular = (std::atan2(length, 0.5 * (trace - 1)) / length) * sine;
  }
  return motion;
}

PlatePairVelocity PlateMotion(const PlatePair& from, const PlatePair& to)
{
  return { PlateMotion(from.Support, to.Support), PlateMotion(from.Paddle, to.Paddle) };
}

PlatePair SlidTowards(const PlatePair& from, const PlatePair& to)
{
  const auto slid = [](Plate plate, const Plate& target)
  {
    const Vector3 along = Cross(plate.Normal, plate.Inward);
    plate.Edge = plate.Edge + Dot(target.Edge - plate.Edge, along) * along;
    return plate;
  };
  return { slid(from.Support, to.Support), slid(from.Paddle, to.Paddle) };
}

double TravelMm(const PlatePairVelocity& motion)
{
  const auto travel = [](const PlateVelocity& v) { return Norm(v.Linear) + 100 * Norm(v.Angular); };
  return std::max(travel(motion.Support), travel(motion.Paddle));
}

PlatePair PlatesOf(const VolumeFromGantry& placed, const MammographyUnit& unit, double thicknessMm,
  double paddleTiltDeg)
{
  PlatePair plates;
  plates.Support.Edge = placed.Point({ 0, unit.SupportEdgeMm, unit.SupportHeightMm });
  plates.Support.Normal = placed.Z;
  plates.Support.Inward = placed.Y;
  plates.Support.EdgeRadiusMm = unit.EdgeRadiusMm;
  plates.Paddle.Edge = placed.Point({ 0, unit.PaddleEdgeMm, unit.SupportHeightMm + thicknessMm });
  const double tilt = paddleTiltDeg * std::numbers::pi / 180;
  plates.Paddle.Normal = std::sin(tilt) * placed.Y - std::cos(tilt) * placed.Z;
  plates.Paddle.Inward = std::cos(tilt) * placed.Y + std::sin(tilt) * placed.Z;
  plates.Paddle.EdgeRadiusMm = unit.EdgeRadiusMm;
  return plates;
}

Vector3 GravityIn(PatientPosition position, const AnatomicalAxes& axes)
{
  constexpr double g = StandardGravityMPerS2;
  switch (position)
  {
    case PatientPosition::Prone:
      return g * axes.Anterior;
    case PatientPosition::Supine:
      return -g * axes.Anterior;
    default:
      return -g * axes.Superior;
  }
}
}
