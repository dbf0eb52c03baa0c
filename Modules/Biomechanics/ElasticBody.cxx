// SPDX-License-Identifier: Apache-2.0
#include "ElasticBody.h"

#include "Error.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
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
/// Subdivisions of the lattice on which the material field is sampled: 220 points in a cell.
constexpr int LatticeOrder = 9;

/// kappa / mu up to which the volume change counts at each quadrature point: that of nu = 0.49.
constexpr double LargestPointwiseRatio = 50;

using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Vector9 = Eigen::Matrix<double, 9, 1>;
using Gradients = Eigen::Matrix<double, 3, 10>;

/// Gradients of the ten shape functions at the quadrature point near corner `q`, one column each.
Gradients ShapeGradients(const double* barycentric, int q)
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
    const int i = ElasticBody::Edges[e][0];
    const int j = ElasticBody::Edges[e][1];
    result.col(4 + e) = 4 * (lambda[i] * g.col(j) + lambda[j] * g.col(i));
  }
  return result;
}

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
}

ElasticBody::ElasticBody(const TetrahedralMesh& mesh, const std::vector<ElasticMaterial>& materials,
  const MaterialField& field, const std::vector<bool>& ignored)
{
  mesh.Validate("simulation mesh");
  const std::size_t cellCount = mesh.NumberOfCells();
  this->Rest = mesh.Points;
  this->CellNodes.resize(NodesPerCell * cellCount);
  this->Volumes.resize(cellCount);
  this->BarycentricGradients.resize(12 * cellCount);

  std::unordered_map<std::uint64_t, std::int32_t> middles;
  middles.reserve(2 * cellCount);
  for (std::size_t cell = 0; cell < cellCount; ++cell)
  {
    const std::int32_t* corners = &mesh.Cells[4 * cell];
    std::int32_t* nodes = &this->CellNodes[NodesPerCell * cell];
    std::copy(corners, corners + 4, nodes);
    for (int e = 0; e < 6; ++e)
    {
      const auto [low, high] = std::minmax(corners[Edges[e][0]], corners[Edges[e][1]]);
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

  const int materialCount = static_cast<int>(materials.size());
  for (std::size_t cell = 0; cell < cellCount; ++cell)
  {
    const int own = mesh.Materials[cell];
    if (own < 0 || own >= materialCount)
    {
      throw InputError("simulation mesh: cell " + std::to_string(cell) + " is of material " +
        std::to_string(own) + ", expected 0 to " + std::to_string(materialCount - 1));
    }
    std::map<int, Part> parts;
    std::array<double, PointsPerCell> count{};
    double total = 0;
    const auto add = [&](int material, const double* lambda)
    {
      Part& part = parts.try_emplace(material, Part{ material, {}, 0 }).first->second;
      // A point as near to several quadrature points as to one counts for each of them in parts.
      const double largest = *std::max_element(lambda, lambda + 4) - 1e-9;
      const auto ties = static_cast<double>(
        std::count_if(lambda, lambda + 4, [=](double l) { return l > largest; }));
      for (int q = 0; q < 4; ++q)
      {
        if (lambda[q] > largest)
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
    for (int i = 0; field && i <= LatticeOrder; ++i)
    {
      for (int j = 0; i + j <= LatticeOrder; ++j)
      {
        for (int k = 0; i + j + k <= LatticeOrder; ++k)
        {
          const int index[4] = { i, j, k, LatticeOrder - i - j - k };
          double lambda[4];
          Vector3 point{ 0, 0, 0 };
          for (int c = 0; c < 4; ++c)
          {
            lambda[c] = (index[c] + 0.25) / (LatticeOrder + 1);
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
  this->Table.resize(materials.size());
  this->SetMaterials(materials);

  // A face met once is on the boundary. The map is ordered, so the order of faces is reproducible.
  std::map<std::array<std::int32_t, 3>, std::pair<int, std::int32_t>> faces;
  for (std::size_t cell = 0; cell < cellCount; ++cell)
  {
    for (int face = 0; face < 4; ++face)
    {
      std::array<std::int32_t, 3> key;
      for (int c = 0; c < 3; ++c)
      {
        key[c] = mesh.Cells[4 * cell + FaceNodes[face][c]];
      }
      std::sort(key.begin(), key.end());
      const auto [found, added] = faces.try_emplace(key, face, static_cast<std::int32_t>(cell));
      if (!added)
      {
        faces.erase(found);
      }
    }
  }
  for (const auto& [key, face] : faces)
  {
    BoundaryFace boundary;
    boundary.Cell = face.second;
    std::copy_n(FaceNodes[face.first], 6, boundary.LocalNodes.begin());
    this->Boundary.push_back(boundary);
  }
  this->MeasureRest();
}

void ElasticBody::MeasureRest()
{
  const auto at = [this](std::int32_t node)
  { return Vector3{ this->Rest[3 * node], this->Rest[3 * node + 1], this->Rest[3 * node + 2] }; };
  for (std::size_t cell = 0; cell < this->NumberOfCells(); ++cell)
  {
    const std::int32_t* nodes = &this->CellNodes[NodesPerCell * cell];
    for (int e = 0; e < 6; ++e)
    {
      const Vector3 middle = 0.5 * (at(nodes[Edges[e][0]]) + at(nodes[Edges[e][1]]));
      std::copy(middle.begin(), middle.end(), &this->Rest[3 * nodes[4 + e]]);
    }
    const Vector3 p = at(nodes[0]);
    const double volume =
      Dot(at(nodes[1]) - p, Cross(at(nodes[2]) - p, at(nodes[3]) - p)) / 6;
    this->Volumes[cell] = volume;
    for (int i = 0; i < 4; ++i)
    {
      // Half the area vector of the opposite face, inwards, over the volume.
      const Vector3 q = at(nodes[FaceNodes[i][0]]);
      const Vector3 inwards =
        Cross(at(nodes[FaceNodes[i][2]]) - q, at(nodes[FaceNodes[i][1]]) - q);
      for (int axis = 0; axis < 3; ++axis)
      {
        this->BarycentricGradients[12 * cell + 3 * i + axis] = inwards[axis] / (6 * volume);
      }
    }
  }
  for (BoundaryFace& face : this->Boundary)
  {
    const std::int32_t* nodes = &this->CellNodes[NodesPerCell * face.Cell];
    const Vector3 p = at(nodes[face.LocalNodes[0]]);
    face.Area = 0.5 *
      Norm(Cross(at(nodes[face.LocalNodes[1]]) - p, at(nodes[face.LocalNodes[2]]) - p));
  }
}

void ElasticBody::SetRestCorners(const std::vector<double>& corners)
{
  // The middles' places are made anew from the corners.
  std::copy_n(corners.begin(), std::min(corners.size(), this->Rest.size()), this->Rest.begin());
  this->MeasureRest();
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
  std::vector<double> result(this->NumberOfNodes(), 0.0);
  for (std::size_t cell = 0; cell < this->NumberOfCells(); ++cell)
  {
    const double whole = cellValues[cell] * this->Volumes[cell];
    for (int a = 0; a < NodesPerCell; ++a)
    {
      // Integrals of the shape functions of corners and middles over a tetrahedron of volume 1.
      result[this->CellNodes[NodesPerCell * cell + a]] += (a < 4 ? -1 / 20.0 : 1 / 5.0) * whole;
    }
  }
  return result;
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
      throw InputError("material " + std::to_string(m) +
        ": expected a positive density, found " + std::to_string(material.DensityGPerCm3) +
        " g/cm^3");
    }
    if (!(material.FungExponent >= 0 &&
          material.FungExponent <= ElasticMaterial::LargestFungExponent))
    {
      throw InputError("material " + std::to_string(m) +
        ": expected a Fung exponent in [0, 50], found " + std::to_string(material.FungExponent));
    }
  }
  this->Table = materials;
  this->Shape.assign(PointsPerCell * this->NumberOfCells(), { 0, 0 });
  this->Kappa.assign(this->NumberOfCells(), 0.0);
  for (std::size_t cell = 0; cell < this->NumberOfCells(); ++cell)
  {
    ShapeEnergy* shape = &this->Shape[PointsPerCell * cell];
    for (std::size_t p = this->PartStarts[cell]; p < this->PartStarts[cell + 1]; ++p)
    {
      const Part& part = this->Parts[p];
      const ElasticMaterial& material = materials[part.Material];
      const double mu = material.ShearModulusKPa();
      for (int q = 0; q < PointsPerCell; ++q)
      {
        shape[q].Mu += part.Around[q] * mu;
        shape[q].Exponent += part.Around[q] * mu * material.FungExponent;
      }
      this->Kappa[cell] += part.Whole * material.BulkModulusKPa();
    }
    for (int q = 0; q < PointsPerCell; ++q)
    {
      shape[q].Exponent /= shape[q].Mu;
    }
  }
}

double ElasticBody::CellShearModulus(std::size_t cell) const
{
  const ShapeEnergy* shape = &this->Shape[PointsPerCell * cell];
  return 0.25 * (shape[0].Mu + shape[1].Mu + shape[2].Mu + shape[3].Mu);
}

std::array<double, ElasticBody::UnknownsPerCell> ElasticBody::GradientRate(std::size_t cell,
  const std::vector<double>& x, const MaterialVelocity& velocity) const
{
  const ShapeEnergy* law = &this->Shape[PointsPerCell * cell];
  // Rates of mu and mu b around each quadrature point, and of kappa.
  double muRate[PointsPerCell] = { 0, 0, 0, 0 };
  double productRate[PointsPerCell] = { 0, 0, 0, 0 };
  double kappaRate = 0;
  for (std::size_t p = this->PartStarts[cell]; p < this->PartStarts[cell + 1]; ++p)
  {
    const Part& part = this->Parts[p];
    const ElasticMaterial& material = this->Table[part.Material];
    const ElasticMaterialRate& rate = velocity[part.Material];
    const double relative = rate.YoungsModulusKPa / material.YoungsModulusKPa;
    const double mu = material.ShearModulusKPa();
    const double ownRate = mu * (relative - rate.PoissonRatio / (1 + material.PoissonRatio));
    for (int q = 0; q < PointsPerCell; ++q)
    {
      muRate[q] += part.Around[q] * ownRate;
      productRate[q] += part.Around[q] * (ownRate * material.FungExponent + mu * rate.FungExponent);
    }
    kappaRate += part.Whole * material.BulkModulusKPa() *
      (relative + 2 * rate.PoissonRatio / (1 - 2 * material.PoissonRatio));
  }
  const double pointKappaRate =
    this->Kappa[cell] <= LargestPointwiseRatio * this->CellShearModulus(cell)
    ? kappaRate
    : LargestPointwiseRatio * 0.25 * (muRate[0] + muRate[1] + muRate[2] + muRate[3]);

  Eigen::Matrix<double, 3, 10> positions;
  const std::int32_t* nodes = &this->CellNodes[NodesPerCell * cell];
  for (int a = 0; a < NodesPerCell; ++a)
  {
    positions.col(a) = Eigen::Map<const Eigen::Vector3d>(&x[3 * nodes[a]]);
  }
  Gradients shape[PointsPerCell];
  Eigen::Matrix3d f[PointsPerCell];
  double meanJ = 0;
  for (int q = 0; q < PointsPerCell; ++q)
  {
    shape[q] = ShapeGradients(&this->BarycentricGradients[12 * cell], q);
    f[q] = positions * shape[q].transpose();
    meanJ += 0.25 * f[q].determinant();
  }
  std::array<double, UnknownsPerCell> result;
  Eigen::Map<Eigen::Matrix<double, 3, 10>> rate(result.data());
  rate.setZero();
  for (int q = 0; q < PointsPerCell; ++q)
  {
    const Eigen::Matrix3d cofactor = Cofactor(f[q]);
    const double j = f[q].determinant();
    const double power = 1 / std::cbrt(j * j);
    const double trace = f[q].squaredNorm();
    const double exponentRate = (productRate[q] - law[q].Exponent * muRate[q]) / law[q].Mu;
    const double scale = 2 * power * law[q].SlopeRate(power * trace - 3, muRate[q], exponentRate);
    const double pressure = (kappaRate - pointKappaRate) * (meanJ - 1) + pointKappaRate * (j - 1);
    const Eigen::Matrix3d stress =
      scale * (f[q] - trace / (3 * j) * cofactor) + pressure * cofactor;
    rate += 0.25 * this->Volumes[cell] * stress * shape[q];
  }
  return result;
}

CellMeasures ElasticBody::MeasuresOf(std::size_t cell, const std::vector<double>& x) const
{
  Eigen::Matrix<double, 3, 10> positions;
  for (int a = 0; a < NodesPerCell; ++a)
  {
    const std::int32_t node = this->CellNodes[NodesPerCell * cell + a];
    positions.col(a) = Eigen::Map<const Eigen::Vector3d>(&x[3 * node]);
  }
  CellMeasures measures{ 0, 0 };
  for (int q = 0; q < PointsPerCell; ++q)
  {
    const Eigen::Matrix3d f =
      positions * ShapeGradients(&this->BarycentricGradients[12 * cell], q).transpose();
    const double j = f.determinant();
    // The part of the Cauchy stress that is no pressure: 2 w' J^(-5/3) dev(F F^T).
    Eigen::Matrix3d stress = f * f.transpose();
    const double invariant = stress.trace() / std::cbrt(j * j) - 3;
    stress -= stress.trace() / 3 * Eigen::Matrix3d::Identity();
    stress *= 2 * this->Shape[PointsPerCell * cell + q].Slope(invariant) / std::pow(j, 5 / 3.0);
    measures.J += 0.25 * j;
    measures.VonMisesKPa += 0.25 * std::sqrt(1.5) * stress.norm();
  }
  return measures;
}

bool ElasticBody::CellTerms(std::size_t cell, const std::vector<double>& x, Order order,
  Terms& terms) const
{
  Eigen::Matrix<double, 3, 10> positions;
  const std::int32_t* nodes = &this->CellNodes[NodesPerCell * cell];
  for (int a = 0; a < NodesPerCell; ++a)
  {
    positions.col(a) = Eigen::Map<const Eigen::Vector3d>(&x[3 * nodes[a]]);
  }
  const double volume = this->Volumes[cell];
  const double weight = 0.25 * volume;
  const double pointKappa =
    std::min(this->Kappa[cell], LargestPointwiseRatio * this->CellShearModulus(cell));
  const double kappa = this->Kappa[cell] - pointKappa;

  Gradients shape[4];
  Eigen::Matrix3d f[4];
  Eigen::Matrix3d cofactor[4];
  double j[4];
  double meanJ = 0;
  for (int q = 0; q < 4; ++q)
  {
    shape[q] = ShapeGradients(&this->BarycentricGradients[12 * cell], q);
    f[q] = positions * shape[q].transpose();
    cofactor[q] = Cofactor(f[q]);
    j[q] = cofactor[q].col(0).dot(f[q].col(0));
    if (!(j[q] > 0))
    {
      return false;
    }
    meanJ += 0.25 * j[q];
  }
  terms.SmallestJ = *std::min_element(j, j + 4);
  terms.LargestJ = *std::max_element(j, j + 4);
  terms.Volume = meanJ * volume;
  terms.Energy = 0.5 * kappa * volume * (meanJ - 1) * (meanJ - 1);
  const double pressure = kappa * (meanJ - 1);

  Eigen::Map<Eigen::Matrix<double, 3, 10>> gradient(terms.Gradient.data());
  Eigen::Map<Eigen::Matrix<double, 30, 30>> hessian(terms.Hessian.data());
  Eigen::Matrix<double, 3, 10> volumeGradient = Eigen::Matrix<double, 3, 10>::Zero();
  gradient.setZero();
  if (order >= Order::Hessian)
  {
    hessian.setZero();
  }
  for (int q = 0; q < 4; ++q)
  {
    const ShapeEnergy& law = this->Shape[PointsPerCell * cell + q];
    const double trace = f[q].squaredNorm();
    const double power = 1 / std::cbrt(j[q] * j[q]);
    const double invariant = power * trace - 3;
    const double pointPressure = pressure + pointKappa * (j[q] - 1);
    terms.Energy += weight * (law.Value(invariant) + 0.5 * pointKappa * (j[q] - 1) * (j[q] - 1));
    if (order == Order::Energy)
    {
      continue;
    }
    const double ratio = trace / (3 * j[q]);
    const double scale = 2 * power * law.Slope(invariant);
    // Half the derivative of the invariant by F, over J^(-2/3).
    const Eigen::Matrix3d direction = f[q] - ratio * cofactor[q];
    const Eigen::Matrix3d stress = scale * direction + pointPressure * cofactor[q];
    gradient += weight * stress * shape[q];
    if (order == Order::Gradient)
    {
      continue;
    }
    volumeGradient += weight * cofactor[q] * shape[q];
    const Eigen::Map<const Vector9> fVector(f[q].data());
    const Eigen::Map<const Vector9> cVector(cofactor[q].data());
    Matrix9 a = Matrix9::Identity();
    a -= (2 / (3 * j[q])) * (fVector * cVector.transpose() + cVector * fVector.transpose());
    a += (5 * ratio / (3 * j[q])) * cVector * cVector.transpose();
    a *= scale;
    a += pointKappa * cVector * cVector.transpose();
    AddDeterminantHessian(f[q], pointPressure - scale * ratio, a);
    if (law.Exponent > 0)
    {
      const Eigen::Map<const Vector9> d(direction.data());
      a += 4 * power * power * law.Curvature(invariant) * d * d.transpose();
    }
    if (order == Order::ProjectedHessian && Eigen::LLT<Matrix9>(a).info() != Eigen::Success)
    {
      const Eigen::SelfAdjointEigenSolver<Matrix9> eigen(a);
      a = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
        eigen.eigenvectors().transpose();
    }
    a *= weight;
    for (int m = 0; m < NodesPerCell; ++m)
    {
      const Eigen::Matrix<double, 3, 9> row = shape[q](0, m) * a.middleRows<3>(0) +
        shape[q](1, m) * a.middleRows<3>(3) + shape[q](2, m) * a.middleRows<3>(6);
      for (int n = 0; n <= m; ++n)
      {
        hessian.block<3, 3>(3 * m, 3 * n) += shape[q](0, n) * row.middleCols<3>(0) +
          shape[q](1, n) * row.middleCols<3>(3) + shape[q](2, n) * row.middleCols<3>(6);
      }
    }
  }
  if (order >= Order::Hessian)
  {
    const Eigen::Map<const Eigen::Matrix<double, 30, 1>> v(volumeGradient.data());
    hessian.triangularView<Eigen::Lower>() += (kappa / volume) * v * v.transpose();
    hessian.triangularView<Eigen::StrictlyUpper>() = hessian.transpose();
  }
  return true;
}
}
