// SPDX-License-Identifier: Apache-2.0
#include "Private/CompressionInternals.h"

#include "Private/Energies/CellPatches.h"
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
    const bool slides = options.ChestWall == ChestWallMode::Sliding;
    this->Wall.emplace(this->Body, this->HeldCells,
      WallStiffness{ options.Wall.Normal,
        slides ? CompressionOptions::SlidingStiffness : options.Wall.Tangential });
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
}
