// SPDX-License-Identifier: Apache-2.0
#include "Private/FrictionEnergy.h"

#include "Private/FacePoints.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace mammoray
{
namespace
{
const Plate& SideOf(const PlatePair& plates, int side)
{
  return side == 0 ? plates.Support : plates.Paddle;
}
}

void FrictionEnergy::SetPoints(FrictionPoints points)
{
  const auto elementOf = [&](const FrictionPoint& point)
  { return this->Part.ElementOfFace(point.Face); };
  std::stable_sort(points.begin(), points.end(),
    [&](const FrictionPoint& a, const FrictionPoint& b) { return elementOf(a) < elementOf(b); });
  this->OrderedPoints = std::move(points);
  this->Starts.clear();
  if (this->OrderedPoints.empty())
  {
    return;
  }
  // Points of faces that cannot move have element -1 and precede those of the first element.
  this->Starts.assign(this->NumberOfPieces() + 1, 0);
  for (const FrictionPoint& point : this->OrderedPoints)
  {
    ++this->Starts[elementOf(point) + 1];
  }
  std::partial_sum(this->Starts.begin(), this->Starts.end(), this->Starts.begin());
}

/// Calls function(FrictionPoint, face, shape functions, position) for the points of an element.
template <typename Function>
void FrictionEnergy::ForEachPoint(std::size_t element, const std::vector<double>& x,
  const Function& function) const
{
  if (this->Starts.empty())
  {
    return;
  }
  const ElasticBody& body = this->Part.Body();
  for (std::size_t p = this->Starts[element]; p < this->Starts[element + 1]; ++p)
  {
    const FrictionPoint& point = this->OrderedPoints[p];
    const ElasticBody::BoundaryFace& face = body.Faces()[point.Face];
    const std::array<double, 6> shape =
      FaceShape(FacePoints()[point.RulePoint], body.NodesPerFace());
    function(point, face, shape, FacePosition(body, face, shape, x));
  }
}

bool FrictionEnergy::Add(std::size_t element, const std::vector<double>& x, EnergyOrder order,
  PieceTerms& terms) const
{
  const int faceNodes = this->Part.Body().NodesPerFace();
  const std::size_t rows = 3 * this->NodesOf(element).size();
  this->ForEachPoint(element, x,
    [&](const FrictionPoint& point, const ElasticBody::BoundaryFace& face,
      const std::array<double, 6>& shape, const Vector3& position)
    {
      const Plate& plate = SideOf(this->CurrentPlates, point.Side);
      const FrictionTerms friction(point, plate, position);
      const Vector3 force = -point.SlidingForce * friction.Gradient();
      terms.Value += point.SlidingForce * friction.Energy;
      terms.Measures.NormalForce[point.Side] += Dot(force, plate.Normal);
      terms.Measures.Friction[point.Side] = terms.Measures.Friction[point.Side] + force;
      if (order == EnergyOrder::Value)
      {
        return;
      }
      const std::array<int, 6>& local = face.LocalNodes;
      for (int a = 0; a < faceNodes; ++a)
      {
        for (int i = 0; i < 3; ++i)
        {
          terms.Gradient[3 * local[a] + i] -= shape[a] * force[i];
        }
      }
      if (order == EnergyOrder::Gradient)
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
  return true;
}

void FrictionEnergy::AddPlateForces(std::size_t element, const std::vector<double>& x,
  const std::vector<PlatePairVelocity>& velocities, std::vector<double>& columns) const
{
  this->ForEachPoint(element, x,
    [&](const FrictionPoint& point, const ElasticBody::BoundaryFace& face,
      const std::array<double, 6>& shape, const Vector3& position)
    {
      const Plate& plate = SideOf(this->CurrentPlates, point.Side);
      const FrictionTerms friction(point, plate, position);
      for (std::size_t p = 0; p < velocities.size(); ++p)
      {
        const PlateVelocity& velocity =
          point.Side == 0 ? velocities[p].Support : velocities[p].Paddle;
        this->Part.AddAtFace(face, shape,
          -point.SlidingForce * friction.GradientDerivative(plate, velocity, position),
          &columns[this->Part.NumberOfUnknowns() * p]);
      }
    });
}

void FrictionEnergy::AddCoefficientForces(std::size_t element, const std::vector<double>& x,
  double rate, double* column) const
{
  this->ForEachPoint(element, x,
    [&](const FrictionPoint& point, const ElasticBody::BoundaryFace& face,
      const std::array<double, 6>& shape, const Vector3& position)
    {
      const FrictionTerms friction(point, SideOf(this->CurrentPlates, point.Side), position);
      this->Part.AddAtFace(face, shape, -rate * point.NormalForce * friction.Gradient(), column);
    });
}

void FrictionEnergy::AddPaddleForceDerivative(std::size_t element, const std::vector<double>& x,
  const PlatePairVelocity& velocity, const std::vector<double>& nodeVelocities, double& rate) const
{
  const Plate& paddle = this->CurrentPlates.Paddle;
  this->ForEachPoint(element, x,
    [&](const FrictionPoint& point, const ElasticBody::BoundaryFace& face,
      const std::array<double, 6>& shape, const Vector3& position)
    {
      if (point.Side == 1)
      {
        const FrictionTerms friction(point, paddle, position);
        const Vector3 relative = FacePosition(this->Part.Body(), face, shape, nodeVelocities) -
          velocity.Paddle.VelocityAt(paddle, position);
        rate -= point.SlidingForce * Dot(friction.HessianTimes(relative), paddle.Normal);
      }
    });
}

FrictionPoints FrictionOfContact(const MovingPart& part, const ContactEnergy& contact,
  const std::vector<double>& x, const PlatePair& plates, double coefficient,
  const FrictionStart& before)
{
  FrictionPoints ordered = before.Dragged;
  std::sort(ordered.begin(), ordered.end(), Precedes);
  FrictionPoints result;
  for (const std::int32_t element : part.Elements())
  {
    for (const ContactPoint& touching : contact.PointsAt(element, x, plates))
    {
      FrictionPoint point;
      point.Face = touching.FaceIndex;
      point.RulePoint = touching.RulePoint;
      point.Side = touching.Side;
      point.NormalForce = touching.Weight * touching.Law.Pressure;
      point.SlidingForce = coefficient * point.NormalForce;
      point.Normal = DirectionInPlate(touching.TouchedPlate, touching.Distance.Gradient);
      const auto found = std::lower_bound(ordered.begin(), ordered.end(), point, Precedes);
      point.Anchor = found != ordered.end() && !Precedes(point, *found)
        ? found->Anchor
        : PointInPlate(SideOf(before.Plates, point.Side),
            FacePosition(part.Body(), touching.Face, touching.Shape, before.Positions));
      result.push_back(point);
    }
  }
  return result;
}

FrictionPoints DraggedTo(const ElasticBody& body, const std::vector<double>& x,
  const PlatePair& plates, FrictionPoints points)
{
  for (FrictionPoint& point : points)
  {
    const std::array<double, 6> shape =
      FaceShape(FacePoints()[point.RulePoint], body.NodesPerFace());
    point = Dragged(point, SideOf(plates, point.Side),
      FacePosition(body, body.Faces()[point.Face], shape, x));
  }
  return points;
}
}
