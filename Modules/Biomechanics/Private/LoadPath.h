// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LoadPath_h
#define mammoray_LoadPath_h

#include "Private/EquilibriumReport.h"
#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/Plates.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayBiomechanicsModule.h"

#include <limits>
#include <string>
#include <vector>

namespace mammoray
{
/// What a load path asks for: equilibrium between these plates with this contact.
struct LoadStep
{
  /// Equilibrium on the way is only a start for the next step: a solution to no less than this is
  /// one of those.
  static constexpr double IntermediateTolerance = 1e-3;

  PlatePair Plates;
  /// kPa / mm^2
  double ContactStiffness = 0;
  /// Relative residual.
  double Tolerance = 0;
  int MaximumNewtonSteps = 0;
};

/// All that a load path knows of a solver. Positions are 3 x nodeCount, mm.
class LoadStepSolver
{
public:
  virtual ~LoadStepSolver() = default;
  /// Begins to move the plates at the equilibrium `x` between `plates`, where friction's anchors
  /// are. Answers a first guess of the positions to solve from.
  virtual std::vector<double> Begin(const std::vector<double>& x, const PlatePair& plates,
    const LoadStep& step) = 0;
  /// From `x` to equilibrium; `last`, between `lastPlates`: the equilibrium before.
  virtual EquilibriumReport Solve(std::vector<double>& x, const std::vector<double>& last,
    const PlatePair& lastPlates, const LoadStep& step, const ProgressCallback& progress) = 0;
  /// The equilibrium `x` was reached on the way, and the plates will move on.
  virtual void Arrived(const std::vector<double>& x, const PlatePair& plates) = 0;
  /// Turns back cells that are inverted at `x`, if any. Answers the Newton steps it took.
  virtual int Untangle(std::vector<double>& x, const LoadStep& step,
    const ProgressCallback& progress) = 0;
};

/// Where a load path begins and how it may be gone.
struct LoadPathStart
{
  std::vector<double> Positions;
  PlatePair Plates;
  /// How many times as stiff as in the options contact is to be in the end, and is on the way.
  double Stiffening = 1;
  double Softness = 1;
  /// Steps as parts of the way.
  double LargestStep = 1;
  double SmallestStep = 0.1;
  /// The path is given up when a step fails after as many.
  int MostNewtonSteps = std::numeric_limits<int>::max();
  /// Contact that hardens by a little and still resists gets twice as many Newton steps.
  bool Patient = false;

  /// From plates that touch nothing of the body; `stepFactor`: of the options' largest step.
  MAMMORAYBIOMECHANICS_EXPORT static LoadPathStart Cold(std::vector<double> positions,
    const PlatePair& opened, const PlatePair& target, const CompressionOptions& options,
    double stepFactor);
  /// From another state.
  MAMMORAYBIOMECHANICS_EXPORT static LoadPathStart Warm(const CompressionState& state,
    const PlatePair& target, const CompressionOptions& options);
};

/**
 * The way from a start to equilibrium between the plates of a target: these are closed in load
 * steps with soft contact, on which Newton's method finds its way in a few steps, then contact is
 * hardened and the last state solved to the end. Steps that fail are made smaller. What it cannot
 * do it throws as CompressionError.
 */
class MAMMORAYBIOMECHANICS_EXPORT LoadPath
{
public:
  /// The solver must outlive the path.
  LoadPath(LoadStepSolver& solver, const CompressionOptions& options, const PlatePair& target,
    LoadPathStart start, const ProgressCallback& progress = {});

  /// Goes to the target at once from positions that a predictor gives there; stays where that
  /// fails.
  void ArriveFrom(std::vector<double> predicted);
  /// Closes the plates with contact as soft as on the way.
  void Close();
  /// Closes the plates and hardens contact until every limit is kept.
  void Complete();

  /// Where the path has arrived; without friction, time and memory.
  const CompressionState& State() const { return this->Reached; }

private:
  void TakeClosingStep();
  void Harden();
  void Polish();
  bool StiffenWherePenetrated();
  bool TakeStep(std::vector<double>& x, const LoadStep& step);
  void Keep(const EquilibriumReport& report, std::vector<double>& x, const PlatePair& plates);
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
  CompressionState Reached;
  PlatePairVelocity Motion;
  /// How many times as stiff as in the options contact is and is to be.
  double Softness;
  double Wanted;
  /// Parts of the way.
  double Done = 0;
  double Step;
  double Hardening;
  double LastGap;
  std::string Reason;
};

/// The refusal that says what was asked for and how far the plates got; gaps in mm.
CompressionError NoEquilibrium(double gapMm, double lastGapMm, const std::string& reason);
}

#endif
