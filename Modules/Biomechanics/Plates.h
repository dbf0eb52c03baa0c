// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Plates_h
#define mammoray_Plates_h

#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayBiomechanicsModule.h"

namespace mammoray
{
/// Largest accepted edge radius, mm. Real plates have 3 to 15 mm; a radius of a metre leaves no
/// flat face.
inline constexpr double MostEdgeRadiusMm = 100;

/// A rigid plate in the frame of the mesh: it fills Dot(x - Edge, Normal) <= 0 and Dot(x - Edge,
/// Inward) >= 0. Its chest-wall edge is rounded; it is unbounded in all other directions.
struct Plate
{
  /// A point on the (unrounded) chest-wall edge of the contact face, mm.
  Vector3 Edge{ 0, 0, 0 };
  /// Unit normal of the contact face; it points out of the plate, towards the breast.
  Vector3 Normal{ 0, 0, 1 };
  /// Unit vector in the contact face that points from the chest-wall edge into the plate;
  /// orthogonal to Normal.
  Vector3 Inward{ 0, 1, 0 };
  /// Radius of the chest-wall edge, mm, [0, MostEdgeRadiusMm].
  double EdgeRadiusMm = 3.0;

  bool operator==(const Plate&) const = default;
};

/// Velocity of a plate with respect to a parameter, per unit of it: x' = Linear + Angular x (x -
/// Edge).
struct PlateVelocity
{
  Vector3 Linear{ 0, 0, 0 };
  Vector3 Angular{ 0, 0, 0 };

  /// Velocity of the plate's material point at x, mm per unit of the parameter.
  Vector3 VelocityAt(const Plate& plate, const Vector3& x) const
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
  /// Signed distance, mm; negative inside the plate.
  double Distance = 0;
  /// Gradient of the distance: a unit vector that points out of the plate.
  Vector3 Gradient{ 0, 0, 0 };
  /// The second derivative is Curvature * Tangent Tangent^T. Curvature is in 1/mm and is 0 next to
  /// flat faces.
  double Curvature = 0;
  Vector3 Tangent{ 0, 0, 0 };
};

/// The signed distance of x to a plate. It is exact outside the plate and inside down to the edge
/// radius. Deeper inside it is the distance to the nearer of the two faces.
MAMMORAYBIOMECHANICS_EXPORT PlateDistance DistanceToPlate(const Plate& plate, const Vector3& x);

/// The plate after a motion of `amount` parameter units: it turns about its Edge, then shifts.
MAMMORAYBIOMECHANICS_EXPORT Plate MovedPlate(const Plate& plate, const PlateVelocity& velocity,
  double amount);
MAMMORAYBIOMECHANICS_EXPORT PlatePair MovedPlates(const PlatePair& plates,
  const PlatePairVelocity& velocity, double amount);

/// The rigid motion that takes `from` to `to` in one unit: MovedPlate(from, PlateMotion(from, to),
/// 1) == to.
MAMMORAYBIOMECHANICS_EXPORT PlateVelocity PlateMotion(const Plate& from, const Plate& to);
MAMMORAYBIOMECHANICS_EXPORT PlatePairVelocity PlateMotion(const PlatePair& from,
  const PlatePair& to);

/**
 * Plates are unbounded along their chest-wall edges, so their reference points may slide along
 * these. Returns the plates `from` with the reference points as near to those of `to` as possible.
 * These are the same plates, but a motion to `to` no longer includes a translation that has no
 * effect.
 */
MAMMORAYBIOMECHANICS_EXPORT PlatePair SlidTowards(const PlatePair& from, const PlatePair& to);

/// Largest distance that the motion moves a point of the plates within 100 mm of an edge's
/// reference point, mm.
MAMMORAYBIOMECHANICS_EXPORT double TravelMm(const PlatePairVelocity& motion);

/**
 * The plates of a unit with this placement, in the volume frame. The support's face lies at z =
 * SupportHeightMm of the gantry frame; the paddle's face lies `thicknessMm` above it.
 * `paddleTiltDeg` turns the paddle about its (unrounded) chest-wall edge, where the thickness is
 * measured; a positive tilt opens the paddle towards the nipple.
 */
MAMMORAYBIOMECHANICS_EXPORT PlatePair PlatesOf(const VolumeFromGantry& placed,
  const MammographyUnit& unit, double thicknessMm, double paddleTiltDeg = 0);

/// Standard gravity, m/s^2.
inline constexpr double StandardGravityMPerS2 = 9.80665;

enum class PatientPosition
{
  /// Standing or sitting, as for a mammogram.
  Upright,
  /// Face down, as for most breast MRI: the breast hangs forwards.
  Prone,
  /// Lying on the back.
  Supine
};

/// Vector of standard gravity in the volume frame for a patient in this position, m/s^2.
MAMMORAYBIOMECHANICS_EXPORT Vector3 GravityIn(PatientPosition position, const AnatomicalAxes& axes);
}

#endif
