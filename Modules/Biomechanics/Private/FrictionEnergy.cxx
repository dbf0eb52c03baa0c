// SPDX-License-Identifier: Apache-2.0
#include "Private/FrictionEnergy.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

namespace mammoray
{
namespace
{
Vector3 Tangential(const Vector3& normal, const Vector3& v)
{
  return v - Dot(normal, v) * normal;
}

const Plate& SideOf(const PlatePair& plates, int side)
{
  return side == 0 ? plates.Support : plates.Paddle;
}
}

Vector3 DirectionInPlate(const Plate& plate, const Vector3& direction)
{
  return { Dot(direction, Cross(plate.Normal, plate.Inward)), Dot(direction, plate.Inward),
    Dot(direction, plate.Normal) };
}

Vector3 DirectionFromPlate(const Plate& plate, const Vector3& direction)
{
  return direction[0] * Cross(plate.Normal, plate.Inward) + direction[1] * plate.Inward +
    direction[2] * plate.Normal;
}

Vector3 PointInPlate(const Plate& plate, const Vector3& point)
{
  return DirectionInPlate(plate, point - plate.Edge);
}

Vector3 PointFromPlate(const Plate& plate, const Vector3& point)
{
  return plate.Edge + DirectionFromPlate(plate, point);
}

FrictionTerms::FrictionTerms(const FrictionPoint& point, const Plate& plate, const Vector3& x)
  : Normal(DirectionFromPlate(plate, point.Normal))
  , Anchor(PointFromPlate(plate, point.Anchor))
{
  constexpr double e = FrictionPoint::SlipMm;
  this->Slip = Tangential(this->Normal, x - this->Anchor);
  const double y = Norm(this->Slip);
  if (y < e)
  {
    this->Energy = y * y / e - y * y * y / (3 * e * e) + e / 3;
    this->Ratio = 2 / e - y / (e * e);
    this->Curvature = 2 / e - 2 * y / (e * e);
  }
  else
  {
    this->Energy = y;
    this->Ratio = 1 / y;
  }
}

Vector3 FrictionTerms::HessianTimes(const Vector3& v) const
{
  const Vector3 along = Tangential(this->Normal, v);
  const double square = Dot(this->Slip, this->Slip);
  const double part = square > 0 ? Dot(this->Slip, along) / square : 0;
  return this->Ratio * along + ((this->Curvature - this->Ratio) * part) * this->Slip;
}

Vector3 FrictionTerms::GradientDerivative(const Plate& plate, const PlateVelocity& velocity,
  const Vector3& x) const
{
  // u = (I - n n^T) d with d = x - c; gradient = g(|u|) u with g = f' / y. c and n move with the
  // plate.
  const Vector3 d = x - this->Anchor;
  const Vector3 turn = Cross(velocity.Angular, this->Normal);
  const Vector3 slipRate =
    -1.0 * Tangential(this->Normal, velocity.VelocityAt(plate, this->Anchor)) -
    Dot(this->Normal, d) * turn - Dot(turn, d) * this->Normal;
  const double square = Dot(this->Slip, this->Slip);
  const double part = square > 0 ? Dot(this->Slip, slipRate) / square : 0;
  return this->Ratio * slipRate + ((this->Curvature - this->Ratio) * part) * this->Slip;
}

bool Precedes(const FrictionPoint& a, const FrictionPoint& b)
{
  return std::tie(a.Face, a.RulePoint, a.Side) < std::tie(b.Face, b.RulePoint, b.Side);
}

FrictionPoints BlendedFriction(FrictionPoints a, FrictionPoints b, double part)
{
  // Points below this fraction of the largest force only cost time.
  constexpr double negligible = 1e-9;
  std::sort(a.begin(), a.end(), Precedes);
  std::sort(b.begin(), b.end(), Precedes);
  FrictionPoints blend;
  const auto add = [&blend](FrictionPoint point, double force)
  {
    const double factor = force / point.NormalForce;
    point.NormalForce *= factor;
    point.SlidingForce *= factor;
    blend.push_back(point);
  };
  for (std::size_t i = 0, j = 0; i < a.size() || j < b.size();)
  {
    if (j == b.size() || (i < a.size() && Precedes(a[i], b[j])))
    {
      add(a[i], (1 - part) * a[i].NormalForce);
      ++i;
    }
    else if (i == a.size() || Precedes(b[j], a[i]))
    {
      add(b[j], part * b[j].NormalForce);
      ++j;
    }
    else
    {
      add(b[j], (1 - part) * a[i].NormalForce + part * b[j].NormalForce);
      ++i;
      ++j;
    }
  }
  double largest = 0;
  for (const FrictionPoint& point : blend)
  {
    largest = std::max(largest, point.NormalForce);
  }
  std::erase_if(blend,
    [=](const FrictionPoint& point) { return point.NormalForce <= negligible * largest; });
  return blend;
}

FrictionPoint Dragged(const FrictionPoint& point, const Plate& plate, const Vector3& x)
{
  const FrictionTerms terms(point, plate, x);
  const double slip = Norm(terms.Slip);
  if (slip <= FrictionPoint::SlipMm)
  {
    return point;
  }
  FrictionPoint dragged = point;
  dragged.Anchor = PointInPlate(plate, x - (FrictionPoint::SlipMm / slip) * terms.Slip);
  return dragged;
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
      double block[3][3];
      for (int j = 0; j < 3; ++j)
      {
        Vector3 axis{ 0, 0, 0 };
        axis[j] = 1;
        const Vector3 column = point.SlidingForce * friction.HessianTimes(axis);
        for (int i = 0; i < 3; ++i)
        {
          block[i][j] = column[i];
        }
      }
      AddFaceHessian(face, faceNodes, shape, block, rows, terms.Hessian);
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
