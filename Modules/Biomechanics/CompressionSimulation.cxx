// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Biomechanics/CompressionSimulation.h"

#include "Private/CompressionInternals.h"
#include "Private/LaggedFriction.h"
#include "Private/LoadPath.h"
#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace mammoray
{
namespace
{
/// Fraction of the largest load step that is used after a failed cold start.
constexpr double SmallerLoadStep = 0.37;
/// Relative tolerance of the force, largest change of the gap in one step, mm, and the smallest
/// step, mm, towards more force before the search gives up.
constexpr double ForceTolerance = 1e-4;
constexpr double LargestForceStepMm = 5;
constexpr double SmallestForceStepMm = 0.1;
constexpr int MostForceSteps = 60;
/// Fraction of the gap without contact at which the search begins.
constexpr double FirstGap = 0.85;
/// Progress [0, 1] that is reported when the plates are closed.
constexpr double ClosedPart = 0.9;

std::vector<bool> CellsOf(const TetrahedralMesh& mesh, const std::vector<bool>& fixed)
{
  std::vector<bool> cells(mesh.NumberOfCells(), false);
  for (std::size_t cell = 0; cell < cells.size(); ++cell)
  {
    const auto material = static_cast<std::size_t>(mesh.Materials[cell]);
    cells[cell] = material < fixed.size() && fixed[material];
  }
  if (std::find(cells.begin(), cells.end(), true) == cells.end())
  {
    throw InputError(
      "simulation mesh: expected cells of a fixed material (chest wall), found none: "
      "the body could float away");
  }
  return cells;
}

void CheckOptions(const CompressionOptions& options)
{
  const auto need = [](bool good, double value, const char* expected)
  {
    if (!good || !std::isfinite(value))
    {
      throw InputError(std::string("compression options: expected ") + expected + ", found " +
        std::to_string(value));
    }
  };
  need(options.ContactStiffness > 0, options.ContactStiffness, "a positive contact stiffness");
  need(options.RelativeTolerance > 0, options.RelativeTolerance, "a positive tolerance");
  need(options.MaximumNewtonSteps > 0, options.MaximumNewtonSteps, "at least one Newton step");
  need(options.LargestLoadStep > 0, options.LargestLoadStep, "a positive load step");
  need(options.Wall.Normal > 0, options.Wall.Normal,
    "a positive stiffness across the chest wall, kPa/mm");
  need(options.Wall.Tangential >= 0, options.Wall.Tangential,
    "a stiffness along the chest wall of at least 0, kPa/mm");
  need(options.SlidingStiffness > 0, options.SlidingStiffness,
    "a positive stiffness along a sliding chest wall, kPa/mm");
  need(options.Friction >= 0, options.Friction, "a coefficient of friction of at least 0");
  need(true, Norm(options.GravityMPerS2), "finite gravity");
  need(true, Norm(options.PullN), "a finite pull");
}

/// With friction the result depends on the path, so no initial guess may shortcut it.
bool CanBePredicted(const CompressionOptions& options)
{
  return options.Friction == 0;
}

void CheckState(const CompressionState& state, std::size_t coordinates)
{
  if (state.Positions.size() != coordinates)
  {
    throw InputError("compression: expected a state of this simulation, of " +
      std::to_string(coordinates) + " coordinates, found " +
      std::to_string(state.Positions.size()));
  }
}

void CheckPlate(const Plate& plate, const char* name)
{
  const bool good = std::abs(Norm(plate.Normal) - 1) < 1e-6 &&
    std::abs(Norm(plate.Inward) - 1) < 1e-6 && std::abs(Dot(plate.Normal, plate.Inward)) < 1e-6 &&
    plate.EdgeRadiusMm >= 0 && plate.EdgeRadiusMm <= MostEdgeRadiusMm &&
    std::isfinite(Norm(plate.Edge));
  if (!good)
  {
    throw InputError(std::string(name) +
      ": expected a finite Edge, orthogonal unit vectors Normal and Inward and an edge radius "
      "from 0 to " +
      std::to_string(static_cast<int>(MostEdgeRadiusMm)) + " mm");
  }
}

void CheckPlates(const PlatePair& plates)
{
  CheckPlate(plates.Support, "support");
  CheckPlate(plates.Paddle, "paddle");
}
}

double GapMm(const PlatePair& plates)
{
  return Dot(plates.Paddle.Edge - plates.Support.Edge, plates.Support.Normal);
}

std::string StiffnessNote(double factor)
{
  if (factor == 1)
  {
    return {};
  }
  char note[160];
  std::snprintf(note, sizeof note,
    "The tissue is too soft for its own weight: all stiffness was raised by a factor of %.2f, the "
    "least that bears it",
    factor);
  return note;
}

double PenetrationLimitMm(const PlatePair& plates)
{
  return std::max(0.05, 1e-3 * GapMm(plates));
}

CompressionSimulation::CompressionSimulation(const TetrahedralMesh& mesh,
  const std::vector<ElasticMaterial>& materials, const std::vector<bool>& fixed,
  const MaterialField& field, const CompressionOptions& options, const BodyField& outsideTissue)
{
  CheckOptions(options);
  ElasticBody body(mesh, materials, field, fixed, options.Element);
  this->Internal = std::make_unique<Internals>(std::move(body), CellsOf(mesh, fixed),
    mesh.NumberOfPoints(), options, outsideTissue);
  if (options.Element == ElementType::Quadratic && CanBePredicted(options))
  {
    CompressionOptions linear = options;
    linear.Element = ElementType::PatchAveragedLinear;
    this->SetPredictor(std::make_unique<CompressionSimulation>(mesh, materials, fixed, field,
      linear, outsideTissue));
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
  this->Internal->Predictor = std::move(predictor);
  this->Internal->EmbedInPredictor();
}

void CompressionSimulation::Unload(const Vector3& gravityMPerS2, const ProgressCallback& progress)
{
  if (!std::isfinite(Norm(gravityMPerS2)))
  {
    throw InputError("unloading: expected a finite gravity");
  }
  this->Internal->Unload(gravityMPerS2, progress);
  this->Internal->ChangePredictor(
    [&](CompressionSimulation& predictor) { predictor.Unload(gravityMPerS2, progress); });
  if (this->Internal->Predictor)
  {
    this->Internal->EmbedInPredictor();
  }
}

double CompressionSimulation::StiffnessFactor() const
{
  return this->Internal->Factor;
}

PlatePair CompressionSimulation::OpenedPlates(const PlatePair& plates,
  const ProgressCallback& progress)
{
  const std::array<double, 2> opening = this->Internal->Solver.Energy().Contact().Opening(
    this->Internal->SettledPositions(progress), plates);
  PlatePair opened = plates;
  opened.Support.Edge = plates.Support.Edge - opening[0] * plates.Support.Normal;
  opened.Paddle.Edge = plates.Paddle.Edge - opening[1] * plates.Paddle.Normal;
  return opened;
}

CompressionState CompressionSimulation::Compress(const PlatePair& plates,
  const CompressionState* start, const ProgressCallback& progress, Refusal refusal)
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
    // The path used soft contact, so its last gap need not have an equilibrium.
    throw NoEquilibrium(GapMm(plates), this->LeastGapMm(plates, error.LastGapMm(), progress),
      error.Reason());
  }
}

CompressionState CompressionSimulation::Adopt(const CompressionSimulation& other,
  const CompressionState& state, const ProgressCallback& progress)
{
  CheckState(state, other.RestPositions().size());
  std::vector<double> positions;
  if (CanBePredicted(this->Internal->Options))
  {
    positions =
      this->Internal->PositionsIn(other, Embedding(other, this->ImagePositions()), state.Positions);
  }
  return this->Run(state.Plates, nullptr, Finish::Complete, progress, 1, std::move(positions));
}

CompressionState CompressionSimulation::RunCold(const PlatePair& plates,
  const ProgressCallback& progress)
{
  try
  {
    return this->Run(plates, nullptr, Finish::Complete, progress);
  }
  catch (const CompressionError& first)
  {
    try
    {
      // Where tissue folds, a path with other load steps may lead past the fold.
      return this->Run(plates, nullptr, Finish::Complete, progress, SmallerLoadStep);
    }
    catch (const CompressionError& second)
    {
      throw second.LastGapMm() < first.LastGapMm() ? second : first;
    }
  }
}

double CompressionSimulation::LeastGapMm(const PlatePair& plates, double fromMm,
  const ProgressCallback& progress)
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
      // No equilibrium at this gap: open the plates further.
    }
  }
  return GapMm(open);
}

std::vector<double> CompressionSimulation::PredictedPositions(const PlatePair& plates,
  const ProgressCallback& progress)
{
  Internals& internal = *this->Internal;
  std::vector<double> positions;
  if (internal.Predictor)
  {
    try
    {
      const auto firstHalf = [&](double fraction, const char* stage)
      { return !progress || progress(0.5 * fraction, stage); };
      const CompressionState predicted =
        internal.Predictor->Run(plates, nullptr, Finish::Prediction, firstHalf);
      positions =
        internal.PositionsIn(*internal.Predictor, *internal.InPredictor, predicted.Positions);
    }
    catch (const ConvergenceError&)
    {
      // This simulation may succeed without a guess although the predictor failed.
    }
  }
  return positions;
}

CompressionState CompressionSimulation::Run(const PlatePair& plates, const CompressionState* start,
  Finish finish, const ProgressCallback& progress, double loadStepFactor,
  std::vector<double> predicted)
{
  const auto begin = std::chrono::steady_clock::now();
  CheckPlates(plates);
  if (start)
  {
    CheckState(*start, this->RestPositions().size());
  }
  Internals& internal = *this->Internal;
  const CompressionOptions& options = internal.Options;
  LoadPathStart from = start
    ? LoadPathStart::Warm(*start, plates, options)
    : LoadPathStart::Cold(internal.SettledPositions(progress), this->OpenedPlates(plates, progress),
        plates, options, loadStepFactor);
  internal.Solver.Energy().SetLoads(internal.Loads(options.GravityMPerS2, options.PullN));
  LaggedFriction solver(internal.Solver, internal.Body, options.Friction, from.Positions,
    from.Plates, start ? start->Friction.get() : nullptr);
  // The path ends when contact is hardened, not when the plates are closed; 1 is reported below.
  LoadPath path(solver, options, plates, std::move(from), ShareOf(progress, 0, ClosedPart));
  if (!start && predicted.empty())
  {
    predicted = this->PredictedPositions(plates, progress);
  }
  if (!predicted.empty())
  {
    path.ArriveFrom(std::move(predicted));
  }
  if (finish == Finish::Prediction)
  {
    path.Close();
  }
  else
  {
    path.Complete();
  }
  CompressionState state = path.State();
  internal.DrawAlong(state.Positions);
  if (options.Friction > 0)
  {
    state.Friction =
      std::make_shared<const FrictionPoints>(internal.Solver.Energy().Friction().Points());
  }
  state.StiffnessFactor = internal.Factor;
  state.FactorMiB = internal.Solver.PeakFactorBytes() / (1 << 20);
  ReportProgress(progress, 1, "compression");
  state.Seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return state;
}

VectorFields CompressionSimulation::Sensitivities(const CompressionState& state,
  const std::vector<PlatePairVelocity>& velocities,
  const std::vector<MaterialDerivative>& materialDerivatives,
  const std::vector<LoadingDerivative>& loadingDerivatives)
{
  CheckState(state, this->RestPositions().size());
  const Internals& internal = *this->Internal;
  EquilibriumDerivatives all{ velocities, materialDerivatives, {}, {} };
  for (MaterialDerivative& table : all.Materials)
  {
    for (ElasticMaterialDerivative& material : table)
    {
      material.YoungsModulusKPa *= internal.Factor;
    }
  }
  for (const LoadingDerivative& velocity : loadingDerivatives)
  {
    all.Support.push_back(
      { { internal.Factor * velocity.Wall.Normal, internal.Factor * velocity.Wall.Tangential },
        velocity.Friction, internal.Loads(velocity.GravityMPerS2, velocity.PullN) });
  }
  this->Internal->AddStressFreeVelocities(all);
  this->Internal->Recall(state);
  VectorFields fields = this->Internal->Solver.Sensitivities(state.Positions, state.Plates, all);
  for (std::size_t field = 0; field < fields.Count(); ++field)
  {
    this->Internal->DrawAlong(fields[field]);
  }
  return fields;
}

CompressionSimulation::LossGradient CompressionSimulation::Backward(const CompressionState& state,
  const std::vector<double>& loss, const std::vector<PlatePairVelocity>& velocities)
{
  CheckState(state, this->RestPositions().size());
  if (loss.size() != state.Positions.size())
  {
    throw InputError("backward: expected a derivative for each of " +
      std::to_string(state.Positions.size()) + " coordinates, found " +
      std::to_string(loss.size()));
  }
  if (this->Internal->Unloaded)
  {
    throw InputError(
      "backward: expected a mesh free of load, found one imaged under gravity, whose "
      "stress-free shape depends on the stiffness of all cells");
  }
  std::vector<double> drawn = loss;
  this->Internal->GatherDrawn(drawn);
  this->Internal->Recall(state);
  EquilibriumGradient gradient =
    this->Internal->Solver.Backward(state.Positions, state.Plates, drawn, velocities);
  return { std::move(gradient.Cells), std::move(gradient.Materials), std::move(gradient.Plates) };
}

double CompressionSimulation::PaddleForceDerivative(const CompressionState& state,
  const PlatePairVelocity& velocity)
{
  return this->Internal->Solver.PaddleForceDerivative(state.Positions, state.Plates, velocity,
    this->Sensitivities(state, { velocity }).Values);
}

std::vector<double> CompressionSimulation::ContactPressuresKPa(const CompressionState& state)
{
  CheckState(state, this->RestPositions().size());
  this->Internal->Recall(state);
  EquilibriumEnergy& energy = this->Internal->Solver.Energy();
  energy.SetPlates(&state.Plates);
  return energy.Contact().NodePressures(state.Positions);
}

CompressionState CompressionSimulation::CompressToForce(const PlatePair& plates,
  const PlatePairVelocity& closing, double forceN, const ProgressCallback& progress)
{
  const auto begin = std::chrono::steady_clock::now();
  CheckPlates(plates);
  const bool hasFriction = this->Internal->Options.Friction > 0;
  const double speed = GapMm(plates) - GapMm(MovedPlates(plates, closing, 1));
  if (!(forceN > 0) || !std::isfinite(forceN) || !(speed > 0))
  {
    throw InputError("compression: expected a positive force and a motion that closes the plates");
  }
  // `at` and the bracket are the closing of the gap from the given plates, mm.
  const double open = GapMm(this->OpenedPlates(plates, progress));
  double at = GapMm(plates) - FirstGap * open;
  const auto platesAt = [&](double closed) { return MovedPlates(plates, closing, closed / speed); };
  CompressionState state = this->Compress(platesAt(at), nullptr, progress);
  double tooLittle = -std::numeric_limits<double>::infinity();
  double tooMuch = std::numeric_limits<double>::infinity();
  int newtonSteps = state.NewtonSteps;
  int loadSteps = state.LoadSteps;
  double allowed = LargestForceStepMm;
  // With friction a state must not be reached from a more closed one: friction would point the
  // other way.
  std::optional<CompressionState> below;
  for (int step = 0; std::abs(state.PaddleForceN / forceN - 1) > ForceTolerance; ++step)
  {
    (state.PaddleForceN < forceN ? tooLittle : tooMuch) = at;
    if (hasFriction && state.PaddleForceN < forceN)
    {
      below = state;
      tooMuch = std::numeric_limits<double>::infinity(); // on the way from another state
    }
    // The force grows faster than linearly with the closing; its logarithm is closer to linear.
    double by = state.PaddleForceN < forceN ? allowed : -allowed;
    if (state.PaddleForceN > 0)
    {
      const double rate = this->PaddleForceDerivative(state, closing) / speed;
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
        const CompressionState* from = hasFriction ? (below ? &*below : nullptr) : &state;
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
  this->Internal->SetMaterials(materials);
  this->Internal->ChangePredictor(
    [&](CompressionSimulation& predictor) { predictor.SetMaterials(materials); });
}

const std::vector<ElasticMaterial>& CompressionSimulation::Materials() const
{
  return this->Internal->GivenMaterials;
}

std::vector<CellMeasures> CompressionSimulation::MeasuresOf(const CompressionState& state) const
{
  const ElasticBody& body = this->Internal->Body;
  CheckState(state, body.RestPositions().size());
  const ElasticEnergy energy(body);
  std::vector<CellMeasures> measures;
  for (std::size_t cell = 0; cell < body.NumberOfCells(); ++cell)
  {
    measures.push_back(energy.MeasuresOf(cell, state.Positions));
  }
  return measures;
}

std::size_t CompressionSimulation::NumberOfNodes() const
{
  return this->Internal->Body.NumberOfNodes();
}

std::size_t CompressionSimulation::NumberOfUnknowns() const
{
  return this->Internal->Solver.Energy().Part().NumberOfUnknowns();
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
