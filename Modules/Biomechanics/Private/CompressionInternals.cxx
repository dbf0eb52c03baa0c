// SPDX-License-Identifier: Apache-2.0
#include "Private/CompressionInternals.h"

#include "Private/CellPatches.h"
#include "Private/LoadEnergy.h"
#include "Private/LoadPath.h"
#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace mammoray
{
namespace
{
/// Smallest fraction of the loads that is added at a time while a breast settles.
constexpr double SmallestSettlingStep = 1.0 / 64;

/// Bounds of the search for the least stiffness factor: the result exceeds a factor that failed by
/// at most this margin (and StressFreeShape's precision); below this fraction of gravity the search
/// gives up.
constexpr double FactorMargin = 1.03;
constexpr double LeastBorne = 1e-3;

WallStiffness WallOf(const CompressionOptions& options)
{
  return { options.Wall.Normal,
    options.ChestWall == ChestWallMode::Sliding ? options.SlidingStiffness
                                                : options.Wall.Tangential };
}

/// True if the body continues behind a face of the boundary.
bool IsCut(const ElasticBody& body, const ElasticBody::BoundaryFace& face,
  const BodyField& outsideTissue)
{
  const std::span<const std::int32_t> nodes = body.NodesOf(face.Element);
  Vector3 corners[3];
  for (int c = 0; c < 3; ++c)
  {
    corners[c] = NodePosition(body.RestPositions(), nodes[face.LocalNodes[c]]);
  }
  const Vector3 sides[3] = { corners[1] - corners[0], corners[2] - corners[1],
    corners[0] - corners[2] };
  const Vector3 normal = Cross(sides[0], sides[1]);
  const Vector3 middle = (1 / 3.0) * (corners[0] + corners[1] + corners[2]);
  const double side = (Norm(sides[0]) + Norm(sides[1]) + Norm(sides[2])) / 3;
  return outsideTissue(middle + (0.5 * side / Norm(normal)) * normal);
}

/// Fixes all coordinates of nodes of fixed cells, unless the breast can move along the chest wall,
/// and of nodes of cut faces.
std::vector<bool> CoordinatesFixedBy(const ElasticBody& body, const std::vector<bool>& fixedCells,
  ChestWallMode mode, const BodyField& outsideTissue)
{
  std::vector<bool> fixed(3 * body.NumberOfNodes(), false);
  for (const ElasticBody::BoundaryFace& face : body.Faces())
  {
    // An element has either only fixed or only other cells.
    const bool cut = outsideTissue && !fixedCells[body.CellsOf(face.Element).front()] &&
      IsCut(body, face, outsideTissue);
    for (int a = 0; cut && a < body.NodesPerFace(); ++a)
    {
      const std::int32_t node = body.NodesOf(face.Element)[face.LocalNodes[a]];
      fixed[3 * node] = fixed[3 * node + 1] = fixed[3 * node + 2] = true;
    }
  }
  for (std::size_t cell = 0; cell < fixedCells.size() && mode == ChestWallMode::Fixed; ++cell)
  {
    for (int a = 0; a < body.NodesPerCell() && fixedCells[cell]; ++a)
    {
      const std::int32_t node = body.Cells()[body.NodesPerCell() * cell + a];
      fixed[3 * node] = fixed[3 * node + 1] = fixed[3 * node + 2] = true;
    }
  }
  return fixed;
}
}

CompressionSimulation::Internals::Internals(ElasticBody body, std::vector<bool> fixedCells,
  std::size_t pointCount, const CompressionOptions& options, const BodyField& outsideTissue)
  : Body(std::move(body))
  , Options(options)
  , FixedCells(std::move(fixedCells))
  , FixedCoordinates(CoordinatesFixedBy(Body, FixedCells, options.ChestWall, outsideTissue))
  , Solver(Body, FixedCoordinates, options.ContactStiffness, FixedCells)
  , GivenMaterials(Body.Materials())
  , Image(Body.RestPositions())
  , NumberOfPoints(pointCount)
{
  if (options.ChestWall != ChestWallMode::Fixed)
  {
    this->Wall.emplace(this->Body, this->FixedCells, WallOf(options));
    this->Solver.SetAttachment(&*this->Wall);
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
    if (!this->FixedCells[index / this->Body.NodesPerCell()])
    {
      free[this->Body.Cells()[index]] = true;
    }
  }
  for (std::size_t cell = 0; cell < this->FixedCells.size(); ++cell)
  {
    const std::int32_t* nodes = &this->Body.Cells()[10 * cell];
    for (int e = 0; e < 6 && this->FixedCells[cell]; ++e)
    {
      const std::int32_t ends[2] = { nodes[CellEdges[e][0]], nodes[CellEdges[e][1]] };
      if (!free[nodes[4 + e]] && (free[ends[0]] || free[ends[1]]))
      {
        this->Followers.push_back({ nodes[4 + e], ends[0], ends[1] });
      }
    }
  }
}

void CompressionSimulation::Internals::DrawAlong(std::span<double> values) const
{
  for (const auto& [middle, a, b] : this->Followers)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      values[3 * middle + axis] = 0.5 * (values[3 * a + axis] + values[3 * b + axis]);
    }
  }
}

void CompressionSimulation::Internals::GatherDrawn(std::span<double> loss) const
{
  for (const auto& [middle, a, b] : this->Followers)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      const double half = 0.5 * std::exchange(loss[3 * middle + axis], 0.0);
      loss[3 * a + axis] += half;
      loss[3 * b + axis] += half;
    }
  }
}

std::vector<double> CompressionSimulation::Internals::Loads(const Vector3& gravityMPerS2,
  const Vector3& pullN) const
{
  return BodyForces(this->Body, this->FixedCells, gravityMPerS2, pullN);
}

void CompressionSimulation::Internals::Settle(const std::vector<double>& from,
  const std::vector<double>& to, std::vector<double>& x, const ProgressCallback& progress)
{
  this->Solver.Energy().SetFriction({});
  const auto at = [](const std::vector<double>& loads, std::size_t c)
  { return loads.empty() ? 0.0 : loads[c]; };
  std::vector<double> part(x.size());
  double step = 1;
  for (double done = 0; done < 1;)
  {
    const double next = std::min(1.0, done + step);
    for (std::size_t c = 0; c < part.size(); ++c)
    {
      part[c] = at(from, c) + next * (at(to, c) - at(from, c));
    }
    this->Solver.Energy().SetLoads(next < 1 ? part : to);
    std::vector<double> positions = x;
    const EquilibriumReport report = this->Solver.Solve(positions, nullptr,
      next < 1 ? LoadStep::IntermediateTolerance : this->Options.RelativeTolerance,
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
  if (!this->Settled.empty())
  {
    return this->Settled;
  }
  const std::vector<double> loads = this->Loads(this->Options.GravityMPerS2, this->Options.PullN);
  std::vector<double> positions = this->Body.RestPositions();
  if (!loads.empty() && this->Unloaded)
  {
    // Soft tissue can hang in several ways; start from the imaged one.
    std::vector<double> hanging = this->Image;
    try
    {
      this->Settle(this->Loads(this->Unloaded->Gravity, { 0, 0, 0 }), loads, hanging, progress);
      positions.swap(hanging);
    }
    catch (const ConvergenceError&)
    {
      this->Settle({}, loads, positions, progress);
    }
  }
  else if (!loads.empty())
  {
    this->Settle({}, loads, positions, progress);
  }
  this->Settled.swap(positions);
  return this->Settled;
}

/// Multiplies the given stiffness of body and wall by a factor.
void CompressionSimulation::Internals::SetStiffness(double factor)
{
  std::vector<ElasticMaterial> materials = this->GivenMaterials;
  for (ElasticMaterial& material : materials)
  {
    material.YoungsModulusKPa *= factor;
  }
  this->Body.SetMaterials(materials);
  this->Factor = factor;
  if (this->Wall)
  {
    const WallStiffness wall = WallOf(this->Options);
    this->Wall->SetStiffness({ factor * wall.Normal, factor * wall.Tangential });
  }
  this->Solver.BodyChanged();
  this->Settled.clear();
}

/// Searches from the body without load; raises the stiffness if the tissue cannot carry its weight.
void CompressionSimulation::Internals::FindRest(const ProgressCallback& progress)
{
  StressFreeShape& shape = this->Unloaded->Shape;
  const double part = shape.Find(progress);
  if (part == 1)
  {
    return;
  }
  // Equilibrium under a fraction of gravity equals that under the whole of it with stiffness
  // divided by the fraction.
  double borne = part / FactorMargin;
  while (borne > 0 && !shape.MoveTo(borne, progress))
  {
    borne = borne > LeastBorne ? borne / FactorMargin : 0;
  }
  if (borne == 0)
  {
    throw ConvergenceError("unloading: expected a stress-free shape, found none: even a thousandth "
                           "of this gravity inverts a cell");
  }
  this->SetStiffness(this->Factor / borne);
  shape.TakeForWhole();
}

/// Makes the stress-free shape found that of the simulation; throws if the imaged shape does not
/// follow from it.
void CompressionSimulation::Internals::TakeRest(const ProgressCallback& progress)
{
  this->Solver.BodyChanged();
  this->Settled.clear();
  const std::vector<double> image = this->Unloaded->Shape.Deformed();
  std::vector<double> loaded = image;
  const std::vector<double> loads = this->Loads(this->Unloaded->Gravity, { 0, 0, 0 });
  this->Settle(loads, loads, loaded, progress);
  double farthest = 0;
  for (std::size_t c = 0; c < 3 * this->NumberOfPoints; ++c)
  {
    farthest = std::max(farthest, std::abs(loaded[c] - image[c]));
  }
  if (farthest > UnloadToleranceMm)
  {
    char message[128];
    std::snprintf(message, sizeof message,
      "unloading: expected the image's shape to %.3f mm, found it off by %.3f mm",
      UnloadToleranceMm, farthest);
    throw ConvergenceError(message);
  }
  this->Image = std::move(loaded);
}

void CompressionSimulation::Internals::Unload(const Vector3& gravityMPerS2,
  const ProgressCallback& progress)
{
  const std::vector<double> rest = this->Body.RestPositions();
  const std::vector<double> corners(this->Image.begin(),
    this->Image.begin() + 3 * static_cast<std::ptrdiff_t>(this->NumberOfPoints));
  const double factor = this->Factor;
  std::unique_ptr<Unloading> before = std::move(this->Unloaded);
  try
  {
    this->SetStiffness(1);
    this->Unloaded = std::make_unique<Unloading>(*this, gravityMPerS2, corners);
    this->FindRest(progress);
    this->TakeRest(progress);
  }
  catch (...)
  {
    this->Unloaded = std::move(before);
    this->SetStiffness(factor);
    this->Body.SetRestCorners(rest);
    if (this->Wall)
    {
      this->Wall->SetRestPositions(this->Body.RestPositions());
    }
    this->Solver.BodyChanged();
    throw;
  }
}

void CompressionSimulation::Internals::SetMaterials(const std::vector<ElasticMaterial>& materials)
{
  const std::vector<ElasticMaterial> before = this->GivenMaterials;
  const double factor = this->Factor;
  this->GivenMaterials = materials;
  const std::vector<double> shape =
    this->Unloaded ? this->Unloaded->Shape.Shape() : std::vector<double>();
  try
  {
    this->SetStiffness(factor);
    if (this->Unloaded)
    {
      if (!this->Unloaded->Shape.MoveTo(1))
      {
        this->FindRest({});
      }
      this->TakeRest({});
    }
  }
  catch (...)
  {
    this->GivenMaterials = before;
    this->SetStiffness(factor);
    if (this->Unloaded)
    {
      this->Unloaded->Shape.Set(shape);
    }
    throw;
  }
}

void CompressionSimulation::Internals::EmbedInPredictor()
{
  this->InPredictor = std::make_unique<Embedding>(*this->Predictor, this->Image);
}

std::vector<double> CompressionSimulation::Internals::PositionsIn(
  const CompressionSimulation& other, const Embedding& embedded,
  const std::vector<double>& positions) const
{
  const std::vector<double>& from = other.ImagePositions();
  std::vector<double> displacement = positions;
  std::transform(displacement.begin(), displacement.end(), from.begin(), displacement.begin(),
    std::minus<>());
  std::vector<double> found = embedded.Map(displacement);
  for (std::size_t c = 0; c < found.size(); ++c)
  {
    found[c] =
      this->FixedCoordinates[c] ? this->Body.RestPositions()[c] : this->Image[c] + found[c];
  }
  this->DrawAlong(found);
  return found;
}

void CompressionSimulation::Internals::ChangePredictor(
  const std::function<void(CompressionSimulation&)>& change)
{
  if (!this->Predictor)
  {
    return;
  }
  try
  {
    change(*this->Predictor);
  }
  catch (const ConvergenceError&)
  {
    this->Predictor.reset();
  }
}

void CompressionSimulation::Internals::AddStressFreeVelocities(EquilibriumDerivatives& velocities)
{
  if (!this->Unloaded)
  {
    return;
  }
  std::vector<WallStiffness> walls;
  for (const SupportDerivative& velocity : velocities.Support)
  {
    walls.push_back(velocity.Wall);
  }
  const VectorFields shapes = this->Unloaded->Shape.Velocities(velocities.Materials, walls);
  for (std::size_t field = 0; field < shapes.Count(); ++field)
  {
    std::vector<double> positions(shapes[field].begin(), shapes[field].end());
    std::vector<double> loads = BodyForceDerivatives(this->Body, this->FixedCells,
      this->Options.GravityMPerS2, this->Options.PullN, positions);
    velocities.Rest.push_back({ std::move(positions), std::move(loads) });
  }
}

void CompressionSimulation::Internals::Recall(const CompressionState& state)
{
  this->Solver.Energy().SetContactStiffness(
    state.ContactStiffness > 0 ? state.ContactStiffness : this->Options.ContactStiffness);
  this->Solver.Energy().SetFriction(state.Friction ? *state.Friction : FrictionPoints());
  this->Solver.Energy().SetLoads(this->Loads(this->Options.GravityMPerS2, this->Options.PullN));
}
}
