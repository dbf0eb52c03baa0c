// SPDX-License-Identifier: Apache-2.0
#include "CompressionSimulation.h"

#include "EquilibriumSolver.h"
#include "Error.h"
#include "Private/CompressionInternals.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>

namespace mammoray
{
namespace
{
/// Equilibrium between load steps is only a start for the next one.
constexpr double IntermediateTolerance = 1e-3;
constexpr int IntermediateNewtonSteps = 40;
/// A warm start has little to lose, since its caller can take a smaller step: where it needs
/// halvings, it gives up after this many Newton steps in all.
constexpr int WarmNewtonSteps = 60;
/// A cold start closes the plates with contact softer by this factor, then hardens it in these
/// steps.
constexpr double Softening = 0.1;
constexpr double Hardening = 10;
/// Contact of a state that misses its penetration limit is made stiffer, by no more than this.
constexpr double LargestStiffening = 256;
/// Tissue hardly changes its volume. Where a quadrature point of a converged state has lost nine
/// tenths of it, a cell is squeezed flat between a plate's edge and the held body. A linear cell is
/// one of a patch that keeps its volume: at such edges some lose 95 % to their neighbours.
double SmallestAllowedJ(ElementType type)
{
  return type == ElementType::Quadratic ? 0.1 : 0.01;
}
/// A plate's travel up to which a warm start goes straight to the new plates, and the travel of one
/// load step of a longer way, mm.
constexpr double ShortTravelMm = 3;
constexpr double LongTravelMm = 6;

std::vector<bool> FixedCoordinates(const ElasticBody& body, const TetrahedralMesh& mesh,
  const std::vector<bool>& held)
{
  std::vector<bool> fixed(3 * body.NumberOfNodes(), false);
  bool any = false;
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    const auto material = static_cast<std::size_t>(mesh.Materials[cell]);
    if (material < held.size() && held[material])
    {
      any = true;
      for (int a = 0; a < body.NodesPerCell(); ++a)
      {
        const std::int32_t node = body.Cells()[body.NodesPerCell() * cell + a];
        fixed[3 * node] = fixed[3 * node + 1] = fixed[3 * node + 2] = true;
      }
    }
  }
  if (!any)
  {
    throw InputError("simulation mesh: expected cells of a held material (chest wall), found none: "
                     "the body could float away");
  }
  return fixed;
}

void CheckPlate(const Plate& plate, const char* name)
{
  const bool good = std::abs(Norm(plate.Normal) - 1) < 1e-6 &&
    std::abs(Norm(plate.Inward) - 1) < 1e-6 && std::abs(Dot(plate.Normal, plate.Inward)) < 1e-6 &&
    plate.EdgeRadiusMm >= 0 && std::isfinite(Norm(plate.Edge));
  if (!good)
  {
    throw InputError(std::string(name) +
      ": expected orthogonal unit vectors Normal and Inward and an edge radius of at least 0");
  }
}

/// The search for a force: how near is near enough, how far the plates go in one step, mm, and the
/// least step towards more force before the search gives up.
constexpr double ForceTolerance = 1e-4;
constexpr double LargestForceStepMm = 5;
constexpr double SmallestForceStepMm = 0.1;
constexpr int MostForceSteps = 60;
/// Part of the gap without contact at which that search begins.
constexpr double FirstGap = 0.85;

std::string InMm(double value)
{
  char text[32];
  std::snprintf(text, sizeof text, "%.2f mm", value);
  return text;
}
}

double GapMm(const PlatePair& plates)
{
  return Dot(plates.Paddle.Edge - plates.Support.Edge, plates.Support.Normal);
}

double PenetrationLimitMm(const PlatePair& plates)
{
  return std::max(0.05, 1e-3 * GapMm(plates));
}

CompressionSimulation::CompressionSimulation(const TetrahedralMesh& mesh,
  const std::vector<ElasticMaterial>& materials, const std::vector<bool>& held,
  const MaterialField& field, const CompressionOptions& options)
{
  if (!(options.ContactStiffness > 0) || !(options.RelativeTolerance > 0) ||
    options.MaximumNewtonSteps < 1 || !(options.LargestLoadStep > 0))
  {
    throw InputError("compression options: expected positive values");
  }
  ElasticBody body(mesh, materials, field, held, options.Element);
  std::vector<bool> fixed = FixedCoordinates(body, mesh, held);
  this->Internal = std::make_unique<Internals>(std::move(body), fixed, options);
  if (options.Element == ElementType::Quadratic)
  {
    CompressionOptions leading = options;
    leading.Element = ElementType::PatchAveragedLinear;
    this->Internal->Coarse =
      std::make_unique<CompressionSimulation>(mesh, materials, held, field, leading);
    this->Internal->InCoarse =
      std::make_unique<Embedding>(*this->Internal->Coarse, this->RestPositions());
  }
}

CompressionSimulation::~CompressionSimulation() = default;
CompressionSimulation::CompressionSimulation(CompressionSimulation&&) noexcept = default;
CompressionSimulation& CompressionSimulation::operator=(CompressionSimulation&&) noexcept = default;

CompressionState CompressionSimulation::Compress(const PlatePair& plates,
  const CompressionState* start, const ProgressCallback& progress) const
{
  return this->Run(plates, start, Finish::Complete, progress);
}

std::vector<double> CompressionSimulation::CoarsePositions(const PlatePair& plates,
  const ProgressCallback& progress) const
{
  const Internals& internal = *this->Internal;
  std::vector<double> positions;
  if (internal.Coarse)
  {
    try
    {
      const auto firstHalf = [&](double fraction, const char* stage)
      { return !progress || progress(0.5 * fraction, stage); };
      const CompressionState coarse =
        internal.Coarse->Run(plates, nullptr, Finish::Rough, firstHalf);
      positions = internal.InCoarse->Map(coarse.Positions);
      for (std::size_t c = 0; c < positions.size(); ++c)
      {
        positions[c] = internal.Fixed[c] ? this->RestPositions()[c] : positions[c];
      }
    }
    catch (const CompressionError&)
    {
      // What stops linear elements need not stop these.
    }
  }
  return positions;
}

CompressionState CompressionSimulation::Run(const PlatePair& plates,
  const CompressionState* start, Finish finish, const ProgressCallback& progress) const
{
  const auto begin = std::chrono::steady_clock::now();
  CheckPlate(plates.Support, "support");
  CheckPlate(plates.Paddle, "paddle");
  EquilibriumSolver& solver = this->Internal->Solver;
  const CompressionOptions& options = this->Internal->Options;
  const double smallestAllowedJ = SmallestAllowedJ(options.Element);

  CompressionState state;
  double wanted = 1;
  double largestStep = 1;
  if (start)
  {
    if (start->Positions.size() != this->RestPositions().size())
    {
      throw InputError("compression: the start is not a state of this simulation: expected " +
        std::to_string(this->RestPositions().size()) + " coordinates, found " +
        std::to_string(start->Positions.size()));
    }
    state.Positions = start->Positions;
    state.Plates = SlidTowards(start->Plates, plates);
    // The edges are rounded as asked from the first step on.
    state.Plates.Support.EdgeRadiusMm = plates.Support.EdgeRadiusMm;
    state.Plates.Paddle.EdgeRadiusMm = plates.Paddle.EdgeRadiusMm;
    wanted = std::max(1.0, start->ContactStiffness / options.ContactStiffness);
  }
  else
  {
    state.Positions = this->RestPositions();
    const std::array<double, 2> opening = solver.Opening(state.Positions, plates);
    state.Plates = plates;
    state.Plates.Support.Edge = plates.Support.Edge - opening[0] * plates.Support.Normal;
    state.Plates.Paddle.Edge = plates.Paddle.Edge - opening[1] * plates.Paddle.Normal;
    const double allowed = options.LargestLoadStep * std::abs(GapMm(state.Plates));
    largestStep = std::min(1.0, allowed / std::max(opening[0] + opening[1], 1e-12));
  }

  const PlatePair first = state.Plates;
  const PlatePairVelocity motion = PlateMotion(first, plates);
  // The way is gone with soft contact, on which Newton's method finds its way in a few steps; only
  // a short one from a state of hard contact is tried as it is.
  double softness = start && TravelMm(motion) <= ShortTravelMm ? wanted : Softening * wanted;
  if (start && softness < wanted)
  {
    largestStep = std::min(1.0, LongTravelMm / TravelMm(motion));
  }
  const double smallestStep = start ? 0.1 : 5e-3;
  // Equal steps: the last one should not be a sliver.
  double step = 1 / std::ceil(1 / largestStep - 1e-9);
  double done = 0;
  double hardening = Hardening;
  const auto continued = [&](double, const char*)
  { return !progress || progress(done, "compression"); };
  double lastGap = GapMm(state.Plates);
  const auto fail = [&](const std::string& reason)
  {
    throw CompressionError("compression: expected equilibrium at a gap of " + InMm(GapMm(plates)) +
        ", the last one reached is at " + InMm(lastGap) + " (" + reason + ")",
      lastGap);
  };
  const auto keep = [&](const EquilibriumReport& report, std::vector<double>& positions)
  {
    state.Positions.swap(positions);
    state.PaddleForceN = report.PaddleForceN;
    state.SupportForceN = report.SupportForceN;
    state.LargestPenetrationMm = report.LargestPenetrationMm;
    state.SmallestJ = report.SmallestJ;
    state.LargestJ = report.LargestJ;
    state.VolumeRatio = report.VolumeRatio;
    state.RelativeResidual = report.RelativeResidual;
  };
  if (!start)
  {
    std::vector<double> positions = this->CoarsePositions(plates, progress);
    if (!positions.empty() && solver.Admissible(positions))
    {
      solver.SetContactStiffness(options.ContactStiffness * softness);
      const EquilibriumReport report = solver.Solve(positions, &plates, IntermediateTolerance,
        std::min(IntermediateNewtonSteps, options.MaximumNewtonSteps), continued);
      state.NewtonSteps += report.NewtonSteps;
      if (report.Converged)
      {
        keep(report, positions);
        state.Plates = plates;
        state.LoadSteps = 1;
        done = 1;
      }
    }
  }
  for (bool polished = finish == Finish::Rough && done == 1; !polished;)
  {
    ReportProgress(progress, done, "compression");
    const double next = done + step > 1 - 1e-9 ? 1 : done + step;
    const double nextSoftness = done < 1 ? softness : std::min(wanted, softness * hardening);
    // A state where nothing is left to move or to harden is solved to the end.
    const bool last = done == 1 && softness == wanted;
    solver.SetContactStiffness(options.ContactStiffness * nextSoftness);
    // Contact that hardens by a little and still resists has a snap to go through, which takes
    // Newton's method its time; smaller steps do not shorten it.
    const bool patient = !start && done == 1 && hardening < 2;
    const PlatePair target = next == 1 ? plates : MovedPlates(first, motion, next);
    std::vector<double> positions = state.Positions;
    if (done < 1)
    {
      const std::vector<double> guess =
        solver.Predict(state.Positions, state.Plates, PlateMotion(state.Plates, target));
      for (std::size_t c = 0; c < positions.size(); ++c)
      {
        positions[c] += guess[c];
      }
      if (!solver.Admissible(positions))
      {
        positions = state.Positions;
      }
    }
    const EquilibriumReport report = solver.Solve(positions, &target,
      last ? options.RelativeTolerance : std::max(IntermediateTolerance, options.RelativeTolerance),
      last        ? options.MaximumNewtonSteps
        : patient ? 2 * options.MaximumNewtonSteps
                  : std::min(IntermediateNewtonSteps, options.MaximumNewtonSteps),
      continued);
    state.NewtonSteps += report.NewtonSteps;
    if (!report.Converged)
    {
      if (done < 1 && softness == wanted)
      {
        softness *= Softening;
      }
      else if (done < 1)
      {
        step *= 0.5;
      }
      else
      {
        hardening = std::sqrt(hardening);
      }
      if (last || step < smallestStep || hardening < 1.01 ||
        (start && state.NewtonSteps >= WarmNewtonSteps))
      {
        fail(report.Reason);
      }
      continue;
    }
    keep(report, positions);
    state.Plates = target;
    if (done < 1 && next < 1 && report.SmallestJ >= smallestAllowedJ)
    {
      lastGap = GapMm(target);
    }
    state.LoadSteps += done < 1;
    done = next;
    softness = nextSoftness;
    polished = last || (finish == Finish::Rough && done == 1);
    // Penetration is inverse to the stiffness; a thousandth is left for the last digits.
    const double excess = state.LargestPenetrationMm / (0.999 * PenetrationLimitMm(plates));
    if (finish == Finish::Complete && done == 1 && softness == wanted && excess > 1)
    {
      polished = false;
      wanted *= std::exp2(std::ceil(std::log2(excess)));
      if (wanted > LargestStiffening)
      {
        char reason[96];
        std::snprintf(reason, sizeof reason,
          "there a penetration of %.3f mm is left, expected at most %.3f mm",
          state.LargestPenetrationMm, PenetrationLimitMm(plates));
        fail(reason);
      }
    }
  }
  if (finish == Finish::Complete && state.SmallestJ < smallestAllowedJ)
  {
    char reason[96];
    std::snprintf(reason, sizeof reason,
      "there a part keeps %.3f of its volume, expected at least %.2f", state.SmallestJ,
      smallestAllowedJ);
    fail(reason);
  }
  state.ContactStiffness = options.ContactStiffness * softness;
  ReportProgress(progress, 1, "compression");
  state.Seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return state;
}

std::vector<std::vector<double>> CompressionSimulation::Sensitivities(const CompressionState& state,
  const std::vector<PlatePairVelocity>& velocities,
  const std::vector<MaterialVelocity>& materialVelocities) const
{
  if (state.Positions.size() != this->RestPositions().size())
  {
    throw InputError("sensitivities: expected a state of this simulation");
  }
  this->Internal->Solver.SetContactStiffness(
    state.ContactStiffness > 0 ? state.ContactStiffness : this->Internal->Options.ContactStiffness);
  return this->Internal->Solver.Sensitivities(state.Positions, state.Plates, velocities,
    materialVelocities);
}

double CompressionSimulation::PaddleForceRate(const CompressionState& state,
  const PlatePairVelocity& velocity) const
{
  const std::vector<double> rates = this->Sensitivities(state, { velocity }).front();
  return this->Internal->Solver.PaddleForceRate(state.Positions, state.Plates, velocity, rates);
}

CompressionState CompressionSimulation::CompressToForce(const PlatePair& plates,
  const PlatePairVelocity& closing, double forceN, const ProgressCallback& progress) const
{
  const auto begin = std::chrono::steady_clock::now();
  CheckPlate(plates.Support, "support");
  CheckPlate(plates.Paddle, "paddle");
  const double speed = GapMm(plates) - GapMm(MovedPlates(plates, closing, 1));
  if (!(forceN > 0) || !std::isfinite(forceN) || !(speed > 0))
  {
    throw InputError("compression: expected a positive force and a motion that closes the plates");
  }
  const std::array<double, 2> opening =
    this->Internal->Solver.Opening(this->RestPositions(), plates);
  // `at` and the bracket count mm that the gap was closed by, from the plates given.
  const double open = GapMm(plates) + opening[0] + opening[1];
  double at = GapMm(plates) - FirstGap * open;
  const auto platesAt = [&](double closed) { return MovedPlates(plates, closing, closed / speed); };
  CompressionState state = this->Compress(platesAt(at), nullptr, progress);
  double tooLittle = -std::numeric_limits<double>::infinity();
  double tooMuch = std::numeric_limits<double>::infinity();
  int newtonSteps = state.NewtonSteps;
  int loadSteps = state.LoadSteps;
  double allowed = LargestForceStepMm;
  for (int step = 0; std::abs(state.PaddleForceN / forceN - 1) > ForceTolerance; ++step)
  {
    (state.PaddleForceN < forceN ? tooLittle : tooMuch) = at;
    // The force grows faster than in proportion to the way: its logarithm is nearer to a line.
    double by = state.PaddleForceN < forceN ? allowed : -allowed;
    if (state.PaddleForceN > 0)
    {
      const double rate = this->PaddleForceRate(state, closing) / speed;
      const double wanted = std::log(forceN / state.PaddleForceN) * state.PaddleForceN / rate;
      by = rate > 0 ? std::clamp(wanted, -allowed, allowed) : by;
    }
    if (!(at + by > tooLittle && at + by < tooMuch))
    {
      by = 0.5 * (tooLittle + tooMuch) - at;
    }
    std::string reason;
    if (step == MostForceSteps)
    {
      reason = "not reached in " + std::to_string(step) + " steps";
    }
    else
    {
      try
      {
        state = this->Compress(platesAt(at + by), &state, progress);
        at += by;
        newtonSteps += state.NewtonSteps;
        loadSteps += state.LoadSteps;
        continue;
      }
      catch (const CompressionError& error)
      {
        allowed = 0.5 * std::min(allowed, std::abs(by));
        if (allowed > SmallestForceStepMm)
        {
          continue;
        }
        reason = "the plates cannot be closed farther";
      }
    }
    char text[160];
    std::snprintf(text, sizeof text,
      "compression: expected a force of %.2f N, found %.2f N at the last gap, %.2f mm (%s)", forceN,
      state.PaddleForceN, GapMm(state.Plates), reason.c_str());
    throw CompressionError(text, GapMm(state.Plates));
  }
  state.NewtonSteps = newtonSteps;
  state.LoadSteps = loadSteps;
  state.Seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return state;
}

void CompressionSimulation::SetMaterials(const std::vector<ElasticMaterial>& materials)
{
  this->Internal->Body.SetMaterials(materials);
  if (this->Internal->Coarse)
  {
    this->Internal->Coarse->SetMaterials(materials);
  }
  this->Internal->Solver.MaterialsChanged();
}

const std::vector<ElasticMaterial>& CompressionSimulation::Materials() const
{
  return this->Internal->Body.Materials();
}

std::vector<CellMeasures> CompressionSimulation::MeasuresOf(const CompressionState& state) const
{
  const ElasticBody& body = this->Internal->Body;
  if (state.Positions.size() != body.RestPositions().size())
  {
    throw InputError("cell measures: expected a state of this simulation");
  }
  std::vector<CellMeasures> measures;
  for (std::size_t cell = 0; cell < body.NumberOfCells(); ++cell)
  {
    measures.push_back(body.MeasuresOf(cell, state.Positions));
  }
  return measures;
}

std::size_t CompressionSimulation::NumberOfNodes() const
{
  return this->Internal->Body.NumberOfNodes();
}

std::size_t CompressionSimulation::NumberOfUnknowns() const
{
  return this->Internal->Solver.NumberOfUnknowns();
}

const std::vector<double>& CompressionSimulation::RestPositions() const
{
  return this->Internal->Body.RestPositions();
}
}
