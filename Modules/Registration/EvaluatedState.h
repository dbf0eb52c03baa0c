// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_EvaluatedState_h
#define mammoray_EvaluatedState_h

#include "mammoray/Registration/BreastModel.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammoray/Registration/Silhouette.h"
#include "mammorayRegistrationModule.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace mammoray
{
/// The unit's focal spot and a target's pixel grid, in the volume frame; `samples` rays along each
/// side of a pixel.
MAMMORAYREGISTRATION_EXPORT XRaySource SourceOf(const VolumeFromGantry& placed,
  const MammographyUnit& unit);
MAMMORAYREGISTRATION_EXPORT XRayDetector DetectorOf(const VolumeFromGantry& placed,
  const ReceptorGrid& grid, int samples);

/**
 * A compressed breast in the unit, and what a search asks of it: the moved surface, its silhouette
 * and its picture. Each is computed when first asked for and kept; the picture and the silhouette
 * for the grid and the directions that were asked for last. Refers to the model and its body, which
 * must outlive it.
 */
class MAMMORAYREGISTRATION_EXPORT EvaluatedState
{
public:
  /// `state`: of `body`, one of the model's. It need not be the equilibrium at `pose`: a start is
  /// moved to its outline as it is.
  EvaluatedState(BreastModel& model, BreastBody& body, const UnitPlacement& placement,
    const BreastPose& pose, CompressionState state);

  /// The same state and points in a unit that stands elsewhere.
  EvaluatedState MovedTo(const BreastPose& pose);
  /// The same in the same unit with its focal spot elsewhere (gantry frame, mm), as a tomosynthesis
  /// has it; kept with this one.
  EvaluatedState& SeenFrom(const Vector3& focalSpotMm);

  const BreastPose& Pose() const { return this->At; }
  const CompressionState& State() const { return this->Equilibrium; }
  const UnitPlacement& Placement() const { return this->Around; }
  const VolumeFromGantry& Placed() const { return this->UnitHere; }
  const BreastModel& Model() const { return this->Breast; }

  /// Points of the model's surface, 3 x pointCount, volume frame, mm.
  const std::vector<double>& SurfacePoints();
  /// The same on the receptor.
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
    /// -ln(I / I0) of each pixel, with what scatters where the model has that.
    std::vector<float> LogAttenuation;
  };
  const Picture& PictureOn(const ReceptorGrid& grid, int samples);

  /// How the surface's points move with the parameters numbered in `wanted`, seen from the unit, mm
  /// per unit of each; one field after the other. Not kept.
  std::vector<double> Velocities(const std::vector<int>& wanted);
  /// How the picture's LogAttenuation changes with so many fields of the surface's velocities, by
  /// pixel, one field after the other; nothing of it is kept but the picture, which the same pass
  /// gives.
  std::vector<std::vector<double>> DifferentiatePicture(const ReceptorGrid& grid, int samples,
    const std::vector<double>& velocities, int fields);

  /// Pictures that were computed, from other focal spots too.
  int NumberOfProjections() const;

private:
  bool Shows(const XRayDetector& detector) const;
  void KeepPicture(const XRaySource& source, const XRayDetector& detector, PathLengthImage lengths);

  BreastModel& Breast;
  BreastBody& Body;
  UnitPlacement Around;
  BreastPose At;
  CompressionState Equilibrium;
  VolumeFromGantry UnitHere;
  std::vector<double> Points;
  std::vector<ReceptorPoint> Projected;

  ReceptorPoint Centre{ 0, 0 };
  std::vector<ReceptorPoint> Directions;
  std::optional<Silhouette> Outline;
  XRayDetector Detector;
  std::optional<Picture> Shown;
  int Projections = 0;
  /// Seen from elsewhere.
  std::vector<std::shared_ptr<EvaluatedState>> Others;
};
}

#endif
