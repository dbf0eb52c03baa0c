// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PlateFriction_h
#define mammoray_PlateFriction_h

#include "mammoray/Biomechanics/Plates.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayBiomechanicsModule.h"

#include <cstdint>
#include <vector>

namespace mammoray
{
/**
 * Coulomb friction at one contact point, smoothed, with a normal force that is frozen ("lagged"):
 * the energy mu N f(|u|) of Li et al. (Incremental potential contact, 2020),
 *
 *   u = (I - n n^T)(x - c),   f'(y) = 2 y / e - y^2 / e^2 for y < e = SlipMm, 1 beyond,
 *
 * c: the point of the plate it sticks to, N: normal force, n: its direction. Up to the slip e it
 * sticks elastically, from there on it slides under mu N. Unlike there, c is not set anew to where
 * the point was before the load step, which lets a point that sticks creep by up to e in each step:
 * it stays, and is dragged along only as far as |u| exceeds e (return mapping; Wriggers,
 * Computational contact mechanics, 2006).
 */
struct FrictionPoint
{
  static constexpr double SlipMm = 0.05;

  /// Boundary face, point of the rule on it, plate (0: support, 1: paddle).
  std::int32_t Face = 0;
  std::int16_t RulePoint = 0;
  std::int16_t Side = 0;
  /// N and mu N, kPa mm^2.
  double NormalForce = 0;
  double SlidingForce = 0;
  /// c and n in the frame of the plate: along its edge, Inward, Normal; from Edge, mm.
  Vector3 Anchor{ 0, 0, 0 };
  Vector3 Normal{ 0, 0, 1 };
};

/// Whether `a` comes before `b` in the order of face, point and plate.
MAMMORAYBIOMECHANICS_EXPORT bool Before(const FrictionPoint& a, const FrictionPoint& b);

/// The points that touch a plate.
using FrictionPoints = std::vector<FrictionPoint>;

/// A point or a direction in the frame of a plate (see FrictionPoint::Anchor), and back.
MAMMORAYBIOMECHANICS_EXPORT Vector3 DirectionInPlate(const Plate& plate, const Vector3& direction);
MAMMORAYBIOMECHANICS_EXPORT Vector3 DirectionFromPlate(const Plate& plate,
  const Vector3& direction);
MAMMORAYBIOMECHANICS_EXPORT Vector3 PointInPlate(const Plate& plate, const Vector3& point);
MAMMORAYBIOMECHANICS_EXPORT Vector3 PointFromPlate(const Plate& plate, const Vector3& point);

/// Energy of friction at a point x, with its derivatives; per unit of mu N.
struct FrictionTerms
{
  /// The slip u, mm.
  Vector3 Slip{ 0, 0, 0 };
  double Energy = 0;
  /// f' / |u|, and f'' where the slip's direction is: Hessian = Ratio (P - t t^T) + Curvature t
  /// t^T.
  double Ratio = 0;
  double Curvature = 0;
  Vector3 Normal{ 0, 0, 1 };
  Vector3 Anchor{ 0, 0, 0 };

  FrictionTerms(const FrictionPoint& point, const Plate& plate, const Vector3& x);
  /// The force is minus this.
  Vector3 Gradient() const { return this->Ratio * this->Slip; }
  /// The second derivative, which has no negative curvature, times a vector.
  Vector3 HessianTimes(const Vector3& v) const;
  /// Rate of Gradient at x with a motion of the plate.
  Vector3 GradientRate(const Plate& plate, const PlateVelocity& velocity, const Vector3& x) const;
};

/// The points of both lists, their forces `part` of the way from `a` to `b` (where a list lacks a
/// point: 0) and otherwise as in `b`; without those whose force fades away. Ordered.
MAMMORAYBIOMECHANICS_EXPORT FrictionPoints BlendedFriction(FrictionPoints a, FrictionPoints b,
  double part);

/// `point` with its anchor dragged so that the slip at x is no longer than SlipMm.
MAMMORAYBIOMECHANICS_EXPORT FrictionPoint Dragged(const FrictionPoint& point, const Plate& plate,
  const Vector3& x);
}

#endif
