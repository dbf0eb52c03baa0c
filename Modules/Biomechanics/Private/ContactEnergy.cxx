// SPDX-License-Identifier: Apache-2.0
#include "Private/ContactEnergy.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
const std::vector<FacePoint>& FacePoints()
{
  static const std::vector<FacePoint> points = []
  {
    constexpr int n = 8;
    std::vector<FacePoint> made;
    for (int i = 0; i < n; ++i)
    {
      for (int j = 0; i + j < n; ++j)
      {
        // Small triangles of both orientations.
        for (int down = 0; down < (i + j + 1 < n ? 2 : 1); ++down)
        {
          const double shift = down ? 2 / 3.0 : 1 / 3.0;
          const double a = (i + shift) / n;
          const double b = (j + shift) / n;
          made.push_back({ { a, b, 1 - a - b }, 1.0 / (n * n) });
        }
      }
    }
    return made;
  }();
  return points;
}

ContactLaw::ContactLaw(double stiffness, double depth)
{
  const double inner = std::min(depth, ContactEnergy::LayerMm);
  const double outer = depth - inner;
  this->Slope = 2 * stiffness * inner;
  this->Pressure = stiffness * inner * inner + this->Slope * outer;
  this->Energy = stiffness * inner * (inner * inner / 3 + inner * outer + outer * outer);
}

void AddFaceHessian(const ElasticBody::BoundaryFace& face, int faceNodes,
  const std::array<double, 6>& shape, const double (&block)[3][3], std::size_t rows,
  std::span<double> hessian)
{
  for (int a = 0; a < faceNodes; ++a)
  {
    for (int b = 0; b < faceNodes; ++b)
    {
      const double shapes = shape[a] * shape[b];
      for (int i = 0; i < 3; ++i)
      {
        for (int j = 0; j < 3; ++j)
        {
          hessian[rows * (3 * face.LocalNodes[b] + j) + 3 * face.LocalNodes[a] + i] +=
            shapes * block[i][j];
        }
      }
    }
  }
}

/// Calls function(ContactPoint) for every point of an element that lies in a plate's layer.
template <typename Function>
void ContactEnergy::ForEachPoint(std::size_t element, const std::vector<double>& x,
  const PlatePair& plates, const Function& function) const
{
  const ElasticBody& body = this->Part.Body();
  const std::span<const std::int32_t> nodes = body.NodesOf(element);
  const int faceNodes = body.NodesPerFace();
  const std::vector<FacePoint>& rule = FacePoints();
  const Plate* sides[2] = { &plates.Support, &plates.Paddle };
  for (const std::int32_t f : this->Part.FacesOf(element))
  {
    const ElasticBody::BoundaryFace& face = body.Faces()[f];
    Vector3 centre{ 0, 0, 0 };
    for (int a = 0; a < faceNodes; ++a)
    {
      centre = centre + (1.0 / faceNodes) * NodePosition(x, nodes[face.LocalNodes[a]]);
    }
    double radius = 0;
    for (int a = 0; a < faceNodes; ++a)
    {
      radius = std::max(radius, Norm(NodePosition(x, nodes[face.LocalNodes[a]]) - centre));
    }
    // The magnitudes of the shape functions sum to at most 5/3, and a distance changes no faster
    // than the position.
    const double near = LayerMm + 5 / 3.0 * radius;
    const bool mayTouch[2] = { DistanceToPlate(plates.Support, centre).Distance < near,
      DistanceToPlate(plates.Paddle, centre).Distance < near };
    if (!mayTouch[0] && !mayTouch[1])
    {
      continue;
    }
    for (std::size_t k = 0; k < rule.size(); ++k)
    {
      const std::array<double, 6> shape = FaceShape(rule[k], faceNodes);
      const Vector3 position = FacePosition(body, face, shape, x);
      for (std::int16_t side = 0; side < 2; ++side)
      {
        const PlateDistance distance = DistanceToPlate(*sides[side], position);
        const double depth = LayerMm - distance.Distance;
        if (mayTouch[side] && depth > 0)
        {
          function(ContactPoint{ face, f, static_cast<std::int16_t>(k), shape, position, side,
            *sides[side], distance, ContactLaw(this->StiffnessValue, depth),
            rule[k].Weight * face.Area });
        }
      }
    }
  }
}

bool ContactEnergy::Add(std::size_t element, const std::vector<double>& x, EnergyOrder order,
  PieceTerms& terms) const
{
  const int faceNodes = this->Part.Body().NodesPerFace();
  const std::size_t rows = 3 * this->NodesOf(element).size();
  this->ForEachPoint(element, x, this->CurrentPlates,
    [&](const ContactPoint& point)
    {
      const double force = point.Weight * point.Law.Pressure;
      terms.Value += point.Weight * point.Law.Energy;
      terms.Measures.Penetration = std::max(terms.Measures.Penetration, -point.Distance.Distance);
      terms.Measures.NormalForce[point.Side] +=
        force * Dot(point.Distance.Gradient, point.TouchedPlate.Normal);
      if (order == EnergyOrder::Value)
      {
        return;
      }
      const std::array<int, 6>& local = point.Face.LocalNodes;
      for (int a = 0; a < faceNodes; ++a)
      {
        for (int i = 0; i < 3; ++i)
        {
          terms.Gradient[3 * local[a] + i] -= force * point.Shape[a] * point.Distance.Gradient[i];
        }
      }
      if (order == EnergyOrder::Gradient)
      {
        return;
      }
      const double along = point.Weight * point.Law.Slope;
      const double across =
        order == EnergyOrder::ProjectedHessian ? 0.0 : -force * point.Distance.Curvature;
      double block[3][3];
      for (int i = 0; i < 3; ++i)
      {
        for (int j = 0; j < 3; ++j)
        {
          block[i][j] = along * point.Distance.Gradient[i] * point.Distance.Gradient[j] +
            across * point.Distance.Tangent[i] * point.Distance.Tangent[j];
        }
      }
      AddFaceHessian(point.Face, faceNodes, point.Shape, block, rows, terms.Hessian);
    });
  return true;
}

std::vector<ContactPoint> ContactEnergy::PointsAt(std::size_t element, const std::vector<double>& x,
  const PlatePair& plates) const
{
  std::vector<ContactPoint> points;
  this->ForEachPoint(element, x, plates,
    [&](const ContactPoint& point) { points.push_back(point); });
  return points;
}

void ContactEnergy::AddPlateForces(std::size_t element, const std::vector<double>& x,
  const std::vector<PlatePairVelocity>& velocities, std::vector<double>& columns) const
{
  // Let b(d) be the contact energy per area and d the distance to a plate moved by v = L + w x r.
  // Then d(grad b)/dp = b' w x grad d - hess(b) v, since grad d turns with the plate.
  this->ForEachPoint(element, x, this->CurrentPlates,
    [&](const ContactPoint& point)
    {
      const double slope = -point.Weight * point.Law.Pressure;
      const double along = point.Weight * point.Law.Slope;
      const PlateDistance& distance = point.Distance;
      for (std::size_t p = 0; p < velocities.size(); ++p)
      {
        const PlateVelocity& velocity =
          point.Side == 0 ? velocities[p].Support : velocities[p].Paddle;
        const Vector3 v = velocity.VelocityAt(point.TouchedPlate, point.Position);
        const Vector3 force = (along * Dot(distance.Gradient, v)) * distance.Gradient +
          (slope * distance.Curvature * Dot(distance.Tangent, v)) * distance.Tangent -
          slope * Cross(velocity.Angular, distance.Gradient);
        this->Part.AddAtFace(point.Face, point.Shape, force,
          &columns[this->Part.NumberOfUnknowns() * p]);
      }
    });
}

void ContactEnergy::AddRestForces(std::size_t element, const std::vector<double>& x,
  const std::vector<double>& restVelocities, double* column) const
{
  this->ForEachPoint(element, x, this->CurrentPlates,
    [&](const ContactPoint& point)
    {
      const double growth =
        this->Part.Body().FaceAreaRate(point.Face, restVelocities) / point.Face.Area;
      this->Part.AddAtFace(point.Face, point.Shape,
        (growth * point.Weight * point.Law.Pressure) * point.Distance.Gradient, column);
    });
}

void ContactEnergy::AddPaddleForceDerivative(std::size_t element, const std::vector<double>& x,
  const PlatePairVelocity& velocity, const std::vector<double>& nodeVelocities, double& rate) const
{
  // F = sum of A p(depth) grad d . n. Only the velocity relative to the paddle matters: a rotation
  // turns both grad d and n.
  this->ForEachPoint(element, x, this->CurrentPlates,
    [&](const ContactPoint& point)
    {
      if (point.Side == 0)
      {
        return;
      }
      const PlateDistance& distance = point.Distance;
      const Vector3& normal = point.TouchedPlate.Normal;
      const Vector3 relative =
        FacePosition(this->Part.Body(), point.Face, point.Shape, nodeVelocities) -
        velocity.Paddle.VelocityAt(point.TouchedPlate, point.Position);
      rate += point.Weight *
        (point.Law.Pressure * distance.Curvature * Dot(distance.Tangent, relative) *
            Dot(distance.Tangent, normal) -
          point.Law.Slope * Dot(distance.Gradient, relative) * Dot(distance.Gradient, normal));
    });
}

std::vector<double> ContactEnergy::NodePressures(const std::vector<double>& x) const
{
  const ElasticBody& body = this->Part.Body();
  std::vector<double> force(body.NumberOfNodes(), 0.0);
  std::vector<double> area(body.NumberOfNodes(), 0.0);
  for (const std::int32_t element : this->Part.Elements())
  {
    for (const std::int32_t f : this->Part.FacesOf(element))
    {
      const ElasticBody::BoundaryFace& face = body.Faces()[f];
      for (int c = 0; c < 3; ++c)
      {
        area[body.NodesOf(face.Element)[face.LocalNodes[c]]] += face.Area / 3;
      }
    }
    this->ForEachPoint(element, x, this->CurrentPlates,
      [&](const ContactPoint& point)
      {
        const std::array<double, 3>& lambda = FacePoints()[point.RulePoint].Lambda;
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

std::array<double, 2> ContactEnergy::Opening(const std::vector<double>& x,
  const PlatePair& plates) const
{
  std::array<double, 2> opening{ 0, 0 };
  const ElasticBody& body = this->Part.Body();
  for (const std::int32_t element : this->Part.Elements())
  {
    for (const std::int32_t f : this->Part.FacesOf(element))
    {
      const ElasticBody::BoundaryFace& face = body.Faces()[f];
      for (const FacePoint& point : FacePoints())
      {
        const Vector3 position = FacePosition(body, face, FaceShape(point, body.NodesPerFace()), x);
        for (int side = 0; side < 2; ++side)
        {
          const Plate& plate = side == 0 ? plates.Support : plates.Paddle;
          const Vector3 offset = position - plate.Edge;
          const double behind = plate.EdgeRadiusMm - Dot(offset, plate.Inward);
          const double reach = plate.EdgeRadiusMm + LayerMm;
          if (behind >= reach)
          {
            continue;
          }
          // Height of the layer over the plate's face, less around the edge.
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
