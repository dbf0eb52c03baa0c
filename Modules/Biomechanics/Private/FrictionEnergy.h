// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_FrictionEnergy_h
#define mammoray_FrictionEnergy_h

#include "Private/ContactEnergy.h"
#include "Private/Energy.h"
#include "Private/MovingPart.h"
#include "mammoray/Biomechanics/Plates.h"
#include "mammorayBiomechanicsModule.h"

#include <cstdint>
#include <span>
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

/// The previous state of friction: its contact points with their anchors dragged along, its
/// positions and plates.
struct FrictionStart
{
  FrictionPoints Dragged;
  std::vector<double> Positions;
  PlatePair Plates;
};

/// Energy of the friction with two plates, with frozen normal forces and anchors (see
/// FrictionPoint). Its pieces are the body's elements. Its Hessian is positive semidefinite.
class MAMMORAYBIOMECHANICS_EXPORT FrictionEnergy : public Energy
{
public:
  /// Begins without points. The part must outlive the energy.
  explicit FrictionEnergy(const MovingPart& part)
    : Part(part)
  {
  }
  void SetPoints(FrictionPoints points);
  /// Points, ordered by elements.
  const FrictionPoints& Points() const { return this->OrderedPoints; }
  void SetPlates(const PlatePair& plates) { this->CurrentPlates = plates; }

  std::size_t NumberOfPieces() const override { return this->Part.Body().NumberOfElements(); }
  std::span<const std::int32_t> NodesOf(std::size_t element) const override
  {
    return this->Part.Body().NodesOf(element);
  }
  /// Measures the friction force and its share of the normal forces.
  bool Add(std::size_t element, const std::vector<double>& x, EnergyOrder order,
    PieceTerms& terms) const override;

  /// Adds -d gradient / dp of an element for parameters that move the plates, to one column of
  /// unknowns each. The anchors move with the plates.
  void AddPlateForces(std::size_t element, const std::vector<double>& x,
    const std::vector<PlatePairVelocity>& velocities, std::vector<double>& columns) const;
  /// As AddPlateForces for a parameter with this derivative of the coefficient of friction.
  void AddCoefficientForces(std::size_t element, const std::vector<double>& x, double rate,
    double* column) const;
  /// See ContactEnergy::AddPaddleForceDerivative.
  void AddPaddleForceDerivative(std::size_t element, const std::vector<double>& x,
    const PlatePairVelocity& velocity, const std::vector<double>& nodeVelocities,
    double& rate) const;

private:
  template <typename Function>
  void ForEachPoint(std::size_t element, const std::vector<double>& x,
    const Function& function) const;

  const MovingPart& Part;
  PlatePair CurrentPlates;
  FrictionPoints OrderedPoints;
  /// Element e has the points Starts[e] to Starts[e + 1] - 1; empty if there are no points.
  std::vector<std::size_t> Starts;
};

/// Friction points for the contact of `part` at `x`. Points that touched in the previous state keep
/// their anchors; new points have theirs where they were in that state.
MAMMORAYBIOMECHANICS_EXPORT FrictionPoints FrictionOfContact(const MovingPart& part,
  const ContactEnergy& contact, const std::vector<double>& x, const PlatePair& plates,
  double coefficient, const FrictionStart& before);
/// Returns `points` with their anchors dragged to the positions `x`.
MAMMORAYBIOMECHANICS_EXPORT FrictionPoints DraggedTo(const ElasticBody& body,
  const std::vector<double>& x, const PlatePair& plates, FrictionPoints points);
}

#endif
