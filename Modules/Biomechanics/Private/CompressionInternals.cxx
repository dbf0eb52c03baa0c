// SPDX-License-Identifier: Apache-2.0
#include "Private/CompressionInternals.h"

#include "Private/CellPatches.h"
#include "Private/LoadEnergy.h"
#include "Private/LoadPath.h"
#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cstdio>

namespace mammoray
{
namespace
{
/// Least part of the loads that is added at a time while a breast settles.
constexpr double SmallestSettlingStep = 1.0 / 64;

/// "The least" stiffness factor is as much larger than the last that was found to fail at most,
/// with RestShape's precision; and how much of the gravity is to be borne at least.
constexpr double FactorMargin = 1.03;
constexpr double LeastBorne = 1e-3;

WallStiffness WallOf(const CompressionOptions& options)
{
  return { options.Wall.Normal,
    options.ChestWall == ChestWallMode::Sliding ? options.SlidingStiffness
                                                : options.Wall.Tangential };
}

/// Whether the body goes on behind a face of the boundary.
bool IsCut(const ElasticBody& body, const ElasticBody::BoundaryFace& face, const BodyField& beside)
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
  return beside(middle + (0.5 * side / Norm(normal)) * normal);
}

/// Every coordinate of a node of a held cell, unless the breast can move along the chest wall, and
/// of a face behind which the body goes on.
std::vector<bool> FixedCoordinates(const ElasticBody& body, const std::vector<bool>& heldCells,
  ChestWallMode mode, const BodyField& beside)
{
  std::vector<bool> fixed(3 * body.NumberOfNodes(), false);
  for (const ElasticBody::BoundaryFace& face : body.Faces())
  {
    // No element holds cells of both kinds.
    const bool cut =
      beside && !heldCells[body.CellsOf(face.Element).front()] && IsCut(body, face, beside);
    for (int a = 0; cut && a < body.NodesPerFace(); ++a)
    {
      const std::int32_t node = body.NodesOf(face.Element)[face.LocalNodes[a]];
      fixed[3 * node] = fixed[3 * node + 1] = fixed[3 * node + 2] = true;
    }
  }
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
}

CompressionSimulation::Internals::Internals(ElasticBody body, std::vector<bool> heldCells,
  std::size_t pointCount, const CompressionOptions& options, const BodyField& beside)
  : Body(std::move(body))
  , Options(options)
  , HeldCells(std::move(heldCells))
  , Fixed(FixedCoordinates(Body, HeldCells, options.ChestWall, beside))
  , Solver(Body, Fixed, options.ContactStiffness, HeldCells)
  , Given(Body.Materials())
  , Image(Body.RestPositions())
  , NumberOfPoints(pointCount)
{
  if (options.ChestWall != ChestWallMode::Held)
  {
    this->Wall.emplace(this->Body, this->HeldCells, WallOf(options));
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
  return BodyForces(this->Body, this->HeldCells, gravityMPerS2, pullN);
}

void CompressionSimulation::Internals::Settle(const std::vector<double>& from,
  const std::vector<double>& to, std::vector<double>& x, const ProgressCallback& progress)
{
  this->Solver.SetFriction({});
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
    this->Solver.SetLoads(next < 1 ? part : to);
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
    // Soft tissue may hang in several ways: in the image it hangs in one of them.
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

/// Gives body and wall the materials and options as they were given, that much stiffer.
void CompressionSimulation::Internals::SetStiffness(double factor)
{
  std::vector<ElasticMaterial> materials = this->Given;
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

/// From the body without load; where its weight is too much, makes it stiffer.
void CompressionSimulation::Internals::FindRest(const ProgressCallback& progress)
{
  RestShape& shape = this->Unloaded->Shape;
  const double part = shape.Find(progress);
  if (part == 1)
  {
    return;
  }
  // Equilibrium under a part of the gravity is that under all of it, of tissue as much stiffer.
  double borne = part / FactorMargin;
  while (borne > 0 && !shape.MoveTo(borne, progress))
  {
    borne = borne > LeastBorne ? borne / FactorMargin : 0;
  }
  if (borne == 0)
  {
    throw ConvergenceError("unloading: expected a shape without load, found none: not even a "
                           "thousandth of this gravity leaves every cell its volume");
  }
  this->SetStiffness(this->Factor / borne);
  shape.TakeForWhole();
}

/// Makes the shape at rest that was found that of the simulation; throws where the image does not
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
  const std::vector<ElasticMaterial> before = this->Given;
  const double factor = this->Factor;
  this->Given = materials;
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
    this->Given = before;
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
    found[c] = this->Fixed[c] ? this->Body.RestPositions()[c] : this->Image[c] + found[c];
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

void CompressionSimulation::Internals::AddRestVelocities(EquilibriumVelocities& velocities)
{
  if (!this->Unloaded)
  {
    return;
  }
  std::vector<WallStiffness> walls;
  for (const HoldingVelocity& velocity : velocities.Holding)
  {
    walls.push_back(velocity.Wall);
  }
  for (std::vector<double>& rate : this->Unloaded->Shape.Rates(velocities.Materials, walls))
  {
    std::vector<double> loads = BodyForceRates(this->Body, this->HeldCells,
      this->Options.GravityMPerS2, this->Options.PullN, rate);
    velocities.Rest.push_back({ std::move(rate), std::move(loads) });
  }
}

void CompressionSimulation::Internals::Recall(const CompressionState& state)
{
  this->Solver.SetContactStiffness(
    state.ContactStiffness > 0 ? state.ContactStiffness : this->Options.ContactStiffness);
  this->Solver.SetFriction(state.Friction ? *state.Friction : FrictionPoints());
  this->Solver.SetLoads(this->Loads(this->Options.GravityMPerS2, this->Options.PullN));
}
}
