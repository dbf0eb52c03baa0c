// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Plates_h
#define mammoray_Plates_h

#include "mammoray/Foundation/Vector3.h"
#include "mammorayBiomechanicsModule.h"

namespace mammoray
{
/// Plates have edges of 3 to 15 mm; of one of a metre nothing is left that presses.
inline constexpr double MostEdgeRadiusMm = 100;

/**
 * A rigid plate: a slab that fills Dot(x - Edge, Normal) <= 0 and Dot(x - Edge, Inward) >= 0, its
 * chest-wall edge rounded; unlimited in every other direction. In the frame of the mesh.
 */
struct Plate
{
  /// A point on the (unrounded) chest-wall edge of the contact face, mm.
  Vector3 Edge{ 0, 0, 0 };
  /// Unit normal of the contact face, out of the plate, towards the breast.
  Vector3 Normal{ 0, 0, 1 };
  /// Unit vector in the contact face from the chest-wall edge into the plate; orthogonal to Normal.
  Vector3 Inward{ 0, 1, 0 };
  /// Radius of the chest-wall edge, mm, 0 to MostEdgeRadiusMm.
  double EdgeRadiusMm = 3.0;

  bool operator==(const Plate&) const = default;
};

/// Rate of change of a plate with a parameter: x' = Linear + Angular x (x - Edge), per unit of it.
struct PlateVelocity
{
  Vector3 Linear{ 0, 0, 0 };
  Vector3 Angular{ 0, 0, 0 };

  /// Velocity of the plate's material point at x.
  Vector3 At(const Plate& plate, const Vector3& x) const
  {
    return this->Linear + Cross(this->Angular, x - plate.Edge);
  }
};

struct PlatePair
{
  Plate Support;
  Plate Paddle;

  bool operator==(const PlatePair&) const = default;
};

struct PlatePairVelocity
{
  PlateVelocity Support;
  PlateVelocity Paddle;
};

/// Signed distance to a plate with its first and second derivatives.
struct PlateDistance
{
  /// mm; negative inside the plate.
  double Distance = 0;
  /// Unit vector out of the plate.
  Vector3 Gradient{ 0, 0, 0 };
  /// The second derivative is Curvature * Tangent Tangent^T; 1/mm, 0 beside flat faces.
  double Curvature = 0;
  Vector3 Tangent{ 0, 0, 0 };
};

/**
 * Exact outside the plate and inside to the depth of the edge radius; deeper, the distance to the
 * nearer of the two faces.
 */
MAMMORAYBIOMECHANICS_EXPORT PlateDistance DistanceToPlate(const Plate& plate, const Vector3& x);

/// The plate after moving for `amount` of the parameter: turned about its Edge, then shifted.
MAMMORAYBIOMECHANICS_EXPORT Plate MovedPlate(const Plate& plate, const PlateVelocity& velocity,
  double amount);
MAMMORAYBIOMECHANICS_EXPORT PlatePair MovedPlates(const PlatePair& plates,
  const PlatePairVelocity& velocity, double amount);

/// The rigid motion that takes `from` to `to` in one unit: MovedPlate(from, Motion(from, to), 1) ==
/// to.
MAMMORAYBIOMECHANICS_EXPORT PlateVelocity PlateMotion(const Plate& from, const Plate& to);
MAMMORAYBIOMECHANICS_EXPORT PlatePairVelocity PlateMotion(const PlatePair& from,
  const PlatePair& to);

/**
 * The plates `from`, which have no end along their chest-wall edges: with the reference points
 * moved along these as near as can be to those of `to`. The same plates; but a motion from there to
 * `to` does not go a way that nothing feels.
 */
MAMMORAYBIOMECHANICS_EXPORT PlatePair SlidTowards(const PlatePair& from, const PlatePair& to);

/// How far a motion takes the points of the plates within 100 mm of the reference point of their
/// edges at most, mm.
MAMMORAYBIOMECHANICS_EXPORT double TravelMm(const PlatePairVelocity& motion);
}

#endif
