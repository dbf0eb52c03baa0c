// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Registration_h
#define mammoray_Registration_h

#include "Beam.h"
#include "CompressionSimulation.h"
#include "Mammogram.h"
#include "MammographyGeometry.h"
#include "PathLengthProjector.h"
#include "PlacedPlates.h"
#include "Progress.h"
#include "Silhouette.h"
#include "mammorayRegistrationModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// One parameter of the registration: a member of BreastPose.
struct RegistrationParameter
{
  /// "thickness", "roll", "lateral", "anterior" or "vertical".
  std::string Name;
  /// "mm" or "deg".
  std::string Unit;
  double Start = 0;
  double Lower = 0;
  double Upper = 0;
  /// Makes the optimiser's unknowns comparable; also ten times the step of the projection's
  /// differences. Positive.
  double Scale = 1;
  /// Standard deviation of the prior around Start; 0 = none.
  double PriorSigma = 0;
  /// Not optimised: stays at Start.
  bool Fixed = false;
};

struct RegistrationOptions
{
  /// In the order of DefaultParameters.
  std::vector<RegistrationParameter> Parameters;
  /// Edge lengths of the pixels in which the images are compared, coarse to fine, mm.
  std::vector<double> PixelSizesMm{ 3.0, 1.5 };
  /// Rays per coarse pixel along each of its sides.
  int Samples = 3;
  /// Directions in which the outlines are compared, spread over the half circle.
  int OutlineDirections = 120;
  /**
   * Standard deviation of the model's error on the outline, mm, and of the z-scored picture, and the
   * distance over which these errors are alike, mm: neighbouring samples share their weight.
   */
  double OutlineSigmaMm = 1.0;
  double IntensitySigma = 0.5;
  double CorrelationLengthMm = 5.0;
  /// Pixels nearer than this to the outline take no part in the comparison of intensities, mm.
  double IntensityMarginMm = 3.0;
  /// Residuals beyond this many standard deviations count linearly (Huber).
  double RobustWidth = 2.0;
  int MaximumIterations = 15;
};

/// What stays the same while the registration runs. The referenced objects must outlive it.
struct RegistrationModel
{
  const CompressionSimulation* Simulation = nullptr;
  /// Interfaces of the anatomy at rest; their points are moved by the simulation.
  const SurfaceMesh* Surface = nullptr;
  /// Moves the surface's points with the simulation.
  const Embedding* SurfaceEmbedding = nullptr;
  /// Has been given the surface with SetSurface.
  PathLengthProjector* Projector = nullptr;
  const Beam* XRays = nullptr;
  AnatomicalAxes Axes;
  /// See FindPoseAnchor.
  Vector3 Anchor{ 0, 0, 0 };
  MammographyUnit Unit;
};

/// How two pictures of the breast agree.
struct Agreement
{
  /// Normalised cross-correlation of log attenuation inside both outlines, [-1, 1].
  double Correlation = 0;
  /// Distances from the synthetic outline to the real one where it lies in the image, mm.
  double MeanOutlineDistanceMm = 0;
  double LargestOutlineDistanceMm = 0;
};

struct RegistrationIteration
{
  int Number = 0;
  std::vector<double> Parameters;
  /// Edge length of the compared pixels, mm.
  double PixelSizeMm = 0;
  /// Half the sum of squared residuals: of everything, the outline, the intensities and the priors.
  double Cost = 0;
  double OutlineCost = 0;
  double IntensityCost = 0;
  double PriorCost = 0;
  double Seconds = 0;
};

struct RegistrationResult
{
  BreastPose Pose;
  /// As given, but for what Warnings tell.
  std::vector<RegistrationParameter> Parameters;
  std::vector<double> Values;
  /// Standard deviation of each parameter by the covariance at the solution; NaN where fixed.
  std::vector<double> StandardDeviations;
  std::vector<RegistrationIteration> Iterations;
  CompressionState State;
  /// Agreement at the start and at the end.
  Agreement Before;
  Agreement After;
  bool Converged = false;
  std::string StopReason;
  /// What the user should know of the search, a sentence each.
  std::vector<std::string> Warnings;
  /// Equilibria solved and pictures projected, and the time each took, s.
  int Evaluations = 0;
  int Projections = 0;
  double MechanicsSeconds = 0;
  double ProjectionSeconds = 0;
  /// All of the search, s.
  double Seconds = 0;
};

/// The unit's focal spot and a target's pixel grid, in the volume frame.
MAMMORAYREGISTRATION_EXPORT XRaySource SourceOf(
  const VolumeFromGantry& placed, const MammographyUnit& unit);
MAMMORAYREGISTRATION_EXPORT XRayDetector DetectorOf(
  const VolumeFromGantry& placed, const RegistrationTarget& grid, int samples);

/**
 * The parameters thickness, roll, lateral, anterior and vertical around a start. Thickness is bounded to
 * 0.5 to 1.5 times the start with a prior of 5 mm (the header's thickness is the paddle's, which bends and is
 * calibrated to some mm), the angle to 30 degrees and the shifts to 50 mm around it; vertical, along the
 * beam and almost without effect on the picture, is fixed.
 */
MAMMORAYREGISTRATION_EXPORT std::vector<RegistrationParameter> DefaultParameters(
  const BreastPose& start);

/// Rate of change of the plates with each of DefaultParameters at a pose (per mm or degree).
MAMMORAYREGISTRATION_EXPORT std::vector<PlatePairVelocity> PlateVelocities(
  const RegistrationModel& model, const BreastPose& pose);

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
 * X-rays a compressed state. Only the grid of `grid` is used. `samples` rays along each side of a pixel.
 */
MAMMORAYREGISTRATION_EXPORT SyntheticMammogram Synthesize(const RegistrationModel& model,
  const BreastPose& pose, const CompressionState& state, const RegistrationTarget& grid,
  int samples);

MAMMORAYREGISTRATION_EXPORT Agreement Compare(
  const SyntheticMammogram& synthetic, const RegistrationTarget& target);

/**
 * Finds the pose and compression whose synthetic mammogram matches the target, by Ceres
 * (Levenberg-Marquardt). A start thinner than the model can be compressed to is opened until there is an equilibrium, with a
 * warning. Throws InputError on bad input, ConvergenceError when no start has an equilibrium, and Interrupted when
 * stopped before the search; a stop during the search ends it with the best pose so far (StopReason says so).
 */
MAMMORAYREGISTRATION_EXPORT RegistrationResult Register(const RegistrationModel& model,
  const RegistrationTarget& target, const RegistrationOptions& options,
  const ProgressCallback& progress = {});
}

#endif
