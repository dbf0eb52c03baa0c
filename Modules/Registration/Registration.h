// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Registration_h
#define mammoray_Registration_h

#include "mammoray/Foundation/Progress.h"
#include "mammoray/Registration/RegistrationResiduals.h"
#include "mammoray/Registration/SyntheticMammogram.h"
#include "mammorayRegistrationModule.h"

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
struct RegistrationIteration
{
  int Number = 0;
  std::vector<double> Parameters;
  /// Edge length of the compared pixels, mm, and how they were compared (NameOf). Costs of
  /// different ones are different quantities.
  double PixelSizeMm = 0;
  std::string Comparison;
  /// Half the sum of squared residuals: of everything, the outline, the intensities and the priors.
  double Cost = 0;
  double OutlineCost = 0;
  double IntensityCost = 0;
  double PriorCost = 0;
  double Seconds = 0;
};

/**
 * What is left between the pictures where a search ended, as its residuals tell (Private/
 * VarianceComponents.h): standard deviation of the outline, mm, and of what is compared of the
 * picture (RegistrationOptions::Comparison), and the length and the edge of the square over which
 * these are alike, mm. All 0 where it is not known.
 */
struct RegistrationMisfit
{
  double OutlineSigmaMm = 0;
  double OutlineScaleMm = 0;
  double PictureSigma = 0;
  double PictureScaleMm = 0;
};

/// How far tissue may lie from where it is found, mm: in the middle, and 95 % of it.
struct ExpectedError
{
  double MedianMm = 0;
  double Most95Mm = 0;
};

struct RegistrationResult
{
  BreastPose Pose;
  /// These are as given, but for what Warnings tell.
  std::vector<RegistrationParameter> Parameters;
  std::vector<double> Values;
  RegistrationMisfit Misfit;
  /// Standard deviation of each parameter by the covariance at the solution; NaN where fixed.
  std::vector<double> StandardDeviations;
  /// Covariance of all parameters at the solution, by Misfit and the priors,
  /// Covariance[i * parameterCount + j], in their units; 0 for fixed ones. Empty where it is not
  /// known.
  std::vector<double> Covariance;
  /**
   * The same with what is not known of the fixed parameters that have a prior: their own variance,
   * and how far the others would have been found elsewhere, had they been held at another value.
   * Empty where it is not known.
   */
  std::vector<double> ConsideredCovariance;
  std::vector<RegistrationIteration> Iterations;
  CompressionState State;
  /**
   * How far the breast lies from where a cold start at the same pose takes it, on average over its
   * nodes, mm, seen where the finest resolution began: 0 unless it has several equilibria there.
   * The one whose picture matches better is searched from. NaN where that start has none or none
   * was made.
   */
  double OtherEquilibriumMm = std::numeric_limits<double>::quiet_NaN();
  /// Agreement at the start and at the end.
  Agreement Before;
  Agreement After;
  bool Converged = false;
  std::string StopReason;
  /// What the user should know of the search, a sentence each.
  std::vector<std::string> Warnings;
  /// What the mammogram's header says of the compressed thickness, mm, and what else header,
  /// picture and result disagree on, a sentence each; of whoever knows the header.
  std::optional<double> HeaderThicknessMm;
  std::vector<std::string> Disagreements;
  /// Of points of the breast between the plates, where picture and volume are of one breast; of
  /// whoever knows the model's own error.
  std::optional<ExpectedError> Expected;
  /// Equilibria solved and pictures compared, and the time each took, s.
  int Evaluations = 0;
  int Projections = 0;
  double MechanicsSeconds = 0;
  double ProjectionSeconds = 0;
  /// Time of all derivatives, of mechanics and pictures together, s.
  double JacobianSeconds = 0;
  /// All of the search, s.
  double Seconds = 0;
};

/// A further projection of one compression: what it shows, in the gantry frame, and where its focal
/// spot stood there, mm.
struct ProjectionTarget
{
  const RegistrationTarget* Target = nullptr;
  Vector3 FocalSpotMm{ 0, 0, 0 };
};

/// One of the mammograms of a breast that are registered together. The model may be that of the
/// others, which is then used by one after the other; model and target must outlive the search.
struct JointMammogram
{
  BreastModel* Model = nullptr;
  UnitPlacement Placement;
  const RegistrationTarget* Target = nullptr;
  /// They mean what those of RegistrationOptions do, for this mammogram.
  std::vector<RegistrationParameter> Parameters;
  std::vector<double> From;
  /**
   * Projections of a tomosynthesis beside Target, which is one of them, taken from the unit's own
   * focal spot: one pose and one equilibrium, seen from many sides. All together count as much as
   * one mammogram (RegistrationResiduals). Starts are chosen by Target alone, and agreement is that
   * with it. They must outlive the search.
   */
  std::vector<ProjectionTarget> Others;
};

/// A free parameter of mammograms registered together.
struct JointUnknown
{
  int Parameter = 0;
  /// The mammogram it belongs to; of a shared one the first.
  std::size_t Mammogram = 0;
  bool Shared = false;
};

struct JointRegistrationResult
{
  /// One for each mammogram, with its own counts and costs, its part of the covariance, and the
  /// seconds of all.
  std::vector<RegistrationResult> Mammograms;
  /// What was free, and its covariance, Covariance[i * Unknowns.size() + j], in the parameters'
  /// units; empty where it is not known.
  std::vector<JointUnknown> Unknowns;
  std::vector<double> Covariance;
};

/// Told of the start of each level of a search and of each step that is accepted: what is found so
/// far of each mammogram, its Parameters, Values and Iterations.
using SearchObserver =
  std::function<void(const std::vector<const RegistrationResult*>& mammograms)>;

/**
 * Whether mammograms of one breast have a parameter in common. The body's stiffness is: tissue is
 * the same in every picture. All others say how the unit stood and how the breast was laid into it,
 * for each exposure anew.
 */
MAMMORAYREGISTRATION_EXPORT bool IsShared(int parameter);

/**
 * Registers several mammograms of one breast (CC and MLO) at once: each has its own pose and
 * compression, shared parameters have one value, bounds and prior (those of the first mammogram),
 * and one Levenberg-Marquardt search minimises the sum of all costs. The models are of the same
 * body; the units may differ. Parameters and From of `options` are not used; either all mammograms
 * have a From or none. Throws and stops as Register.
 */
MAMMORAYREGISTRATION_EXPORT JointRegistrationResult RegisterTogether(
  const std::vector<JointMammogram>& mammograms, const RegistrationOptions& options,
  const ProgressCallback& progress = {}, const SearchObserver& observer = {});

/**
 * Finds the pose and compression whose synthetic mammogram matches the target, by Ceres
 * (Levenberg-Marquardt). A start thinner than the model can be compressed to is opened until there
 * is an equilibrium, with a warning. Throws InputError on bad input, ConvergenceError when no start
 * has an equilibrium, and Interrupted when stopped before the search; a stop during the search ends
 * it with the best pose so far (StopReason says so).
 */
MAMMORAYREGISTRATION_EXPORT RegistrationResult Register(BreastModel& model,
  const UnitPlacement& placement, const RegistrationTarget& target,
  const RegistrationOptions& options, const ProgressCallback& progress = {});
}

#endif
