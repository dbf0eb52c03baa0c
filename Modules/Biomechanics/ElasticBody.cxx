// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Biomechanics/ElasticBody.h"

#include "Private/CellPatches.h"
#include "mammoray/Foundation/Error.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <unordered_map>

namespace mammoray
{
namespace
{
/// Barycentric coordinates of the 4-point rule: (5 + 3 sqrt 5) / 20 and (5 - sqrt 5) / 20.
constexpr double NearCoordinate = 0.58541019662496845446;
constexpr double FarCoordinate = 0.13819660112501051518;

using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Vector9 = Eigen::Matrix<double, 9, 1>;

/// Ten nodes, four points of equal weight, an element of its own.
struct QuadraticCell
{
  static constexpr int Nodes = 10;
  static constexpr int Points = 4;
  static constexpr int MostPointsPerElement = 4;
  /// Subdivisions of the lattice on which the material field is sampled: 220 points in a cell.
  static constexpr int LatticeOrder = 9;
  using Gradients = Eigen::Matrix<double, 3, 10>;
  /// Of an element: a vector at each node, and its stiffness.
  using NodeVectors = Eigen::Matrix<double, 3, 10>;
  using Stiffness = Eigen::Matrix<double, 30, 30>;

  /// Gradients of the shape functions at the quadrature point near corner `q`, one column each.
  static Gradients ShapeGradients(const double* barycentric, int q)
  {
    const Eigen::Map<const Eigen::Matrix<double, 3, 4>> g(barycentric);
    double lambda[4] = { FarCoordinate, FarCoordinate, FarCoordinate, FarCoordinate };
    lambda[q] = NearCoordinate;
    Gradients result;
    for (int i = 0; i < 4; ++i)
    {
      result.col(i) = (4 * lambda[i] - 1) * g.col(i);
    }
    for (int e = 0; e < 6; ++e)
    {
      const int i = CellEdges[e][0];
      const int j = CellEdges[e][1];
      result.col(4 + e) = 4 * (lambda[i] * g.col(j) + lambda[j] * g.col(i));
    }
    return result;
  }
  static int Local(const int*, int node) { return node; }
};

/// Four nodes, one point, part of a patch.
struct LinearCell
{
  static constexpr int Nodes = 4;
  static constexpr int Points = 1;
  static constexpr int MostPointsPerElement = LargestPatchSize;
  /// 35 points in a cell.
  static constexpr int LatticeOrder = 4;
  using Gradients = Eigen::Matrix<double, 3, 4>;
  // Every cell of a patch but the first brings one node or none.
  using NodeVectors =
    Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, MostPointsPerElement + 3>;
  using Stiffness = Eigen::MatrixXd;

  static Gradients ShapeGradients(const double* barycentric, int)
  {
    return Eigen::Map<const Gradients>(barycentric);
  }
  static int Local(const int* localNodes, int node) { return localNodes[node]; }
};

Eigen::Matrix3d Cofactor(const Eigen::Matrix3d& f)
{
  Eigen::Matrix3d c;
  c.col(0) = f.col(1).cross(f.col(2));
  c.col(1) = f.col(2).cross(f.col(0));
  c.col(2) = f.col(0).cross(f.col(1));
  return c;
}

/// Adds s * d^2 det F / dF^2; index 3 * column + row of F.
void AddDeterminantHessian(const Eigen::Matrix3d& f, double s, Matrix9& a)
{
  for (int j = 0; j < 3; ++j)
  {
    // d cof.col(j) / d F.col(l) = -+ [F.col(m)]x, m the third column.
    for (int step = 1; step < 3; ++step)
    {
      const int l = (j + step) % 3;
      const int m = 3 - j - l;
      const double sign = step == 1 ? -s : s;
      const Eigen::Vector3d v = f.col(m);
      a(3 * j + 0, 3 * l + 1) += -sign * v[2];
      a(3 * j + 0, 3 * l + 2) += sign * v[1];
      a(3 * j + 1, 3 * l + 0) += sign * v[2];
      a(3 * j + 1, 3 * l + 2) += -sign * v[0];
      a(3 * j + 2, 3 * l + 0) += -sign * v[1];
      a(3 * j + 2, 3 * l + 1) += sign * v[0];
    }
  }
}

/// Adds to `a` what makes it positive semidefinite on the space spanned by `basis`, orthonormal,
/// that it maps into itself.
template <int Size>
void ProjectOn(const Eigen::Matrix<double, 9, Size>& basis, Matrix9& a)
{
  const Eigen::Matrix<double, Size, Size> block = basis.transpose() * a * basis;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, Size, Size>> eigen(block);
  for (int k = 0; k < Size && eigen.eigenvalues()[k] < 0; ++k)
  {
    const Vector9 direction = basis * eigen.eigenvectors().col(k);
    a -= eigen.eigenvalues()[k] * direction * direction.transpose();
  }
}

/**
 * Replaces the negative eigenvalues of `a`, the second derivative of an isotropic energy at F, by
 * zero. With the singular vectors u_i and v_j of F, it maps the span of u_0 v_0^T, u_1 v_1^T and
 * u_2 v_2^T into itself, and those of u_i v_j^T and u_j v_i^T (Smith, de Goes and Kim 2019); that
 * is ten times as fast as all nine dimensions at once.
 */
void ProjectIsotropic(const Eigen::Matrix3d& f, Matrix9& a)
{
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> right(f.transpose() * f);
  const Eigen::Matrix3d v = right.eigenvectors();
  const Eigen::Matrix3d u = (f * v).colwise().normalized();
  const auto product = [&](int i, int j) -> Vector9
  {
    const Eigen::Matrix3d outer = u.col(i) * v.col(j).transpose();
    return Eigen::Map<const Vector9>(outer.data());
  };
  Eigen::Matrix<double, 9, 3> scaling;
  scaling << product(0, 0), product(1, 1), product(2, 2);
  ProjectOn(scaling, a);
  for (int i = 0; i < 3; ++i)
  {
    const int j = (i + 1) % 3;
    Eigen::Matrix<double, 9, 2> shearing;
    shearing << product(i, j), product(j, i);
    ProjectOn(shearing, a);
  }
}

/**
 * p = J^(-2/3), and its derivatives as p' = -2/3 p / SlopeJ and p'' = 10/9 p / (SlopeJ CurvatureJ):
 * both are J, but in the extended domain below ExtendedBelow, where a parabola continues p.
 */
struct PowerOfJ
{
  double Value;
  double SlopeJ;
  double CurvatureJ;

  PowerOfJ(double j, ElasticBody::Domain domain)
    : Value(1 / std::cbrt(j * j))
    , SlopeJ(j)
    , CurvatureJ(j)
  {
    constexpr double ExtendedBelow = 0.1;
    if (domain == ElasticBody::Domain::Extended && j < ExtendedBelow)
    {
      const double beyond = j - ExtendedBelow;
      const double value = 1 / std::cbrt(ExtendedBelow * ExtendedBelow);
      const double slope = -2 * value / (3 * ExtendedBelow);
      const double curvature = -5 * slope / (3 * ExtendedBelow);
      this->Value = value + beyond * (slope + 0.5 * beyond * curvature);
      this->SlopeJ = -2 * this->Value / (3 * (slope + beyond * curvature));
      this->CurvatureJ = 10 * this->Value / (9 * curvature * this->SlopeJ);
    }
  }
};

/// A deformed quadrature point.
template <typename Cell>
struct PointState
{
  /// Of the cell's nodes.
  typename Cell::Gradients Shape;
  Eigen::Matrix3d F;
  Eigen::Matrix3d Cofactor;
  double J = 1;
  /// Undeformed volume it stands for, mm^3.
  double Weight = 0;
  /// Its place in ElasticBody::Shape.
  std::size_t Law = 0;
  /// Places of the cell's nodes in the element.
  const int* LocalNodes = nullptr;

  /// Adds the lower half of G^T a G to an element's stiffness, G: F by the nodes' positions.
  template <typename Stiffness>
  void AddStiffnessTo(Stiffness& stiffness, const Matrix9& a) const
  {
    for (int m = 0; m < Cell::Nodes; ++m)
    {
      const Eigen::Matrix<double, 3, 9> row = this->Shape(0, m) * a.middleRows<3>(0) +
        this->Shape(1, m) * a.middleRows<3>(3) + this->Shape(2, m) * a.middleRows<3>(6);
      const int to = Cell::Local(this->LocalNodes, m);
      for (int n = 0; n <= m; ++n)
      {
        const Eigen::Matrix3d block = this->Shape(0, n) * row.template middleCols<3>(0) +
          this->Shape(1, n) * row.template middleCols<3>(3) +
          this->Shape(2, n) * row.template middleCols<3>(6);
        const int from = Cell::Local(this->LocalNodes, n);
        if (to >= from)
        {
          stiffness.template block<3, 3>(3 * to, 3 * from) += block;
        }
        else
        {
          stiffness.template block<3, 3>(3 * from, 3 * to) += block.transpose();
        }
      }
    }
  }

  /// Adds a vector for each of the cell's nodes to those of the element.
  template <typename Vectors>
  void AddTo(Vectors& vectors, const typename Cell::Gradients& add) const
  {
    for (int m = 0; m < Cell::Nodes; ++m)
    {
      vectors.col(Cell::Local(this->LocalNodes, m)) += add.col(m);
    }
  }
};
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
      // Half the area vector of the opposite face, inwards, over the volume.
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
  // The middles' places are made anew from the corners.
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
  // An element's moduli are means over its volume.
  this->SetMaterials(std::vector<ElasticMaterial>(this->Table));
}

double ElasticBody::CellDensity(std::size_t cell) const
{
  double density = 0;
  for (std::size_t p = this->PartStarts[cell]; p < this->PartStarts[cell + 1]; ++p)
  {
    density += this->Parts[p].Whole * this->Table[this->Parts[p].Material].DensityGPerCm3;
  }
  return density;
}

std::vector<double> ElasticBody::NodeIntegrals(const std::vector<double>& cellValues) const
{
  // Integrals of the shape functions of corners and middles over a tetrahedron of volume 1.
  const bool quadratic = this->Kind == ElementType::Quadratic;
  const double ofCorner = quadratic ? -1 / 20.0 : 1 / 4.0;
  const double ofMiddle = 1 / 5.0;
  std::vector<double> result(this->NumberOfNodes(), 0.0);
  for (std::size_t cell = 0; cell < this->NumberOfCells(); ++cell)
  {
    const double whole = cellValues[cell] * this->Volumes[cell];
    for (int a = 0; a < this->NodesPerCell(); ++a)
    {
      result[this->CellNodes[this->NodesPerCell() * cell + a]] +=
        (a < 4 ? ofCorner : ofMiddle) * whole;
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
    // The gradient of the opposite corner's coordinate is as long as the face is large over 3 V.
    const Eigen::Map<const Eigen::Vector3d> height(&this->BarycentricGradients[3 * place]);
    boundary.Area = 3 * this->Volumes[cell] * height.norm();
    this->Boundary.push_back(boundary);
  }
}

void ElasticBody::SampleMaterials(const TetrahedralMesh& mesh, int materialCount,
  const MaterialField& field, const std::vector<bool>& ignored)
{
  const int points = this->PointsPerCell();
  const int order =
    this->Kind == ElementType::Quadratic ? QuadraticCell::LatticeOrder : LinearCell::LatticeOrder;
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
      // A point as near to several quadrature points as to one counts for each of them in parts.
      const double largest = *std::max_element(lambda, lambda + 4) - 1e-9;
      const auto ties = static_cast<double>(
        std::count_if(lambda, lambda + 4, [=](double l) { return l > largest; }));
      for (int q = 0; q < 4; ++q)
      {
        if (points == 1 || lambda[q] > largest)
        {
          part.Around[q] += 1 / ties;
          count[q] += 1 / ties;
        }
      }
      part.Whole += 1;
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
        part.Around[q] /= count[q];
      }
      part.Whole /= total;
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
    // Where a material is used decides nothing: a table with a bad entry is refused as a whole.
    const ElasticMaterial& material = materials[m];
    if (!(material.YoungsModulusKPa > 0) ||
      !(material.PoissonRatio >= 0 && material.PoissonRatio < 0.5))
    {
      throw InputError("material " + std::to_string(m) +
        ": expected a positive Young's modulus and a Poisson's ratio in [0, 0.5), found " +
        std::to_string(material.YoungsModulusKPa) + " kPa and " +
        std::to_string(material.PoissonRatio));
    }
    if (!(material.DensityGPerCm3 > 0))
    {
      throw InputError("material " + std::to_string(m) + ": expected a positive density, found " +
        std::to_string(material.DensityGPerCm3) + " g/cm^3");
    }
    if (!(material.FungExponent >= 0 &&
          material.FungExponent <= ElasticMaterial::LargestFungExponent))
    {
      throw InputError("material " + std::to_string(m) +
        ": expected a Fung exponent in [0, 50], found " + std::to_string(material.FungExponent));
    }
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
          shape[q].Mu += part.Around[q] * mu;
          shape[q].Exponent += part.Around[q] * mu * material.FungExponent;
        }
        this->Kappa[element] += share * part.Whole * material.BulkModulusKPa();
      }
      for (int q = 0; q < points; ++q)
      {
        shape[q].Exponent /= shape[q].Mu;
        this->Mu[element] += share / points * shape[q].Mu;
      }
    }
  }
}

template <typename Cell, typename State>
void ElasticBody::DeformCell(std::size_t cell, const std::vector<double>& x, State* states) const
{
  const std::int32_t* nodes = &this->CellNodes[Cell::Nodes * cell];
  typename Cell::Gradients positions;
  for (int a = 0; a < Cell::Nodes; ++a)
  {
    positions.col(a) = Eigen::Map<const Eigen::Vector3d>(&x[3 * nodes[a]]);
  }
  for (int q = 0; q < Cell::Points; ++q)
  {
    State& state = states[q];
    state.Shape = Cell::ShapeGradients(&this->BarycentricGradients[12 * cell], q);
    state.F = positions * state.Shape.transpose();
    state.Cofactor = Cofactor(state.F);
    state.J = state.Cofactor.col(0).dot(state.F.col(0));
    state.Weight = this->Volumes[cell] / Cell::Points;
    state.Law = Cell::Points * cell + q;
    state.LocalNodes = &this->LocalNodes[Cell::Nodes * cell];
  }
}

template <typename Cell>
std::vector<double> ElasticBody::RateOf(std::size_t element, const std::vector<double>& x,
  const MaterialVelocity& velocity) const
{
  // Rates of mu and mu b at each quadrature point, and of the element's mu and kappa.
  double muRate[Cell::MostPointsPerElement] = {};
  double productRate[Cell::MostPointsPerElement] = {};
  double meanMuRate = 0;
  double kappaRate = 0;
  double meanJ = 0;
  std::array<PointState<Cell>, Cell::MostPointsPerElement> states;
  int count = 0;
  for (const std::int32_t cell : this->CellsOf(element))
  {
    const double share = this->Volumes[cell] / this->ElementVolumes[element];
    for (std::size_t p = this->PartStarts[cell]; p < this->PartStarts[cell + 1]; ++p)
    {
      const Part& part = this->Parts[p];
      const ElasticMaterial& material = this->Table[part.Material];
      const ElasticMaterialRate& rate = velocity[part.Material];
      const double relative = rate.YoungsModulusKPa / material.YoungsModulusKPa;
      const double mu = material.ShearModulusKPa();
      const double ownRate = mu * (relative - rate.PoissonRatio / (1 + material.PoissonRatio));
      for (int q = 0; q < Cell::Points; ++q)
      {
        muRate[count + q] += part.Around[q] * ownRate;
        productRate[count + q] +=
          part.Around[q] * (ownRate * material.FungExponent + mu * rate.FungExponent);
      }
      kappaRate += share * part.Whole * material.BulkModulusKPa() *
        (relative + 2 * rate.PoissonRatio / (1 - 2 * material.PoissonRatio));
    }
    this->DeformCell<Cell>(cell, x, &states[count]);
    for (int q = 0; q < Cell::Points; ++q, ++count)
    {
      meanMuRate += share / Cell::Points * muRate[count];
      meanJ += share / Cell::Points * states[count].J;
    }
  }
  const double ratio = this->LargestPointwiseRatio();
  const double pointKappaRate =
    this->Kappa[element] <= ratio * this->Mu[element] ? kappaRate : ratio * meanMuRate;

  std::vector<double> result(3 * this->NodesOf(element).size(), 0.0);
  Eigen::Map<Eigen::Matrix<double, 3, Eigen::Dynamic>> rates(result.data(), 3,
    static_cast<Eigen::Index>(result.size() / 3));
  for (int p = 0; p < count; ++p)
  {
    const PointState<Cell>& state = states[p];
    const ShapeEnergy& law = this->Shape[state.Law];
    const double power = 1 / std::cbrt(state.J * state.J);
    const double trace = state.F.squaredNorm();
    const double exponentRate = (productRate[p] - law.Exponent * muRate[p]) / law.Mu;
    const double scale = 2 * power * law.SlopeRate(power * trace - 3, muRate[p], exponentRate);
    const double pressure =
      (kappaRate - pointKappaRate) * (meanJ - 1) + pointKappaRate * (state.J - 1);
    const Eigen::Matrix3d stress =
      scale * (state.F - trace / (3 * state.J) * state.Cofactor) + pressure * state.Cofactor;
    state.AddTo(rates, state.Weight * stress * state.Shape);
  }
  return result;
}

template <typename Cell>
CellMeasures ElasticBody::CellMeasuresOf(std::size_t cell, const std::vector<double>& x) const
{
  CellMeasures measures{ 0, 0 };
  std::array<PointState<Cell>, Cell::Points> states;
  this->DeformCell<Cell>(cell, x, states.data());
  for (const PointState<Cell>& state : states)
  {
    // The part of the Cauchy stress that is no pressure: 2 w' J^(-5/3) dev(F F^T).
    Eigen::Matrix3d stress = state.F * state.F.transpose();
    const double invariant = stress.trace() / std::cbrt(state.J * state.J) - 3;
    stress -= stress.trace() / 3 * Eigen::Matrix3d::Identity();
    stress *= 2 * this->Shape[state.Law].Slope(invariant) / std::pow(state.J, 5 / 3.0);
    measures.J += state.J / Cell::Points;
    measures.VonMisesKPa += std::sqrt(1.5) / Cell::Points * stress.norm();
  }
  return measures;
}

template <typename Cell>
bool ElasticBody::TermsOf(std::size_t element, const std::vector<double>& x, Order order,
  Domain domain, Terms& terms) const
{
  const double volume = this->ElementVolumes[element];
  const double pointKappa =
    std::min(this->Kappa[element], this->LargestPointwiseRatio() * this->Mu[element]);
  const double kappa = this->Kappa[element] - pointKappa;

  std::array<PointState<Cell>, Cell::MostPointsPerElement> states;
  int count = 0;
  terms.SmallestJ = std::numeric_limits<double>::infinity();
  terms.LargestJ = -terms.SmallestJ;
  terms.Volume = 0;
  for (const std::int32_t cell : this->CellsOf(element))
  {
    this->DeformCell<Cell>(cell, x, &states[count]);
    for (int q = 0; q < Cell::Points; ++q, ++count)
    {
      const PointState<Cell>& state = states[count];
      if (!(state.J > 0) && domain == Domain::Admissible)
      {
        return false;
      }
      terms.SmallestJ = std::min(terms.SmallestJ, state.J);
      terms.LargestJ = std::max(terms.LargestJ, state.J);
      terms.Volume += state.Weight * state.J;
    }
  }
  const double meanJ = terms.Volume / volume;
  terms.Energy = 0.5 * kappa * volume * (meanJ - 1) * (meanJ - 1);
  const double pressure = kappa * (meanJ - 1);

  const auto nodeCount = static_cast<Eigen::Index>(this->NodesOf(element).size());
  using NodeVectors = typename Cell::NodeVectors;
  using Stiffness = typename Cell::Stiffness;
  NodeVectors volumeGradient = NodeVectors::Zero(3, nodeCount);
  if (order >= Order::Gradient)
  {
    terms.Gradient.assign(3 * nodeCount, 0.0);
  }
  if (order >= Order::Hessian)
  {
    terms.Hessian.assign(9 * nodeCount * nodeCount, 0.0);
  }
  Eigen::Map<NodeVectors> gradient(terms.Gradient.data(), 3, nodeCount);
  Eigen::Map<Stiffness> hessian(terms.Hessian.data(), 3 * nodeCount, 3 * nodeCount);
  for (int p = 0; p < count; ++p)
  {
    const PointState<Cell>& state = states[p];
    const Eigen::Matrix3d& f = state.F;
    const Eigen::Matrix3d& cofactor = state.Cofactor;
    const double j = state.J;
    ShapeEnergy law = this->Shape[state.Law];
    if (domain == Domain::Extended)
    {
      law.Exponent = 0; // whose exponential of a large invariant would overflow
    }
    const double trace = f.squaredNorm();
    const PowerOfJ power(j, domain);
    const double invariant = power.Value * trace - 3;
    const double pointPressure = pressure + pointKappa * (j - 1);
    terms.Energy += state.Weight * (law.Value(invariant) + 0.5 * pointKappa * (j - 1) * (j - 1));
    if (order == Order::Energy)
    {
      continue;
    }
    const double ratio = trace / (3 * power.SlopeJ);
    const double scale = 2 * power.Value * law.Slope(invariant);
    // Half the derivative of the invariant by F, over p.
    const Eigen::Matrix3d direction = f - ratio * cofactor;
    const Eigen::Matrix3d stress = scale * direction + pointPressure * cofactor;
    state.AddTo(gradient, state.Weight * stress * state.Shape);
    if (order == Order::Gradient)
    {
      continue;
    }
    state.AddTo(volumeGradient, state.Weight * cofactor * state.Shape);
    const Eigen::Map<const Vector9> fVector(f.data());
    const Eigen::Map<const Vector9> cVector(cofactor.data());
    Matrix9 a = Matrix9::Identity();
    a -= (2 / (3 * power.SlopeJ)) * (fVector * cVector.transpose() + cVector * fVector.transpose());
    a += (5 * ratio / (3 * power.CurvatureJ)) * cVector * cVector.transpose();
    a *= scale;
    a += pointKappa * cVector * cVector.transpose();
    AddDeterminantHessian(f, pointPressure - scale * ratio, a);
    if (law.Exponent > 0)
    {
      const Eigen::Map<const Vector9> d(direction.data());
      a += 4 * power.Value * power.Value * law.Curvature(invariant) * d * d.transpose();
    }
    if (order == Order::ProjectedHessian && Eigen::LLT<Matrix9>(a).info() != Eigen::Success)
    {
      ProjectIsotropic(f, a);
    }
    a *= state.Weight;
    state.AddStiffnessTo(hessian, a);
  }
  if (order >= Order::Hessian)
  {
    const Eigen::Map<const Eigen::Matrix<double, Stiffness::RowsAtCompileTime, 1>> v(
      volumeGradient.data(), 3 * nodeCount);
    hessian.template triangularView<Eigen::Lower>() += (kappa / volume) * v * v.transpose();
    hessian.template triangularView<Eigen::StrictlyUpper>() = hessian.transpose();
  }
  return true;
}

bool ElasticBody::ElementTerms(std::size_t element, const std::vector<double>& x, Order order,
  Terms& terms, Domain domain) const
{
  return this->Kind == ElementType::Quadratic
    ? this->TermsOf<QuadraticCell>(element, x, order, domain, terms)
    : this->TermsOf<LinearCell>(element, x, order, domain, terms);
}

std::vector<double> ElasticBody::GradientRate(std::size_t element, const std::vector<double>& x,
  const MaterialVelocity& velocity) const
{
  return this->Kind == ElementType::Quadratic ? this->RateOf<QuadraticCell>(element, x, velocity)
                                              : this->RateOf<LinearCell>(element, x, velocity);
}

CellMeasures ElasticBody::MeasuresOf(std::size_t cell, const std::vector<double>& x) const
{
  return this->Kind == ElementType::Quadratic ? this->CellMeasuresOf<QuadraticCell>(cell, x)
                                              : this->CellMeasuresOf<LinearCell>(cell, x);
}
}
