// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Registration_h
#define mammoray_Registration_h

#include "mammoray/Foundation/Progress.h"
#include "mammoray/Registration/RegistrationResult.h"
#include "mammorayRegistrationModule.h"

#include <functional>
#include <vector>

namespace mammoray
{
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
