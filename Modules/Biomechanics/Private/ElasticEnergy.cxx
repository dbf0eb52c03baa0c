// SPDX-License-Identifier: Apache-2.0
#include "Private/ElasticEnergy.h"

#include "Private/CellPatches.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace mammoray
{
namespace
{
/// Barycentric coordinates of the 4-point rule: (5 + 3 sqrt 5) / 20 and (5 - sqrt 5) / 20.
constexpr double NearCoordinate = 0.58541019662496845446;
constexpr double FarCoordinate = 0.13819660112501051518;

using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Vector9 = Eigen::Matrix<double, 9, 1>;

/// A quadratic cell: ten nodes, four points of equal weight; the cell is the element.
struct QuadraticCell
{
  static constexpr int Nodes = 10;
  static constexpr int Points = 4;
  static constexpr int MostPointsPerElement = 4;
  /// r of the class comment in ElasticEnergy.h.
  static constexpr double LargestPointwiseRatio = 50;
  using Gradients = Eigen::Matrix<double, 3, 10>;
  /// A vector at each node of an element, and its stiffness.
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

/// A linear cell: four nodes, one point; a part of a patch.
struct LinearCell
{
  static constexpr int Nodes = 4;
  static constexpr int Points = 1;
  static constexpr int MostPointsPerElement = LargestPatchSize;
  static constexpr double LargestPointwiseRatio = 0;
  using Gradients = Eigen::Matrix<double, 3, 4>;
  // Every cell of a patch except the first adds at most one node.
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

/// Adds v w^T column by column, without Eigen's temporary matrix.
void AddOuterProduct(const Vector9& v, const Vector9& w, Matrix9& a)
{
  for (int j = 0; j < 9; ++j)
  {
    a.col(j) += w[j] * v;
  }
}

/// Makes `a` positive semidefinite on an invariant subspace with this orthonormal basis.
template <int Size>
void ProjectOn(const Eigen::Matrix<double, 9, Size>& basis, Matrix9& a)
{
  // lazyProduct avoids the packing of Eigen's product, which is slower at this size.
  const Eigen::Matrix<double, 9, Size> image = a.lazyProduct(basis);
  const Eigen::Matrix<double, Size, Size> block = basis.transpose().lazyProduct(image);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, Size, Size>> eigen(block);
  for (int k = 0; k < Size && eigen.eigenvalues()[k] < 0; ++k)
  {
    const Vector9 direction = basis * eigen.eigenvectors().col(k);
    AddOuterProduct(direction, -eigen.eigenvalues()[k] * direction, a);
  }
}

/**
 * Replaces the negative eigenvalues of `a`, the second derivative of an isotropic energy at F, by
 * zero. With the singular vectors u_i and v_j of F, three kinds of subspaces are invariant: the
 * span of u_0 v_0^T, u_1 v_1^T and u_2 v_2^T, and each span of u_i v_j^T and u_j v_i^T (Smith, de
 * Goes and Kim 2019). This is ten times as fast as an eigendecomposition in nine dimensions.
 */
void ProjectIsotropic(const Eigen::Matrix3d& f, Matrix9& a)
{
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> right(f.transpose() * f);
  const Eigen::Matrix3d& v = right.eigenvectors();
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

/// p = J^(-2/3) and its derivatives p' = -2/3 p / SlopeJ and p'' = 10/9 p / (SlopeJ CurvatureJ).
/// SlopeJ and CurvatureJ equal J, except in the extended domain below ExtendedBelow, where a
/// parabola continues p.
struct PowerOfJ
{
  double Value;
  double SlopeJ;
  double CurvatureJ;

  PowerOfJ(double j, ElasticEnergy::Domain domain)
    : Value(1 / std::cbrt(j * j))
    , SlopeJ(j)
    , CurvatureJ(j)
  {
    constexpr double ExtendedBelow = 0.1;
    if (domain == ElasticEnergy::Domain::Extended && j < ExtendedBelow)
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
  /// Gradients of the shape functions of the cell's nodes.
  typename Cell::Gradients Shape;
  Eigen::Matrix3d F;
  Eigen::Matrix3d Cofactor;
  double J = 1;
  /// Undeformed volume that the point represents, mm^3.
  double Weight = 0;
  /// Index of the point in the body (ElasticBody::LawAt).
  std::size_t Law = 0;
  /// Local indices of the cell's nodes in the element.
  const int* LocalNodes = nullptr;

  /// Adds the lower half of G^T a G to an element's stiffness, where G is the derivative of F with
  /// respect to the node positions.
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

  /// Adds one vector per node, or per corner, of the cell to those of the element.
  template <typename Vectors, typename Add>
  void AddTo(Vectors& vectors, const Add& vectorsOfCell) const
  {
    const auto add = vectorsOfCell.eval();
    for (int m = 0; m < add.cols(); ++m)
    {
      vectors.col(Cell::Local(this->LocalNodes, m)) += add.col(m);
    }
  }
};

/// The quadrature points of a cell in the deformed body.
template <typename Cell>
void DeformCell(const ElasticBody& body, std::size_t cell, const std::vector<double>& x,
  PointState<Cell>* states)
{
  const std::int32_t* nodes = &body.Cells()[Cell::Nodes * cell];
  typename Cell::Gradients positions;
  for (int a = 0; a < Cell::Nodes; ++a)
  {
    positions.col(a) = Eigen::Map<const Eigen::Vector3d>(&x[3 * nodes[a]]);
  }
  for (int q = 0; q < Cell::Points; ++q)
  {
    PointState<Cell>& state = states[q];
    state.Shape = Cell::ShapeGradients(body.BarycentricGradientsOf(cell), q);
    state.F = positions * state.Shape.transpose();
    state.Cofactor = Cofactor(state.F);
    state.J = state.Cofactor.col(0).dot(state.F.col(0));
    state.Weight = body.CellVolume(cell) / Cell::Points;
    state.Law = Cell::Points * cell + q;
    state.LocalNodes = body.LocalNodesOf(cell);
  }
}

/// `rateIn(cell, material)` is the derivative of a material's constants in a cell.
template <typename Cell, typename RateIn>
std::vector<double> RateOf(const ElasticBody& body, std::size_t element,
  const std::vector<double>& x, const RateIn& rateIn)
{
  // Derivatives of mu and mu b at each quadrature point, and of the element's mu and kappa.
  double muRate[Cell::MostPointsPerElement] = {};
  double productRate[Cell::MostPointsPerElement] = {};
  double meanMuRate = 0;
  double kappaRate = 0;
  double meanJ = 0;
  std::array<PointState<Cell>, Cell::MostPointsPerElement> states;
  int count = 0;
  for (const std::int32_t cell : body.CellsOf(element))
  {
    const double share = body.CellVolume(cell) / body.ElementVolume(element);
    for (const ElasticBody::Part& part : body.PartsOf(cell))
    {
      const ElasticMaterial& material = body.Materials()[part.Material];
      const ElasticMaterialDerivative rate = rateIn(cell, part.Material);
      const double relative = rate.YoungsModulusKPa / material.YoungsModulusKPa;
      const double mu = material.ShearModulusKPa();
      const double ownRate = mu * (relative - rate.PoissonRatio / (1 + material.PoissonRatio));
      for (int q = 0; q < Cell::Points; ++q)
      {
        muRate[count + q] += part.PointShares[q] * ownRate;
        productRate[count + q] +=
          part.PointShares[q] * (ownRate * material.FungExponent + mu * rate.FungExponent);
      }
      kappaRate += share * part.CellShare * material.BulkModulusKPa() *
        (relative + 2 * rate.PoissonRatio / (1 - 2 * material.PoissonRatio));
    }
    DeformCell<Cell>(body, cell, x, &states[count]);
    for (int q = 0; q < Cell::Points; ++q, ++count)
    {
      meanMuRate += share / Cell::Points * muRate[count];
      meanJ += share / Cell::Points * states[count].J;
    }
  }
  const double ratio = Cell::LargestPointwiseRatio;
  const double pointKappaRate =
    body.ElementBulkModulus(element) <= ratio * body.ElementShearModulus(element)
    ? kappaRate
    : ratio * meanMuRate;

  std::vector<double> result(3 * body.NodesOf(element).size(), 0.0);
  Eigen::Map<Eigen::Matrix<double, 3, Eigen::Dynamic>> rates(result.data(), 3,
    static_cast<Eigen::Index>(result.size() / 3));
  for (int p = 0; p < count; ++p)
  {
    const PointState<Cell>& state = states[p];
    const ShapeEnergy& law = body.LawAt(state.Law);
    const double power = 1 / std::cbrt(state.J * state.J);
    const double trace = state.F.squaredNorm();
    const double exponentRate = (productRate[p] - law.Exponent * muRate[p]) / law.Mu;
    const double scale =
      2 * power * law.SlopeDerivative(power * trace - 3, muRate[p], exponentRate);
    const double pressure =
      (kappaRate - pointKappaRate) * (meanJ - 1) + pointKappaRate * (state.J - 1);
    const Eigen::Matrix3d stress =
      scale * (state.F - trace / (3 * state.J) * state.Cofactor) + pressure * state.Cofactor;
    state.AddTo(rates, state.Weight * stress * state.Shape);
  }
  return result;
}

template <typename Cell>
CellMeasures CellMeasuresOf(const ElasticBody& body, std::size_t cell, const std::vector<double>& x)
{
  CellMeasures measures{ 0, 0 };
  std::array<PointState<Cell>, Cell::Points> states;
  DeformCell<Cell>(body, cell, x, states.data());
  for (const PointState<Cell>& state : states)
  {
    // Deviatoric part of the Cauchy stress: 2 w' J^(-5/3) dev(F F^T).
    Eigen::Matrix3d stress = state.F * state.F.transpose();
    const double invariant = stress.trace() / std::cbrt(state.J * state.J) - 3;
    stress -= stress.trace() / 3 * Eigen::Matrix3d::Identity();
    stress *= 2 * body.LawAt(state.Law).Slope(invariant) / std::pow(state.J, 5 / 3.0);
    measures.J += state.J / Cell::Points;
    measures.VonMisesKPa += std::sqrt(1.5) / Cell::Points * stress.norm();
  }
  return measures;
}

/// Second derivative of the energy density with respect to F at a quadrature point. `pressure` is
/// the sum of the element's and the point's own pressure; for `direction` see AddTerms.
template <typename Cell>
Matrix9 PointStiffness(const PointState<Cell>& state, const ShapeEnergy& law, const PowerOfJ& power,
  const Eigen::Matrix3d& direction, double pointKappa, double pressure)
{
  const double trace = state.F.squaredNorm();
  const double invariant = power.Value * trace - 3;
  const double ratio = trace / (3 * power.SlopeJ);
  const double scale = 2 * power.Value * law.Slope(invariant);
  const Vector9 f = Eigen::Map<const Vector9>(state.F.data());
  const Vector9 c = Eigen::Map<const Vector9>(state.Cofactor.data());
  const double mixed = -2 * scale / (3 * power.SlopeJ);
  const double square = 5 * scale * ratio / (3 * power.CurvatureJ) + pointKappa;
  Matrix9 a = scale * Matrix9::Identity();
  AddOuterProduct(f, mixed * c, a);
  AddOuterProduct(c, mixed * f + square * c, a);
  AddDeterminantHessian(state.F, pressure - scale * ratio, a);
  if (const double curvature = law.Curvature(invariant); curvature != 0)
  {
    const Vector9 d = Eigen::Map<const Vector9>(direction.data());
    AddOuterProduct(d, 4 * power.Value * power.Value * curvature * d, a);
  }
  return a;
}

/// The deformed quadrature points of an element.
template <typename Cell>
struct ElementState
{
  std::array<PointState<Cell>, Cell::MostPointsPerElement> Points;
  int Count = 0;
  PositionMeasures Measures;

  /// Returns false if a point is inverted and the domain does not admit it.
  bool Deform(const ElasticBody& body, std::size_t element, const std::vector<double>& x,
    ElasticEnergy::Domain domain)
  {
    for (const std::int32_t cell : body.CellsOf(element))
    {
      DeformCell<Cell>(body, cell, x, &this->Points[this->Count]);
      for (int q = 0; q < Cell::Points; ++q, ++this->Count)
      {
        const PointState<Cell>& state = this->Points[this->Count];
        if (!(state.J > 0) && domain == ElasticEnergy::Domain::Admissible)
        {
          return false;
        }
        this->Measures.SmallestJ = std::min(this->Measures.SmallestJ, state.J);
        this->Measures.LargestJ = std::max(this->Measures.LargestJ, state.J);
        this->Measures.Volume += state.Weight * state.J;
      }
    }
    return true;
  }
};

/// Volumetric terms of an element: the part of kappa that acts on its points, the rest, and the
/// mean J on which the rest acts.
struct MeanVolume
{
  double PointKappa;
  double Kappa;
  double J;

  MeanVolume(const ElasticBody& body, std::size_t element, double largestPointwiseRatio,
    double deformedVolume)
    : PointKappa(std::min(body.ElementBulkModulus(element),
        largestPointwiseRatio * body.ElementShearModulus(element)))
    , Kappa(body.ElementBulkModulus(element) - PointKappa)
    , J(deformedVolume / body.ElementVolume(element))
  {
  }
  double Pressure() const { return this->Kappa * (this->J - 1); }
};

template <typename Cell>
bool AddTerms(const ElasticBody& body, std::size_t element, const std::vector<double>& x,
  EnergyOrder order, ElasticEnergy::Domain domain, PieceTerms& terms)
{
  ElementState<Cell> deformed;
  if (!deformed.Deform(body, element, x, domain))
  {
    return false;
  }
  terms.Measures.Add(deformed.Measures);
  const double volume = body.ElementVolume(element);
  const MeanVolume mean(body, element, Cell::LargestPointwiseRatio, deformed.Measures.Volume);
  const double pointKappa = mean.PointKappa;
  const double kappa = mean.Kappa;
  terms.Value += 0.5 * kappa * volume * (mean.J - 1) * (mean.J - 1);
  const double pressure = mean.Pressure();

  const auto nodeCount = static_cast<Eigen::Index>(body.NodesOf(element).size());
  using NodeVectors = typename Cell::NodeVectors;
  using Stiffness = typename Cell::Stiffness;
  NodeVectors volumeGradient = NodeVectors::Zero(3, nodeCount);
  Eigen::Map<NodeVectors> gradient(terms.Gradient.data(), 3, nodeCount);
  Eigen::Map<Stiffness> hessian(terms.Hessian.data(), 3 * nodeCount, 3 * nodeCount);
  for (int p = 0; p < deformed.Count; ++p)
  {
    const PointState<Cell>& state = deformed.Points[p];
    const double j = state.J;
    ShapeEnergy law = body.LawAt(state.Law);
    if (domain == ElasticEnergy::Domain::Extended)
    {
      law = law.NeoHookean();
    }
    const double trace = state.F.squaredNorm();
    const PowerOfJ power(j, domain);
    const double invariant = power.Value * trace - 3;
    const double pointPressure = pressure + pointKappa * (j - 1);
    terms.Value += state.Weight * (law.Value(invariant) + 0.5 * pointKappa * (j - 1) * (j - 1));
    if (order == EnergyOrder::Value)
    {
      continue;
    }
    const double ratio = trace / (3 * power.SlopeJ);
    const double scale = 2 * power.Value * law.Slope(invariant);
    // Half the derivative of the invariant I with respect to F, divided by p.
    const Eigen::Matrix3d direction = state.F - ratio * state.Cofactor;
    const Eigen::Matrix3d stress = scale * direction + pointPressure * state.Cofactor;
    state.AddTo(gradient, state.Weight * stress * state.Shape);
    if (order == EnergyOrder::Gradient)
    {
      continue;
    }
    state.AddTo(volumeGradient, state.Weight * state.Cofactor * state.Shape);
    Matrix9 a = PointStiffness(state, law, power, direction, pointKappa, pointPressure);
    if (order == EnergyOrder::ProjectedHessian && Eigen::LLT<Matrix9>(a).info() != Eigen::Success)
    {
      ProjectIsotropic(state.F, a);
    }
    a *= state.Weight;
    state.AddStiffnessTo(hessian, a);
  }
  if (order >= EnergyOrder::Hessian)
  {
    const Eigen::Map<const Eigen::Matrix<double, Stiffness::RowsAtCompileTime, 1>> v(
      volumeGradient.data(), 3 * nodeCount);
    hessian.template triangularView<Eigen::Lower>() += (kappa / volume) * v * v.transpose();
    hessian.template triangularView<Eigen::StrictlyUpper>() = hessian.transpose();
  }
  return true;
}

/// Adds d gradient / dX. With L = dX_j g_j^T (g_j is the gradient of corner j's coordinate), the
/// motion of a corner changes F by -F L, the weights by tr L and the gradients of the shape
/// functions by -L^T grad N. w J depends on the deformed cell only and does not change.
template <typename Cell>
bool AddRestTerms(const ElasticBody& body, std::size_t element, const std::vector<double>& x,
  std::span<double> matrix)
{
  ElementState<Cell> deformed;
  if (!deformed.Deform(body, element, x, ElasticEnergy::Domain::Admissible))
  {
    return false;
  }
  const double volume = body.ElementVolume(element);
  const MeanVolume mean(body, element, Cell::LargestPointwiseRatio, deformed.Measures.Volume);
  const auto rows = static_cast<Eigen::Index>(3 * body.NodesOf(element).size());
  Eigen::Map<Eigen::MatrixXd> result(matrix.data(), rows, rows);
  using NodeVectors = typename Cell::NodeVectors;
  NodeVectors volumeGradient = NodeVectors::Zero(3, rows / 3);
  NodeVectors pressureRate = NodeVectors::Zero(3, rows / 3);
  for (int p = 0; p < deformed.Count; ++p)
  {
    const PointState<Cell>& state = deformed.Points[p];
    const auto cell = static_cast<std::size_t>(state.Law) / Cell::Points;
    const Eigen::Map<const Eigen::Matrix<double, 3, 4>> corners(body.BarycentricGradientsOf(cell));
    const ShapeEnergy& law = body.LawAt(state.Law);
    const PowerOfJ power(state.J, ElasticEnergy::Domain::Admissible);
    const double trace = state.F.squaredNorm();
    const double pressure = mean.Pressure() + mean.PointKappa * (state.J - 1);
    const Eigen::Matrix3d direction = state.F - trace / (3 * state.J) * state.Cofactor;
    const Eigen::Matrix3d stress =
      2 * power.Value * law.Slope(power.Value * trace - 3) * direction + pressure * state.Cofactor;
    const Matrix9 a = PointStiffness(state, law, power, direction, mean.PointKappa, pressure);
    const typename Cell::Gradients forces = stress * state.Shape;
    state.AddTo(volumeGradient, state.Weight * state.Cofactor * state.Shape);
    // For patches, kappa is the volume mean over their cells.
    const double kappaRate =
      (body.CellBulkModulus(cell) - body.ElementBulkModulus(element)) / volume;
    state.AddTo(pressureRate,
      state.Weight * (kappaRate * (mean.J - 1) - mean.Kappa * mean.J / volume) * corners);
    for (int j = 0; j < 4; ++j)
    {
      const Eigen::Vector3d g = corners.col(j);
      const Eigen::Vector3d traction = stress * g;
      const int column = 3 * Cell::Local(state.LocalNodes, j);
      for (int k = 0; k < 3; ++k)
      {
        const Eigen::Matrix3d change = -state.F.col(k) * g.transpose();
        const Vector9 rate = a * Eigen::Map<const Vector9>(change.data());
        typename Cell::Gradients add = Eigen::Map<const Eigen::Matrix3d>(rate.data()) * state.Shape;
        add += g[k] * forces - traction * state.Shape.row(k);
        for (int m = 0; m < Cell::Nodes; ++m)
        {
          result.template block<3, 1>(3 * Cell::Local(state.LocalNodes, m), column + k) +=
            state.Weight * add.col(m);
        }
      }
    }
  }
  const Eigen::Map<const Eigen::VectorXd> v(volumeGradient.data(), rows);
  const Eigen::Map<const Eigen::VectorXd> rate(pressureRate.data(), rows);
  result += v * rate.transpose();
  return true;
}
}

bool ElasticEnergy::AddRestDerivative(std::size_t element, const std::vector<double>& x,
  std::span<double> matrix) const
{
  return this->Body.Type() == ElementType::Quadratic
    ? AddRestTerms<QuadraticCell>(this->Body, element, x, matrix)
    : AddRestTerms<LinearCell>(this->Body, element, x, matrix);
}

bool ElasticEnergy::Add(std::size_t element, const std::vector<double>& x, EnergyOrder order,
  PieceTerms& terms) const
{
  return this->Body.Type() == ElementType::Quadratic
    ? AddTerms<QuadraticCell>(this->Body, element, x, order, this->CurrentDomain, terms)
    : AddTerms<LinearCell>(this->Body, element, x, order, this->CurrentDomain, terms);
}

std::vector<double> ElasticEnergy::GradientDerivative(std::size_t element,
  const std::vector<double>& x, const MaterialDerivative& velocity) const
{
  const auto rateIn = [&](std::int32_t, int material) { return velocity[material]; };
  return this->Body.Type() == ElementType::Quadratic
    ? RateOf<QuadraticCell>(this->Body, element, x, rateIn)
    : RateOf<LinearCell>(this->Body, element, x, rateIn);
}

std::vector<double> ElasticEnergy::StiffnessDerivative(std::size_t cell, std::size_t element,
  const std::vector<double>& x) const
{
  const auto rateIn = [&](std::int32_t other, int material)
  {
    const bool same = static_cast<std::size_t>(other) == cell;
    return ElasticMaterialDerivative{ same ? this->Body.Materials()[material].YoungsModulusKPa
                                           : 0.0 };
  };
  return this->Body.Type() == ElementType::Quadratic
    ? RateOf<QuadraticCell>(this->Body, element, x, rateIn)
    : RateOf<LinearCell>(this->Body, element, x, rateIn);
}

CellMeasures ElasticEnergy::MeasuresOf(std::size_t cell, const std::vector<double>& x) const
{
  return this->Body.Type() == ElementType::Quadratic
    ? CellMeasuresOf<QuadraticCell>(this->Body, cell, x)
    : CellMeasuresOf<LinearCell>(this->Body, cell, x);
}
}
