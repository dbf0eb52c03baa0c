// SPDX-License-Identifier: Apache-2.0
#include "Private/AttachmentEnergy.h"

#include "Private/CellPatches.h"
#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace mammoray
{
namespace
{
/// Radius of a triangle's influence, in mean sides: smooth from one triangle to the next, yet the
/// wall's curvature over several triangles is kept.
constexpr double ReachInSides = 1.5;
/// Weights whose exponent is this far below the largest one are below roundoff.
constexpr double NegligibleExponent = 40;

/// a += s (u v^T + v u^T)
void AddSymmetric(std::array<Vector3, 3>& a, double s, const Vector3& u, const Vector3& v)
{
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 3; ++j)
    {
      a[i][j] += s * (u[i] * v[j] + v[i] * u[j]);
    }
  }
}

void AddDiagonal(std::array<Vector3, 3>& a, double s)
{
  for (int i = 0; i < 3; ++i)
  {
    a[i][i] += s;
  }
}

/// A triangle between a fixed cell and another one, as a face of the latter.
struct Interface
{
  std::int32_t Cell = 0;
  int Face = 0;
};

std::vector<Interface> FindInterface(const ElasticBody& body, const std::vector<bool>& fixedCells)
{
  struct Sides
  {
    Interface Free{ -1, 0 };
    bool Fixed = false;
  };
  std::map<std::array<std::int32_t, 3>, Sides> faces;
  for (std::size_t cell = 0; cell < body.NumberOfCells(); ++cell)
  {
    const std::int32_t* nodes = &body.Cells()[body.NodesPerCell() * cell];
    for (int face = 0; face < 4; ++face)
    {
      const int* local = FaceCorners[face];
      std::array<std::int32_t, 3> key{ nodes[local[0]], nodes[local[1]], nodes[local[2]] };
      std::sort(key.begin(), key.end());
      Sides& sides = faces[key];
      if (fixedCells[cell])
      {
        sides.Fixed = true;
      }
      else
      {
        sides.Free = { static_cast<std::int32_t>(cell), face };
      }
    }
  }
  std::vector<Interface> result;
  for (const auto& [key, sides] : faces)
  {
    if (sides.Fixed && sides.Free.Cell >= 0)
    {
      result.push_back(sides.Free);
    }
  }
  return result;
}
}

AttachmentEnergy::AttachmentEnergy(const ElasticBody& body, const std::vector<bool>& fixedCells,
  const WallStiffness& stiffness)
  : Stiffness(stiffness)
{
  const std::vector<double>& rest = body.RestPositions();
  std::map<std::int32_t, double> areas;
  double sides = 0;
  for (const Interface& face : FindInterface(body, fixedCells))
  {
    const std::int32_t* nodes = &body.Cells()[body.NodesPerCell() * face.Cell];
    const int* local = FaceCorners[face.Face];
    Vector3 corners[3];
    for (int c = 0; c < 3; ++c)
    {
      corners[c] = NodePosition(rest, nodes[local[c]]);
    }
    const Vector3 outwards = 0.5 * Cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double area = Norm(outwards);
    this->Triangles.push_back(
      { (1 / 3.0) * (corners[0] + corners[1] + corners[2]), (-1 / area) * outwards, area });
    // Areas come from the four triangles between corners and mid-side nodes, because every node's
    // share is then positive; integrals of the quadratic shape functions are not.
    const bool quadratic = body.Type() == ElementType::Quadratic;
    for (int c = 0; c < 3; ++c)
    {
      areas[nodes[local[c]]] += (quadratic ? 1 / 12.0 : 1 / 3.0) * area;
      if (quadratic)
      {
        areas[nodes[FaceMiddles[face.Face][c]]] += 0.25 * area;
      }
    }
    sides +=
      Norm(corners[1] - corners[0]) + Norm(corners[2] - corners[1]) + Norm(corners[0] - corners[2]);
  }
  if (this->Triangles.empty())
  {
    throw InputError("chest wall: expected tissue that meets fixed cells, found none");
  }
  const double reach = ReachInSides * sides / (3.0 * static_cast<double>(this->Triangles.size()));
  this->Sharpness = 1 / (reach * reach);
  for (const auto& [node, area] : areas)
  {
    this->NodeIndices.push_back(node);
    this->NodeValues.push_back({});
    this->NodeValues.back().Area = area;
  }
  this->SetRestPositions(rest);
}

void AttachmentEnergy::SetRestPositions(const std::vector<double>& rest)
{
  for (std::size_t n = 0; n < this->NodeIndices.size(); ++n)
  {
    Node& node = this->NodeValues[n];
    node.Rest = NodePosition(rest, this->NodeIndices[n]);
    const SurfaceHeight height = this->HeightAt(node.Rest);
    node.RestHeight = height.Value;
    node.Normal = (1 / Norm(height.Gradient)) * height.Gradient;
  }
}

SurfaceHeight AttachmentEnergy::HeightAt(const Vector3& x) const
{
  double nearest = std::numeric_limits<double>::infinity();
  for (const Triangle& triangle : this->Triangles)
  {
    const Vector3 r = x - triangle.Middle;
    nearest = std::min(nearest, Dot(r, r));
  }
  // With W = sum w_i and S = sum w_i s_i, s_i = n_i . (x - c_i): differentiate h W = S twice.
  // Weights relative to the nearest triangle's cannot all vanish; the factor cancels in h.
  double weightSum = 0;
  double heightSum = 0;
  Vector3 weightGradient{ 0, 0, 0 };
  Vector3 heightGradient{ 0, 0, 0 };
  std::array<Vector3, 3> weightHessian{};
  std::array<Vector3, 3> heightHessian{};
  const double a = this->Sharpness;
  for (const Triangle& triangle : this->Triangles)
  {
    const Vector3 r = x - triangle.Middle;
    const double exponent = a * (Dot(r, r) - nearest);
    if (exponent > NegligibleExponent)
    {
      continue;
    }
    const double w = triangle.Area * std::exp(-exponent);
    const double s = Dot(triangle.Normal, r);
    weightSum += w;
    heightSum += w * s;
    const Vector3 slope = (-2 * a * w) * r;
    weightGradient = weightGradient + slope;
    heightGradient = heightGradient + s * slope + w * triangle.Normal;
    AddSymmetric(weightHessian, 2 * a * a * w, r, r);
    AddDiagonal(weightHessian, -2 * a * w);
    AddSymmetric(heightHessian, 2 * a * a * w * s, r, r);
    AddDiagonal(heightHessian, -2 * a * w * s);
    AddSymmetric(heightHessian, 1, slope, triangle.Normal);
  }
  SurfaceHeight result;
  result.Value = heightSum / weightSum;
  result.Gradient = (1 / weightSum) * (heightGradient - result.Value * weightGradient);
  AddSymmetric(result.Hessian, -1 / weightSum, result.Gradient, weightGradient);
  for (int i = 0; i < 3; ++i)
  {
    result.Hessian[i] =
      result.Hessian[i] + (1 / weightSum) * (heightHessian[i] - result.Value * weightHessian[i]);
  }
  return result;
}

AttachmentEnergy::Terms AttachmentEnergy::NodeTerms(std::size_t n, const Vector3& x,
  const WallStiffness& stiffness, bool projected) const
{
  const Node& node = this->NodeValues[n];
  const SurfaceHeight height = this->HeightAt(x);
  const double lift = height.Value - node.RestHeight;
  const Vector3 way = x - node.Rest;
  const Vector3 along = way - Dot(node.Normal, way) * node.Normal;
  const double across = node.Area * stiffness.Normal;
  const double tangential = node.Area * stiffness.Tangential;
  Terms terms;
  terms.LiftMm = lift;
  terms.GlideMm = Norm(along);
  terms.Energy = 0.5 * across * lift * lift + 0.5 * tangential * Dot(along, along);
  terms.Gradient = (across * lift) * height.Gradient + tangential * along;
  AddSymmetric(terms.Hessian, 0.5 * across, height.Gradient, height.Gradient);
  AddDiagonal(terms.Hessian, tangential);
  AddSymmetric(terms.Hessian, -0.5 * tangential, node.Normal, node.Normal);
  for (int i = 0; i < 3 && !projected; ++i)
  {
    terms.Hessian[i] = terms.Hessian[i] + (across * lift) * height.Hessian[i];
  }
  return terms;
}

std::array<Vector3, 3> AttachmentEnergy::NodeRestDerivative(std::size_t n, const Vector3& x) const
{
  const Node& node = this->NodeValues[n];
  const SurfaceHeight there = this->HeightAt(node.Rest);
  const Vector3 upwards = this->HeightAt(x).Gradient;
  const Vector3 way = x - node.Rest;
  const double across = node.Area * this->Stiffness.Normal;
  const double tangential = node.Area * this->Stiffness.Tangential;
  std::array<Vector3, 3> result{};
  for (int k = 0; k < 3; ++k)
  {
    // The normal turns with the position: dn = P H e_k / |grad h|.
    const Vector3 bend = (1 / Norm(there.Gradient)) * there.Hessian[k];
    const Vector3 turn = bend - Dot(node.Normal, bend) * node.Normal;
    Vector3 unit{ 0, 0, 0 };
    unit[k] = 1;
    const Vector3 along = -1.0 * unit + node.Normal[k] * node.Normal -
      Dot(node.Normal, way) * turn - Dot(turn, way) * node.Normal;
    const Vector3 column = (-across * there.Gradient[k]) * upwards + tangential * along;
    for (int i = 0; i < 3; ++i)
    {
      result[i][k] = column[i];
    }
  }
  return result;
}

bool AttachmentEnergy::Add(std::size_t n, const std::vector<double>& x, EnergyOrder order,
  PieceTerms& terms) const
{
  const Terms node = this->NodeTerms(n, NodePosition(x, this->NodeIndices[n]), this->Stiffness,
    order == EnergyOrder::ProjectedHessian);
  terms.Value += node.Energy;
  terms.Measures.WallLift = std::max(terms.Measures.WallLift, std::abs(node.LiftMm));
  terms.Measures.WallGlide = std::max(terms.Measures.WallGlide, node.GlideMm);
  for (int i = 0; i < 3 && order >= EnergyOrder::Gradient; ++i)
  {
    terms.Gradient[i] += node.Gradient[i];
    for (int j = 0; j < 3 && order >= EnergyOrder::Hessian; ++j)
    {
      terms.Hessian[3 * i + j] += node.Hessian[i][j];
    }
  }
  return true;
}
}
