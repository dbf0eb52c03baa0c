// SPDX-License-Identifier: Apache-2.0
#include "Private/InverseEquilibrium.h"

#include "Private/CellPatches.h"
#include "Private/LoadEnergy.h"
#include "mammoray/Foundation/ParallelFor.h"

#include <algorithm>
#include <array>

namespace mammoray
{
namespace
{
/// Any positive value: there is no contact.
constexpr double AnyContactStiffness = 1;
}

InverseEquilibrium::InverseEquilibrium(ElasticBody& body, AttachmentEnergy* wall,
  const std::vector<bool>& fixed, const std::vector<bool>& fixedCells, std::vector<double> corners,
  const Vector3& gravityMPerS2)
  : Body(body)
  , Wall(wall)
  , FixedCells(fixedCells)
  , Corners(std::move(corners))
  , Gravity(gravityMPerS2)
  , Energy(body, fixed, AnyContactStiffness, fixedCells)
{
  this->Energy.SetAttachment(wall);
  const std::size_t first = this->Corners.size() / 3;
  this->Ends.resize(2 * (body.NumberOfNodes() - first));
  for (std::size_t cell = 0; cell < body.NumberOfCells(); ++cell)
  {
    const std::int32_t* nodes = &body.Cells()[body.NodesPerCell() * cell];
    for (int a = 4; a < body.NodesPerCell(); ++a)
    {
      for (int end = 0; end < 2; ++end)
      {
        this->Ends[2 * (nodes[a] - first) + end] = nodes[CellEdges[a - 4][end]];
      }
    }
  }
  this->MakePattern();
}

void InverseEquilibrium::MakePattern()
{
  const SparsePattern& lower = this->Energy.Pattern();
  const std::size_t size = this->Coordinates().size();
  std::vector<std::vector<int>> rows(size);
  for (std::size_t column = 0; column < size; ++column)
  {
    for (int k = lower.Starts[column]; k < lower.Starts[column + 1]; ++k)
    {
      const int row = lower.Rows[k];
      rows[column].push_back(row);
      if (row != static_cast<int>(column))
      {
        rows[row].push_back(static_cast<int>(column));
      }
    }
  }
  // Columns are visited in ascending order, so the upper entries of a column come first.
  for (std::vector<int>& column : rows)
  {
    std::sort(column.begin(), column.end());
    this->Entries.Rows.insert(this->Entries.Rows.end(), column.begin(), column.end());
    this->Entries.Starts.push_back(static_cast<int>(this->Entries.Rows.size()));
  }
}

std::vector<double> InverseEquilibrium::Unloaded() const
{
  std::vector<double> y = this->Corners;
  y.resize(3 * this->Body.NumberOfNodes());
  this->PutMiddlesBetween(y);
  return y;
}

void InverseEquilibrium::PutMiddlesBetween(std::span<double> values) const
{
  const std::size_t first = this->Corners.size();
  for (std::size_t c = first; c < values.size(); ++c)
  {
    const std::int32_t* ends = &this->Ends[2 * ((c - first) / 3)];
    values[c] = 0.5 * (values[3 * ends[0] + c % 3] + values[3 * ends[1] + c % 3]);
  }
}

std::vector<double> InverseEquilibrium::Deformed(const std::vector<double>& y) const
{
  std::vector<double> x = y;
  std::copy(this->Corners.begin(), this->Corners.end(), x.begin());
  return x;
}

/// Returns false if a cell is inverted.
bool InverseEquilibrium::MoveRest(const std::vector<double>& y)
{
  this->Body.SetRestCorners(y);
  if (this->Wall)
  {
    this->Wall->SetRestPositions(this->Body.RestPositions());
  }
  this->Energy.BodyChanged();
  for (std::size_t cell = 0; cell < this->FixedCells.size(); ++cell)
  {
    if (!this->FixedCells[cell] && !(this->Body.CellVolume(cell) > 0))
    {
      return false;
    }
  }
  return true;
}

bool InverseEquilibrium::Evaluate(const std::vector<double>& y, bool derivatives)
{
  if (!this->MoveRest(y))
  {
    return false;
  }
  std::vector<double> loads =
    BodyForces(this->Body, this->FixedCells, this->LoadedPart * this->Gravity, { 0, 0, 0 });
  this->Energy.SetLoads(std::move(loads));
  const std::vector<double> x = this->Deformed(y);
  this->Energy.Evaluate(x, derivatives ? EnergyOrder::Hessian : EnergyOrder::Gradient,
    this->Current);
  if (!this->Current.Valid)
  {
    return false;
  }
  this->Residual.resize(this->Coordinates().size());
  std::transform(this->Coordinates().begin(), this->Coordinates().end(), this->Residual.begin(),
    [&](std::int32_t coordinate) { return -this->Current.Gradient[coordinate]; });
  if (derivatives)
  {
    this->Values.assign(this->Entries.Rows.size(), 0.0);
    this->AddHessian(this->Current.Hessian);
    this->AddElements(x);
    this->AddWall(x);
  }
  return true;
}

/// Adds the columns of mid-side nodes, whose unknowns are deformed positions.
void InverseEquilibrium::AddHessian(const std::vector<double>& hessian)
{
  const SparsePattern& lower = this->Energy.Pattern();
  const std::vector<std::int32_t>& coordinates = this->Coordinates();
  for (std::size_t column = 0; column < coordinates.size(); ++column)
  {
    for (int k = lower.Starts[column]; k < lower.Starts[column + 1]; ++k)
    {
      const int row = lower.Rows[k];
      if (!this->IsCorner(coordinates[column]))
      {
        this->Values[this->Entries.PlaceOf(static_cast<int>(column), row)] += hessian[k];
      }
      if (row != static_cast<int>(column) && !this->IsCorner(coordinates[row]))
      {
        this->Values[this->Entries.PlaceOf(row, static_cast<int>(column))] += hessian[k];
      }
    }
  }
}

void InverseEquilibrium::AddEntry(std::int32_t rowCoordinate, std::int32_t columnCoordinate,
  double value)
{
  const std::vector<std::int32_t>& unknown = this->Energy.Part().Unknowns();
  const std::int32_t row = unknown[rowCoordinate];
  const std::int32_t column = unknown[columnCoordinate];
  if (row >= 0 && column >= 0)
  {
    this->Values[this->Entries.PlaceOf(column, row)] += value;
  }
}

/// Adds minus the derivative of the weight to the columns of the corners in an element's matrix.
void InverseEquilibrium::AddWeight(std::size_t element, std::vector<double>& matrix) const
{
  const int perCell = this->Body.NodesPerCell();
  const std::size_t rows = 3 * this->Body.NodesOf(element).size();
  for (const std::int32_t cell : this->Body.CellsOf(element))
  {
    const int* local = this->Body.LocalNodesOf(cell);
    const double* gradients = this->Body.BarycentricGradientsOf(cell);
    const double mass =
      WeightDensity * this->Body.CellDensity(cell) * this->Body.CellVolume(cell) * this->LoadedPart;
    for (int j = 0; j < 4; ++j)
    {
      for (int k = 0; k < 3; ++k)
      {
        double* column = &matrix[rows * (3 * local[j] + k)];
        for (int a = 0; a < perCell; ++a)
        {
          const double share = this->Body.IntegralOfShape(a) * mass * gradients[3 * j + k];
          for (int axis = 0; axis < 3; ++axis)
          {
            column[3 * local[a] + axis] -= share * this->Gravity[axis];
          }
        }
      }
    }
  }
}

void InverseEquilibrium::AddElements(const std::vector<double>& x)
{
  const std::vector<std::int32_t>& elements = this->Energy.Part().Elements();
  std::vector<std::vector<double>> matrices(elements.size());
  ParallelFor(elements.size(),
    [&](std::size_t e)
    {
      const auto element = static_cast<std::size_t>(elements[e]);
      const std::size_t rows = 3 * this->Body.NodesOf(element).size();
      matrices[e].assign(rows * rows, 0.0);
      this->Energy.Elastic().AddRestDerivative(element, x, matrices[e]);
      this->AddWeight(element, matrices[e]);
    });
  for (std::size_t e = 0; e < elements.size(); ++e)
  {
    const std::span<const std::int32_t> nodes = this->Body.NodesOf(elements[e]);
    const double* value = matrices[e].data();
    const auto rows = static_cast<std::int32_t>(3 * nodes.size());
    for (std::int32_t c = 0; c < rows; ++c)
    {
      const std::int32_t column = 3 * nodes[c / 3] + c % 3;
      for (std::int32_t r = 0; r < rows && this->IsCorner(column); ++r)
      {
        this->AddEntry(3 * nodes[r / 3] + r % 3, column, value[rows * c + r]);
      }
    }
  }
}

void InverseEquilibrium::AddWall(const std::vector<double>& x)
{
  if (!this->Wall)
  {
    return;
  }
  std::vector<std::array<Vector3, 3>> rates(this->Wall->NumberOfPieces());
  ParallelFor(rates.size(),
    [&](std::size_t n)
    { rates[n] = this->Wall->NodeRestDerivative(n, NodePosition(x, this->Wall->Nodes()[n])); });
  for (std::size_t n = 0; n < rates.size(); ++n)
  {
    const std::int32_t node = this->Wall->Nodes()[n];
    for (int i = 0; i < 3; ++i)
    {
      for (int k = 0; k < 3; ++k)
      {
        if (this->IsCorner(3 * node))
        {
          this->AddEntry(3 * node + i, 3 * node + k, rates[n][i][k]);
          continue;
        }
        // A mid-side node follows the ends of its side.
        const std::size_t end = 2 * (node - this->Corners.size() / 3);
        this->AddEntry(3 * node + i, 3 * this->Ends[end] + k, 0.5 * rates[n][i][k]);
        this->AddEntry(3 * node + i, 3 * this->Ends[end + 1] + k, 0.5 * rates[n][i][k]);
      }
    }
  }
}

std::vector<double> InverseEquilibrium::ParameterForces(const std::vector<double>& y,
  const std::vector<MaterialDerivative>& materials, const std::vector<WallStiffness>& walls) const
{
  const std::vector<double> x = this->Deformed(y);
  std::vector<double> columns = MaterialForces(this->Energy, x, materials);
  std::vector<SupportDerivative> holding;
  holding.reserve(walls.size());
  for (const WallStiffness& wall : walls)
  {
    holding.push_back({ wall, 0, {} });
  }
  const std::vector<double> more = SupportForces(this->Energy, x, holding);
  columns.insert(columns.end(), more.begin(), more.end());
  return columns;
}
}
