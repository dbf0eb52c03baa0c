// SPDX-License-Identifier: Apache-2.0
#include "Private/PlateFriction.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace mammoray
{
namespace
{
Vector3 Tangential(const Vector3& normal, const Vector3& v)
{
  return v - Dot(normal, v) * normal;
}
}

Vector3 DirectionInPlate(const Plate& plate, const Vector3& direction)
{
  return { Dot(direction, Cross(plate.Normal, plate.Inward)), Dot(direction, plate.Inward),
    Dot(direction, plate.Normal) };
}

Vector3 DirectionFromPlate(const Plate& plate, const Vector3& direction)
{
  return direction[0] * Cross(plate.Normal, plate.Inward) + direction[1] * plate.Inward +
    direction[2] * plate.Normal;
}

Vector3 PointInPlate(const Plate& plate, const Vector3& point)
{
  return DirectionInPlate(plate, point - plate.Edge);
}

Vector3 PointFromPlate(const Plate& plate, const Vector3& point)
{
  return plate.Edge + DirectionFromPlate(plate, point);
}

FrictionTerms::FrictionTerms(const FrictionPoint& point, const Plate& plate, const Vector3& x)
  : Normal(DirectionFromPlate(plate, point.Normal))
  , Anchor(PointFromPlate(plate, point.Anchor))
{
  constexpr double e = FrictionPoint::SlipMm;
  this->Slip = Tangential(this->Normal, x - this->Anchor);
  const double y = Norm(this->Slip);
  if (y < e)
  {
    this->Energy = y * y / e - y * y * y / (3 * e * e) + e / 3;
    this->Ratio = 2 / e - y / (e * e);
    this->Curvature = 2 / e - 2 * y / (e * e);
  }
  else
  {
    this->Energy = y;
    this->Ratio = 1 / y;
  }
}

Vector3 FrictionTerms::HessianTimes(const Vector3& v) const
{
  const Vector3 along = Tangential(this->Normal, v);
  const double square = Dot(this->Slip, this->Slip);
  const double part = square > 0 ? Dot(this->Slip, along) / square : 0;
  return this->Ratio * along + ((this->Curvature - this->Ratio) * part) * this->Slip;
}

Vector3 FrictionTerms::GradientDerivative(const Plate& plate, const PlateVelocity& velocity,
  const Vector3& x) const
{
  // u = (I - n n^T) d with d = x - c; gradient = g(|u|) u with g = f' / y. c and n move with the
  // plate.
  const Vector3 d = x - this->Anchor;
  const Vector3 turn = Cross(velocity.Angular, this->Normal);
  const Vector3 slipRate =
    -1.0 * Tangential(this->Normal, velocity.VelocityAt(plate, this->Anchor)) -
    Dot(this->Normal, d) * turn - Dot(turn, d) * this->Normal;
  const double square = Dot(this->Slip, this->Slip);
  const double part = square > 0 ? Dot(this->Slip, slipRate) / square : 0;
  return this->Ratio * slipRate + ((this->Curvature - this->Ratio) * part) * this->Slip;
}

bool Precedes(const FrictionPoint& a, const FrictionPoint& b)
{
  return std::tie(a.Face, a.RulePoint, a.Side) < std::tie(b.Face, b.RulePoint, b.Side);
}

FrictionPoints BlendedFriction(FrictionPoints a, FrictionPoints b, double part)
{
  // Points below this fraction of the largest force only cost time.
  constexpr double negligible = 1e-9;
  std::sort(a.begin(), a.end(), Precedes);
  std::sort(b.begin(), b.end(), Precedes);
  FrictionPoints blend;
  const auto add = [&blend](FrictionPoint point, double force)
  {
    const double factor = force / point.NormalForce;
    point.NormalForce *= factor;
    point.SlidingForce *= factor;
    blend.push_back(point);
  };
  for (std::size_t i = 0, j = 0; i < a.size() || j < b.size();)
  {
    if (j == b.size() || (i < a.size() && Precedes(a[i], b[j])))
    {
      add(a[i], (1 - part) * a[i].NormalForce);
      ++i;
    }
    else if (i == a.size() || Precedes(b[j], a[i]))
    {
      add(b[j], part * b[j].NormalForce);
      ++j;
    }
    else
    {
      add(b[j], (1 - part) * a[i].NormalForce + part * b[j].NormalForce);
      ++i;
      ++j;
    }
  }
  double largest = 0;
  for (const FrictionPoint& point : blend)
  {
    largest = std::max(largest, point.NormalForce);
  }
  std::erase_if(blend,
    [=](const FrictionPoint& point) { return point.NormalForce <= negligible * largest; });
  return blend;
}

FrictionPoint Dragged(const FrictionPoint& point, const Plate& plate, const Vector3& x)
{
  const FrictionTerms terms(point, plate, x);
  const double slip = Norm(terms.Slip);
  if (slip <= FrictionPoint::SlipMm)
  {
    return point;
  }
  FrictionPoint dragged = point;
  dragged.Anchor = PointInPlate(plate, x - (FrictionPoint::SlipMm / slip) * terms.Slip);
  return dragged;
}
}
