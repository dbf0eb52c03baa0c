// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Biomechanics/CompressionSimulation.h"

#include "Private/CellPatches.h"
#include "Private/CompressionInternals.h"
#include "mammoray/Biomechanics/EquilibriumSolver.h"
#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

namespace mammoray
{
namespace
{
/// Equilibrium between load steps is only a start for the next one.
constexpr double IntermediateTolerance = 1e-3;
/// The same between the plates asked for, where contact is still to be hardened: with the plates at
/// rest there is no way to lose.
constexpr double ArrivalTolerance = 5e-2;
constexpr int IntermediateNewtonSteps = 40;
/// Of the largest load step, where a cold start failed.
constexpr double SmallerLoadStep = 0.37;
/// Of a start that another mesh gave and in which cells are inverted.
constexpr double UntanglingTolerance = 3e-2;
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
/// Of the residual with the normal forces of friction brought up to date, and how often they are.
/// Friction is a part of the forces, known to some per cent at best.
constexpr double FrictionTolerance = 1e-4;
constexpr double IntermediateFrictionTolerance = 5e-2;
constexpr int MostFrictionUpdates = 60;
/// A residual that does not fall below this part of the last one calls for smaller updates, down to
/// that.
constexpr double StalledFriction = 0.95;
constexpr double SmallestFrictionPart = 1.0 / 16;
/// Least part of the loads that is added at a time while a breast settles.
constexpr double SmallestSettlingStep = 1.0 / 64;
constexpr int MostUnloadingSteps = 200;
/// Weight of 1 g/cm^3 at 1 m/s^2 in kPa mm^2 per mm^3.
constexpr double WeightDensity = 1e-3;
/// A plate's travel up to which a warm start goes straight to the new plates, and the travel of one
/// load step of a longer way, mm.
constexpr double ShortTravelMm = 3;
constexpr double LongTravelMm = 6;

std::vector<bool> CellsOf(const TetrahedralMesh& mesh, const std::vector<bool>& held)
{
  std::vector<bool> cells(mesh.NumberOfCells(), false);
  for (std::size_t cell = 0; cell < cells.size(); ++cell)
  {
    const auto material = static_cast<std::size_t>(mesh.Materials[cell]);
    cells[cell] = material < held.size() && held[material];
  }
  if (std::find(cells.begin(), cells.end(), true) == cells.end())
  {
    throw InputError("simulation mesh: expected cells of a held material (chest wall), found none: "
                     "the body could float away");
  }
  return cells;
}

/// Every coordinate of a node of a held cell, unless the breast can move along the chest wall.
std::vector<bool> FixedCoordinates(const ElasticBody& body, const std::vector<bool>& heldCells,
  ChestWallMode mode)
{
  std::vector<bool> fixed(3 * body.NumberOfNodes(), false);
  for (std::size_t cell = 0; cell < heldCells.size() && mode == ChestWallMode::Held; ++cell)
  {
    for (int a = 0; a < body.NodesPerCell() && heldCells[cell]; ++a)
    {
      const std::int32_t node = body.Cells()[body.NodesPerCell() * cell + a];
      fixed[3 * node] = fixed[3 * node + 1] = fixed[3 * node + 2] = true;
    }
  }
  return fixed;
}

void CheckOptions(const CompressionOptions& options)
{
  if (!(options.ContactStiffness > 0) || !(options.RelativeTolerance > 0) ||
    options.MaximumNewtonSteps < 1 || !(options.LargestLoadStep > 0))
  {
    throw InputError("compression options: expected positive values");
  }
  if (!(options.Wall.Normal > 0) || !std::isfinite(options.Wall.Normal) ||
    !(options.Wall.Tangential >= 0) || !std::isfinite(options.Wall.Tangential))
  {
    throw InputError("compression options: expected a positive stiffness across the chest wall and "
                     "one of at least 0 along it, found " +
      std::to_string(options.Wall.Normal) + " and " + std::to_string(options.Wall.Tangential) +
      " kPa/mm");
  }
  if (!(options.Friction >= 0) || !std::isfinite(options.Friction))
  {
    throw InputError(
      "compression options: expected a coefficient of friction of at least 0, found " +
      std::to_string(options.Friction));
  }
  if (!std::isfinite(Norm(options.GravityMPerS2)) || !std::isfinite(Norm(options.PullN)))
  {
    throw InputError("compression options: expected finite gravity and pull");
  }
}

/// A predictor serves where the way is simple: its breast hangs and rubs otherwise.
bool CanBePredicted(const CompressionOptions& options)
{
  return options.ChestWall == ChestWallMode::Held && options.Friction == 0 &&
    Norm(options.GravityMPerS2) == 0 && Norm(options.PullN) == 0;
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

CompressionError NoEquilibrium(double gapMm, double lastGapMm, const std::string& reason)
{
  return { "compression: expected equilibrium at a gap of " + InMm(gapMm) +
      ", the last one reached is at " + InMm(lastGapMm) + " (" + reason + ")",
    lastGapMm, reason };
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

CompressionSimulation::Internals::Internals(ElasticBody body, std::vector<bool> heldCells,
  std::size_t pointCount, const CompressionOptions& options)
  : Body(std::move(body))
  , Options(options)
  , HeldCells(std::move(heldCells))
  , Fixed(FixedCoordinates(Body, HeldCells, options.ChestWall))
  , Solver(Body, Fixed, options.ContactStiffness, HeldCells)
  , Image(Body.RestPositions())
  , NumberOfPoints(pointCount)
{
  if (options.ChestWall != ChestWallMode::Held)
  {
    this->Wall.emplace(this->Body, this->HeldCells);
    const bool slides = options.ChestWall == ChestWallMode::Sliding;
    this->Solver.SetWall(&*this->Wall,
      { options.Wall.Normal,
        slides ? CompressionOptions::SlidingStiffness : options.Wall.Tangential });
    this->FindFollowers();
  }
}

void CompressionSimulation::Internals::FindFollowers()
{
  if (this->Body.Type() != ElementType::Quadratic)
  {
    return;
  }
  std::vector<bool> free(this->Body.NumberOfNodes(), false);
  for (std::size_t index = 0; index < this->Body.Cells().size(); ++index)
  {
    if (!this->HeldCells[index / this->Body.NodesPerCell()])
    {
      free[this->Body.Cells()[index]] = true;
    }
  }
  for (std::size_t cell = 0; cell < this->HeldCells.size(); ++cell)
  {
    const std::int32_t* nodes = &this->Body.Cells()[10 * cell];
    for (int e = 0; e < 6 && this->HeldCells[cell]; ++e)
    {
      const std::int32_t ends[2] = { nodes[CellEdges[e][0]], nodes[CellEdges[e][1]] };
      if (!free[nodes[4 + e]] && (free[ends[0]] || free[ends[1]]))
      {
        this->Followers.push_back({ nodes[4 + e], ends[0], ends[1] });
      }
    }
  }
}

void CompressionSimulation::Internals::DrawAlong(std::vector<double>& values) const
{
  for (const auto& [middle, a, b] : this->Followers)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      values[3 * middle + axis] = 0.5 * (values[3 * a + axis] + values[3 * b + axis]);
    }
  }
}

std::vector<double> CompressionSimulation::Internals::Loads(const Vector3& gravityMPerS2,
  const Vector3& pullN) const
{
  if (Norm(gravityMPerS2) == 0 && Norm(pullN) == 0)
  {
    return {};
  }
  std::vector<double> density(this->Body.NumberOfCells(), 0.0);
  std::vector<double> tissue(this->Body.NumberOfCells(), 0.0);
  double volume = 0;
  for (std::size_t cell = 0; cell < density.size(); ++cell)
  {
    if (!this->HeldCells[cell])
    {
      density[cell] = WeightDensity * this->Body.CellDensity(cell);
      tissue[cell] = 1;
      volume += this->Body.CellVolume(cell);
    }
  }
  const std::vector<double> weight = this->Body.NodeIntegrals(density);
  const std::vector<double> part = this->Body.NodeIntegrals(tissue);
  std::vector<double> loads(3 * this->Body.NumberOfNodes());
  for (std::size_t c = 0; c < loads.size(); ++c)
  {
    loads[c] = weight[c / 3] * gravityMPerS2[c % 3] + 1e3 * part[c / 3] / volume * pullN[c % 3];
  }
  return loads;
}

void CompressionSimulation::Internals::SettleUnder(std::vector<double> loads,
  std::vector<double>& x, const ProgressCallback& progress)
{
  this->Solver.SetFriction({});
  std::vector<double> part(loads.size());
  double step = 1;
  for (double done = 0; done < 1;)
  {
    const double next = std::min(1.0, done + step);
    std::transform(loads.begin(), loads.end(), part.begin(),
      [=](double load) { return next * load; });
    this->Solver.SetLoads(part);
    std::vector<double> positions = x;
    const EquilibriumReport report = this->Solver.Solve(positions, nullptr,
      next < 1 ? IntermediateTolerance : this->Options.RelativeTolerance,
      this->Options.MaximumNewtonSteps, progress);
    if (report.Converged)
    {
      x.swap(positions);
      done = next;
      continue;
    }
    step *= 0.5;
    if (step < SmallestSettlingStep)
    {
      char reason[160];
      std::snprintf(reason, sizeof reason,
        "compression: expected equilibrium under gravity and pull, found none beyond %.2f of them "
        "(",
        done);
      throw ConvergenceError(reason + report.Reason + ")");
    }
  }
  this->DrawAlong(x);
}

const std::vector<double>& CompressionSimulation::Internals::SettledPositions(
  const ProgressCallback& progress)
{
  if (this->Settled.empty())
  {
    std::vector<double> positions = this->Body.RestPositions();
    std::vector<double> loads = this->Loads(this->Options.GravityMPerS2, this->Options.PullN);
    if (!loads.empty())
    {
      this->SettleUnder(std::move(loads), positions, progress);
    }
    this->Settled.swap(positions);
  }
  return this->Settled;
}

void CompressionSimulation::Internals::SetRestCorners(const std::vector<double>& corners)
{
  this->Body.SetRestCorners(corners);
  if (this->Wall)
  {
    this->Wall->SetRestPositions(this->Body.RestPositions());
  }
  this->Solver.BodyChanged();
  this->Settled.clear();
  for (std::size_t cell = 0; cell < this->HeldCells.size(); ++cell)
  {
    if (!this->HeldCells[cell] && !(this->Body.CellVolume(cell) > 0))
    {
      throw ConvergenceError("unloading: expected a shape without load, found cell " +
        std::to_string(cell) +
        " turned inside out on the way: the tissue is too soft for this "
        "gravity");
    }
  }
}

void CompressionSimulation::Internals::Recall(const CompressionState& state)
{
  this->Solver.SetContactStiffness(
    state.ContactStiffness > 0 ? state.ContactStiffness : this->Options.ContactStiffness);
  this->Solver.SetFriction(state.Friction ? *state.Friction : FrictionPoints());
  this->Solver.SetLoads(this->Loads(this->Options.GravityMPerS2, this->Options.PullN));
}

EquilibriumReport CompressionSimulation::Internals::Solve(std::vector<double>& x,
  const PlatePair& plates, const CompressionState& last,
  const EquilibriumSolver::FrictionStart& before, double tolerance, int maximumSteps,
  const ProgressCallback& progress)
{
  const double mu = this->Options.Friction;
  if (mu == 0)
  {
    return this->Solver.Solve(x, &plates, tolerance, maximumSteps, progress);
  }
  this->Solver.SetFriction(this->Solver.FrictionAt(last.Positions, last.Plates, mu, before));
  const double wanted =
    tolerance < IntermediateTolerance ? FrictionTolerance : IntermediateFrictionTolerance;
  int newtonSteps = 0;
  double part = 0.5;
  double residualBefore = std::numeric_limits<double>::infinity();
  for (int update = 0;; ++update)
  {
    EquilibriumReport report = this->Solver.Solve(x, &plates, tolerance, maximumSteps, progress);
    newtonSteps += report.NewtonSteps;
    report.NewtonSteps = newtonSteps;
    if (!report.Converged)
    {
      return report;
    }
    FrictionPoints used = this->Solver.Friction();
    const FrictionPoints found = this->Solver.FrictionAt(x, plates, mu, before);
    this->Solver.SetFriction(found);
    const double residual = this->Solver.Evaluate(x, &plates).RelativeResidual;
    if (residual <= wanted)
    {
      this->Solver.SetFriction(std::move(used));
      return report;
    }
    if (update == MostFrictionUpdates)
    {
      char reason[128];
      std::snprintf(reason, sizeof reason,
        "relative residual %.2g after %d updates of friction, expected at most %.2g", residual,
        update, wanted);
      report.Converged = false;
      report.Reason = reason;
      return report;
    }
    // All of the change overshoots: friction that grows unloads its own contact.
    part = residual > StalledFriction * residualBefore ? std::max(0.5 * part, SmallestFrictionPart)
                                                       : part;
    residualBefore = residual;
    this->Solver.SetFriction(BlendedFriction(std::move(used), found, part));
  }
}

CompressionSimulation::CompressionSimulation(const TetrahedralMesh& mesh,
  const std::vector<ElasticMaterial>& materials, const std::vector<bool>& held,
  const MaterialField& field, const CompressionOptions& options)
{
  CheckOptions(options);
  ElasticBody body(mesh, materials, field, held, options.Element);
  this->Internal = std::make_unique<Internals>(std::move(body), CellsOf(mesh, held),
    mesh.NumberOfPoints(), options);
  if (options.Element == ElementType::Quadratic && CanBePredicted(options))
  {
    CompressionOptions linear = options;
    linear.Element = ElementType::PatchAveragedLinear;
    this->SetPredictor(
      std::make_unique<CompressionSimulation>(mesh, materials, held, field, linear));
  }
}

CompressionSimulation::~CompressionSimulation() = default;
CompressionSimulation::CompressionSimulation(CompressionSimulation&&) noexcept = default;
CompressionSimulation& CompressionSimulation::operator=(CompressionSimulation&&) noexcept = default;

void CompressionSimulation::SetPredictor(std::unique_ptr<CompressionSimulation> predictor)
{
  if (predictor && predictor->Materials().size() != this->Materials().size())
  {
    throw InputError("predictor: expected " + std::to_string(this->Materials().size()) +
      " materials, found " + std::to_string(predictor->Materials().size()));
  }
  if (!predictor || !CanBePredicted(this->Internal->Options))
  {
    return;
  }
  this->Internal->InPredictor = std::make_unique<Embedding>(*predictor, this->RestPositions());
  this->Internal->Predictor = std::move(predictor);
}

void CompressionSimulation::Unload(const Vector3& gravityMPerS2, const ProgressCallback& progress)
{
  Internals& internal = *this->Internal;
  if (!std::isfinite(Norm(gravityMPerS2)))
  {
    throw InputError("unloading: expected a finite gravity");
  }
  const std::vector<double> given = internal.Body.RestPositions();
  const std::vector<double> image(internal.Image.begin(),
    internal.Image.begin() + 3 * static_cast<std::ptrdiff_t>(internal.NumberOfPoints));
  std::vector<double> corners = image;
  std::vector<double> loaded = internal.Image;
  try
  {
    for (int step = 0;; ++step)
    {
      ReportProgress(progress, static_cast<double>(step) / MostUnloadingSteps, "unloading");
      internal.SetRestCorners(corners);
      internal.SettleUnder(internal.Loads(gravityMPerS2, { 0, 0, 0 }), loaded, progress);
      double farthest = 0;
      for (std::size_t c = 0; c < corners.size(); ++c)
      {
        const double off = image[c] - loaded[c];
        farthest = std::max(farthest, std::abs(off));
        corners[c] += off;
      }
      if (farthest <= UnloadToleranceMm)
      {
        break;
      }
      if (step == MostUnloadingSteps)
      {
        throw ConvergenceError("unloading: expected the image's shape to " +
          InMm(UnloadToleranceMm) + ", found it off by " + InMm(farthest) + " after " +
          std::to_string(step) + " steps");
      }
    }
  }
  catch (...)
  {
    internal.SetRestCorners(given);
    throw;
  }
  internal.Image = std::move(loaded);
  internal.Predictor.reset(); // which knows nothing of the new shape
}

PlatePair CompressionSimulation::OpenedPlates(const PlatePair& plates,
  const ProgressCallback& progress) const
{
  const std::array<double, 2> opening =
    this->Internal->Solver.Opening(this->Internal->SettledPositions(progress), plates);
  PlatePair opened = plates;
  opened.Support.Edge = plates.Support.Edge - opening[0] * plates.Support.Normal;
  opened.Paddle.Edge = plates.Paddle.Edge - opening[1] * plates.Paddle.Normal;
  return opened;
}

CompressionState CompressionSimulation::Compress(const PlatePair& plates,
  const CompressionState* start, const ProgressCallback& progress, Refusal refusal) const
{
  if (start)
  {
    return this->Run(plates, start, Finish::Complete, progress);
  }
  try
  {
    return this->RunCold(plates, progress);
  }
  catch (const CompressionError& error)
  {
    if (refusal == Refusal::AtOnce)
    {
      throw;
    }
    // The way is gone with soft contact; what was reached there need not be an equilibrium.
    throw NoEquilibrium(GapMm(plates), this->LeastGapMm(plates, error.LastGapMm(), progress),
      error.Reason());
  }
}

CompressionState CompressionSimulation::RunCold(const PlatePair& plates,
  const ProgressCallback& progress) const
{
  try
  {
    return this->Run(plates, nullptr, Finish::Complete, progress);
  }
  catch (const CompressionError& first)
  {
    try
    {
      // Where tissue folds, another way may lead past the fold.
      return this->Run(plates, nullptr, Finish::Complete, progress, SmallerLoadStep);
    }
    catch (const CompressionError& second)
    {
      throw second.LastGapMm() < first.LastGapMm() ? second : first;
    }
  }
}

double CompressionSimulation::LeastGapMm(const PlatePair& plates, double fromMm,
  const ProgressCallback& progress) const
{
  const PlatePair open = this->OpenedPlates(plates, progress);
  const PlatePairVelocity closing = PlateMotion(open, plates);
  const double way = GapMm(open) - GapMm(plates);
  for (double gap = fromMm; gap < GapMm(open); gap *= 1.15)
  {
    try
    {
      this->RunCold(MovedPlates(open, closing, (GapMm(open) - gap) / way), progress);
      return gap;
    }
    catch (const CompressionError&)
    {
      // Not here; more open.
    }
  }
  return GapMm(open);
}

std::vector<double> CompressionSimulation::PredictedPositions(const PlatePair& plates,
  const ProgressCallback& progress) const
{
  const Internals& internal = *this->Internal;
  std::vector<double> positions;
  if (internal.Predictor)
  {
    try
    {
      const auto firstHalf = [&](double fraction, const char* stage)
      { return !progress || progress(0.5 * fraction, stage); };
      const CompressionState predicted =
        internal.Predictor->Run(plates, nullptr, Finish::Prediction, firstHalf);
      positions = internal.InPredictor->Map(predicted.Positions);
      for (std::size_t c = 0; c < positions.size(); ++c)
      {
        positions[c] = internal.Fixed[c] ? this->RestPositions()[c] : positions[c];
      }
    }
    catch (const CompressionError&)
    {
      // What stops its elements need not stop these.
    }
  }
  return positions;
}

CompressionState CompressionSimulation::Run(const PlatePair& plates, const CompressionState* start,
  Finish finish, const ProgressCallback& progress, double loadStepFactor) const
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
    // Plates that rub do not slide along their edges unfelt.
    state.Plates = options.Friction > 0 ? start->Plates : SlidTowards(start->Plates, plates);
    // The edges are rounded as asked from the first step on.
    state.Plates.Support.EdgeRadiusMm = plates.Support.EdgeRadiusMm;
    state.Plates.Paddle.EdgeRadiusMm = plates.Paddle.EdgeRadiusMm;
    wanted = std::max(1.0, start->ContactStiffness / options.ContactStiffness);
  }
  else
  {
    state.Positions = this->Internal->SettledPositions(progress);
    state.Plates = this->OpenedPlates(plates, progress);
    const double allowed = loadStepFactor * options.LargestLoadStep * std::abs(GapMm(state.Plates));
    const double way = Norm(state.Plates.Support.Edge - plates.Support.Edge) +
      Norm(state.Plates.Paddle.Edge - plates.Paddle.Edge);
    largestStep = std::min(1.0, allowed / std::max(way, 1e-12));
  }
  solver.SetLoads(this->Internal->Loads(options.GravityMPerS2, options.PullN));
  // Anchors of friction are those of the state at which the load step began.
  EquilibriumSolver::FrictionStart before{ {}, state.Positions, state.Plates };
  if (start && start->Friction)
  {
    before.Dragged = solver.DraggedTo(state.Positions, state.Plates, *start->Friction);
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
  { throw NoEquilibrium(GapMm(plates), lastGap, reason); };
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
    state.LargestWallLiftMm = report.LargestWallLiftMm;
    state.LargestWallGlideMm = report.LargestWallGlideMm;
  };
  if (!start)
  {
    std::vector<double> positions = this->PredictedPositions(plates, progress);
    if (!positions.empty())
    {
      solver.SetContactStiffness(options.ContactStiffness * softness);
      if (!solver.Admissible(positions))
      {
        state.NewtonSteps +=
          solver
            .Untangle(positions, &plates, UntanglingTolerance,
              std::min(IntermediateNewtonSteps, options.MaximumNewtonSteps), continued)
            .NewtonSteps;
      }
      const EquilibriumReport report = solver.Solve(positions, &plates, ArrivalTolerance,
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
  for (bool polished = finish == Finish::Prediction && done == 1; !polished;)
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
      before.Positions = state.Positions;
      before.Plates = state.Plates;
      solver.SetFriction(options.Friction > 0
          ? solver.FrictionAt(state.Positions, state.Plates, options.Friction, before)
          : FrictionPoints());
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
    // Of contact as hard as wanted the penetration decides whether it is to be harder still.
    const double rough =
      done == 1 && nextSoftness < wanted ? ArrivalTolerance : IntermediateTolerance;
    const EquilibriumReport report = this->Internal->Solve(positions, target, state, before,
      last ? options.RelativeTolerance : std::max(rough, options.RelativeTolerance),
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
    if (next < 1)
    {
      before.Dragged = solver.DraggedTo(state.Positions, target, solver.Friction());
    }
    state.LoadSteps += done < 1;
    done = next;
    softness = nextSoftness;
    polished = last || (finish == Finish::Prediction && done == 1);
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
  this->Internal->DrawAlong(state.Positions);
  state.ContactStiffness = options.ContactStiffness * softness;
  if (options.Friction > 0)
  {
    state.Friction = std::make_shared<const FrictionPoints>(solver.Friction());
  }
  state.FactorMiB = solver.PeakFactorBytes() / (1 << 20);
  ReportProgress(progress, 1, "compression");
  state.Seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return state;
}

std::vector<std::vector<double>> CompressionSimulation::Sensitivities(const CompressionState& state,
  const std::vector<PlatePairVelocity>& velocities,
  const std::vector<MaterialVelocity>& materialVelocities,
  const std::vector<LoadingVelocity>& loadingVelocities) const
{
  if (state.Positions.size() != this->RestPositions().size())
  {
    throw InputError("sensitivities: expected a state of this simulation");
  }
  std::vector<HoldingVelocity> holding;
  for (const LoadingVelocity& velocity : loadingVelocities)
  {
    holding.push_back({ velocity.Wall, velocity.Friction,
      this->Internal->Loads(velocity.GravityMPerS2, velocity.PullN) });
  }
  this->Internal->Recall(state);
  std::vector<std::vector<double>> rates = this->Internal->Solver.Sensitivities(state.Positions,
    state.Plates, velocities, materialVelocities, holding);
  for (std::vector<double>& rate : rates)
  {
    this->Internal->DrawAlong(rate);
  }
  return rates;
}

double CompressionSimulation::PaddleForceRate(const CompressionState& state,
  const PlatePairVelocity& velocity) const
{
  const std::vector<double> rates = this->Sensitivities(state, { velocity }).front();
  return this->Internal->Solver.PaddleForceRate(state.Positions, state.Plates, velocity, rates);
}

std::vector<double> CompressionSimulation::ContactPressuresKPa(const CompressionState& state) const
{
  if (state.Positions.size() != this->RestPositions().size())
  {
    throw InputError("contact pressures: expected a state of this simulation");
  }
  this->Internal->Recall(state);
  return this->Internal->Solver.ContactPressures(state.Positions, state.Plates);
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
  // `at` and the bracket count mm that the gap was closed by, from the plates given.
  const double open = GapMm(this->OpenedPlates(plates, progress));
  double at = GapMm(plates) - FirstGap * open;
  const auto platesAt = [&](double closed) { return MovedPlates(plates, closing, closed / speed); };
  CompressionState state = this->Compress(platesAt(at), nullptr, progress);
  double tooLittle = -std::numeric_limits<double>::infinity();
  double tooMuch = std::numeric_limits<double>::infinity();
  int newtonSteps = state.NewtonSteps;
  int loadSteps = state.LoadSteps;
  double allowed = LargestForceStepMm;
  // With friction no state is reached from a farther closed one, where it points the other way.
  const bool rubs = this->Internal->Options.Friction > 0;
  std::optional<CompressionState> below;
  for (int step = 0; std::abs(state.PaddleForceN / forceN - 1) > ForceTolerance; ++step)
  {
    (state.PaddleForceN < forceN ? tooLittle : tooMuch) = at;
    if (rubs && state.PaddleForceN < forceN)
    {
      below = state;
      tooMuch = std::numeric_limits<double>::infinity(); // on the way from another state
    }
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
        const CompressionState* from = rubs ? (below ? &*below : nullptr) : &state;
        state = this->Compress(platesAt(at + by), from, progress);
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
    throw CompressionError(text, GapMm(state.Plates), reason);
  }
  state.NewtonSteps = newtonSteps;
  state.LoadSteps = loadSteps;
  state.Seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return state;
}

void CompressionSimulation::SetMaterials(const std::vector<ElasticMaterial>& materials)
{
  this->Internal->Body.SetMaterials(materials);
  if (this->Internal->Predictor)
  {
    this->Internal->Predictor->SetMaterials(materials);
  }
  this->Internal->Solver.BodyChanged();
  this->Internal->Settled.clear();
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

const std::vector<double>& CompressionSimulation::ImagePositions() const
{
  return this->Internal->Image;
}
}
