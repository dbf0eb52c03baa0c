// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PosedBreast_h
#define mammoray_PosedBreast_h

#include "mammoray/Registration/BreastModel.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammorayRegistrationModule.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace mammoray
{
/// The unit's focal spot and a target's pixel grid, in the volume frame; `samples` rays along each
/// side of a pixel.
MAMMORAYREGISTRATION_EXPORT XRaySource SourceOf(const VolumeFromGantry& placed,
  const MammographyUnit& unit);
MAMMORAYREGISTRATION_EXPORT XRayDetector DetectorOf(const VolumeFromGantry& placed,
  const ReceptorGrid& grid, int samples);

/// Shadow of a point of the gantry frame from the unit's focal spot; NaN at or above the spot.
MAMMORAYREGISTRATION_EXPORT ReceptorPoint ShadowOf(const Vector3& gantry,
  const MammographyUnit& unit);

/**
 * Projects points from the unit's focal spot onto the receptor plane.
 * `points`: 3 x pointCount, volume frame, mm. Points at or above the focal spot become NaN.
 */
MAMMORAYREGISTRATION_EXPORT std::vector<ReceptorPoint> ProjectToReceptor(
  const std::vector<double>& points, const VolumeFromGantry& placed, const MammographyUnit& unit);

/**
 * Velocities of the projections of points, mm per unit of a parameter. `velocities`: of the points
 * relative to the unit, 3 x pointCount, volume frame, mm per unit.
 */
MAMMORAYREGISTRATION_EXPORT std::vector<ReceptorPoint> ReceptorVelocities(
  const std::vector<double>& points, std::span<const double> velocities,
  const VolumeFromGantry& placed, const MammographyUnit& unit);

/**
 * A compressed breast in the unit: the moved surface, its silhouette and its picture. Each is
 * computed at the first call and kept; picture and silhouette are kept for the last grid and
 * directions only. Model and body must outlive it.
 */
class MAMMORAYREGISTRATION_EXPORT PosedBreast
{
public:
  /// `body`: one of the model's; `state`: a state of it, which need not be the equilibrium at
  /// `pose`, since a start is moved to its outline without compressing it anew.
  PosedBreast(BreastModel& model, BreastBody& body, const UnitPlacement& placement,
    const BreastPose& pose, CompressionState state);

  /// The same state and points with the unit at another pose.
  PosedBreast MovedTo(const BreastPose& pose);
  /// The same breast and unit with another focal spot (gantry frame, mm), as in tomosynthesis;
  /// owned by this one.
  PosedBreast& SeenFrom(const Vector3& focalSpotMm);

  const BreastPose& Pose() const { return this->UnitPose; }
  const CompressionState& State() const { return this->Equilibrium; }
  const UnitPlacement& Placement() const { return this->Unit; }
  const VolumeFromGantry& Placed() const { return this->UnitFrame; }
  const BreastModel& Model() const { return this->Breast; }

  /// Points of the model's surface, 3 x pointCount, volume frame, mm.
  const std::vector<double>& SurfacePoints();
  /// Their shadows on the receptor.
  const std::vector<ReceptorPoint>& SurfaceOnReceptor();

  struct Silhouette
  {
    /// SilhouetteRadii and the edges they cross.
    std::vector<double> Radii;
    std::vector<std::int32_t> Crossed;
  };
  const Silhouette& SilhouetteFrom(const ReceptorPoint& centre,
    const std::vector<ReceptorPoint>& directions);

  struct Picture
  {
    PathLengthImage Lengths;
    /// -ln(I / I0) of each pixel, with scatter if the model has a scatter model.
    std::vector<float> LogAttenuation;
  };
  const Picture& PictureOn(const ReceptorGrid& grid, int samples);

  /// Velocities of the surface's points with the parameters numbered in `wanted`, seen from the
  /// unit, mm per unit of each. Not kept.
  VectorFields Velocities(const std::vector<int>& wanted);
  /// Derivatives of LogAttenuation with each field of the surface's velocities, a value for each
  /// pixel. The same pass gives the picture, which is kept; the derivatives are not.
  std::vector<std::vector<double>> DifferentiatePicture(const ReceptorGrid& grid, int samples,
    const VectorFields& velocities);

  /// Number of pictures computed, including those from other focal spots.
  int NumberOfProjections() const;

private:
  bool Shows(const XRayDetector& detector) const;
  void KeepPicture(const XRaySource& source, const XRayDetector& detector, PathLengthImage lengths);

  BreastModel& Breast;
  BreastBody& Body;
  UnitPlacement Unit;
  BreastPose UnitPose;
  CompressionState Equilibrium;
  VolumeFromGantry UnitFrame;
  std::vector<double> Points;
  std::vector<ReceptorPoint> Projected;

  ReceptorPoint Centre{ 0, 0 };
  std::vector<ReceptorPoint> Directions;
  std::optional<Silhouette> Outline;
  XRayDetector Detector;
  std::optional<Picture> LastPicture;
  int Projections = 0;
  /// Seen from elsewhere.
  std::vector<std::shared_ptr<PosedBreast>> OtherSpots;
};
}

#endif
