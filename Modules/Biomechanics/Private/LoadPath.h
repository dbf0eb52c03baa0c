// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LoadPath_h
#define mammoray_LoadPath_h

#include "Private/EquilibriumReport.h"
#include "mammorayBiomechanicsModule.h"

#include <limits>
#include <string>
#include <vector>

namespace mammoray
{
/// A load step: equilibrium between these plates with this contact.
struct LoadStep
{
  /// Tolerance of intermediate equilibria, which only start the next step.
  static constexpr double IntermediateTolerance = 1e-3;

  PlatePair Plates;
  /// kPa / mm^2
  double ContactStiffness = 0;
  /// Relative residual at which the step is solved.
  double Tolerance = 0;
  int MaximumNewtonSteps = 0;
};

/// The interface through which a load path uses a solver. Positions are 3 x nodeCount, mm.
class LoadStepSolver
{
public:
  virtual ~LoadStepSolver() = default;
  /// Starts a load step at the equilibrium `x` between `plates`, which defines friction's anchors.
  /// Returns a first guess of the new positions.
  virtual std::vector<double> Begin(const std::vector<double>& x, const PlatePair& plates,
    const LoadStep& step) = 0;
  /// Solves from `x` to equilibrium. `last` is the previous equilibrium, between `lastPlates`.
  virtual EquilibriumReport Solve(std::vector<double>& x, const std::vector<double>& last,
    const PlatePair& lastPlates, const LoadStep& step, const ProgressCallback& progress) = 0;
  /// Accepts the intermediate equilibrium `x` before the plates move on.
  virtual void Arrived(const std::vector<double>& x, const PlatePair& plates) = 0;
  /// Turns back cells that are inverted at `x`, if there are any. Returns the number of Newton
  /// steps taken.
  virtual int Untangle(std::vector<double>& x, const LoadStep& step,
    const ProgressCallback& progress) = 0;
};

/// Start of a load path, and its step sizes.
struct LoadPathStart
{
  std::vector<double> Positions;
  PlatePair Plates;
  /// Contact stiffness at the end (Stiffening) and on the way (Softness), as factors on that of the
  /// options.
  double Stiffening = 1;
  double Softness = 1;
  /// Largest and smallest load step as fractions of the path.
  double LargestStep = 1;
  double SmallestStep = 0.1;
  /// The path is abandoned if a step fails after this many Newton steps in total.
  int MostNewtonSteps = std::numeric_limits<int>::max();
  /// If true, small hardening steps that still fail get twice as many Newton steps.
  bool Patient = false;

  /// A start from plates that touch nothing. `stepFactor` scales the options' largest step.
  MAMMORAYBIOMECHANICS_EXPORT static LoadPathStart Cold(std::vector<double> positions,
    const PlatePair& opened, const PlatePair& target, const CompressionOptions& options,
    double stepFactor);
  /// A start from another state.
  MAMMORAYBIOMECHANICS_EXPORT static LoadPathStart Warm(const CompressionState& state,
    const PlatePair& target, const CompressionOptions& options);
};

/**
 * Follows the path from a start to equilibrium between the target plates. The plates close in load
 * steps with soft contact, which Newton's method solves in a few steps. Then contact is hardened
 * and the last state is solved to the final tolerance. Failing steps are made smaller. Throws
 * CompressionError if the target is not reached.
 */
class MAMMORAYBIOMECHANICS_EXPORT LoadPath
{
public:
  /// The solver and the options must outlive the path.
  LoadPath(LoadStepSolver& solver, const CompressionOptions& options, const PlatePair& target,
    LoadPathStart start, const ProgressCallback& progress = {});

  /// Jumps to the target from predicted positions; the path stays where it is if that fails.
  void ArriveFrom(std::vector<double> predicted);
  /// Closes the plates with soft contact only.
  void Close();
  /// Closes the plates and hardens contact until every limit is met.
  void Complete();

  /// The current state, without friction, time and memory.
  const CompressionState& State() const { return this->Current; }

private:
  void TakeClosingStep();
  void Harden();
  void Polish();
  bool StiffenWherePenetrated();
  bool TakeStep(std::vector<double>& x, const LoadStep& step);
  double StiffnessAt(double softness) const { return this->Options.ContactStiffness * softness; }
  int IntermediateSteps() const;
  double AtLeast(double tolerance) const;
  ProgressCallback StepProgress() const;
  [[noreturn]] void Fail(const std::string& reason) const;

  LoadStepSolver& Solver;
  const CompressionOptions& Options;
  const PlatePair Target;
  const LoadPathStart Start;
  const ProgressCallback Progress;
  CompressionState Current;
  PlatePairVelocity Motion;
  /// Present and wanted contact stiffness, as factors on that of the options.
  double Softness;
  double TargetSoftness;
  /// Fraction of the path that is done, and the present load step.
  double Fraction = 0;
  double Step;
  double Hardening;
  double LastGap;
  std::string Reason;
};

/// The error that states the requested and the last gap, mm, and the reason.
CompressionError NoEquilibrium(double gapMm, double lastGapMm, const std::string& reason);
}

#endif
