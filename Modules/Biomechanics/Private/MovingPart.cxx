// SPDX-License-Identifier: Apache-2.0
#include "Private/MovingPart.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <span>
#include <string>

namespace mammoray
{
MovingPart::MovingPart(const ElasticBody& body, const std::vector<bool>& fixed,
  const std::vector<bool>& rigid)
  : WholeBody(body)
  , Rigid(rigid)
{
  if (fixed.size() != body.RestPositions().size())
  {
    throw InputError("equilibrium: expected 3 flags per node, found " +
      std::to_string(fixed.size()) + " for " + std::to_string(body.NumberOfNodes()) + " nodes");
  }
  std::vector<bool> moves(body.NumberOfElements(), false);
  std::vector<bool> used(body.NumberOfNodes(), false);
  const auto isFree = [&](std::int32_t node)
  { return !(fixed[3 * node] && fixed[3 * node + 1] && fixed[3 * node + 2]); };
  for (std::size_t element = 0; element < body.NumberOfElements(); ++element)
  {
    const std::span<const std::int32_t> nodes = body.NodesOf(element);
    // A patch has either only rigid or only other cells.
    const auto first = static_cast<std::size_t>(body.CellsOf(element).front());
    const bool stands = first < rigid.size() && rigid[first];
    if (!stands && std::any_of(nodes.begin(), nodes.end(), isFree))
    {
      moves[element] = true;
      this->MovingElements.push_back(static_cast<std::int32_t>(element));
      for (const std::int32_t node : nodes)
      {
        used[node] = true;
      }
    }
    else
    {
      this->VolumeAtRest += body.ElementVolume(element);
    }
  }
  if (this->MovingElements.empty())
  {
    throw InputError("equilibrium: expected cells that can move, found all of them fixed");
  }
  this->UnknownOfCoordinate.assign(fixed.size(), -1);
  for (std::size_t c = 0; c < fixed.size(); ++c)
  {
    if (!fixed[c] && used[c / 3])
    {
      this->UnknownOfCoordinate[c] = static_cast<std::int32_t>(this->CoordinateOfUnknown.size());
      this->CoordinateOfUnknown.push_back(static_cast<std::int32_t>(c));
    }
  }
  this->ElementFaces.resize(body.NumberOfElements());
  this->FaceElements.assign(body.Faces().size(), -1);
  for (std::size_t f = 0; f < body.Faces().size(); ++f)
  {
    const ElasticBody::BoundaryFace& face = body.Faces()[f];
    const std::span<const std::int32_t> nodes = body.NodesOf(face.Element);
    if (moves[face.Element] &&
      std::any_of(face.LocalNodes.begin(), face.LocalNodes.begin() + body.NodesPerFace(),
        [&](int local) { return isFree(nodes[local]); }))
    {
      this->ElementFaces[face.Element].push_back(static_cast<std::int32_t>(f));
      this->FaceElements[f] = face.Element;
    }
  }
}

void MovingPart::AddAtNode(std::int32_t node, const Vector3& force, double* column) const
{
  for (int i = 0; i < 3; ++i)
  {
    const std::int32_t unknown = this->UnknownOfCoordinate[3 * node + i];
    if (unknown >= 0)
    {
      column[unknown] += force[i];
    }
  }
}

void MovingPart::AddAtFace(const ElasticBody::BoundaryFace& face,
  const std::array<double, 6>& shape, const Vector3& force, double* column) const
{
  const std::span<const std::int32_t> nodes = this->WholeBody.NodesOf(face.Element);
  for (int a = 0; a < this->WholeBody.NodesPerFace(); ++a)
  {
    this->AddAtNode(nodes[face.LocalNodes[a]], shape[a] * force, column);
  }
}
}
