// SPDX-License-Identifier: Apache-2.0
#include "Private/EquilibriumEnergy.h"

#include "mammoray/Foundation/ParallelFor.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
/// The part of the body that is relaxed alone: nodes with at least this fraction of the largest
/// residual force and so many layers of elements around them, unless they exceed this fraction of
/// the unknowns.
constexpr double WorstForce = 0.1;
constexpr int LayersAroundWorst = 2;
constexpr double LargestPart = 0.2;

double SquaredNorm(const std::vector<double>& v)
{
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()))
    .squaredNorm();
}
}

EquilibriumEnergy::EquilibriumEnergy(const ElasticBody& body, const std::vector<bool>& fixed,
  double contactStiffness, const std::vector<bool>& rigid)
  : Moving(body, fixed, rigid)
  , BodyTerm(body)
  , ContactTerm(Moving, contactStiffness)
  , FrictionTerm(Moving)
  , LoadTerm(body)
{
  this->MeasureScales();
  this->MakePattern();
  this->MakeScatter();
  this->Elements.resize(this->Moving.Elements().size());
}

void EquilibriumEnergy::BodyChanged()
{
  this->MeasureScales();
  ++this->Changes;
}

void EquilibriumEnergy::SetDomain(ElasticEnergy::Domain domain)
{
  this->Changes += domain != this->BodyTerm.GetDomain();
  this->BodyTerm.SetDomain(domain);
}

void EquilibriumEnergy::SetPlates(const PlatePair* plates)
{
  this->Changes += this->HasPlates != (plates != nullptr);
  this->HasPlates = plates != nullptr;
  if (plates)
  {
    this->Changes += *plates != this->ContactTerm.Plates();
    this->ContactTerm.SetPlates(*plates);
    this->FrictionTerm.SetPlates(*plates);
  }
}

void EquilibriumEnergy::SetContactStiffness(double stiffness)
{
  this->Changes += stiffness != this->ContactTerm.Stiffness();
  this->ContactTerm.SetStiffness(stiffness);
}

void EquilibriumEnergy::SetFriction(FrictionPoints points)
{
  this->Changes += !points.empty() || !this->FrictionTerm.Points().empty();
  this->FrictionTerm.SetPoints(std::move(points));
}

void EquilibriumEnergy::SetAttachment(const AttachmentEnergy* attachment)
{
  ++this->Changes;
  this->WallTerm = attachment;
}

void EquilibriumEnergy::SetLoads(std::vector<double> loads)
{
  if (loads != this->LoadTerm.Forces())
  {
    ++this->Changes;
    this->LoadTerm.SetForces(std::move(loads));
  }
}

void EquilibriumEnergy::MeasureScales()
{
  const ElasticBody& body = this->Moving.Body();
  double stiffness = 0;
  this->VolumeAtRest = this->Moving.RigidVolume();
  for (const std::int32_t element : this->Moving.Elements())
  {
    stiffness += body.ElementShearModulus(element) * body.ElementVolume(element);
    this->VolumeAtRest += body.ElementVolume(element);
  }
  this->EnergyNoise = 1e-13 * 1.5 * stiffness;
  this->SmallestForce = 1e-4 * stiffness / std::cbrt(this->VolumeAtRest);
}

void EquilibriumEnergy::MakePattern()
{
  // Collect the elements of every node, then the nodes with which each node shares an element.
  const std::vector<std::int32_t>& unknown = this->Moving.Unknowns();
  std::vector<std::vector<std::int32_t>> movingOfNode(this->Moving.Body().NumberOfNodes());
  for (std::size_t moving = 0; moving < this->Moving.Elements().size(); ++moving)
  {
    for (const std::int32_t node : this->NodesOf(moving))
    {
      movingOfNode[node].push_back(static_cast<std::int32_t>(moving));
    }
  }
  std::vector<std::int32_t> near;
  std::vector<int> unknowns;
  std::int32_t nodeOfLast = -1;
  for (std::size_t u = 0; u < this->Moving.NumberOfUnknowns(); ++u)
  {
    const std::int32_t node = this->Moving.Coordinates()[u] / 3;
    if (node != nodeOfLast)
    {
      near.clear();
      for (const std::int32_t moving : movingOfNode[node])
      {
        const std::span<const std::int32_t> nodes = this->NodesOf(moving);
        near.insert(near.end(), nodes.begin(), nodes.end());
      }
      std::sort(near.begin(), near.end());
      near.erase(std::unique(near.begin(), near.end()), near.end());
      unknowns.clear();
      for (const std::int32_t other : near)
      {
        for (int axis = 0; axis < 3; ++axis)
        {
          if (unknown[3 * other + axis] >= 0)
          {
            unknowns.push_back(unknown[3 * other + axis]);
          }
        }
      }
      nodeOfLast = node;
    }
    // Unknowns are numbered in the order of the coordinates, so these ascend.
    this->HessianPattern.Rows.insert(this->HessianPattern.Rows.end(),
      std::lower_bound(unknowns.begin(), unknowns.end(), static_cast<int>(u)), unknowns.end());
    this->HessianPattern.Starts.push_back(static_cast<int>(this->HessianPattern.Rows.size()));
  }
}

void EquilibriumEnergy::MakeScatter()
{
  const std::vector<std::int32_t>& unknown = this->Moving.Unknowns();
  this->ScatterStarts.assign(1, 0);
  for (std::size_t moving = 0; moving < this->Moving.Elements().size(); ++moving)
  {
    const std::size_t rows = 3 * this->NodesOf(moving).size();
    this->ScatterStarts.push_back(this->ScatterStarts.back() + rows * (rows + 1) / 2);
  }
  this->Scatter.resize(this->ScatterStarts.back());
  ParallelFor(this->Moving.Elements().size(),
    [&](std::size_t moving)
    {
      std::int32_t* scatter = &this->Scatter[this->ScatterStarts[moving]];
      const std::size_t rows = 3 * this->NodesOf(moving).size();
      for (std::size_t c = 0; c < rows; ++c)
      {
        for (std::size_t r = c; r < rows; ++r)
        {
          const auto [column, row] = std::minmax(unknown[this->CoordinateOf(moving, c)],
            unknown[this->CoordinateOf(moving, r)]);
          *scatter++ =
            column >= 0 ? static_cast<std::int32_t>(this->HessianPattern.PlaceOf(column, row)) : -1;
        }
      }
    });
}

void EquilibriumEnergy::EvaluateElement(std::size_t moving, const std::vector<double>& x,
  EnergyOrder order)
{
  ElementWork& work = this->Elements[moving];
  const auto element = static_cast<std::size_t>(this->Moving.Elements()[moving]);
  const std::size_t rows = 3 * this->NodesOf(moving).size();
  PieceTerms ofBody;
  PieceTerms ofContact;
  if (order >= EnergyOrder::Gradient)
  {
    work.BodyGradient.assign(rows, 0.0);
    work.ContactGradient.assign(rows, 0.0);
    ofBody.Gradient = work.BodyGradient;
    ofContact.Gradient = work.ContactGradient;
  }
  // One matrix per thread stays in the processor's cache.
  thread_local std::vector<double> hessian;
  if (order >= EnergyOrder::Hessian)
  {
    hessian.assign(rows * rows, 0.0);
    ofBody.Hessian = ofContact.Hessian = hessian;
  }
  work.Valid = this->BodyTerm.Add(element, x, order, ofBody);
  if (!work.Valid)
  {
    return;
  }
  if (this->HasPlates)
  {
    this->ContactTerm.Add(element, x, order, ofContact);
    this->FrictionTerm.Add(element, x, order, ofContact);
  }
  work.Value = ofBody.Value + ofContact.Value;
  work.Measures = ofBody.Measures;
  work.Measures.Add(ofContact.Measures);
  if (order >= EnergyOrder::Hessian)
  {
    work.LowerHalf.resize(rows * (rows + 1) / 2);
    auto to = work.LowerHalf.begin();
    for (std::size_t c = 0; c < rows; ++c)
    {
      to = std::copy_n(hessian.begin() + rows * c + c, rows - c, to);
    }
  }
}

void EquilibriumEnergy::Evaluate(const std::vector<double>& x, EnergyOrder order,
  Evaluation& result)
{
  ParallelFor(this->Elements.size(),
    [&](std::size_t moving) { this->EvaluateElement(moving, x, order); });
  result.Valid = std::all_of(this->Elements.begin(), this->Elements.end(),
    [](const ElementWork& work) { return work.Valid; });
  if (!result.Valid)
  {
    return;
  }
  if (order >= EnergyOrder::Gradient)
  {
    result.Gradient.assign(x.size(), 0.0);
  }
  if (order >= EnergyOrder::Hessian)
  {
    result.Hessian.assign(this->HessianPattern.Rows.size(), 0.0);
  }
  ForceNorms norms;
  this->SumElements(order, result, norms);
  this->AddLoads(x, order, result, norms);
  this->AddAttachment(x, order, result, norms);
  if (order >= EnergyOrder::Gradient)
  {
    this->MeasureForces(norms, result);
  }
  if (order >= EnergyOrder::Hessian)
  {
    this->ScatterHessians(result);
  }
}

void EquilibriumEnergy::SumElements(EnergyOrder order, Evaluation& result, ForceNorms& norms) const
{
  result.Energy = 0;
  result.Measures = {};
  result.Measures.Volume = this->Moving.RigidVolume();
  for (const ElementWork& work : this->Elements)
  {
    result.Energy += work.Value;
    result.Measures.Add(work.Measures);
  }
  if (order == EnergyOrder::Value)
  {
    return;
  }
  std::vector<double> contactGradient(result.Gradient.size(), 0.0);
  for (std::size_t moving = 0; moving < this->Elements.size(); ++moving)
  {
    const ElementWork& work = this->Elements[moving];
    for (std::size_t r = 0; r < work.ContactGradient.size(); ++r)
    {
      const std::size_t coordinate = this->CoordinateOf(moving, r);
      result.Gradient[coordinate] += work.BodyGradient[r] + work.ContactGradient[r];
      contactGradient[coordinate] += work.ContactGradient[r];
    }
  }
  norms.Contact = std::sqrt(SquaredNorm(contactGradient));
}

void EquilibriumEnergy::AddLoads(const std::vector<double>& x, EnergyOrder order,
  Evaluation& result, ForceNorms& norms) const
{
  PieceTerms terms;
  terms.Value = result.Energy;
  for (std::size_t node = 0; node < this->LoadTerm.NumberOfPieces(); ++node)
  {
    if (order >= EnergyOrder::Gradient)
    {
      terms.Gradient = { &result.Gradient[3 * node], 3 };
    }
    this->LoadTerm.Add(node, x, order, terms);
  }
  result.Energy = terms.Value;
  norms.Loads = std::sqrt(SquaredNorm(this->LoadTerm.Forces()));
}

void EquilibriumEnergy::AddAttachment(const std::vector<double>& x, EnergyOrder order,
  Evaluation& result, ForceNorms& norms)
{
  if (!this->WallTerm)
  {
    return;
  }
  this->WallNodes.resize(this->WallTerm->NumberOfPieces());
  ParallelFor(this->WallNodes.size(),
    [&](std::size_t n)
    {
      NodeWork& work = this->WallNodes[n];
      work = {};
      work.Terms.Gradient = work.Gradient;
      work.Terms.Hessian = work.Hessian;
      this->WallTerm->Add(n, x, order, work.Terms);
    });
  const std::vector<std::int32_t>& unknown = this->Moving.Unknowns();
  double square = 0;
  for (std::size_t n = 0; n < this->WallNodes.size(); ++n)
  {
    const NodeWork& work = this->WallNodes[n];
    result.Energy += work.Terms.Value;
    result.Measures.Add(work.Terms.Measures);
    if (order == EnergyOrder::Value)
    {
      continue;
    }
    square += Dot(work.Gradient, work.Gradient);
    const std::int32_t node = this->WallTerm->NodesOf(n).front();
    for (int i = 0; i < 3; ++i)
    {
      const std::int32_t column = unknown[3 * node + i];
      result.Gradient[3 * node + i] += work.Gradient[i];
      for (int j = i; j < 3 && column >= 0 && order >= EnergyOrder::Hessian; ++j)
      {
        const std::int32_t row = unknown[3 * node + j];
        if (row >= 0)
        {
          result.Hessian[this->HessianPattern.PlaceOf(column, row)] += work.Hessian[3 * i + j];
        }
      }
    }
  }
  norms.Wall = std::sqrt(square);
}

void EquilibriumEnergy::MeasureForces(const ForceNorms& norms, Evaluation& result) const
{
  double residual = 0;
  double reaction = 0;
  for (std::size_t c = 0; c < result.Gradient.size(); ++c)
  {
    (this->Moving.Unknowns()[c] >= 0 ? residual : reaction) +=
      result.Gradient[c] * result.Gradient[c];
  }
  result.ResidualNorm = std::sqrt(residual);
  result.ForceScale =
    std::max({ norms.Contact, norms.Wall, norms.Loads, std::sqrt(reaction), this->SmallestForce });
}

void EquilibriumEnergy::ScatterHessians(Evaluation& result) const
{
  for (std::size_t moving = 0; moving < this->Elements.size(); ++moving)
  {
    const std::int32_t* scatter = &this->Scatter[this->ScatterStarts[moving]];
    for (const double entry : this->Elements[moving].LowerHalf)
    {
      if (*scatter >= 0)
      {
        result.Hessian[*scatter] += entry;
      }
      ++scatter;
    }
  }
}

/// 3 x nodeCount flags that are false at the unknowns of the worst part; empty if these are too
/// many.
std::vector<bool> EquilibriumEnergy::FixedAroundWorst(const std::vector<double>& gradient) const
{
  const ElasticBody& body = this->Moving.Body();
  const std::size_t nodeCount = body.NumberOfNodes();
  std::vector<double> squares(nodeCount, 0.0);
  for (const std::int32_t coordinate : this->Coordinates())
  {
    const double force = gradient[coordinate];
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
      for (const std::int32_t element : this->Moving.Elements())
      {
        const std::span<const std::int32_t> nodes = body.NodesOf(element);
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
    for (const std::int32_t coordinate : this->Coordinates())
    {
      fixed[coordinate] = !chosen[coordinate / 3];
      count += chosen[coordinate / 3];
    }
    if (count <= LargestPart * static_cast<double>(this->Moving.NumberOfUnknowns()))
    {
      return fixed;
    }
  }
  return {};
}

std::unique_ptr<Objective> EquilibriumEnergy::WorstPart(const std::vector<double>& gradient) const
{
  const std::vector<bool> fixed = this->FixedAroundWorst(gradient);
  if (fixed.empty())
  {
    return nullptr;
  }
  auto part = std::make_unique<EquilibriumEnergy>(this->Moving.Body(), fixed,
    this->ContactTerm.Stiffness(), this->Moving.RigidCells());
  part->SetDomain(this->BodyTerm.GetDomain());
  part->SetPlates(this->HasPlates ? &this->ContactTerm.Plates() : nullptr);
  part->SetLoads(this->LoadTerm.Forces());
  part->SetAttachment(this->WallTerm);
  part->SetFriction(this->FrictionTerm.Points());
  return part;
}
}
