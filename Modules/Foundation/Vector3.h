// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Vector3_h
#define mammoray_Vector3_h

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace mammoray
{
/// A point or a direction: x, y, z. Frame and unit are stated where it is used.
using Vector3 = std::array<double, 3>;

inline Vector3 operator+(const Vector3& a, const Vector3& b)
{
  return { a[0] + b[0], a[1] + b[1], a[2] + b[2] };
}
inline Vector3 operator-(const Vector3& a, const Vector3& b)
{
  return { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
}
inline Vector3 operator*(double s, const Vector3& a)
{
  return { s * a[0], s * a[1], s * a[2] };
}
inline double Dot(const Vector3& a, const Vector3& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vector3 Cross(const Vector3& a, const Vector3& b)
{
  return { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
}
inline double Norm(const Vector3& a)
{
  return std::sqrt(Dot(a, a));
}

/// Rotates v about the origin by Rodrigues' formula, right-handed; `rotation` is the axis times the
/// angle in radians.
inline Vector3 Rotated(const Vector3& v, const Vector3& rotation)
{
  const double angle = Norm(rotation);
  if (angle == 0)
  {
    return v;
  }
  const Vector3 axis = (1 / angle) * rotation;
  return std::cos(angle) * v + std::sin(angle) * Cross(axis, v) +
    ((1 - std::cos(angle)) * Dot(axis, v)) * axis;
}

/// The extent [Low, High] of values along one direction. The extent of an empty set is [+inf,
/// -inf].
struct Extent
{
  double Low = std::numeric_limits<double>::infinity();
  double High = -std::numeric_limits<double>::infinity();

  void Add(double place)
  {
    this->Low = std::min(this->Low, place);
    this->High = std::max(this->High, place);
  }
  double Length() const { return this->High - this->Low; }
  double Middle() const { return 0.5 * (this->Low + this->High); }
};

/// An axis-aligned box. The default is empty: [+inf, -inf] along each axis.
struct Box3
{
  Vector3 Low{ Extent().Low, Extent().Low, Extent().Low };
  Vector3 High{ Extent().High, Extent().High, Extent().High };

  void Add(const Vector3& point)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      this->Low[axis] = std::min(this->Low[axis], point[axis]);
      this->High[axis] = std::max(this->High[axis], point[axis]);
    }
  }
  void Add(const Box3& box)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      this->Low[axis] = std::min(this->Low[axis], box.Low[axis]);
      this->High[axis] = std::max(this->High[axis], box.High[axis]);
    }
  }
};

/// Extents of points (x y z interleaved) along each of several directions.
template <std::size_t Count>
std::array<Extent, Count> ExtentsAlong(const std::array<Vector3, Count>& directions,
  const std::vector<double>& points)
{
  std::array<Extent, Count> extents;
  for (std::size_t id = 0; id + 2 < points.size(); id += 3)
  {
    for (std::size_t axis = 0; axis < Count; ++axis)
    {
      extents[axis].Add(Dot({ points[id], points[id + 1], points[id + 2] }, directions[axis]));
    }
  }
  return extents;
}
}

#endif
