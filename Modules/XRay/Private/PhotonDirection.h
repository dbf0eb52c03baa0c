// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PhotonDirection_h
#define mammoray_PhotonDirection_h

#include "mammoray/Foundation/Vector3.h"
#include "mammoray/XRay/RandomStream.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mammoray
{
/// A unit vector turned by an angle of this cosine, to any side with the same probability.
inline Vector3 TurnDirection(const Vector3& direction, double cosine, RandomStream& random)
{
  const double azimuth = 2 * std::numbers::pi * random.Uniform();
  const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
  // Across the direction, from the axis that it leads least along.
  Vector3 axis{ 0, 0, 0 };
  const auto magnitude = [&](std::size_t a) { return std::abs(direction[a]); };
  std::size_t least = magnitude(0) <= magnitude(1) ? 0 : 1;
  least = magnitude(least) <= magnitude(2) ? least : 2;
  axis[least] = 1;
  Vector3 u = Cross(direction, axis);
  u = (1 / Norm(u)) * u;
  const Vector3 v = Cross(direction, u);
  const Vector3 turned =
    cosine * direction + (sine * std::cos(azimuth)) * u + (sine * std::sin(azimuth)) * v;
  return (1 / Norm(turned)) * turned;
}
}

#endif
