// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationModel_h
#define mammoray_RegistrationModel_h

#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/Embedding.h"
#include "mammoray/Biomechanics/PlacedPlates.h"
#include "mammoray/Foundation/PoseParameters.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammoray/Registration/Silhouette.h"
#include "mammoray/XRay/Beam.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayRegistrationModule.h"

#include <vector>

namespace mammoray
{
/// What stays the same while the registration runs, but for the stiffness of the simulation's
/// materials. The referenced objects must outlive it.
struct RegistrationModel
{
  CompressionSimulation* Simulation = nullptr;
  /// The simulation's materials where the stiffness parameter is 1, and which of them it scales
  /// (gland, so that it changes the ratio to fat). None: the parameter must be fixed.
  std::vector<ElasticMaterial> Elastic;
  std::vector<int> ScaledMaterials;
  /// Interfaces of the anatomy at rest; their points are moved by the simulation.
  const SurfaceMesh* Surface = nullptr;
  /// Moves the surface's points with the simulation.
  const Embedding* SurfaceEmbedding = nullptr;
  /**
   * A cheaper simulation of the same body and materials (linear elements on the same mesh), with
   * which the start is chosen and all resolutions but the finest are searched, and the surface in
   * it. Null: everything is done with Simulation.
   */
  CompressionSimulation* Scout = nullptr;
  const Embedding* ScoutEmbedding = nullptr;
  /// Has been given the surface with SetSurface.
  PathLengthProjector* Projector = nullptr;
  const Beam* XRays = nullptr;
  AnatomicalAxes Axes;
  /// See FindPoseAnchor.
  Vector3 Anchor{ 0, 0, 0 };
  MammographyUnit Unit;
};

/// The unit's focal spot and a target's pixel grid, in the volume frame.
MAMMORAYREGISTRATION_EXPORT XRaySource SourceOf(const VolumeFromGantry& placed,
  const MammographyUnit& unit);
MAMMORAYREGISTRATION_EXPORT XRayDetector DetectorOf(const VolumeFromGantry& placed,
  const RegistrationTarget& grid, int samples);

/// The plates at a pose, volume frame.
MAMMORAYREGISTRATION_EXPORT PlatePair PlatesAt(const RegistrationModel& model,
  const BreastPose& pose);

/// Equilibrium at `values`: sets the simulation's stiffness, then compresses it. Throws as
/// CompressionSimulation::Compress, at once.
MAMMORAYREGISTRATION_EXPORT CompressionState CompressAt(const RegistrationModel& model,
  const std::vector<double>& values, const CompressionState* start = nullptr,
  const ProgressCallback& progress = {});

/// Rate of change of the plates with each parameter before the stiffness, in their order (per mm or
/// degree).
MAMMORAYREGISTRATION_EXPORT std::vector<PlatePairVelocity> PlateVelocities(
  const RegistrationModel& model, const BreastPose& pose);

/**
 * How points that move with the simulation change with the parameters numbered in `wanted`, seen
 * from the unit: exact derivatives of their equilibrium `state` at `values` minus the motion of the
 * unit's own points. One vector of 3 x pointCount each, volume frame, mm per unit of the parameter.
 * Sets the simulation's stiffness.
 */
MAMMORAYREGISTRATION_EXPORT std::vector<std::vector<double>> VelocitiesSeenFromUnit(
  const RegistrationModel& model, const std::vector<double>& values, const CompressionState& state,
  const Embedding& points, const std::vector<int>& wanted);

/// A synthetic mammogram on a target's pixel grid.
struct SyntheticMammogram
{
  /// -ln(I / I0) of each pixel.
  std::vector<float> LogAttenuation;
  /// Outer silhouette on the receptor, gantry x, y, mm; from +x to -x around the nipple.
  std::vector<ReceptorPoint> Outline;
  /// Rays whose crossings did not cancel.
  std::size_t InconsistentRays = 0;
};

/**
 * X-rays a compressed state. Only the grid of `grid` is used, and its BreastMask (rows x columns,
 * at least one pixel 1) to centre the silhouette on. `samples` rays along each side of a pixel.
 * Throws InputError on an empty mask.
 */
MAMMORAYREGISTRATION_EXPORT SyntheticMammogram Synthesize(const RegistrationModel& model,
  const BreastPose& pose, const CompressionState& state, const RegistrationTarget& grid,
  int samples);

/// How two pictures of the breast agree.
struct Agreement
{
  /// Normalised cross-correlation of log attenuation inside both outlines, [-1, 1].
  double Correlation = 0;
  /// Distances from the synthetic outline to the real one where it lies in the image, mm.
  double MeanOutlineDistanceMm = 0;
  double LargestOutlineDistanceMm = 0;
};

MAMMORAYREGISTRATION_EXPORT Agreement Compare(const SyntheticMammogram& synthetic,
  const RegistrationTarget& target);
}

#endif
