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
#include "mammorayRegistrationModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// One parameter of the registration.
struct RegistrationParameter
{
  /// "thickness", "roll", "lateral", "anterior"
  std::string Name;
  std::string Unit;
  double Start = 0;
  double Lower = 0;
  double Upper = 0;
  /// A step of this size changes the picture noticeably; scales the optimiser's unknowns. Positive.
  double Scale = 1;
  bool Fixed = false;
};

struct RegistrationOptions
{
  /// thickness (mm), roll (deg), lateral (mm), anterior (mm): those of BreastPose, in this order.
  std::vector<RegistrationParameter> Parameters;
  /// Edge length of the pixels in which the images are compared, mm.
  double PixelSizeMm = 1.5;
  /// Number of directions in which the outlines are compared.
  int OutlineSamples = 121;
  /// Standard deviation of an outline sample, mm, and of a pixel of the z-scored image.
  double OutlineSigmaMm = 0.5;
  double IntensitySigma = 0.5;
  int MaximumIterations = 20;
};

/// What stays the same while the registration runs. The referenced objects must outlive it.
struct RegistrationModel
{
  const CompressionSimulation* Simulation = nullptr;
  /// Interfaces of the anatomy at rest; their points are moved by the simulation.
  const SurfaceMesh* Surface = nullptr;
  PathLengthProjector* Projector = nullptr;
  const Beam* XRays = nullptr;
  AnatomicalAxes Axes;
  Vector3 Anchor{ 0, 0, 0 };
  MammographyUnit Unit;
};

struct RegistrationIteration
{
  int Number = 0;
  std::vector<double> Parameters;
  double Cost = 0;
  double OutlineCost = 0;
  double IntensityCost = 0;
  double Seconds = 0;
};

struct RegistrationResult
{
  BreastPose Pose;
  std::vector<RegistrationParameter> Parameters;
  std::vector<double> Values;
  /// Standard deviation of each parameter by the covariance at the solution; NaN where fixed.
  std::vector<double> StandardDeviations;
  std::vector<RegistrationIteration> Iterations;
  CompressionState State;
  /// Normalised cross-correlation of log attenuation inside both outlines, [-1, 1].
  double Correlation = 0;
  /// Mean absolute and largest distance of the outlines, mm.
  double MeanOutlineDistanceMm = 0;
  double LargestOutlineDistanceMm = 0;
  bool Converged = false;
  std::string StopReason;
  int Evaluations = 0;
  double Seconds = 0;
};

/// Source and a detector grid of the unit, volume frame; the grid is given in the receptor plane.
MAMMORAYREGISTRATION_EXPORT XRaySource SourceOf(
  const VolumeFromGantry& placed, const MammographyUnit& unit);
MAMMORAYREGISTRATION_EXPORT XRayDetector DetectorOf(const VolumeFromGantry& placed,
  const std::array<double, 2>& origin, const std::array<double, 2>& columnStep,
  const std::array<double, 2>& rowStep, int columns, int rows);

/// Default parameters, bounds and scales around a start.
MAMMORAYREGISTRATION_EXPORT std::vector<RegistrationParameter> DefaultParameters(
  const BreastPose& start);

/**
 * Finds the pose and compression whose synthetic mammogram matches the target, by Ceres
 * (Levenberg-Marquardt). Ends with a result in every case but bad input (InputError) and a stop by the
 * progress callback, which ends the search with the best pose so far (StopReason says so).
 */
MAMMORAYREGISTRATION_EXPORT RegistrationResult Register(const RegistrationModel& model,
  const RegistrationTarget& target, const RegistrationOptions& options,
  const ProgressCallback& progress = {});
}

#endif
