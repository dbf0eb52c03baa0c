// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Vector3_h
#define mammoray_Vector3_h

#include <array>
#include <cmath>

namespace mammoray
{
/// A point or a direction; x, y, z. The frame and unit are said where it is used.
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
}

#endif
