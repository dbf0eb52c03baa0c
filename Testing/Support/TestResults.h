// SPDX-License-Identifier: Apache-2.0
// Result files for tests, every field of which differs from its default.
#ifndef mammoray_Testing_TestResults_h
#define mammoray_Testing_TestResults_h

#include "mammoray/Foundation/PoseParameters.h"
#include "mammoray/Study/ResultFile.h"

#include <limits>

namespace mammoray::test
{
/// A pose with its parameters, all of them held.
inline void SetPose(ResultFile& result, const BreastPose& pose)
{
  result.Pose = pose;
  result.Parameters.clear();
  for (const PoseParameter& parameter : PoseParameters)
  {
    const double value = pose.*parameter.Value;
    result.Parameters.push_back({ parameter.Name, parameter.Unit, value,
      std::numeric_limits<double>::quiet_NaN(), value - 1, value - 2, value + 3, true, false });
  }
}

/// The covariance of all parameters where only the thickness is uncertain.
inline std::vector<double> OnlyThickness(double sigmaMm)
{
  std::vector<double> covariance(PoseParameters.size() * PoseParameters.size());
  covariance.front() = sigmaMm * sigmaMm;
  return covariance;
}

/// One mammogram, of whose parameters only the thickness was found, a unit in the volume's frame.
inline ResultFile MakeResultFile()
{
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  ResultFile result;
  result.Trust = { Trust::Doubtful, { "The outlines lie apart.", "It \"did not\" settle." } };
  result.Axes = AnatomicalAxes::FromCode("ALS");
  result.Anchor = { 1.5, -2.25, 3.125 };
  SetPose(result, PoseOf({ 51.5, 1.25, -0.5, 0.75, 2.5, 5.5, -1.5, 0.125, 1.75 }));
  result.Parameters[0].StandardDeviation = 0.25;
  result.Parameters[0].Fixed = false;
  result.Parameters[0].AtBound = true;
  result.Covariance = OnlyThickness(0.25);
  result.ConsideredCovariance = OnlyThickness(0.5);
  result.Grid = { 30, 50, { 48, 1 }, { 0, 2 }, { -2, 0 } };
  result.Placed = { { 0.1, 0.2, 0.3 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
  result.Unit = { 660, 3, 1, 2, 4 };
  result.Projections = { { { 105, 0, 630 }, { 0.9, 0.5, 1, 0.8 } } };
  result.After = { 0.93, 0.62, unknown };
  result.Converged = true;
  result.StopReason = "it was near enough";
  result.Evaluations = 9;
  result.Seconds = 44.25;
  result.Timings = { { "read", 0.5 }, { "register", 44 } };
  result.Iterations = { { 0, { 50, 1.25 }, 3, "global", 12.5, 8, 4, 0.5, 1.25 },
    { 1, { 51.5, 1.25 }, 1.5, "gradient", 6.5, 3, 3, 0.5, 2.5 } };
  result.Compression = { .PaddleForceN = 87,
    .SupportForceN = 91,
    .LargestPenetrationMm = 0.02,
    .SmallestJ = 0.5,
    .LargestJ = 1.5,
    .VolumeRatio = 0.99,
    .RelativeResidual = 1e-9,
    .LargestWallGlideMm = 3 };
  result.OtherEquilibriumMm = 1.25;
  result.Mammogram = { .Columns = 30,
    .Rows = 50,
    .ColumnSpacingMm = 2.0,
    .RowSpacingMm = 2.5,
    .View = "MLO",
    .Laterality = 'L',
    .BodyPartThicknessMm = 52.0,
    .PeakKilovoltage = 28.0 };
  result.ShareExcluded = 0.125;
  result.Warnings = { "Something had to be assumed." };
  result.Notes = { "*.nii: one of two was taken" };
  result.Inputs = { { MaterialTableRole, "table.json", "12ab" },
    { MammogramRole, "mlo.dcm", "34cd" } };
  result.Spectrum = "W28kVp_Rh50um_Be1mm";
  result.Versions = { { "MammoRay", "0.1" }, { "VTK", "9.1" } };
  return result;
}

inline JointResultFile MakeJointResultFile()
{
  JointResultFile result;
  result.Mammograms = { { "cc", "CC", 'R', Trust::Good, 0.95, 0.5 },
    { "mlo", "MLO", 'R', Trust::None, 0.25, std::numeric_limits<double>::quiet_NaN() } };
  result.Unknowns = { { "thickness", "mm", "cc", 50.5, 0.25 },
    { "stiffness", "", std::nullopt, 1.5, std::numeric_limits<double>::quiet_NaN() } };
  result.Covariance = { 0.0625, 0.01, 0.01, 0.25 };
  result.Converged = true;
  result.StopReason = "it was near enough";
  result.Seconds = 99.5;
  return result;
}
}

#endif
