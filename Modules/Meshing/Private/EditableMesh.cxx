// SPDX-License-Identifier: Apache-2.0
#include "Private/EditableMesh.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace mammoray
{
EditableMesh::EditableMesh(const TetrahedralMesh& mesh)
{
  for (std::size_t point = 0; point < mesh.NumberOfPoints(); ++point)
  {
    this->Points.push_back(mesh.Point(point));
  }
  this->Stars.resize(this->Points.size());
  this->Cells.reserve(mesh.NumberOfCells());
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    const std::int32_t* ids = &mesh.Cells[4 * cell];
    this->Add({ ids[0], ids[1], ids[2], ids[3] }, mesh.Materials[cell]);
  }
}

TetrahedralMesh EditableMesh::Finish() const
{
  TetrahedralMesh mesh;
  std::vector<std::int32_t> newId(this->Points.size(), -1);
  for (const Cell& cell : this->Cells)
  {
    if (!cell.Alive || cell.Material == 0)
    {
      continue;
    }
    for (const std::int32_t id : cell.Ids)
    {
      std::int32_t& fresh = newId[static_cast<std::size_t>(id)];
      if (fresh < 0)
      {
        fresh = static_cast<std::int32_t>(mesh.NumberOfPoints());
        const Vector3& point = this->Point(id);
        mesh.Points.insert(mesh.Points.end(), point.begin(), point.end());
      }
      mesh.Cells.push_back(fresh);
    }
    mesh.Materials.push_back(cell.Material);
  }
  return mesh;
}

std::vector<std::int32_t> EditableMesh::Ring(std::int32_t a, std::int32_t b) const
{
  std::vector<std::int32_t> ring;
  for (const std::int32_t cell : this->Star(a))
  {
    if (Contains((*this)[cell].Ids, b))
    {
      ring.push_back(cell);
    }
  }
  return ring;
}

std::vector<std::int32_t> EditableMesh::Neighbours(std::int32_t point) const
{
  std::vector<std::int32_t> neighbours;
  for (const std::int32_t cell : this->Star(point))
  {
    for (const std::int32_t id : (*this)[cell].Ids)
    {
      if (id != point)
      {
        neighbours.push_back(id);
      }
    }
  }
  std::sort(neighbours.begin(), neighbours.end());
  neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
  return neighbours;
}

std::vector<EditableMesh::Arc> EditableMesh::LinkEdges(std::int32_t point) const
{
  // Stars have some dozen cells: a search through all keys takes less time than sorting them.
  constexpr std::uint64_t paired = ~std::uint64_t{ 0 };
  std::vector<std::uint64_t> keys;
  std::vector<Arc> edges;
  keys.reserve(3 * this->Star(point).size());
  edges.reserve(3 * this->Star(point).size());
  for (const std::int32_t cell : this->Star(point))
  {
    const Cell& around = (*this)[cell];
    std::array<std::int32_t, 3> link{};
    std::copy_if(around.Ids.begin(), around.Ids.end(), link.begin(),
      [point](std::int32_t id) { return id != point; });
    for (std::size_t n = 0; n < 3; ++n)
    {
      const auto [low, high] = std::minmax(link[n], link[(n + 1) % 3]);
      const std::uint64_t key =
        static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint32_t>(high);
      const auto first = std::find(keys.begin(), keys.end(), key);
      if (first != keys.end())
      {
        edges[static_cast<std::size_t>(first - keys.begin())].Materials[1] = around.Material;
        *first = paired;
      }
      else // a first side, or a third one as of cells that overlap
      {
        keys.push_back(key);
        edges.push_back({ low, high, { around.Material, Nothing } });
      }
    }
  }
  return edges;
}

std::vector<EditableMesh::Arc> EditableMesh::Arcs(std::int32_t point) const
{
  std::vector<Arc> arcs;
  for (Arc edge : this->LinkEdges(point))
  {
    edge.Materials[1] = std::max(edge.Materials[1], 0);
    if (edge.Materials[0] != edge.Materials[1])
    {
      std::sort(edge.Materials.begin(), edge.Materials.end());
      arcs.push_back(edge);
    }
  }
  std::sort(arcs.begin(), arcs.end(),
    [](const Arc& a, const Arc& b)
    { return std::tie(a.A, a.B, a.Materials) < std::tie(b.A, b.B, b.Materials); });
  return arcs;
}

bool EditableMesh::IsSurrounded(std::int32_t point) const
{
  const std::vector<Arc> edges = this->LinkEdges(point);
  return std::none_of(edges.begin(), edges.end(),
    [](const Arc& edge) { return edge.Materials[1] == Nothing; });
}

double EditableMesh::Volume(const std::array<std::int32_t, 4>& ids) const
{
  const Vector3& origin = this->Point(ids[0]);
  return Dot(this->Point(ids[1]) - origin,
           Cross(this->Point(ids[2]) - origin, this->Point(ids[3]) - origin)) /
    6;
}

double EditableMesh::Quality(const std::array<std::int32_t, 4>& ids) const
{
  // sin = 3 V l / (2 A B) at an edge of length l between faces with areas A and B.
  double doubleArea[4];
  for (int corner = 0; corner < 4; ++corner)
  {
    const Vector3& p = this->Point(ids[(corner + 1) % 4]);
    doubleArea[corner] =
      Norm(Cross(this->Point(ids[(corner + 2) % 4]) - p, this->Point(ids[(corner + 3) % 4]) - p));
  }
  double smallest = std::numeric_limits<double>::max();
  double shortest = smallest;
  double longest = 0;
  for (int a = 0; a < 4; ++a)
  {
    for (int b = a + 1; b < 4; ++b)
    {
      const int c = a == 0 ? (b == 1 ? 2 : 1) : 0;
      const int d = 6 - a - b - c;
      const double length = Norm(this->Point(ids[b]) - this->Point(ids[a]));
      const double areas = doubleArea[c] * doubleArea[d];
      smallest = std::min(smallest, areas > 0 ? length / areas : 0.0);
      shortest = std::min(shortest, length);
      longest = std::max(longest, length);
    }
  }
  const double sixfold = 6 * this->Volume(ids);
  return sixfold > 0 ? std::min(sixfold * smallest, 2 * shortest / longest)
                     : std::min(sixfold, -1e-300);
}

double EditableMesh::WorstOf(const std::vector<std::int32_t>& cells) const
{
  double worst = 1;
  for (const std::int32_t cell : cells)
  {
    worst = std::min(worst, this->Quality((*this)[cell].Ids, (*this)[cell].Material));
  }
  return worst;
}

std::int32_t EditableMesh::Add(const std::array<std::int32_t, 4>& ids, std::int32_t material)
{
  const auto cell = static_cast<std::int32_t>(this->Cells.size());
  this->Cells.push_back({ ids, material, true });
  for (const std::int32_t id : ids)
  {
    this->Stars[static_cast<std::size_t>(id)].push_back(cell);
  }
  return cell;
}

void EditableMesh::Remove(std::int32_t cell)
{
  Cell& gone = this->Cells[static_cast<std::size_t>(cell)];
  gone.Alive = false;
  for (const std::int32_t id : gone.Ids)
  {
    std::vector<std::int32_t>& star = this->Stars[static_cast<std::size_t>(id)];
    star.erase(std::find(star.begin(), star.end(), cell));
  }
}

void EditableMesh::Restore(std::int32_t cell)
{
  Cell& back = this->Cells[static_cast<std::size_t>(cell)];
  back.Alive = true;
  for (const std::int32_t id : back.Ids)
  {
    this->Stars[static_cast<std::size_t>(id)].push_back(cell);
  }
}

std::int32_t EditableMesh::SplitEdge(std::int32_t a, std::int32_t b, double share)
{
  const auto middle = static_cast<std::int32_t>(this->Points.size());
  const Vector3 from = this->Point(a);
  this->Points.push_back(from + share * (this->Point(b) - from));
  this->Stars.emplace_back();
  for (const std::int32_t cell : this->Ring(a, b))
  {
    const Cell old = (*this)[cell];
    this->Remove(cell);
    this->Add(Replaced(old.Ids, b, middle), old.Material);
    this->Add(Replaced(old.Ids, a, middle), old.Material);
  }
  return middle;
}
}
