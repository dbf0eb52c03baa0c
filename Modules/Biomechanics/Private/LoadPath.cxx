// SPDX-License-Identifier: Apache-2.0
#include "Private/LoadPath.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace mammoray
{
namespace
{
/// Tolerance at the target plates while contact still has to be hardened: these plates no longer
/// move.
constexpr double ArrivalTolerance = 5e-2;
constexpr int IntermediateNewtonSteps = 40;
/// Tolerance for a guess from another mesh that has inverted cells.
constexpr double UntanglingTolerance = 3e-2;
/// A warm start gives up after this many Newton steps in total if it needs halvings: its caller can
/// take a smaller step.
constexpr int WarmNewtonSteps = 60;
/// A cold start closes the plates with contact softer by this factor. Then contact is hardened by
/// at most this factor per step, down to the smallest useful one.
constexpr double Softening = 0.1;
constexpr double LargestHardening = 10;
constexpr double SmallestHardening = 1.01;
/// Smaller hardening steps that still fail cross a snap-through. Newton's method needs time for it,
/// which smaller steps do not shorten.
constexpr double PatientHardening = 2;
/// Largest factor by which contact is stiffened when a state exceeds its penetration limit.
constexpr double LargestStiffening = 256;
/// Smallest load steps as fractions of the path.
constexpr double SmallestColdStep = 5e-3;
constexpr double SmallestWarmStep = 0.1;
/// A warm start goes straight to plates within this travel; longer paths use load steps of the
/// second travel, mm.
constexpr double ShortTravelMm = 3;
constexpr double LongTravelMm = 6;

/**
 * Tissue hardly changes its volume. If a quadrature point of a converged quadratic state has lost
 * 90 % of it, the cell is squeezed flat between a plate's edge and the fixed body. A linear cell
 * belongs to a patch that keeps its volume; at such edges some cells lose 95 % to their neighbours.
 */
double SmallestAllowedJ(ElementType type)
{
  return type == ElementType::Quadratic ? 0.1 : 0.01;
}

std::string InMm(double value)
{
  char text[32];
  std::snprintf(text, sizeof text, "%.2f mm", value);
  return text;
}
}

CompressionError NoEquilibrium(double gapMm, double lastGapMm, const std::string& reason)
{
  return { "compression: expected equilibrium at a gap of " + InMm(gapMm) +
      ", the last one reached is at " + InMm(lastGapMm) + " (" + reason + ")",
    lastGapMm, reason };
}

LoadPathStart LoadPathStart::Cold(std::vector<double> positions, const PlatePair& opened,
  const PlatePair& target, const CompressionOptions& options, double stepFactor)
{
  LoadPathStart start;
  start.Positions = std::move(positions);
  start.Plates = opened;
  start.Softness = Softening;
  const double allowed = stepFactor * options.LargestLoadStep * std::abs(GapMm(opened));
  const double way =
    Norm(opened.Support.Edge - target.Support.Edge) + Norm(opened.Paddle.Edge - target.Paddle.Edge);
  start.LargestStep = std::min(1.0, allowed / std::max(way, 1e-12));
  start.SmallestStep = SmallestColdStep;
  start.Patient = true;
  return start;
}

LoadPathStart LoadPathStart::Warm(const CompressionState& state, const PlatePair& target,
  const CompressionOptions& options)
{
  LoadPathStart start;
  start.Positions = state.Positions;
  // With friction, sliding along the plates' edges has an effect, so the plates stay.
  start.Plates = options.Friction > 0 ? state.Plates : SlidTowards(state.Plates, target);
  // Use the target's edge radii from the first step on.
  start.Plates.Support.EdgeRadiusMm = target.Support.EdgeRadiusMm;
  start.Plates.Paddle.EdgeRadiusMm = target.Paddle.EdgeRadiusMm;
  start.Stiffening = std::max(1.0, state.ContactStiffness / options.ContactStiffness);
  start.Softness = start.Stiffening;
  start.SmallestStep = SmallestWarmStep;
  start.MostNewtonSteps = WarmNewtonSteps;
  // Only short paths are tried with hard contact.
  const double travel = TravelMm(PlateMotion(start.Plates, target));
  if (!(travel <= ShortTravelMm))
  {
    // Harden again at the end, only as far as needed there, so that the result does not depend on
    // the start.
    start.Stiffening = 1;
    start.Softness = Softening;
    start.LargestStep = std::min(1.0, LongTravelMm / travel);
  }
  return start;
}

LoadPath::LoadPath(LoadStepSolver& solver, const CompressionOptions& options,
  const PlatePair& target, LoadPathStart start, const ProgressCallback& progress)
  : Solver(solver)
  , Options(options)
  , Target(target)
  , Start(std::move(start))
  , Progress(progress)
  , Motion(PlateMotion(Start.Plates, target))
  , Softness(Start.Softness)
  , TargetSoftness(Start.Stiffening)
  // Use equal steps, so that the last one is not a sliver.
  , Step(1 / std::ceil(1 / Start.LargestStep - 1e-9))
  , Hardening(LargestHardening)
  , LastGap(GapMm(Start.Plates))
{
  this->Current.Positions = this->Start.Positions;
  this->Current.Plates = this->Start.Plates;
  this->Current.ContactStiffness = this->StiffnessAt(this->Softness);
}

int LoadPath::IntermediateSteps() const
{
  return std::min(IntermediateNewtonSteps, this->Options.MaximumNewtonSteps);
}

double LoadPath::AtLeast(double tolerance) const
{
  return std::max(tolerance, this->Options.RelativeTolerance);
}

/// Newton steps do not advance the path, so they report the same fraction.
ProgressCallback LoadPath::StepProgress() const
{
  return [this](double, const char*)
  { return !this->Progress || this->Progress(this->Fraction, "compression"); };
}

void LoadPath::Fail(const std::string& reason) const
{
  throw NoEquilibrium(GapMm(this->Target), this->LastGap, reason);
}

/// Returns false and sets Reason if the step fails; otherwise the state is updated.
bool LoadPath::TakeStep(std::vector<double>& x, const LoadStep& step)
{
  const EquilibriumReport report = this->Solver.Solve(x, this->Current.Positions,
    this->Current.Plates, step, this->StepProgress());
  this->Current.NewtonSteps += report.NewtonSteps;
  this->Reason = report.Reason;
  if (report.Converged)
  {
    static_cast<EquilibriumMeasures&>(this->Current) = report;
    this->Current.Positions.swap(x);
    this->Current.Plates = step.Plates;
  }
  return report.Converged;
}

void LoadPath::ArriveFrom(std::vector<double> predicted)
{
  LoadStep step{ this->Target, this->StiffnessAt(this->Softness), UntanglingTolerance,
    this->IntermediateSteps() };
  this->Current.NewtonSteps += this->Solver.Untangle(predicted, step, this->StepProgress());
  step.Tolerance = ArrivalTolerance;
  if (this->TakeStep(predicted, step))
  {
    this->Current.LoadSteps = 1;
    this->Fraction = 1;
  }
}

void LoadPath::TakeClosingStep()
{
  ReportProgress(this->Progress, this->Fraction, "compression");
  const double next = this->Fraction + this->Step > 1 - 1e-9 ? 1 : this->Fraction + this->Step;
  const LoadStep step{ next == 1 ? this->Target
                                 : MovedPlates(this->Start.Plates, this->Motion, next),
    this->StiffnessAt(this->Softness), this->AtLeast(LoadStep::IntermediateTolerance),
    this->IntermediateSteps() };
  std::vector<double> x = this->Solver.Begin(this->Current.Positions, this->Current.Plates, step);
  if (!this->TakeStep(x, step))
  {
    if (this->Softness == this->TargetSoftness)
    {
      this->Softness *= Softening;
    }
    else
    {
      this->Step *= 0.5;
    }
    if (this->Step < this->Start.SmallestStep ||
      this->Current.NewtonSteps >= this->Start.MostNewtonSteps)
    {
      this->Fail(this->Reason);
    }
    return;
  }
  if (next < 1)
  {
    if (this->Current.SmallestJ >= SmallestAllowedJ(this->Options.Element))
    {
      this->LastGap = GapMm(step.Plates);
    }
    this->Solver.Arrived(this->Current.Positions, step.Plates);
  }
  ++this->Current.LoadSteps;
  this->Fraction = next;
}

void LoadPath::Harden()
{
  ReportProgress(this->Progress, this->Fraction, "compression");
  const double next = std::min(this->TargetSoftness, this->Softness * this->Hardening);
  const bool patient = this->Start.Patient && this->Hardening < PatientHardening;
  // With fully hardened contact, the penetration decides whether it must be harder still.
  const LoadStep step{ this->Target, this->StiffnessAt(next),
    this->AtLeast(next < this->TargetSoftness ? ArrivalTolerance : LoadStep::IntermediateTolerance),
    patient ? 2 * this->Options.MaximumNewtonSteps : this->IntermediateSteps() };
  std::vector<double> x = this->Current.Positions;
  if (this->TakeStep(x, step))
  {
    this->Softness = next;
    return;
  }
  this->Hardening = std::sqrt(this->Hardening);
  if (this->Hardening < SmallestHardening ||
    this->Current.NewtonSteps >= this->Start.MostNewtonSteps)
  {
    this->Fail(this->Reason);
  }
}

/// Solves to the final tolerance; nothing moves or hardens any more.
void LoadPath::Polish()
{
  ReportProgress(this->Progress, this->Fraction, "compression");
  const LoadStep step{ this->Target, this->StiffnessAt(this->Softness),
    this->Options.RelativeTolerance, this->Options.MaximumNewtonSteps };
  std::vector<double> x = this->Current.Positions;
  if (!this->TakeStep(x, step))
  {
    this->Fail(this->Reason);
  }
}

/// Raises the wanted stiffness if the penetration exceeds its limit; returns true if so.
bool LoadPath::StiffenWherePenetrated()
{
  // Penetration is inversely proportional to the stiffness; 0.999 leaves room for roundoff.
  const double excess =
    this->Current.LargestPenetrationMm / (0.999 * PenetrationLimitMm(this->Target));
  if (!(excess > 1))
  {
    return false;
  }
  this->TargetSoftness *= std::exp2(std::ceil(std::log2(excess)));
  if (this->TargetSoftness > LargestStiffening)
  {
    char reason[96];
    std::snprintf(reason, sizeof reason, "expected a penetration of at most %.3f mm, found %.3f mm",
      PenetrationLimitMm(this->Target), this->Current.LargestPenetrationMm);
    this->Fail(reason);
  }
  return true;
}

void LoadPath::Close()
{
  while (this->Fraction < 1)
  {
    this->TakeClosingStep();
  }
  this->Current.ContactStiffness = this->StiffnessAt(this->Softness);
}

void LoadPath::Complete()
{
  this->Close();
  for (bool polished = false; !polished;)
  {
    const bool hard = this->Softness == this->TargetSoftness && !this->StiffenWherePenetrated();
    if (hard)
    {
      this->Polish();
      polished = !this->StiffenWherePenetrated();
    }
    else
    {
      this->Harden();
    }
  }
  this->Current.ContactStiffness = this->StiffnessAt(this->Softness);
  const double smallest = SmallestAllowedJ(this->Options.Element);
  if (this->Current.SmallestJ < smallest)
  {
    char reason[96];
    std::snprintf(reason, sizeof reason,
      "expected every part to keep at least %.2f of its volume, found %.3f", smallest,
      this->Current.SmallestJ);
    this->Fail(reason);
  }
}
}
