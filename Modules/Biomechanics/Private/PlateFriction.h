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
 * Smoothed Coulomb friction at one contact point with a frozen ("lagged") normal force. Its energy
 * is mu N f(|u|) (Li et al., Incremental potential contact, 2020) with
 *
 *   u = (I - n n^T)(x - c),   f'(y) = 2 y / e - y^2 / e^2 for y < e = SlipMm, 1 beyond.
 *
 * c is the anchor on the plate, N the normal force, and n its direction. The point sticks
 * elastically up to the slip e and slides under mu N beyond. Li et al. reset c at each load step,
 * so that a sticking point creeps by up to e in each step. Here c stays and is dragged along only
 * as far as |u| exceeds e (return mapping; Wriggers, Computational contact mechanics, 2006).
 */
struct FrictionPoint
{
  static constexpr double SlipMm = 0.05;

  /// Boundary face, index of the point on it (FacePoints), and plate (0: support, 1: paddle).
  std::int32_t Face = 0;
  std::int16_t RulePoint = 0;
  std::int16_t Side = 0;
  /// Normal force N and sliding force mu N, kPa mm^2.
  double NormalForce = 0;
  double SlidingForce = 0;
  /// c and n in the frame of the plate. Its axes run along the edge, along Inward and along Normal;
  /// its origin is Edge; mm.
  Vector3 Anchor{ 0, 0, 0 };
  Vector3 Normal{ 0, 0, 1 };
};

/// True if `a` precedes `b` in the order of face, point and plate.
MAMMORAYBIOMECHANICS_EXPORT bool Precedes(const FrictionPoint& a, const FrictionPoint& b);

/// Contact points of both plates.
using FrictionPoints = std::vector<FrictionPoint>;

/// Transforms directions and points into the frame of a plate (see FrictionPoint::Anchor) and back.
MAMMORAYBIOMECHANICS_EXPORT Vector3 DirectionInPlate(const Plate& plate, const Vector3& direction);
MAMMORAYBIOMECHANICS_EXPORT Vector3 DirectionFromPlate(const Plate& plate,
  const Vector3& direction);
MAMMORAYBIOMECHANICS_EXPORT Vector3 PointInPlate(const Plate& plate, const Vector3& point);
MAMMORAYBIOMECHANICS_EXPORT Vector3 PointFromPlate(const Plate& plate, const Vector3& point);

/// Energy of friction at a point x with its derivatives, per unit of mu N.
struct FrictionTerms
{
  /// Slip u, mm.
  Vector3 Slip{ 0, 0, 0 };
  double Energy = 0;
  /// Ratio = f' / |u| and Curvature = f''. With P = I - n n^T and the direction t of the slip, the
  /// Hessian is Ratio (P - t t^T) + Curvature t t^T.
  double Ratio = 0;
  double Curvature = 0;
  Vector3 Normal{ 0, 0, 1 };
  Vector3 Anchor{ 0, 0, 0 };

  FrictionTerms(const FrictionPoint& point, const Plate& plate, const Vector3& x);
  /// Gradient of the energy; minus the force.
  Vector3 Gradient() const { return this->Ratio * this->Slip; }
  /// The Hessian, which is positive semidefinite, times a vector.
  Vector3 HessianTimes(const Vector3& v) const;
  /// Derivative of Gradient at x with a motion of the plate.
  Vector3 GradientDerivative(const Plate& plate, const PlateVelocity& velocity,
    const Vector3& x) const;
};

/// Interpolates two lists of points: forces lie `part` of the way from `a` to `b` (0 where a list
/// lacks a point), all else is as in `b`. Points whose force vanishes are dropped. The result is
/// ordered.
MAMMORAYBIOMECHANICS_EXPORT FrictionPoints BlendedFriction(FrictionPoints a, FrictionPoints b,
  double part);

/// Returns `point` with its anchor dragged so that the slip at x is at most SlipMm.
MAMMORAYBIOMECHANICS_EXPORT FrictionPoint Dragged(const FrictionPoint& point, const Plate& plate,
  const Vector3& x);
}

#endif
