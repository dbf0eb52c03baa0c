// SPDX-License-Identifier: Apache-2.0
#include "Private/LoadEnergy.h"

#include "mammoray/Foundation/Error.h"

#include <numeric>
#include <string>

namespace mammoray
{
void LoadEnergy::SetForces(std::vector<double> forces)
{
  if (!forces.empty() && forces.size() != this->Body.RestPositions().size())
  {
    throw InputError("loads: expected 3 forces per node, found " + std::to_string(forces.size()) +
      " for " + std::to_string(this->Body.NumberOfNodes()) + " nodes");
  }
  this->NodeForces = std::move(forces);
  this->NodeIndices.resize(this->NumberOfPieces());
  std::iota(this->NodeIndices.begin(), this->NodeIndices.end(), 0);
}

std::span<const std::int32_t> LoadEnergy::NodesOf(std::size_t node) const
{
  return { &this->NodeIndices[node], 1 };
}

bool LoadEnergy::Add(std::size_t node, const std::vector<double>& x, EnergyOrder order,
  PieceTerms& terms) const
{
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const std::size_t c = 3 * node + axis;
    terms.Value -= this->NodeForces[c] * (x[c] - this->Body.RestPositions()[c]);
    if (order >= EnergyOrder::Gradient)
    {
      terms.Gradient[axis] -= this->NodeForces[c];
    }
  }
  return true;
}

std::vector<double> BodyForces(const ElasticBody& body, const std::vector<bool>& fixedCells,
  const Vector3& gravityMPerS2, const Vector3& pullN)
{
  if (Norm(gravityMPerS2) == 0 && Norm(pullN) == 0)
  {
    return {};
  }
  std::vector<double> density(body.NumberOfCells(), 0.0);
  std::vector<double> tissue(body.NumberOfCells(), 0.0);
  double volume = 0;
  for (std::size_t cell = 0; cell < density.size(); ++cell)
  {
    if (!fixedCells[cell])
    {
      density[cell] = WeightDensity * body.CellDensity(cell);
      if (density[cell] == 0 && Norm(gravityMPerS2) > 0)
      {
        throw InputError("gravity: expected the density, g/cm3, of every material that is not "
                         "fixed, found none of one");
      }
      tissue[cell] = 1;
      volume += body.CellVolume(cell);
    }
  }
  const std::vector<double> weight = body.NodeIntegrals(density);
  const std::vector<double> part = body.NodeIntegrals(tissue);
  std::vector<double> forces(3 * body.NumberOfNodes());
  for (std::size_t c = 0; c < forces.size(); ++c)
  {
    forces[c] = weight[c / 3] * gravityMPerS2[c % 3] + 1e3 * part[c / 3] / volume * pullN[c % 3];
  }
  return forces;
}

std::vector<double> BodyForceDerivatives(const ElasticBody& body,
  const std::vector<bool>& fixedCells, const Vector3& gravityMPerS2, const Vector3& pullN,
  const std::vector<double>& restVelocities)
{
  if (Norm(gravityMPerS2) == 0 && Norm(pullN) == 0)
  {
    return {};
  }
  // All integrals are linear in the cells' volumes. The fraction of the total volume that a cell
  // has contributes two terms to the derivative.
  std::vector<double> weightGrowth(body.NumberOfCells(), 0.0);
  std::vector<double> growth(body.NumberOfCells(), 0.0);
  std::vector<double> tissue(body.NumberOfCells(), 0.0);
  double volume = 0;
  double volumeRate = 0;
  for (std::size_t cell = 0; cell < growth.size(); ++cell)
  {
    if (!fixedCells[cell])
    {
      const double rate = body.CellVolumeRate(cell, restVelocities);
      growth[cell] = rate / body.CellVolume(cell);
      weightGrowth[cell] = WeightDensity * body.CellDensity(cell) * growth[cell];
      tissue[cell] = 1;
      volume += body.CellVolume(cell);
      volumeRate += rate;
    }
  }
  const std::vector<double> weight = body.NodeIntegrals(weightGrowth);
  const std::vector<double> part = body.NodeIntegrals(tissue);
  const std::vector<double> partRate = body.NodeIntegrals(growth);
  std::vector<double> rates(3 * body.NumberOfNodes());
  for (std::size_t c = 0; c < rates.size(); ++c)
  {
    const double pulled = 1e3 * (partRate[c / 3] - part[c / 3] * volumeRate / volume) / volume;
    rates[c] = weight[c / 3] * gravityMPerS2[c % 3] + pulled * pullN[c % 3];
  }
  return rates;
}
}
