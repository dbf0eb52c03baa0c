// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Biomechanics/EquilibriumSolver.h"

#include "Private/SparseCholesky.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/ParallelFor.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <optional>
#include <span>

namespace mammoray
{
namespace
{
/**
 * Middles of equal small triangles: where a plate's edge cuts through a face, many points beat a
 * high degree. On a round of 3 mm that is pressed 0.05 mm deep the contact is 1.1 mm wide: points
 * of an 8 mm face must not lie farther apart than that, or the body rests on a few of them and
 * catches on the edge from one to the next (16 points: twice as many Newton steps).
 */
struct TrianglePoint
{
  double Lambda[3];
  double Weight;
};
const std::vector<TrianglePoint>& TriangleRule()
{
  static const std::vector<TrianglePoint> rule = []
  {
    constexpr int n = 8;
    std::vector<TrianglePoint> points;
    for (int i = 0; i < n; ++i)
    {
      for (int j = 0; i + j < n; ++j)
      {
        // Small triangles that point up and down.
        for (int down = 0; down < (i + j + 1 < n ? 2 : 1); ++down)
        {
          const double shift = down ? 2 / 3.0 : 1 / 3.0;
          const double a = (i + shift) / n;
          const double b = (j + shift) / n;
          points.push_back({ { a, b, 1 - a - b }, 1.0 / (n * n) });
        }
      }
    }
    return points;
  }();
  return rule;
}

/// Shape functions of the triangle with six nodes or three.
std::array<double, 6> TriangleShape(const double* l, int nodes)
{
  if (nodes == 3)
  {
    return { l[0], l[1], l[2], 0, 0, 0 };
  }
  return { l[0] * (2 * l[0] - 1), l[1] * (2 * l[1] - 1), l[2] * (2 * l[2] - 1), 4 * l[0] * l[1],
    4 * l[1] * l[2], 4 * l[2] * l[0] };
}

Vector3 NodeOf(const std::vector<double>& x, std::int32_t node)
{
  return { x[3 * node], x[3 * node + 1], x[3 * node + 2] };
}

/// A point of a boundary face.
Vector3 FacePosition(const ElasticBody& body, const ElasticBody::BoundaryFace& face,
  const std::array<double, 6>& shape, const std::vector<double>& x)
{
  const std::span<const std::int32_t> nodes = body.NodesOf(face.Element);
  Vector3 position{ 0, 0, 0 };
  for (int a = 0; a < body.NodesPerFace(); ++a)
  {
    position = position + shape[a] * NodeOf(x, nodes[face.LocalNodes[a]]);
  }
  return position;
}

/// Longest coordinate of a Newton step that is taken without trying a stiffer matrix, mm: about
/// half a cell.
constexpr double LargestNewtonStepMm = 5;

/// Least share of the projected matrix worth mixing in.
constexpr double SmallestShare = 1.0 / 64;

/// A factor of positions this near, mm, still serves: for the last digits by conjugate gradients,
/// which give a step to this fraction in a few products or not at all.
constexpr double NearFactorMm = 0.01;
constexpr double GradientsTolerance = 1e-3;
constexpr int MostGradientsSteps = 6;

/// The part of the body that is relaxed alone: nodes with this fraction of the largest residual
/// force at least, and those of so many layers of elements around them; more than that part of the
/// unknowns is no part. How well and how long it is relaxed.
constexpr double WorstForce = 0.1;
constexpr int LayersAroundWorst = 2;
constexpr double LargestPart = 0.2;
constexpr double PartTolerance = 1e-2;
constexpr int PartNewtonSteps = 10;

/// Energy per area of a depth in the contact layer, its first and its second derivative.
struct ContactLaw
{
  double Energy;
  double Pressure;
  double Slope;

  ContactLaw(double stiffness, double depth)
  {
    const double inner = std::min(depth, EquilibriumSolver::ContactLayerMm);
    const double outer = depth - inner;
    this->Slope = 2 * stiffness * inner;
    this->Pressure = stiffness * inner * inner + this->Slope * outer;
    this->Energy = stiffness * inner * (inner * inner / 3 + inner * outer + outer * outer);
  }
};

/// A point of a boundary face in the layer of a plate.
struct ContactPoint
{
  const ElasticBody::BoundaryFace& Face;
  std::int32_t FaceIndex;
  std::int16_t RulePoint;
  /// Of the nodes of the face.
  std::array<double, 6> Shape;
  Vector3 Position;
  /// 0: support, 1: paddle.
  std::int16_t Side;
  const Plate& Touched;
  PlateDistance Distance;
  ContactLaw Law;
  /// Undeformed area it stands for, mm^2.
  double Weight;
};

struct ContactTotals
{
  double Energy = 0;
  double Penetration = 0;
  /// Force along the normals of support and paddle, kPa mm^2.
  double NormalForce[2] = { 0, 0 };
  /// Of friction, kPa mm^2.
  std::array<Vector3, 2> Friction{};
};

const Plate& SideOf(const PlatePair& plates, int side)
{
  return side == 0 ? plates.Support : plates.Paddle;
}

double LargestMagnitude(const std::vector<double>& v)
{
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()))
    .lpNorm<Eigen::Infinity>();
}

double SquaredNorm(const std::vector<double>& v)
{
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()))
    .squaredNorm();
}
}

struct EquilibriumSolver::Internals
{
  const ElasticBody& Body;
  const std::vector<bool> LeftOut;
  double ContactStiffness;
  /// Dead loads; empty or one per coordinate.
  std::vector<double> Loads;
  const ChestWall* Wall = nullptr;
  WallStiffness Stiffness;
  FrictionPoints Friction;
  /// Those of active element a are FrictionStarts[a] to FrictionStarts[a + 1]; empty without
  /// friction.
  std::vector<std::size_t> FrictionStarts;
  /// Active element of each boundary face; -1 where it cannot touch.
  std::vector<std::int32_t> ActiveOfFace;
  /// Elements with a free node, and for each of them the boundary faces with a free node.
  std::vector<std::int32_t> ActiveElements;
  std::vector<std::vector<std::int32_t>> FacesOfElement;
  /// Number of the unknown of each coordinate; -1 where fixed.
  std::vector<std::int32_t> Unknown;
  std::vector<std::int32_t> CoordinateOfUnknown;
  /// Lower triangle by columns.
  std::vector<int> Starts;
  std::vector<int> Rows;
  /// Where each entry of the lower half of an element's matrix goes; -1: nowhere. Those of active
  /// element a begin at ScatterStarts[a].
  std::vector<std::int32_t> Scatter;
  std::vector<std::size_t> ScatterStarts;
  std::unique_ptr<SparseCholesky> Factor;

  /// A force no result depends on: convergence is measured against it while nothing touches.
  double SmallestForce = 0;
  double RestVolume = 0;
  /// Volume of the elements that do not move.
  double FixedVolume = 0;
  /// Roundoff of the energy, kPa mm^3.
  double EnergyNoise = 0;

  struct Assembly
  {
    bool Valid = false;
    ContactTotals Contact;
    double Energy = 0;
    double SmallestJ = 1;
    double LargestJ = 1;
    double Volume = 0;
    /// All coordinates.
    std::vector<double> Gradient;
    double ContactNorm = 0;
    double WallNorm = 0;
    double LoadNorm = 0;
    double ReactionNorm = 0;
    double WallLift = 0;
    double WallGlide = 0;
    double ResidualNorm = 0;
    std::vector<double> Values;
  };
  mutable Assembly Current;
  /// What the matrix of Current was assembled for; no positions: for nothing that still is.
  struct MatrixState
  {
    std::vector<double> Positions;
    std::optional<PlatePair> Plates;
    double ContactStiffness = 0;
    ElasticBody::Domain Domain = ElasticBody::Domain::Admissible;
    bool operator==(const MatrixState&) const = default;
  };
  mutable MatrixState CurrentState;
  /// Positions of the factor at hand; empty when there is none or not of the true second
  /// derivative.
  mutable std::vector<double> FactorPositions;
  ElasticBody::Domain Domain = ElasticBody::Domain::Admissible;

  /// Share of the projected matrix in the last factor, and that matrix where it was needed.
  mutable double Share = 0;
  mutable std::vector<double> ProjectedValues;

  mutable std::vector<ElasticBody::Terms> ElementResults;
  mutable std::vector<ContactTotals> ElementContacts;
  mutable std::vector<std::vector<double>> ElementContactGradients;
  mutable std::vector<char> ElementValid;
  mutable std::vector<ChestWall::Terms> WallResults;

  Internals(const ElasticBody& body, const std::vector<bool>& fixed, double contactStiffness,
    const std::vector<bool>& leftOut);
  void MakePattern();
  std::span<const std::int32_t> NodesOf(std::size_t active) const
  {
    return this->Body.NodesOf(this->ActiveElements[active]);
  }
  /// Coordinate of a row of an active element's matrix.
  std::size_t CoordinateOf(std::size_t active, std::size_t row) const
  {
    return 3 * static_cast<std::size_t>(this->NodesOf(active)[row / 3]) + row % 3;
  }
  void MeasureScales();
  /// Calls function(ContactPoint) for every point of an active element that lies in a plate's
  /// layer.
  template <typename Function>
  void ForEachContact(std::size_t active, const std::vector<double>& x, const PlatePair& plates,
    const Function& function) const;
  /// Adds the contact of the faces of an active element to its terms.
  void AddContact(std::size_t active, const std::vector<double>& x, const PlatePair& plates,
    ElasticBody::Order order, ElasticBody::Terms& terms, ContactTotals& totals,
    std::vector<double>& contactGradient) const;
  /// The same of the friction of an active element.
  void AddFriction(std::size_t active, const std::vector<double>& x, const PlatePair& plates,
    ElasticBody::Order order, ElasticBody::Terms& terms, ContactTotals& totals,
    std::vector<double>& contactGradient) const;
  /// Calls function(FrictionPoint, face, shape functions, position) for those of an active element.
  template <typename Function>
  void ForEachFriction(std::size_t active, const std::vector<double>& x,
    const Function& function) const;
  void AddWall(const std::vector<double>& x, ElasticBody::Order order, Assembly& result) const;
  /// Adds a force at a point of a boundary face to a column of unknowns.
  void AddAtFace(const ElasticBody::BoundaryFace& face, const std::array<double, 6>& shape,
    const Vector3& force, double* column) const;
  void Assemble(const std::vector<double>& x, const PlatePair* plates, ElasticBody::Order order,
    Assembly& result) const;
  /// Makes Current that of the positions, with its matrix, where it is not already.
  void AssembleCurrent(const std::vector<double>& x, const PlatePair* plates) const;
  /// Factor of Current's matrix, or of a stiffer one where that is indefinite; `stiffer`: than the
  /// last one, which was of the same positions.
  bool FactorizeWithFallback(const std::vector<double>& x, const PlatePair* plates,
    bool stiffer = false) const;
  /// Newton's step by the factor at hand of other positions, by conjugate gradients; false: those
  /// do not get there.
  bool FindStepByOldFactor(const std::vector<double>& force, std::vector<double>& step) const;
  /// - d Gradient / dp at the free coordinates, one column per velocity.
  std::vector<double> PlateForces(const std::vector<double>& x, const PlatePair& plates,
    const std::vector<PlatePairVelocity>& velocities) const;
  /// - d Gradient / dp at the free coordinates, one column per velocity.
  std::vector<double> MaterialForces(const std::vector<double>& x,
    const std::vector<MaterialVelocity>& velocities) const;
  /// - d Gradient / dp at the free coordinates, one column per velocity.
  std::vector<double> HoldingForces(const std::vector<double>& x, const PlatePair& plates,
    const std::vector<HoldingVelocity>& velocities) const;
  EquilibriumReport Report(const Assembly& assembly) const;
  /// EquilibriumSolver::Solve; `eliminate`: with RelaxWorst where Newton's method struggles.
  EquilibriumReport Newton(std::vector<double>& x, const PlatePair* plates, double tolerance,
    int maximumSteps, bool eliminate, const ProgressCallback& progress) const;
  /**
   * Minimises the energy over the coordinates where the residual forces of Current are largest and
   * those around them, the others fixed. Tissue folds and slips at the plates' edges in steps of
   * some mm, and the whole body would wait for it at the price of a factor each (nonlinear
   * elimination: Lanzkron, Rose & Wilkes 1996; Cai & Li 2011). Never raises the energy. False where
   * those are too many and `x` stays.
   */
  bool RelaxWorst(std::vector<double>& x, const PlatePair* plates,
    const ProgressCallback& progress) const;
  /// 3 x nodeCount flags: true but at the unknowns that RelaxWorst moves; empty: too many.
  std::vector<bool> FixedAroundWorst() const;
  /// Largest difference of a coordinate from the positions of the factor at hand, mm.
  double DistanceOfFactor(const std::vector<double>& x) const;
  double ForceScale(const Assembly& assembly) const
  {
    return std::max({ assembly.ContactNorm, assembly.WallNorm, assembly.LoadNorm,
      assembly.ReactionNorm, this->SmallestForce });
  }
};

EquilibriumSolver::Internals::Internals(const ElasticBody& body, const std::vector<bool>& fixed,
  double contactStiffness, const std::vector<bool>& leftOut)
  : Body(body)
  , LeftOut(leftOut)
  , ContactStiffness(contactStiffness)
{
  if (fixed.size() != body.RestPositions().size())
  {
    throw InputError("equilibrium: expected 3 flags per node, found " +
      std::to_string(fixed.size()) + " for " + std::to_string(body.NumberOfNodes()) + " nodes");
  }
  std::vector<std::int32_t> activeOfElement(body.NumberOfElements(), -1);
  std::vector<bool> used(body.NumberOfNodes(), false);
  const auto isFree = [&](std::int32_t node)
  { return !(fixed[3 * node] && fixed[3 * node + 1] && fixed[3 * node + 2]); };
  for (std::size_t element = 0; element < body.NumberOfElements(); ++element)
  {
    const std::span<const std::int32_t> nodes = body.NodesOf(element);
    // Patches hold no cells of both kinds.
    const auto first = static_cast<std::size_t>(body.CellsOf(element).front());
    const bool rigid = first < leftOut.size() && leftOut[first];
    if (!rigid && std::any_of(nodes.begin(), nodes.end(), isFree))
    {
      activeOfElement[element] = static_cast<std::int32_t>(this->ActiveElements.size());
      this->ActiveElements.push_back(static_cast<std::int32_t>(element));
      for (const std::int32_t node : nodes)
      {
        used[node] = true;
      }
    }
    else
    {
      this->FixedVolume += body.ElementVolume(element);
    }
  }
  if (this->ActiveElements.empty())
  {
    throw InputError("equilibrium: expected cells that can move, found all of them held");
  }
  this->MeasureScales();

  this->Unknown.assign(fixed.size(), -1);
  for (std::size_t c = 0; c < fixed.size(); ++c)
  {
    if (!fixed[c] && used[c / 3])
    {
      this->Unknown[c] = static_cast<std::int32_t>(this->CoordinateOfUnknown.size());
      this->CoordinateOfUnknown.push_back(static_cast<std::int32_t>(c));
    }
  }
  this->FacesOfElement.resize(this->ActiveElements.size());
  this->ActiveOfFace.assign(body.Faces().size(), -1);
  for (std::size_t f = 0; f < body.Faces().size(); ++f)
  {
    const ElasticBody::BoundaryFace& face = body.Faces()[f];
    const std::span<const std::int32_t> nodes = body.NodesOf(face.Element);
    const std::int32_t active = activeOfElement[face.Element];
    if (active >= 0 &&
      std::any_of(face.LocalNodes.begin(), face.LocalNodes.begin() + body.NodesPerFace(),
        [&](int local) { return isFree(nodes[local]); }))
    {
      this->FacesOfElement[active].push_back(static_cast<std::int32_t>(f));
      this->ActiveOfFace[f] = active;
    }
  }
  this->MakePattern();
  this->Factor = std::make_unique<SparseCholesky>(this->Starts, this->Rows);
  this->ElementResults.resize(this->ActiveElements.size());
  this->ElementContacts.resize(this->ActiveElements.size());
  this->ElementContactGradients.resize(this->ActiveElements.size());
  this->ElementValid.resize(this->ActiveElements.size());
}

void EquilibriumSolver::Internals::MeasureScales()
{
  double stiffness = 0;
  this->RestVolume = this->FixedVolume;
  for (const std::int32_t element : this->ActiveElements)
  {
    stiffness += this->Body.ElementShearModulus(element) * this->Body.ElementVolume(element);
    this->RestVolume += this->Body.ElementVolume(element);
  }
  this->EnergyNoise = 1e-13 * 1.5 * stiffness;
  this->SmallestForce = 1e-4 * stiffness / std::cbrt(this->RestVolume);
}

void EquilibriumSolver::Internals::MakePattern()
{
  // Elements of every node, then for each node those it shares an element with.
  std::vector<std::vector<std::int32_t>> activeOfNode(this->Body.NumberOfNodes());
  this->ScatterStarts.assign(1, 0);
  for (std::size_t active = 0; active < this->ActiveElements.size(); ++active)
  {
    for (const std::int32_t node : this->NodesOf(active))
    {
      activeOfNode[node].push_back(static_cast<std::int32_t>(active));
    }
    const std::size_t rows = 3 * this->NodesOf(active).size();
    this->ScatterStarts.push_back(this->ScatterStarts.back() + rows * (rows + 1) / 2);
  }
  this->Starts.assign(1, 0);
  std::vector<std::int32_t> near;
  std::vector<int> unknowns;
  std::int32_t nodeOfLast = -1;
  for (std::size_t u = 0; u < this->CoordinateOfUnknown.size(); ++u)
  {
    const std::int32_t node = this->CoordinateOfUnknown[u] / 3;
    if (node != nodeOfLast)
    {
      near.clear();
      for (const std::int32_t active : activeOfNode[node])
      {
        const std::span<const std::int32_t> nodes = this->NodesOf(active);
        near.insert(near.end(), nodes.begin(), nodes.end());
      }
      std::sort(near.begin(), near.end());
      near.erase(std::unique(near.begin(), near.end()), near.end());
      unknowns.clear();
      for (const std::int32_t other : near)
      {
        for (int axis = 0; axis < 3; ++axis)
        {
          if (this->Unknown[3 * other + axis] >= 0)
          {
            unknowns.push_back(this->Unknown[3 * other + axis]);
          }
        }
      }
      nodeOfLast = node;
    }
    // Unknowns are numbered as the coordinates are, so these ascend.
    this->Rows.insert(this->Rows.end(),
      std::lower_bound(unknowns.begin(), unknowns.end(), static_cast<int>(u)), unknowns.end());
    this->Starts.push_back(static_cast<int>(this->Rows.size()));
  }
  this->Scatter.resize(this->ScatterStarts.back());
  ParallelFor(this->ActiveElements.size(),
    [&](std::size_t active)
    {
      std::int32_t* scatter = &this->Scatter[this->ScatterStarts[active]];
      const std::size_t rows = 3 * this->NodesOf(active).size();
      for (std::size_t c = 0; c < rows; ++c)
      {
        for (std::size_t r = c; r < rows; ++r)
        {
          const auto [column, row] = std::minmax(this->Unknown[this->CoordinateOf(active, c)],
            this->Unknown[this->CoordinateOf(active, r)]);
          *scatter = -1;
          if (column >= 0)
          {
            const auto begin = this->Rows.begin() + this->Starts[column];
            const auto end = this->Rows.begin() + this->Starts[column + 1];
            *scatter =
              static_cast<std::int32_t>(std::lower_bound(begin, end, row) - this->Rows.begin());
          }
          ++scatter;
        }
      }
    });
}

template <typename Function>
void EquilibriumSolver::Internals::ForEachContact(std::size_t active, const std::vector<double>& x,
  const PlatePair& plates, const Function& function) const
{
  const std::span<const std::int32_t> nodes = this->NodesOf(active);
  const int faceNodes = this->Body.NodesPerFace();
  const Plate* sides[2] = { &plates.Support, &plates.Paddle };
  for (const std::int32_t f : this->FacesOfElement[active])
  {
    const ElasticBody::BoundaryFace& face = this->Body.Faces()[f];
    Vector3 centre{ 0, 0, 0 };
    for (int a = 0; a < faceNodes; ++a)
    {
      centre = centre + (1.0 / faceNodes) * NodeOf(x, nodes[face.LocalNodes[a]]);
    }
    double radius = 0;
    for (int a = 0; a < faceNodes; ++a)
    {
      radius = std::max(radius, Norm(NodeOf(x, nodes[face.LocalNodes[a]]) - centre));
    }
    // The shape functions' magnitudes sum to 5/3 at most, and a distance grows no faster than the
    // way.
    const double near = ContactLayerMm + 5 / 3.0 * radius;
    const bool mayTouch[2] = { DistanceToPlate(plates.Support, centre).Distance < near,
      DistanceToPlate(plates.Paddle, centre).Distance < near };
    if (!mayTouch[0] && !mayTouch[1])
    {
      continue;
    }
    for (std::size_t k = 0; k < TriangleRule().size(); ++k)
    {
      const TrianglePoint& rulePoint = TriangleRule()[k];
      const std::array<double, 6> shape = TriangleShape(rulePoint.Lambda, faceNodes);
      const Vector3 position = FacePosition(this->Body, face, shape, x);
      for (std::int16_t side = 0; side < 2; ++side)
      {
        const PlateDistance distance = DistanceToPlate(*sides[side], position);
        const double depth = ContactLayerMm - distance.Distance;
        if (mayTouch[side] && depth > 0)
        {
          function(ContactPoint{ face, f, static_cast<std::int16_t>(k), shape, position, side,
            *sides[side], distance, ContactLaw(this->ContactStiffness, depth),
            rulePoint.Weight * face.Area });
        }
      }
    }
  }
}

void EquilibriumSolver::Internals::AddContact(std::size_t active, const std::vector<double>& x,
  const PlatePair& plates, ElasticBody::Order order, ElasticBody::Terms& terms,
  ContactTotals& totals, std::vector<double>& contactGradient) const
{
  const int faceNodes = this->Body.NodesPerFace();
  const std::size_t rows = 3 * this->NodesOf(active).size();
  this->ForEachContact(active, x, plates,
    [&](const ContactPoint& point)
    {
      const double force = point.Weight * point.Law.Pressure;
      totals.Energy += point.Weight * point.Law.Energy;
      totals.Penetration = std::max(totals.Penetration, -point.Distance.Distance);
      totals.NormalForce[point.Side] += force * Dot(point.Distance.Gradient, point.Touched.Normal);
      if (order == ElasticBody::Order::Energy)
      {
        return;
      }
      const std::array<int, 6>& local = point.Face.LocalNodes;
      for (int a = 0; a < faceNodes; ++a)
      {
        for (int i = 0; i < 3; ++i)
        {
          contactGradient[3 * local[a] + i] -= force * point.Shape[a] * point.Distance.Gradient[i];
        }
      }
      if (order == ElasticBody::Order::Gradient)
      {
        return;
      }
      const double along = point.Weight * point.Law.Slope;
      const double across =
        order == ElasticBody::Order::ProjectedHessian ? 0.0 : -force * point.Distance.Curvature;
      double block[3][3];
      for (int i = 0; i < 3; ++i)
      {
        for (int j = 0; j < 3; ++j)
        {
          block[i][j] = along * point.Distance.Gradient[i] * point.Distance.Gradient[j] +
            across * point.Distance.Tangent[i] * point.Distance.Tangent[j];
        }
      }
      for (int a = 0; a < faceNodes; ++a)
      {
        for (int b = 0; b < faceNodes; ++b)
        {
          const double shapes = point.Shape[a] * point.Shape[b];
          for (int i = 0; i < 3; ++i)
          {
            for (int j = 0; j < 3; ++j)
            {
              terms.Hessian[rows * (3 * local[b] + j) + 3 * local[a] + i] += shapes * block[i][j];
            }
          }
        }
      }
    });
}

template <typename Function>
void EquilibriumSolver::Internals::ForEachFriction(std::size_t active, const std::vector<double>& x,
  const Function& function) const
{
  if (this->FrictionStarts.empty())
  {
    return;
  }
  for (std::size_t p = this->FrictionStarts[active]; p < this->FrictionStarts[active + 1]; ++p)
  {
    const FrictionPoint& point = this->Friction[p];
    const ElasticBody::BoundaryFace& face = this->Body.Faces()[point.Face];
    const std::array<double, 6> shape =
      TriangleShape(TriangleRule()[point.RulePoint].Lambda, this->Body.NodesPerFace());
    function(point, face, shape, FacePosition(this->Body, face, shape, x));
  }
}

void EquilibriumSolver::Internals::AddFriction(std::size_t active, const std::vector<double>& x,
  const PlatePair& plates, ElasticBody::Order order, ElasticBody::Terms& terms,
  ContactTotals& totals, std::vector<double>& contactGradient) const
{
  const int faceNodes = this->Body.NodesPerFace();
  const std::size_t rows = contactGradient.size();
  this->ForEachFriction(active, x,
    [&](const FrictionPoint& point, const ElasticBody::BoundaryFace& face,
      const std::array<double, 6>& shape, const Vector3& position)
    {
      const Plate& plate = SideOf(plates, point.Side);
      const FrictionTerms friction(point, plate, position);
      const Vector3 force = -point.SlidingForce * friction.Gradient();
      totals.Energy += point.SlidingForce * friction.Energy;
      totals.NormalForce[point.Side] += Dot(force, plate.Normal);
      totals.Friction[point.Side] = totals.Friction[point.Side] + force;
      if (order == ElasticBody::Order::Energy)
      {
        return;
      }
      const std::array<int, 6>& local = face.LocalNodes;
      for (int a = 0; a < faceNodes; ++a)
      {
        for (int i = 0; i < 3; ++i)
        {
          contactGradient[3 * local[a] + i] -= shape[a] * force[i];
        }
      }
      if (order == ElasticBody::Order::Gradient)
      {
        return;
      }
      for (int j = 0; j < 3; ++j)
      {
        Vector3 axis{ 0, 0, 0 };
        axis[j] = 1;
        const Vector3 column = point.SlidingForce * friction.HessianTimes(axis);
        for (int a = 0; a < faceNodes; ++a)
        {
          for (int b = 0; b < faceNodes; ++b)
          {
            for (int i = 0; i < 3; ++i)
            {
              terms.Hessian[rows * (3 * local[b] + j) + 3 * local[a] + i] +=
                shape[a] * shape[b] * column[i];
            }
          }
        }
      }
    });
}

void EquilibriumSolver::Internals::AddWall(const std::vector<double>& x, ElasticBody::Order order,
  Assembly& result) const
{
  const std::vector<std::int32_t>& nodes = this->Wall->Nodes();
  result.WallLift = result.WallGlide = 0;
  this->WallResults.resize(nodes.size());
  ParallelFor(nodes.size(),
    [&](std::size_t n)
    {
      this->WallResults[n] = this->Wall->NodeTerms(n, NodeOf(x, nodes[n]), this->Stiffness,
        order == ElasticBody::Order::ProjectedHessian);
    });
  double square = 0;
  for (std::size_t n = 0; n < nodes.size(); ++n)
  {
    const ChestWall::Terms& terms = this->WallResults[n];
    result.Energy += terms.Energy;
    result.WallLift = std::max(result.WallLift, std::abs(terms.LiftMm));
    result.WallGlide = std::max(result.WallGlide, terms.GlideMm);
    if (order == ElasticBody::Order::Energy)
    {
      continue;
    }
    square += Dot(terms.Gradient, terms.Gradient);
    for (int i = 0; i < 3; ++i)
    {
      const std::int32_t column = this->Unknown[3 * nodes[n] + i];
      result.Gradient[3 * nodes[n] + i] += terms.Gradient[i];
      for (int j = i; j < 3 && column >= 0 && order >= ElasticBody::Order::Hessian; ++j)
      {
        const std::int32_t row = this->Unknown[3 * nodes[n] + j];
        const auto begin = this->Rows.begin() + this->Starts[column];
        const auto end = this->Rows.begin() + this->Starts[column + 1];
        if (row >= 0)
        {
          result.Values[std::lower_bound(begin, end, row) - this->Rows.begin()] +=
            terms.Hessian[i][j];
        }
      }
    }
  }
  result.WallNorm = std::sqrt(square);
}

void EquilibriumSolver::Internals::Assemble(const std::vector<double>& x, const PlatePair* plates,
  ElasticBody::Order order, Assembly& result) const
{
  ParallelFor(this->ActiveElements.size(),
    [&](std::size_t active)
    {
      ElasticBody::Terms& terms = this->ElementResults[active];
      this->ElementContacts[active] = {};
      this->ElementContactGradients[active].assign(3 * this->NodesOf(active).size(), 0.0);
      this->ElementValid[active] =
        this->Body.ElementTerms(this->ActiveElements[active], x, order, terms, this->Domain);
      if (this->ElementValid[active] && plates)
      {
        this->AddContact(active, x, *plates, order, terms, this->ElementContacts[active],
          this->ElementContactGradients[active]);
        this->AddFriction(active, x, *plates, order, terms, this->ElementContacts[active],
          this->ElementContactGradients[active]);
      }
    });
  result.Valid = std::all_of(this->ElementValid.begin(), this->ElementValid.end(),
    [](char valid) { return valid; });
  if (!result.Valid)
  {
    return;
  }
  // Sums in the order of the elements, whatever the number of threads.
  result.Contact = {};
  result.Energy = 0;
  result.SmallestJ = result.LargestJ = this->ElementResults.front().SmallestJ;
  result.Volume = this->FixedVolume;
  for (std::size_t active = 0; active < this->ActiveElements.size(); ++active)
  {
    const ElasticBody::Terms& terms = this->ElementResults[active];
    const ContactTotals& contact = this->ElementContacts[active];
    result.Energy += terms.Energy + contact.Energy;
    result.SmallestJ = std::min(result.SmallestJ, terms.SmallestJ);
    result.LargestJ = std::max(result.LargestJ, terms.LargestJ);
    result.Volume += terms.Volume;
    result.Contact.Energy += contact.Energy;
    result.Contact.Penetration = std::max(result.Contact.Penetration, contact.Penetration);
    for (int side = 0; side < 2; ++side)
    {
      result.Contact.NormalForce[side] += contact.NormalForce[side];
      result.Contact.Friction[side] = result.Contact.Friction[side] + contact.Friction[side];
    }
  }
  for (std::size_t c = 0; c < this->Loads.size(); ++c)
  {
    result.Energy -= this->Loads[c] * (x[c] - this->Body.RestPositions()[c]);
  }
  if (order == ElasticBody::Order::Energy)
  {
    if (this->Wall)
    {
      this->AddWall(x, order, result);
    }
    return;
  }
  if (order >= ElasticBody::Order::Hessian)
  {
    result.Values.assign(this->Rows.size(), 0.0);
  }
  result.Gradient.assign(x.size(), 0.0);
  std::vector<double> contactGradient(x.size(), 0.0);
  for (std::size_t active = 0; active < this->ActiveElements.size(); ++active)
  {
    const std::vector<double>& contact = this->ElementContactGradients[active];
    for (std::size_t r = 0; r < contact.size(); ++r)
    {
      const std::size_t coordinate = this->CoordinateOf(active, r);
      result.Gradient[coordinate] += this->ElementResults[active].Gradient[r] + contact[r];
      contactGradient[coordinate] += contact[r];
    }
  }
  for (std::size_t c = 0; c < this->Loads.size(); ++c)
  {
    result.Gradient[c] -= this->Loads[c];
  }
  result.ContactNorm = std::sqrt(SquaredNorm(contactGradient));
  result.LoadNorm = std::sqrt(SquaredNorm(this->Loads));
  if (this->Wall)
  {
    this->AddWall(x, order, result);
  }
  double residual = 0;
  double reaction = 0;
  for (std::size_t c = 0; c < x.size(); ++c)
  {
    (this->Unknown[c] >= 0 ? residual : reaction) += result.Gradient[c] * result.Gradient[c];
  }
  result.ResidualNorm = std::sqrt(residual);
  result.ReactionNorm = std::sqrt(reaction);
  if (order == ElasticBody::Order::Gradient)
  {
    return;
  }
  for (std::size_t active = 0; active < this->ActiveElements.size(); ++active)
  {
    const std::int32_t* scatter = &this->Scatter[this->ScatterStarts[active]];
    const double* hessian = this->ElementResults[active].Hessian.data();
    const std::size_t rows = 3 * this->NodesOf(active).size();
    for (std::size_t c = 0; c < rows; ++c)
    {
      for (std::size_t r = c; r < rows; ++r, ++scatter)
      {
        if (*scatter >= 0)
        {
          result.Values[*scatter] += hessian[rows * c + r];
        }
      }
    }
  }
}

void EquilibriumSolver::Internals::AssembleCurrent(const std::vector<double>& x,
  const PlatePair* plates) const
{
  MatrixState state{ x, plates ? std::optional(*plates) : std::nullopt, this->ContactStiffness,
    this->Domain };
  if (!this->Current.Valid || state != this->CurrentState)
  {
    this->Assemble(x, plates, ElasticBody::Order::Hessian, this->Current);
    this->CurrentState = std::move(state);
  }
}

bool EquilibriumSolver::Internals::FactorizeWithFallback(const std::vector<double>& x,
  const PlatePair* plates, bool stiffer) const
{
  // Where the matrix is indefinite, mix in as little as needed of the one that cannot be: all of it
  // would be far too stiff and Newton's method would crawl. What was needed last is a good guess.
  this->FactorPositions.clear();
  if (stiffer)
  {
    this->Share = std::clamp(8 * this->Share, SmallestShare, 1.0);
  }
  else
  {
    this->Share = this->Share < 4 * SmallestShare ? 0 : 0.25 * this->Share;
    this->ProjectedValues.clear();
  }
  std::vector<double> mixed;
  for (;; this->Share = std::clamp(8 * this->Share, SmallestShare, 1.0))
  {
    if (this->Share == 0)
    {
      if (this->Factor->Factorize(this->Current.Values))
      {
        this->FactorPositions = x;
        return true;
      }
      continue;
    }
    if (this->ProjectedValues.empty())
    {
      Assembly projected;
      this->Assemble(x, plates, ElasticBody::Order::ProjectedHessian, projected);
      this->ProjectedValues.swap(projected.Values);
    }
    mixed = this->Current.Values;
    for (std::size_t k = 0; k < mixed.size(); ++k)
    {
      mixed[k] += this->Share * (this->ProjectedValues[k] - mixed[k]);
    }
    if (this->Factor->Factorize(mixed))
    {
      return true;
    }
    if (this->Share == 1)
    {
      return false;
    }
  }
}

bool EquilibriumSolver::Internals::FindStepByOldFactor(const std::vector<double>& force,
  std::vector<double>& step) const
{
  const auto size = static_cast<Eigen::Index>(force.size());
  const auto view = [size](std::vector<double>& v)
  { return Eigen::Map<Eigen::VectorXd>(v.data(), size); };
  std::vector<double> residual = force;
  std::vector<double> preconditioned = force;
  std::vector<double> direction;
  std::vector<double> product(force.size());
  step.assign(force.size(), 0.0);
  const double enough = GradientsTolerance * view(residual).norm();
  double before = 0;
  for (int iteration = 0; iteration < MostGradientsSteps; ++iteration)
  {
    this->Factor->Solve(preconditioned);
    const double now = view(residual).dot(view(preconditioned));
    if (iteration == 0)
    {
      direction = preconditioned;
    }
    else
    {
      view(direction) = view(preconditioned) + now / before * view(direction);
    }
    this->Factor->Multiply(this->Current.Values, direction.data(), product.data());
    const double curvature = view(direction).dot(view(product));
    if (!(curvature > 0))
    {
      return false;
    }
    view(step) += now / curvature * view(direction);
    view(residual) -= now / curvature * view(product);
    if (view(residual).norm() <= enough)
    {
      return true;
    }
    preconditioned = residual;
    before = now;
  }
  return false;
}

double EquilibriumSolver::Internals::DistanceOfFactor(const std::vector<double>& x) const
{
  if (this->FactorPositions.size() != x.size())
  {
    return std::numeric_limits<double>::infinity();
  }
  double farthest = 0;
  for (std::size_t c = 0; c < x.size(); ++c)
  {
    farthest = std::max(farthest, std::abs(x[c] - this->FactorPositions[c]));
  }
  return farthest;
}

EquilibriumReport EquilibriumSolver::Internals::Report(const Assembly& assembly) const
{
  EquilibriumReport report;
  report.Energy = assembly.Energy;
  report.RelativeResidual = assembly.ResidualNorm / this->ForceScale(assembly);
  report.SupportForceN = 1e-3 * assembly.Contact.NormalForce[0];
  report.PaddleForceN = 1e-3 * assembly.Contact.NormalForce[1];
  for (int side = 0; side < 2; ++side)
  {
    report.FrictionN[side] = 1e-3 * assembly.Contact.Friction[side];
  }
  report.LargestPenetrationMm = assembly.Contact.Penetration;
  report.LargestWallLiftMm = assembly.WallLift;
  report.LargestWallGlideMm = assembly.WallGlide;
  report.SmallestJ = assembly.SmallestJ;
  report.LargestJ = assembly.LargestJ;
  report.VolumeRatio = assembly.Volume / this->RestVolume;
  return report;
}

void EquilibriumSolver::Internals::AddAtFace(const ElasticBody::BoundaryFace& face,
  const std::array<double, 6>& shape, const Vector3& force, double* column) const
{
  const std::span<const std::int32_t> nodes = this->Body.NodesOf(face.Element);
  for (int a = 0; a < this->Body.NodesPerFace(); ++a)
  {
    for (int i = 0; i < 3; ++i)
    {
      const std::int32_t unknown = this->Unknown[3 * nodes[face.LocalNodes[a]] + i];
      if (unknown >= 0)
      {
        column[unknown] += shape[a] * force[i];
      }
    }
  }
}

std::vector<double> EquilibriumSolver::Internals::PlateForces(const std::vector<double>& x,
  const PlatePair& plates, const std::vector<PlatePairVelocity>& velocities) const
{
  // With b(d) the energy of a contact point per area, d its distance to the plate moved by v = L +
  // w x r: d(grad b)/dp = b' w x grad d - hess(b) v, since grad d turns with the plate.
  const std::size_t n = this->CoordinateOfUnknown.size();
  std::vector<double> columns(n * velocities.size(), 0.0);
  for (std::size_t active = 0; active < this->ActiveElements.size(); ++active)
  {
    this->ForEachContact(active, x, plates,
      [&](const ContactPoint& point)
      {
        const double slope = -point.Weight * point.Law.Pressure;
        const double along = point.Weight * point.Law.Slope;
        const PlateDistance& distance = point.Distance;
        for (std::size_t p = 0; p < velocities.size(); ++p)
        {
          const PlateVelocity& velocity =
            point.Side == 0 ? velocities[p].Support : velocities[p].Paddle;
          const Vector3 v = velocity.At(point.Touched, point.Position);
          const Vector3 force = (along * Dot(distance.Gradient, v)) * distance.Gradient +
            (slope * distance.Curvature * Dot(distance.Tangent, v)) * distance.Tangent -
            slope * Cross(velocity.Angular, distance.Gradient);
          this->AddAtFace(point.Face, point.Shape, force, &columns[n * p]);
        }
      });
    this->ForEachFriction(active, x,
      [&](const FrictionPoint& point, const ElasticBody::BoundaryFace& face,
        const std::array<double, 6>& shape, const Vector3& position)
      {
        const Plate& plate = SideOf(plates, point.Side);
        const FrictionTerms friction(point, plate, position);
        for (std::size_t p = 0; p < velocities.size(); ++p)
        {
          const PlateVelocity& velocity =
            point.Side == 0 ? velocities[p].Support : velocities[p].Paddle;
          this->AddAtFace(face, shape,
            -point.SlidingForce * friction.GradientRate(plate, velocity, position),
            &columns[n * p]);
        }
      });
  }
  return columns;
}

std::vector<double> EquilibriumSolver::Internals::HoldingForces(const std::vector<double>& x,
  const PlatePair& plates, const std::vector<HoldingVelocity>& velocities) const
{
  const std::size_t n = this->CoordinateOfUnknown.size();
  std::vector<double> columns(n * velocities.size(), 0.0);
  for (std::size_t p = 0; p < velocities.size(); ++p)
  {
    const HoldingVelocity& velocity = velocities[p];
    double* column = &columns[n * p];
    for (std::size_t u = 0; u < n && !velocity.Loads.empty(); ++u)
    {
      column[u] = velocity.Loads[this->CoordinateOfUnknown[u]];
    }
    for (std::size_t w = 0; this->Wall && w < this->Wall->Nodes().size(); ++w)
    {
      const std::int32_t node = this->Wall->Nodes()[w];
      const Vector3 rate = this->Wall->NodeTerms(w, NodeOf(x, node), velocity.Wall).Gradient;
      for (int i = 0; i < 3; ++i)
      {
        const std::int32_t unknown = this->Unknown[3 * node + i];
        if (unknown >= 0)
        {
          column[unknown] -= rate[i];
        }
      }
    }
    for (std::size_t active = 0; active < this->ActiveElements.size() && velocity.Friction != 0;
         ++active)
    {
      this->ForEachFriction(active, x,
        [&](const FrictionPoint& point, const ElasticBody::BoundaryFace& face,
          const std::array<double, 6>& shape, const Vector3& position)
        {
          const FrictionTerms friction(point, SideOf(plates, point.Side), position);
          this->AddAtFace(face, shape, -velocity.Friction * point.NormalForce * friction.Gradient(),
            column);
        });
    }
  }
  return columns;
}

std::vector<double> EquilibriumSolver::Internals::MaterialForces(const std::vector<double>& x,
  const std::vector<MaterialVelocity>& velocities) const
{
  const std::size_t n = this->CoordinateOfUnknown.size();
  std::vector<double> columns(n * velocities.size(), 0.0);
  std::vector<std::vector<double>> rates(this->ActiveElements.size());
  for (std::size_t p = 0; p < velocities.size(); ++p)
  {
    ParallelFor(rates.size(),
      [&](std::size_t active)
      { rates[active] = this->Body.GradientRate(this->ActiveElements[active], x, velocities[p]); });
    for (std::size_t active = 0; active < rates.size(); ++active)
    {
      for (std::size_t r = 0; r < rates[active].size(); ++r)
      {
        const std::int32_t unknown = this->Unknown[this->CoordinateOf(active, r)];
        if (unknown >= 0)
        {
          columns[n * p + unknown] -= rates[active][r];
        }
      }
    }
  }
  return columns;
}

EquilibriumSolver::EquilibriumSolver(const ElasticBody& body, const std::vector<bool>& fixed,
  double contactStiffness, const std::vector<bool>& leftOut)
  : Internal(std::make_unique<Internals>(body, fixed, contactStiffness, leftOut))
{
}

EquilibriumSolver::~EquilibriumSolver() = default;

std::size_t EquilibriumSolver::NumberOfUnknowns() const
{
  return this->Internal->CoordinateOfUnknown.size();
}

void EquilibriumSolver::BodyChanged()
{
  this->Internal->MeasureScales();
  this->Internal->CurrentState = {};
  this->Internal->FactorPositions.clear();
}

void EquilibriumSolver::SetContactStiffness(double stiffness)
{
  this->Internal->ContactStiffness = stiffness;
}

void EquilibriumSolver::SetLoads(std::vector<double> loads)
{
  if (!loads.empty() && loads.size() != this->Internal->Body.RestPositions().size())
  {
    throw InputError("loads: expected 3 forces per node, found " + std::to_string(loads.size()) +
      " for " + std::to_string(this->Internal->Body.NumberOfNodes()) + " nodes");
  }
  if (loads != this->Internal->Loads)
  {
    this->Internal->CurrentState = {};
    this->Internal->Loads = std::move(loads);
  }
}

void EquilibriumSolver::SetWall(const ChestWall* wall, const WallStiffness& stiffness)
{
  this->Internal->Wall = wall;
  this->Internal->Stiffness = stiffness;
  this->Internal->CurrentState = {};
  this->Internal->FactorPositions.clear();
}

void EquilibriumSolver::SetFriction(FrictionPoints points)
{
  Internals& internal = *this->Internal;
  if (!points.empty() || !internal.Friction.empty())
  {
    internal.CurrentState = {};
  }
  std::stable_sort(points.begin(), points.end(),
    [&](const FrictionPoint& a, const FrictionPoint& b)
    { return internal.ActiveOfFace[a.Face] < internal.ActiveOfFace[b.Face]; });
  internal.Friction = std::move(points);
  internal.FrictionStarts.clear();
  if (internal.Friction.empty())
  {
    return;
  }
  internal.FrictionStarts.assign(internal.ActiveElements.size() + 1, 0);
  for (const FrictionPoint& point : internal.Friction)
  {
    ++internal.FrictionStarts[internal.ActiveOfFace[point.Face] + 1];
  }
  std::partial_sum(internal.FrictionStarts.begin(), internal.FrictionStarts.end(),
    internal.FrictionStarts.begin());
}

const FrictionPoints& EquilibriumSolver::Friction() const
{
  return this->Internal->Friction;
}

FrictionPoints EquilibriumSolver::FrictionAt(const std::vector<double>& x, const PlatePair& plates,
  double coefficient, const FrictionStart& before) const
{
  const Internals& internal = *this->Internal;
  FrictionPoints ordered = before.Dragged;
  std::sort(ordered.begin(), ordered.end(), Before);
  FrictionPoints result;
  for (std::size_t active = 0; active < internal.ActiveElements.size(); ++active)
  {
    internal.ForEachContact(active, x, plates,
      [&](const ContactPoint& contact)
      {
        FrictionPoint point;
        point.Face = contact.FaceIndex;
        point.RulePoint = contact.RulePoint;
        point.Side = contact.Side;
        point.NormalForce = contact.Weight * contact.Law.Pressure;
        point.SlidingForce = coefficient * point.NormalForce;
        point.Normal = DirectionInPlate(contact.Touched, contact.Distance.Gradient);
        const auto found = std::lower_bound(ordered.begin(), ordered.end(), point, Before);
        point.Anchor = found != ordered.end() && !Before(point, *found)
          ? found->Anchor
          : PointInPlate(SideOf(before.Plates, point.Side),
              FacePosition(internal.Body, contact.Face, contact.Shape, before.Positions));
        result.push_back(point);
      });
  }
  return result;
}

FrictionPoints EquilibriumSolver::DraggedTo(const std::vector<double>& x, const PlatePair& plates,
  FrictionPoints points) const
{
  const ElasticBody& body = this->Internal->Body;
  for (FrictionPoint& point : points)
  {
    const std::array<double, 6> shape =
      TriangleShape(TriangleRule()[point.RulePoint].Lambda, body.NodesPerFace());
    point = Dragged(point, SideOf(plates, point.Side),
      FacePosition(body, body.Faces()[point.Face], shape, x));
  }
  return points;
}

EquilibriumReport EquilibriumSolver::Internals::Newton(std::vector<double>& x,
  const PlatePair* plates, double tolerance, int maximumSteps, bool eliminate,
  const ProgressCallback& progress) const
{
  Assembly& current = this->Current;
  this->AssembleCurrent(x, plates);
  if (!current.Valid)
  {
    EquilibriumReport report;
    report.Reason = "a cell is inverted at the start";
    return report;
  }
  std::vector<double> force(this->CoordinateOfUnknown.size());
  std::vector<double> step;
  std::vector<double> trial;
  Assembly probe;
  for (int newton = 0;; ++newton)
  {
    EquilibriumReport report = this->Report(current);
    report.NewtonSteps = newton;
    if (report.RelativeResidual <= tolerance)
    {
      report.Converged = true;
      return report;
    }
    if (newton == maximumSteps)
    {
      char reason[128];
      std::snprintf(reason, sizeof reason,
        "relative residual %.2g after %d Newton steps, expected at most %.2g",
        report.RelativeResidual, newton, tolerance);
      report.Reason = reason;
      return report;
    }
    ReportProgress(progress, 0, "equilibrium");
    for (std::size_t u = 0; u < force.size(); ++u)
    {
      force[u] = -current.Gradient[this->CoordinateOfUnknown[u]];
    }
    const bool found =
      this->DistanceOfFactor(x) < NearFactorMm && this->FindStepByOldFactor(force, step);
    // A huge step comes from a matrix that is nearly singular; a stiffer one leads farther than a
    // small part of it.
    for (bool stiffer = false; !found; stiffer = true)
    {
      if (!this->FactorizeWithFallback(x, plates, stiffer))
      {
        report.Reason = "the stiffness matrix is singular";
        return report;
      }
      step = force;
      this->Factor->Solve(step);
      if (this->Share == 1 || LargestMagnitude(step) <= LargestNewtonStepMm)
      {
        break;
      }
    }
    double slope = 0;
    for (std::size_t u = 0; u < step.size(); ++u)
    {
      slope += step[u] * current.Gradient[this->CoordinateOfUnknown[u]];
    }
    double length = 1;
    bool accepted = false;
    for (int halving = 0; halving < 30 && !accepted; ++halving)
    {
      length = std::ldexp(1.0, -halving);
      trial = x;
      for (std::size_t u = 0; u < step.size(); ++u)
      {
        trial[this->CoordinateOfUnknown[u]] += length * step[u];
      }
      this->Assemble(trial, plates, ElasticBody::Order::Energy, probe);
      accepted = probe.Valid &&
        probe.Energy <= current.Energy + 1e-4 * length * slope +
            std::max(this->EnergyNoise, 1e-13 * std::abs(current.Energy));
    }
    if (!accepted)
    {
      report.Reason = "no step lowers the energy";
      return report;
    }
    x.swap(trial);
    this->AssembleCurrent(x, plates);
    const bool struggling = this->Share > 0 || length < 1;
    if (eliminate && struggling && this->Report(current).RelativeResidual > tolerance &&
      this->RelaxWorst(x, plates, progress))
    {
      this->AssembleCurrent(x, plates);
    }
  }
}

std::vector<bool> EquilibriumSolver::Internals::FixedAroundWorst() const
{
  const std::size_t nodeCount = this->Body.NumberOfNodes();
  std::vector<double> squares(nodeCount, 0.0);
  for (const std::int32_t coordinate : this->CoordinateOfUnknown)
  {
    const double force = this->Current.Gradient[coordinate];
    squares[coordinate / 3] += force * force;
  }
  const double largest = *std::max_element(squares.begin(), squares.end());
  for (double part = WorstForce; part < 1; part *= 2)
  {
    std::vector<bool> chosen(nodeCount);
    std::transform(squares.begin(), squares.end(), chosen.begin(),
      [&](double square) { return square > part * part * largest; });
    for (int layer = 0; layer < LayersAroundWorst; ++layer)
    {
      std::vector<bool> wider = chosen;
      for (const std::int32_t element : this->ActiveElements)
      {
        const std::span<const std::int32_t> nodes = this->Body.NodesOf(element);
        if (std::any_of(nodes.begin(), nodes.end(), [&](std::int32_t n) { return chosen[n]; }))
        {
          for (const std::int32_t node : nodes)
          {
            wider[node] = true;
          }
        }
      }
      chosen.swap(wider);
    }
    std::vector<bool> fixed(3 * nodeCount, true);
    std::size_t count = 0;
    for (const std::int32_t coordinate : this->CoordinateOfUnknown)
    {
      fixed[coordinate] = !chosen[coordinate / 3];
      count += chosen[coordinate / 3];
    }
    if (count <= LargestPart * static_cast<double>(this->CoordinateOfUnknown.size()))
    {
      return fixed;
    }
  }
  return {};
}

bool EquilibriumSolver::Internals::RelaxWorst(std::vector<double>& x, const PlatePair* plates,
  const ProgressCallback& progress) const
{
  const std::vector<bool> fixed = this->FixedAroundWorst();
  if (fixed.empty())
  {
    return false;
  }
  EquilibriumSolver part(this->Body, fixed, this->ContactStiffness, this->LeftOut);
  part.Internal->Domain = this->Domain;
  part.SetLoads(this->Loads);
  part.SetWall(this->Wall, this->Stiffness);
  part.SetFriction(this->Friction);
  part.Internal->Newton(x, plates, PartTolerance, PartNewtonSteps, false, progress);
  return true;
}

EquilibriumReport EquilibriumSolver::Solve(std::vector<double>& x, const PlatePair* plates,
  double tolerance, int maximumSteps, const ProgressCallback& progress) const
{
  return this->Internal->Newton(x, plates, tolerance, maximumSteps, true, progress);
}

bool EquilibriumSolver::Admissible(const std::vector<double>& x) const
{
  Internals::Assembly probe;
  this->Internal->Assemble(x, nullptr, ElasticBody::Order::Energy, probe);
  return probe.Valid;
}

EquilibriumReport EquilibriumSolver::Untangle(std::vector<double>& x, const PlatePair* plates,
  double tolerance, int maximumSteps, const ProgressCallback& progress) const
{
  struct ExtendedHere
  {
    ElasticBody::Domain& Domain;
    explicit ExtendedHere(ElasticBody::Domain& domain)
      : Domain(domain)
    {
      domain = ElasticBody::Domain::Extended;
    }
    ~ExtendedHere() { this->Domain = ElasticBody::Domain::Admissible; }
  };
  const ExtendedHere extended(this->Internal->Domain);
  return this->Internal->Newton(x, plates, tolerance, maximumSteps, true, progress);
}

EquilibriumReport EquilibriumSolver::Evaluate(const std::vector<double>& x,
  const PlatePair* plates) const
{
  Internals::Assembly assembly;
  this->Internal->Assemble(x, plates, ElasticBody::Order::Gradient, assembly);
  if (!assembly.Valid)
  {
    throw ConvergenceError("equilibrium: expected no inverted cell, found one");
  }
  return this->Internal->Report(assembly);
}

std::vector<double> EquilibriumSolver::Gradient(const std::vector<double>& x,
  const PlatePair* plates) const
{
  Internals::Assembly assembly;
  this->Internal->Assemble(x, plates, ElasticBody::Order::Gradient, assembly);
  if (!assembly.Valid)
  {
    throw ConvergenceError("equilibrium: expected no inverted cell, found one");
  }
  return assembly.Gradient;
}

std::vector<double> EquilibriumSolver::HessianProduct(const std::vector<double>& x,
  const PlatePair* plates, const std::vector<double>& direction) const
{
  const Internals& internal = *this->Internal;
  Internals::Assembly assembly;
  internal.Assemble(x, plates, ElasticBody::Order::Hessian, assembly);
  if (!assembly.Valid)
  {
    throw ConvergenceError("equilibrium: expected no inverted cell, found one");
  }
  const std::size_t n = internal.CoordinateOfUnknown.size();
  std::vector<double> in(n);
  std::vector<double> out(n);
  for (std::size_t u = 0; u < n; ++u)
  {
    in[u] = direction[internal.CoordinateOfUnknown[u]];
  }
  internal.Factor->Multiply(assembly.Values, in.data(), out.data());
  std::vector<double> result(x.size(), 0.0);
  for (std::size_t u = 0; u < n; ++u)
  {
    result[internal.CoordinateOfUnknown[u]] = out[u];
  }
  return result;
}

std::vector<double> EquilibriumSolver::ContactPressures(const std::vector<double>& x,
  const PlatePair& plates) const
{
  const Internals& internal = *this->Internal;
  const ElasticBody& body = internal.Body;
  std::vector<double> force(body.NumberOfNodes(), 0.0);
  std::vector<double> area(body.NumberOfNodes(), 0.0);
  for (std::size_t active = 0; active < internal.ActiveElements.size(); ++active)
  {
    for (const std::int32_t f : internal.FacesOfElement[active])
    {
      const ElasticBody::BoundaryFace& face = body.Faces()[f];
      for (int c = 0; c < 3; ++c)
      {
        area[body.NodesOf(face.Element)[face.LocalNodes[c]]] += face.Area / 3;
      }
    }
    internal.ForEachContact(active, x, plates,
      [&](const ContactPoint& point)
      {
        const double* lambda = TriangleRule()[point.RulePoint].Lambda;
        for (int c = 0; c < 3; ++c)
        {
          force[body.NodesOf(point.Face.Element)[point.Face.LocalNodes[c]]] +=
            lambda[c] * point.Weight * point.Law.Pressure;
        }
      });
  }
  for (std::size_t node = 0; node < force.size(); ++node)
  {
    force[node] = area[node] > 0 ? force[node] / area[node] : 0;
  }
  for (const ElasticBody::BoundaryFace& face : body.Faces())
  {
    const std::span<const std::int32_t> nodes = body.NodesOf(face.Element);
    for (int side = 0; side < 3 && body.Type() == ElementType::Quadratic; ++side)
    {
      force[nodes[face.LocalNodes[3 + side]]] =
        0.5 * (force[nodes[face.LocalNodes[side]]] + force[nodes[face.LocalNodes[(side + 1) % 3]]]);
    }
  }
  return force;
}

std::vector<std::vector<double>> EquilibriumSolver::Sensitivities(const std::vector<double>& x,
  const PlatePair& plates, const std::vector<PlatePairVelocity>& velocities,
  const std::vector<MaterialVelocity>& materialVelocities,
  const std::vector<HoldingVelocity>& holdingVelocities) const
{
  const Internals& internal = *this->Internal;
  for (const MaterialVelocity& velocity : materialVelocities)
  {
    if (velocity.size() != internal.Body.Materials().size())
    {
      throw InputError("sensitivities: expected a rate for each of " +
        std::to_string(internal.Body.Materials().size()) + " materials, found " +
        std::to_string(velocity.size()));
    }
  }
  for (const HoldingVelocity& velocity : holdingVelocities)
  {
    if (!velocity.Loads.empty() && velocity.Loads.size() != x.size())
    {
      throw InputError("sensitivities: expected a rate for each of " + std::to_string(x.size()) +
        " loads, found " + std::to_string(velocity.Loads.size()));
    }
  }
  const std::size_t count =
    velocities.size() + materialVelocities.size() + holdingVelocities.size();
  std::vector<std::vector<double>> result;
  if (count == 0)
  {
    return result;
  }
  internal.AssembleCurrent(x, &plates);
  if (!internal.Current.Valid)
  {
    throw ConvergenceError("sensitivities: expected no inverted cell, found one");
  }
  const std::size_t n = internal.CoordinateOfUnknown.size();
  std::vector<double> right;
  for (const std::vector<double>& columns :
    { internal.PlateForces(x, plates, velocities), internal.MaterialForces(x, materialVelocities),
      internal.HoldingForces(x, plates, holdingVelocities) })
  {
    right.insert(right.end(), columns.begin(), columns.end());
  }
  // Parameters have units of their own: each is refined to its own size.
  const auto norm = [n](const std::vector<double>& columns, std::size_t p) {
    return Eigen::Map<const Eigen::VectorXd>(&columns[n * p], static_cast<Eigen::Index>(n)).norm();
  };

  // The factor at hand is that of the last Newton step, a hair away: refine with this state's
  // matrix. Far from it the refinement would not converge, so a factor of another state is not
  // tried.
  const double farthest = internal.DistanceOfFactor(x);
  bool refined = false;
  std::vector<double> solution(right.size(), 0.0);
  std::vector<double> residual = right;
  for (int pass = 0; pass < 8 && farthest < NearFactorMm && !refined; ++pass)
  {
    internal.Factor->Solve(residual);
    for (std::size_t k = 0; k < solution.size(); ++k)
    {
      solution[k] += residual[k];
    }
    for (std::size_t p = 0; p < count; ++p)
    {
      internal.Factor->Multiply(internal.Current.Values, &solution[n * p], &residual[n * p]);
    }
    for (std::size_t k = 0; k < solution.size(); ++k)
    {
      residual[k] = right[k] - residual[k];
    }
    refined = true;
    for (std::size_t p = 0; p < count; ++p)
    {
      refined = refined && norm(residual, p) <= 1e-9 * norm(right, p);
    }
  }
  if (!refined)
  {
    internal.FactorPositions.clear();
    if (!internal.Factor->Factorize(internal.Current.Values))
    {
      throw ConvergenceError("sensitivities: expected a stable equilibrium, found a stiffness "
                             "matrix that is not positive definite");
    }
    internal.FactorPositions = x;
    solution = right;
    internal.Factor->Solve(solution);
  }
  for (std::size_t p = 0; p < count; ++p)
  {
    result.emplace_back(x.size(), 0.0);
    for (std::size_t u = 0; u < n; ++u)
    {
      result[p][internal.CoordinateOfUnknown[u]] = solution[n * p + u];
    }
  }
  return result;
}

double EquilibriumSolver::PaddleForceRate(const std::vector<double>& x, const PlatePair& plates,
  const PlatePairVelocity& velocity, const std::vector<double>& nodeVelocities) const
{
  // F = sum of A p(depth) grad d . n. Seen from the paddle only the relative velocity counts; what
  // turns both grad d and n leaves their product as it is.
  const Internals& internal = *this->Internal;
  double rate = 0;
  for (std::size_t active = 0; active < internal.ActiveElements.size(); ++active)
  {
    internal.ForEachContact(active, x, plates,
      [&](const ContactPoint& point)
      {
        if (point.Side == 0)
        {
          return;
        }
        const PlateDistance& distance = point.Distance;
        const Vector3& normal = point.Touched.Normal;
        const Vector3 relative =
          FacePosition(internal.Body, point.Face, point.Shape, nodeVelocities) -
          velocity.Paddle.At(point.Touched, point.Position);
        rate += point.Weight *
          (point.Law.Pressure * distance.Curvature * Dot(distance.Tangent, relative) *
              Dot(distance.Tangent, normal) -
            point.Law.Slope * Dot(distance.Gradient, relative) * Dot(distance.Gradient, normal));
      });
    internal.ForEachFriction(active, x,
      [&](const FrictionPoint& point, const ElasticBody::BoundaryFace& face,
        const std::array<double, 6>& shape, const Vector3& position)
      {
        if (point.Side == 1)
        {
          const FrictionTerms friction(point, plates.Paddle, position);
          const Vector3 relative = FacePosition(internal.Body, face, shape, nodeVelocities) -
            velocity.Paddle.At(plates.Paddle, position);
          rate -= point.SlidingForce * Dot(friction.HessianTimes(relative), plates.Paddle.Normal);
        }
      });
  }
  return 1e-3 * rate;
}

std::vector<double> EquilibriumSolver::Predict(const std::vector<double>& x,
  const PlatePair& plates, const PlatePairVelocity& motion) const
{
  const Internals& internal = *this->Internal;
  std::vector<double> result(x.size(), 0.0);
  if (internal.DistanceOfFactor(x) > 2.0)
  {
    internal.AssembleCurrent(x, &plates);
    if (!internal.Current.Valid || !internal.FactorizeWithFallback(x, &plates))
    {
      return result;
    }
  }
  std::vector<double> solution = internal.PlateForces(x, plates, { motion });
  internal.Factor->Solve(solution);
  for (std::size_t u = 0; u < solution.size(); ++u)
  {
    result[internal.CoordinateOfUnknown[u]] = solution[u];
  }
  return result;
}

double EquilibriumSolver::PeakFactorBytes() const
{
  return this->Internal->Factor->PeakBytes();
}

std::array<double, 2> EquilibriumSolver::Opening(const std::vector<double>& x,
  const PlatePair& plates) const
{
  std::array<double, 2> opening{ 0, 0 };
  const ElasticBody& body = this->Internal->Body;
  for (const std::vector<std::int32_t>& faces : this->Internal->FacesOfElement)
  {
    for (const std::int32_t f : faces)
    {
      const ElasticBody::BoundaryFace& face = body.Faces()[f];
      for (const TrianglePoint& point : TriangleRule())
      {
        const Vector3 position =
          FacePosition(body, face, TriangleShape(point.Lambda, body.NodesPerFace()), x);
        for (int side = 0; side < 2; ++side)
        {
          const Plate& plate = side == 0 ? plates.Support : plates.Paddle;
          const Vector3 offset = position - plate.Edge;
          const double behind = plate.EdgeRadiusMm - Dot(offset, plate.Inward);
          const double reach = plate.EdgeRadiusMm + ContactLayerMm;
          if (behind >= reach)
          {
            continue;
          }
          // Height of the layer over the plate's face, less where it goes round the edge.
          const double layer =
            (behind > 0 ? std::sqrt(reach * reach - behind * behind) : reach) - plate.EdgeRadiusMm;
          opening[side] = std::max(opening[side], layer - Dot(offset, plate.Normal));
        }
      }
    }
  }
  return opening;
}
}
