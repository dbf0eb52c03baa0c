// SPDX-License-Identifier: Apache-2.0
#include "Private/EquilibriumSolver.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/ParallelFor.h"

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>
#include <string>

namespace mammoray
{
namespace
{
void Check(const EquilibriumDerivatives& velocities, std::size_t materials, std::size_t coordinates)
{
  for (const MaterialDerivative& velocity : velocities.Materials)
  {
    if (velocity.size() != materials)
    {
      throw InputError("sensitivities: expected a derivative for each of " +
        std::to_string(materials) + " materials, found " + std::to_string(velocity.size()));
    }
  }
  for (const SupportDerivative& velocity : velocities.Support)
  {
    if (!velocity.Loads.empty() && velocity.Loads.size() != coordinates)
    {
      throw InputError("sensitivities: expected a derivative for each of " +
        std::to_string(coordinates) + " loads, found " + std::to_string(velocity.Loads.size()));
    }
  }
}

/// -d gradient / dX dX/dp of an element: 3 numbers for each of its nodes, one parameter after the
/// other.
std::vector<double> RestForcesOf(const EquilibriumEnergy& energy, std::size_t element,
  const std::vector<double>& x, const std::vector<StressFreeVelocity>& velocities)
{
  const std::span<const std::int32_t> nodes = energy.Part().Body().NodesOf(element);
  const std::size_t rows = 3 * nodes.size();
  std::vector<double> matrix(rows * rows, 0.0);
  energy.Elastic().AddRestDerivative(element, x, matrix);
  std::vector<double> forces(rows * velocities.size(), 0.0);
  for (std::size_t p = 0; p < velocities.size(); ++p)
  {
    for (std::size_t c = 0; c < rows && !velocities[p].Positions.empty(); ++c)
    {
      const double rate = velocities[p].Positions[3 * nodes[c / 3] + c % 3];
      for (std::size_t r = 0; r < rows; ++r)
      {
        forces[rows * p + r] -= matrix[rows * c + r] * rate;
      }
    }
  }
  return forces;
}

/// Adds the same terms of the wall and of the dead loads to a column of unknowns.
void AddRestForces(const EquilibriumEnergy& energy, const std::vector<double>& x,
  const StressFreeVelocity& velocity, double* column)
{
  const MovingPart& part = energy.Part();
  for (std::size_t u = 0; u < part.NumberOfUnknowns() && !velocity.Loads.empty(); ++u)
  {
    column[u] += velocity.Loads[part.Coordinates()[u]];
  }
  const AttachmentEnergy* wall = energy.Attachment();
  for (std::size_t w = 0; wall && w < wall->Nodes().size(); ++w)
  {
    const std::int32_t node = wall->Nodes()[w];
    const std::array<Vector3, 3> rows = wall->NodeRestDerivative(w, NodePosition(x, node));
    const Vector3 rate = NodePosition(velocity.Positions, node);
    part.AddAtNode(node, { -Dot(rows[0], rate), -Dot(rows[1], rate), -Dot(rows[2], rate) }, column);
  }
}

/// -d gradient / dX dX/dp at the unknowns, one column per parameter.
std::vector<double> RestForces(const EquilibriumEnergy& energy, const std::vector<double>& x,
  const std::vector<StressFreeVelocity>& velocities)
{
  const MovingPart& part = energy.Part();
  const std::size_t n = part.NumberOfUnknowns();
  std::vector<double> columns(n * velocities.size(), 0.0);
  std::vector<std::vector<double>> forces(velocities.empty() ? 0 : part.Elements().size());
  ParallelFor(forces.size(),
    [&](std::size_t moving)
    { forces[moving] = RestForcesOf(energy, part.Elements()[moving], x, velocities); });
  for (std::size_t p = 0; p < velocities.size(); ++p)
  {
    if (velocities[p].Positions.empty())
    {
      continue;
    }
    double* column = &columns[n * p];
    for (std::size_t moving = 0; moving < forces.size(); ++moving)
    {
      const std::int32_t element = part.Elements()[moving];
      const std::span<const std::int32_t> nodes = part.Body().NodesOf(element);
      const double* force = &forces[moving][3 * nodes.size() * p];
      for (std::size_t a = 0; a < nodes.size(); ++a)
      {
        part.AddAtNode(nodes[a], { force[3 * a], force[3 * a + 1], force[3 * a + 2] }, column);
      }
      energy.Contact().AddRestForces(element, x, velocities[p].Positions, column);
    }
    AddRestForces(energy, x, velocities[p], column);
  }
  return columns;
}
}

std::vector<double> SupportForces(const EquilibriumEnergy& energy, const std::vector<double>& x,
  const std::vector<SupportDerivative>& velocities)
{
  const MovingPart& part = energy.Part();
  const std::size_t n = part.NumberOfUnknowns();
  std::vector<double> columns(n * velocities.size(), 0.0);
  for (std::size_t p = 0; p < velocities.size(); ++p)
  {
    const SupportDerivative& velocity = velocities[p];
    double* column = &columns[n * p];
    for (std::size_t u = 0; u < n && !velocity.Loads.empty(); ++u)
    {
      column[u] = velocity.Loads[part.Coordinates()[u]];
    }
    const AttachmentEnergy* wall = energy.Attachment();
    for (std::size_t w = 0; wall && w < wall->Nodes().size(); ++w)
    {
      const std::int32_t node = wall->Nodes()[w];
      part.AddAtNode(node, -1.0 * wall->NodeTerms(w, NodePosition(x, node), velocity.Wall).Gradient,
        column);
    }
    if (velocity.Friction != 0)
    {
      for (const std::int32_t element : part.Elements())
      {
        energy.Friction().AddCoefficientForces(element, x, velocity.Friction, column);
      }
    }
  }
  return columns;
}

std::vector<double> MaterialForces(const EquilibriumEnergy& energy, const std::vector<double>& x,
  const std::vector<MaterialDerivative>& velocities)
{
  const MovingPart& part = energy.Part();
  const std::size_t n = part.NumberOfUnknowns();
  std::vector<double> columns(n * velocities.size(), 0.0);
  std::vector<std::vector<double>> rates(part.Elements().size());
  for (std::size_t p = 0; p < velocities.size(); ++p)
  {
    ParallelFor(rates.size(),
      [&](std::size_t moving)
      {
        rates[moving] =
          energy.Elastic().GradientDerivative(part.Elements()[moving], x, velocities[p]);
      });
    for (std::size_t moving = 0; moving < rates.size(); ++moving)
    {
      const std::span<const std::int32_t> nodes = part.Body().NodesOf(part.Elements()[moving]);
      const double* rate = rates[moving].data();
      for (std::size_t a = 0; a < nodes.size(); ++a)
      {
        part.AddAtNode(nodes[a], { -rate[3 * a], -rate[3 * a + 1], -rate[3 * a + 2] },
          &columns[n * p]);
      }
    }
  }
  return columns;
}

std::vector<double> StiffnessProducts(const EquilibriumEnergy& energy, const std::vector<double>& x,
  const std::vector<double>& vector)
{
  const MovingPart& part = energy.Part();
  const ElasticBody& body = part.Body();
  std::vector<double> products(body.NumberOfCells(), 0.0);
  ParallelFor(part.Elements().size(),
    [&](std::size_t moving)
    {
      const std::int32_t element = part.Elements()[moving];
      const std::span<const std::int32_t> nodes = body.NodesOf(element);
      for (const std::int32_t cell : body.CellsOf(element))
      {
        const std::vector<double> rate = energy.Elastic().StiffnessDerivative(cell, element, x);
        double product = 0;
        for (std::size_t c = 0; c < rate.size(); ++c)
        {
          const std::int32_t unknown = part.Unknowns()[3 * nodes[c / 3] + c % 3];
          product -= unknown < 0 ? 0.0 : rate[c] * vector[unknown];
        }
        products[cell] = product;
      }
    });
  return products;
}

std::vector<double> PlateForces(const EquilibriumEnergy& energy, const std::vector<double>& x,
  const std::vector<PlatePairVelocity>& velocities)
{
  const MovingPart& part = energy.Part();
  std::vector<double> columns(part.NumberOfUnknowns() * velocities.size(), 0.0);
  for (const std::int32_t element : part.Elements())
  {
    energy.Contact().AddPlateForces(element, x, velocities, columns);
    energy.Friction().AddPlateForces(element, x, velocities, columns);
  }
  return columns;
}

VectorFields EquilibriumSolver::Sensitivities(const std::vector<double>& x, const PlatePair& plates,
  const EquilibriumDerivatives& velocities)
{
  this->Objective.SetPlates(&plates);
  const EquilibriumEnergy& energy = this->Objective;
  Check(velocities, energy.Part().Body().Materials().size(), x.size());
  const std::size_t count =
    velocities.Plates.size() + velocities.Materials.size() + velocities.Support.size();
  if (count == 0)
  {
    return {};
  }
  std::vector<double> right;
  for (const std::vector<double>& columns :
    { PlateForces(energy, x, velocities.Plates), MaterialForces(energy, x, velocities.Materials),
      SupportForces(energy, x, velocities.Support) })
  {
    right.insert(right.end(), columns.begin(), columns.end());
  }
  const std::vector<double> rest = RestForces(energy, x, velocities.Rest);
  std::transform(rest.begin(), rest.end(), right.end() - static_cast<std::ptrdiff_t>(rest.size()),
    right.end() - static_cast<std::ptrdiff_t>(rest.size()), std::plus<>());
  const std::vector<double> solution = this->SolveAt(x, right, count);
  const std::vector<std::int32_t>& coordinates = energy.Coordinates();
  const std::size_t n = coordinates.size();
  VectorFields result(count, x.size());
  for (std::size_t p = 0; p < count; ++p)
  {
    for (std::size_t u = 0; u < n; ++u)
    {
      result[p][coordinates[u]] = solution[n * p + u];
    }
  }
  return result;
}

EquilibriumGradient EquilibriumSolver::Backward(const std::vector<double>& x,
  const PlatePair& plates, const std::vector<double>& loss,
  const std::vector<PlatePairVelocity>& motions)
{
  this->Objective.SetPlates(&plates);
  const EquilibriumEnergy& energy = this->Objective;
  std::vector<double> right;
  for (const std::int32_t coordinate : energy.Coordinates())
  {
    right.push_back(loss[coordinate]);
  }
  // The stiffness matrix is symmetric.
  const std::vector<double> adjoint = this->SolveAt(x, right, 1);
  const auto products = [&](const std::vector<double>& columns)
  {
    std::vector<double> values;
    for (auto column = columns.begin(); column != columns.end();
         column += static_cast<std::ptrdiff_t>(adjoint.size()))
    {
      values.push_back(std::inner_product(adjoint.begin(), adjoint.end(), column, 0.0));
    }
    return values;
  };
  const std::vector<ElasticMaterial>& table = energy.Part().Body().Materials();
  std::vector<MaterialDerivative> stiffer(table.size(), MaterialDerivative(table.size()));
  for (std::size_t material = 0; material < table.size(); ++material)
  {
    stiffer[material][material].YoungsModulusKPa = table[material].YoungsModulusKPa;
  }
  return { StiffnessProducts(energy, x, adjoint), products(MaterialForces(energy, x, stiffer)),
    products(PlateForces(energy, x, motions)) };
}

std::vector<double> EquilibriumSolver::SolveAt(const std::vector<double>& x,
  const std::vector<double>& right, std::size_t count)
{
  const Evaluation& current = this->Newton.EvaluateAt(x);
  if (!current.Valid)
  {
    throw ConvergenceError("sensitivities: expected no inverted cell, found one");
  }
  // The last factor belongs to positions very close to these. Refinement would diverge with a
  // factor of another state, which is therefore not tried.
  FactorCache& factor = this->Newton.Factor();
  std::vector<double> solution;
  if (!(factor.DistanceMm(x) < FactorCache::NearMm) ||
    !factor.RefineNearby(current.Hessian, right, count, solution))
  {
    if (!factor.Factorize(current.Hessian, x))
    {
      throw ConvergenceError("sensitivities: expected a stable equilibrium, found a stiffness "
                             "matrix that is not positive definite");
    }
    if (!factor.SolveOwn(current.Hessian, right, count, solution))
    {
      throw ConvergenceError("sensitivities: expected to solve by a factor in single precision, "
                             "found a stiffness matrix that is too ill-conditioned for it");
    }
  }
  return solution;
}
double EquilibriumSolver::PaddleForceDerivative(const std::vector<double>& x,
  const PlatePair& plates, const PlatePairVelocity& velocity,
  const std::vector<double>& nodeVelocities)
{
  this->Objective.SetPlates(&plates);
  const EquilibriumEnergy& energy = this->Objective;
  double rate = 0;
  for (const std::int32_t element : energy.Part().Elements())
  {
    energy.Contact().AddPaddleForceDerivative(element, x, velocity, nodeVelocities, rate);
    energy.Friction().AddPaddleForceDerivative(element, x, velocity, nodeVelocities, rate);
  }
  return 1e-3 * rate;
}
}
