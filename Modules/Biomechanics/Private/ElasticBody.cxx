// SPDX-License-Identifier: Apache-2.0
#include "Private/ElasticBody.h"

#include "Private/CellPatches.h"
#include "mammoray/Foundation/Error.h"

#include <Eigen/Core>

#include <algorithm>
#include <map>
#include <string>
#include <unordered_map>

namespace mammoray
{
namespace
{
/// Subdivisions of the lattice on which the material field is sampled in a cell: 220 points around
/// four quadrature points, 35 around one.
int LatticeOrder(ElementType type)
{
  return type == ElementType::Quadratic ? 9 : 4;
}
}

ElasticBody::ElasticBody(const TetrahedralMesh& mesh, const std::vector<ElasticMaterial>& materials,
  const MaterialField& field, const std::vector<bool>& ignored, ElementType type)
  : Kind(type)
{
  mesh.Validate("simulation mesh");
  this->AddNodesAndCells(mesh);
  this->SampleMaterials(mesh, static_cast<int>(materials.size()), field, ignored);
  this->MakeElements(mesh, ignored);
  this->Table.resize(materials.size());
  this->SetMaterials(materials);
}

void ElasticBody::AddNodesAndCells(const TetrahedralMesh& mesh)
{
  const std::size_t cellCount = mesh.NumberOfCells();
  this->Rest = mesh.Points;
  this->Volumes.resize(cellCount);
  this->BarycentricGradients.resize(12 * cellCount);
  if (this->Kind == ElementType::PatchAveragedLinear)
  {
    this->CellNodes = mesh.Cells;
    this->MeasureRest();
    return;
  }
  this->CellNodes.resize(10 * cellCount);
  std::unordered_map<std::uint64_t, std::int32_t> middles;
  middles.reserve(2 * cellCount);
  for (std::size_t cell = 0; cell < cellCount; ++cell)
  {
    const std::int32_t* corners = &mesh.Cells[4 * cell];
    std::int32_t* nodes = &this->CellNodes[10 * cell];
    std::copy(corners, corners + 4, nodes);
    for (int e = 0; e < 6; ++e)
    {
      const auto [low, high] = std::minmax(corners[CellEdges[e][0]], corners[CellEdges[e][1]]);
      const std::uint64_t key = (static_cast<std::uint64_t>(low) << 32) | std::uint32_t(high);
      const auto [found, added] =
        middles.try_emplace(key, static_cast<std::int32_t>(this->Rest.size() / 3));
      nodes[4 + e] = found->second;
      if (added)
      {
        this->Rest.resize(this->Rest.size() + 3);
      }
    }
  }
  this->MeasureRest();
}

void ElasticBody::MeasureRest()
{
  const auto at = [this](std::int32_t node) {
    return Vector3{ this->Rest[3 * node], this->Rest[3 * node + 1], this->Rest[3 * node + 2] };
  };
  for (std::size_t cell = 0; cell < this->NumberOfCells(); ++cell)
  {
    const std::int32_t* nodes = &this->CellNodes[this->NodesPerCell() * cell];
    for (int a = 4; a < this->NodesPerCell(); ++a)
    {
      const int* ends = CellEdges[a - 4];
      const Vector3 middle = 0.5 * (at(nodes[ends[0]]) + at(nodes[ends[1]]));
      std::copy(middle.begin(), middle.end(), &this->Rest[3 * nodes[a]]);
    }
    const Vector3 p = at(nodes[0]);
    const double volume = Dot(at(nodes[1]) - p, Cross(at(nodes[2]) - p, at(nodes[3]) - p)) / 6;
    this->Volumes[cell] = volume;
    for (int i = 0; i < 4; ++i)
    {
      // Half the inward area vector of the opposite face, divided by the volume.
      const Vector3 q = at(nodes[FaceCorners[i][0]]);
      const Vector3 inwards =
        Cross(at(nodes[FaceCorners[i][2]]) - q, at(nodes[FaceCorners[i][1]]) - q);
      for (int axis = 0; axis < 3; ++axis)
      {
        this->BarycentricGradients[12 * cell + 3 * i + axis] = inwards[axis] / (6 * volume);
      }
    }
  }
}

void ElasticBody::SetRestCorners(const std::vector<double>& corners)
{
  // MeasureRest computes the mid-side nodes from the corners.
  std::copy_n(corners.begin(), std::min(corners.size(), this->Rest.size()), this->Rest.begin());
  this->MeasureRest();
  for (std::size_t element = 0; element < this->NumberOfElements(); ++element)
  {
    this->ElementVolumes[element] = 0;
    for (const std::int32_t cell : this->CellsOf(element))
    {
      this->ElementVolumes[element] += this->Volumes[cell];
    }
  }
  for (BoundaryFace& face : this->Boundary)
  {
    const std::span<const std::int32_t> nodes = this->NodesOf(face.Element);
    Vector3 ends[3];
    for (int c = 0; c < 3; ++c)
    {
      std::copy_n(&this->Rest[3 * nodes[face.LocalNodes[c]]], 3, ends[c].begin());
    }
    face.Area = 0.5 * Norm(Cross(ends[1] - ends[0], ends[2] - ends[0]));
  }
  // Update the elements' moduli, which are means over their undeformed volume.
  this->SetMaterials(std::vector<ElasticMaterial>(this->Table));
}

double ElasticBody::CellDensity(std::size_t cell) const
{
  double density = 0;
  for (std::size_t p = this->PartStarts[cell]; p < this->PartStarts[cell + 1]; ++p)
  {
    const double ofPart = this->Table[this->Parts[p].Material].DensityGPerCm3;
    if (ofPart == 0)
    {
      return 0;
    }
    density += this->Parts[p].CellShare * ofPart;
  }
  return density;
}

double ElasticBody::CellBulkModulus(std::size_t cell) const
{
  double kappa = 0;
  for (const Part& part : this->PartsOf(cell))
  {
    kappa += part.CellShare * this->Table[part.Material].BulkModulusKPa();
  }
  return kappa;
}

double ElasticBody::CellVolumeRate(std::size_t cell, const std::vector<double>& velocities) const
{
  const std::int32_t* nodes = &this->CellNodes[this->NodesPerCell() * cell];
  const double* gradients = this->BarycentricGradientsOf(cell);
  double divergence = 0;
  for (int i = 0; i < 4; ++i)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      divergence += gradients[3 * i + axis] * velocities[3 * nodes[i] + axis];
    }
  }
  return divergence * this->Volumes[cell];
}

double ElasticBody::FaceAreaRate(const BoundaryFace& face,
  const std::vector<double>& velocities) const
{
  const std::span<const std::int32_t> nodes = this->NodesOf(face.Element);
  const auto side = [&](const std::vector<double>& values, int end)
  {
    const std::int32_t from = nodes[face.LocalNodes[0]];
    const std::int32_t to = nodes[face.LocalNodes[end]];
    return Vector3{ values[3 * to] - values[3 * from], values[3 * to + 1] - values[3 * from + 1],
      values[3 * to + 2] - values[3 * from + 2] };
  };
  const Vector3 a = side(this->Rest, 1);
  const Vector3 b = side(this->Rest, 2);
  const Vector3 normal = Cross(a, b);
  const Vector3 rate = Cross(side(velocities, 1), b) + Cross(a, side(velocities, 2));
  return 0.5 * Dot(normal, rate) / Norm(normal);
}

std::vector<double> ElasticBody::NodeIntegrals(const std::vector<double>& cellValues) const
{
  std::vector<double> result(this->NumberOfNodes(), 0.0);
  for (std::size_t cell = 0; cell < this->NumberOfCells(); ++cell)
  {
    const double whole = cellValues[cell] * this->Volumes[cell];
    for (int a = 0; a < this->NodesPerCell(); ++a)
    {
      result[this->CellNodes[this->NodesPerCell() * cell + a]] += this->IntegralOfShape(a) * whole;
    }
  }
  return result;
}

void ElasticBody::MakeElements(const TetrahedralMesh& mesh, const std::vector<bool>& ignored)
{
  const std::size_t cellCount = this->NumberOfCells();
  const std::vector<std::int32_t> neighbours = FaceNeighbours(mesh);
  std::vector<std::vector<std::int32_t>> elements;
  if (this->Kind == ElementType::PatchAveragedLinear)
  {
    std::vector<char> groups(cellCount);
    for (std::size_t cell = 0; cell < cellCount; ++cell)
    {
      const auto material = static_cast<std::size_t>(mesh.Materials[cell]);
      groups[cell] = material < ignored.size() && ignored[material];
    }
    elements = MakePatches(mesh, neighbours, groups);
  }
  else
  {
    for (std::size_t cell = 0; cell < cellCount; ++cell)
    {
      elements.push_back({ static_cast<std::int32_t>(cell) });
    }
  }

  const auto nodesPerCell = static_cast<std::size_t>(this->NodesPerCell());
  this->LocalNodes.resize(this->CellNodes.size());
  this->CellStarts.push_back(0);
  this->NodeStarts.push_back(0);
  std::vector<std::int32_t> elementOfCell(cellCount);
  for (const std::vector<std::int32_t>& cells : elements)
  {
    double volume = 0;
    for (const std::int32_t cell : cells)
    {
      elementOfCell[cell] = static_cast<std::int32_t>(this->ElementVolumes.size());
      volume += this->Volumes[cell];
      for (std::size_t a = nodesPerCell * cell; a < nodesPerCell * (cell + 1); ++a)
      {
        const auto begin = this->ElementNodes.begin() + this->NodeStarts.back();
        const auto found = std::find(begin, this->ElementNodes.end(), this->CellNodes[a]);
        this->LocalNodes[a] = static_cast<int>(found - begin);
        if (found == this->ElementNodes.end())
        {
          this->ElementNodes.push_back(this->CellNodes[a]);
        }
      }
    }
    this->ElementCells.insert(this->ElementCells.end(), cells.begin(), cells.end());
    this->ElementVolumes.push_back(volume);
    this->CellStarts.push_back(this->ElementCells.size());
    this->NodeStarts.push_back(this->ElementNodes.size());
  }

  for (std::size_t place = 0; place < neighbours.size(); ++place)
  {
    if (neighbours[place] >= 0)
    {
      continue;
    }
    const std::size_t cell = place / 4;
    const std::size_t face = place % 4;
    BoundaryFace boundary;
    boundary.Element = elementOfCell[cell];
    for (int a = 0; a < this->NodesPerFace(); ++a)
    {
      const int node = a < 3 ? FaceCorners[face][a] : FaceMiddles[face][a - 3];
      boundary.LocalNodes[a] = this->LocalNodes[nodesPerCell * cell + node];
    }
    // The gradient of the opposite corner's coordinate has the length area / (3 V).
    const Eigen::Map<const Eigen::Vector3d> height(&this->BarycentricGradients[3 * place]);
    boundary.Area = 3 * this->Volumes[cell] * height.norm();
    this->Boundary.push_back(boundary);
  }
}

void ElasticBody::SampleMaterials(const TetrahedralMesh& mesh, int materialCount,
  const MaterialField& field, const std::vector<bool>& ignored)
{
  const int points = this->PointsPerCell();
  const int order = LatticeOrder(this->Kind);
  for (std::size_t cell = 0; cell < this->NumberOfCells(); ++cell)
  {
    const int own = mesh.Materials[cell];
    if (own < 0 || own >= materialCount)
    {
      throw InputError("simulation mesh: cell " + std::to_string(cell) + " is of material " +
        std::to_string(own) + ", expected 0 to " + std::to_string(materialCount - 1));
    }
    std::map<int, Part> parts;
    std::array<double, 4> count{};
    double total = 0;
    const auto add = [&](int material, const double* lambda)
    {
      Part& part = parts.try_emplace(material, Part{ material }).first->second;
      // A lattice point equally near to several quadrature points is divided among them.
      const double largest = *std::max_element(lambda, lambda + 4) - 1e-9;
      const auto ties = static_cast<double>(
        std::count_if(lambda, lambda + 4, [=](double l) { return l > largest; }));
      for (int q = 0; q < 4; ++q)
      {
        if (points == 1 || lambda[q] > largest)
        {
          part.PointShares[q] += 1 / ties;
          count[q] += 1 / ties;
        }
      }
      part.CellShare += 1;
      total += 1;
    };
    if (!field)
    {
      const double centre[4] = { 0.25, 0.25, 0.25, 0.25 };
      add(own, centre);
    }
    for (int i = 0; field && i <= order; ++i)
    {
      for (int j = 0; i + j <= order; ++j)
      {
        for (int k = 0; i + j + k <= order; ++k)
        {
          const int index[4] = { i, j, k, order - i - j - k };
          double lambda[4];
          Vector3 point{ 0, 0, 0 };
          for (int c = 0; c < 4; ++c)
          {
            lambda[c] = (index[c] + 0.25) / (order + 1);
            point = point + lambda[c] * mesh.Point(mesh.Cells[4 * cell + c]);
          }
          int material = field(point);
          if (material < 0 || material >= materialCount)
          {
            throw InputError("material field: found material " + std::to_string(material) +
              ", expected 0 to " + std::to_string(materialCount - 1));
          }
          if (material == 0 ||
            (static_cast<std::size_t>(material) < ignored.size() && ignored[material]))
          {
            material = own;
          }
          add(material, lambda);
        }
      }
    }
    this->PartStarts.push_back(this->Parts.size());
    for (auto& [material, part] : parts)
    {
      for (int q = 0; q < 4; ++q)
      {
        part.PointShares[q] /= count[q];
      }
      part.CellShare /= total;
      this->Parts.push_back(part);
    }
  }
  this->PartStarts.push_back(this->Parts.size());
}

void ElasticBody::SetMaterials(const std::vector<ElasticMaterial>& materials)
{
  if (materials.size() != this->Table.size())
  {
    throw InputError("materials: expected " + std::to_string(this->Table.size()) + ", found " +
      std::to_string(materials.size()));
  }
  for (std::size_t m = 0; m < materials.size(); ++m)
  {
    // Check all entries, used or not: a table with a bad entry is rejected.
    const auto need = [m](bool good, const char* expected, double found)
    {
      if (!good)
      {
        throw InputError("material " + std::to_string(m) + ": expected " + expected + ", found " +
          std::to_string(found));
      }
    };
    const ElasticMaterial& material = materials[m];
    need(material.YoungsModulusKPa > 0, "a positive Young's modulus, kPa",
      material.YoungsModulusKPa);
    need(material.PoissonRatio >= 0 && material.PoissonRatio < 0.5, "a Poisson's ratio in [0, 0.5)",
      material.PoissonRatio);
    need(material.DensityGPerCm3 >= 0 && std::isfinite(material.DensityGPerCm3),
      "a positive density, g/cm^3", material.DensityGPerCm3);
    need(material.FungExponent >= 0 &&
        material.FungExponent <= ElasticMaterial::LargestFungExponent,
      "a Fung exponent in [0, 50]", material.FungExponent);
  }
  this->Table = materials;
  const int points = this->PointsPerCell();
  this->Shape.assign(points * this->NumberOfCells(), { 0, 0 });
  this->Mu.assign(this->NumberOfElements(), 0.0);
  this->Kappa.assign(this->NumberOfElements(), 0.0);
  for (std::size_t element = 0; element < this->NumberOfElements(); ++element)
  {
    for (const std::int32_t cell : this->CellsOf(element))
    {
      const double share = this->Volumes[cell] / this->ElementVolumes[element];
      ShapeEnergy* shape = &this->Shape[points * cell];
      for (std::size_t p = this->PartStarts[cell]; p < this->PartStarts[cell + 1]; ++p)
      {
        const Part& part = this->Parts[p];
        const ElasticMaterial& material = materials[part.Material];
        const double mu = material.ShearModulusKPa();
        for (int q = 0; q < points; ++q)
        {
          shape[q].Mu += part.PointShares[q] * mu;
          shape[q].Exponent += part.PointShares[q] * mu * material.FungExponent;
        }
        this->Kappa[element] += share * part.CellShare * material.BulkModulusKPa();
      }
      for (int q = 0; q < points; ++q)
      {
        shape[q].Exponent /= shape[q].Mu;
        this->Mu[element] += share / points * shape[q].Mu;
      }
    }
  }
}

}
