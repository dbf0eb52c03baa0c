// SPDX-License-Identifier: Apache-2.0
#include "Private/EditableMesh.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <numeric>
#include <set>

namespace mammoray
{
namespace
{
/// The arcs around one material: closed curves and the points where they touch.
class Curves
{
public:
  Curves(const std::vector<EditableMesh::Arc>& arcs, std::int32_t material)
  {
    for (const EditableMesh::Arc& arc : arcs)
    {
      if (arc.Materials[0] == material || arc.Materials[1] == material)
      {
        const std::size_t a = this->NodeOf(arc.A);
        const std::size_t b = this->NodeOf(arc.B);
        ++this->Nodes[a].Degree;
        ++this->Nodes[b].Degree;
        this->Nodes[this->Root(a)].Parent = this->Root(b);
      }
    }
  }
  int Excess()
  {
    int curves = 0;
    int touches = 0;
    for (std::size_t n = 0; n < this->Nodes.size(); ++n)
    {
      curves += this->Root(n) == n;
      touches += this->Nodes[n].Degree / 2 - 1;
    }
    return std::max(0, curves - 1) + touches;
  }
  void AddTouches(std::set<std::int32_t>& points) const
  {
    for (const Node& node : this->Nodes)
    {
      if (node.Degree > 2)
      {
        points.insert(node.Id);
      }
    }
  }

private:
  struct Node
  {
    std::int32_t Id;
    int Degree;
    std::size_t Parent;
  };
  std::size_t NodeOf(std::int32_t id)
  {
    for (std::size_t n = 0; n < this->Nodes.size(); ++n)
    {
      if (this->Nodes[n].Id == id)
      {
        return n;
      }
    }
    this->Nodes.push_back({ id, 0, this->Nodes.size() });
    return this->Nodes.size() - 1;
  }
  std::size_t Root(std::size_t n) const
  {
    while (this->Nodes[n].Parent != n)
    {
      n = this->Nodes[n].Parent;
    }
    return n;
  }
  std::vector<Node> Nodes;
};

std::vector<std::int32_t> MaterialsOf(const std::vector<EditableMesh::Arc>& arcs)
{
  std::vector<std::int32_t> materials;
  for (const EditableMesh::Arc& arc : arcs)
  {
    materials.insert(materials.end(), { arc.Materials[0], arc.Materials[1] });
  }
  std::sort(materials.begin(), materials.end());
  materials.erase(std::unique(materials.begin(), materials.end()), materials.end());
  return materials;
}

/// The other ends of a point's pinched edges.
std::set<std::int32_t> PinchedEdges(const EditableMesh& mesh, std::int32_t point)
{
  const std::vector<EditableMesh::Arc> arcs = mesh.Arcs(point);
  std::set<std::int32_t> ends;
  for (const std::int32_t material : MaterialsOf(arcs))
  {
    Curves(arcs, material).AddTouches(ends);
  }
  return ends;
}

bool IsAirPinched(const EditableMesh& mesh, std::int32_t point)
{
  return Curves(mesh.Arcs(point), 0).Excess() > 0;
}

constexpr const char* Stage = "mending interfaces";

/// Changes the material of cells near pinches.
class Relabeller
{
public:
  Relabeller(EditableMesh& mesh, const ProgressCallback& progress)
    : Mesh(mesh)
  {
    this->FindComponents(progress);
  }

  /// Changes cells around one pinched point and adds their corners to `touched`.
  void Mend(std::int32_t point, std::vector<std::int32_t>& touched)
  {
    while (PinchExcess(this->Mesh, point) > 0 && this->ChangeBest(point, touched))
    {
    }
  }

private:
  void FindComponents(const ProgressCallback& progress)
  {
    const std::size_t count = this->Mesh.NumberOfCells();
    this->Component.assign(count, -1);
    std::vector<std::int32_t> stack;
    std::size_t visited = 0;
    for (std::size_t start = 0; start < count; ++start)
    {
      if (this->Component[start] >= 0 || !this->Mesh.IsAlive(static_cast<std::int32_t>(start)))
      {
        continue;
      }
      const auto id = static_cast<std::int32_t>(this->Spare.size());
      double volume = 0;
      this->Component[start] = id;
      stack.push_back(static_cast<std::int32_t>(start));
      while (!stack.empty())
      {
        const std::int32_t cell = stack.back();
        stack.pop_back();
        if (++visited % 65536 == 0)
        {
          ReportProgress(progress, static_cast<double>(visited) / count, Stage);
        }
        volume += this->Mesh.Volume(this->Mesh[cell].Ids);
        for (const std::int32_t other : this->FaceNeighbours(cell))
        {
          std::int32_t& place = this->Component[static_cast<std::size_t>(other)];
          if (place < 0 && this->Mesh[other].Material == this->Mesh[cell].Material)
          {
            place = id;
            stack.push_back(other);
          }
        }
      }
      this->Spare.push_back(volume / 50);
    }
  }

  std::vector<std::int32_t> FaceNeighbours(std::int32_t cell) const
  {
    std::vector<std::int32_t> neighbours;
    const std::array<std::int32_t, 4>& ids = this->Mesh[cell].Ids;
    for (int left = 0; left < 4; ++left)
    {
      std::int32_t a = ids[(left + 1) % 4];
      std::int32_t b = ids[(left + 2) % 4];
      std::int32_t c = ids[(left + 3) % 4];
      // Examine as few cells as possible.
      for (std::int32_t* other : { &b, &c })
      {
        if (this->Mesh.Star(*other).size() < this->Mesh.Star(a).size())
        {
          std::swap(a, *other);
        }
      }
      for (const std::int32_t other : this->Mesh.Star(a))
      {
        if (other != cell && Contains(this->Mesh[other].Ids, b) &&
          Contains(this->Mesh[other].Ids, c))
        {
          neighbours.push_back(other);
        }
      }
    }
    return neighbours;
  }

  int ExcessAround(std::int32_t cell) const
  {
    int excess = 0;
    for (const std::int32_t id : this->Mesh[cell].Ids)
    {
      excess += PinchExcess(this->Mesh, id);
    }
    return excess;
  }

  std::vector<Contacts> ContactsAround(std::int32_t cell) const
  {
    std::vector<Contacts> contacts;
    for (const std::int32_t id : this->Mesh[cell].Ids)
    {
      contacts.push_back(FindContacts(this->Mesh, id));
    }
    return contacts;
  }

  /// True if the cell with `material` has fewer pinches at its corners and no new contact of
  /// materials arises, as where a thin layer opens. The cell is left unchanged.
  bool Helps(std::int32_t cell, std::int32_t material, std::int32_t point)
  {
    const std::int32_t own = this->Mesh[cell].Material;
    const int before = PinchExcess(this->Mesh, point);
    this->Mesh.SetMaterial(cell, material);
    bool helps = PinchExcess(this->Mesh, point) < before;
    if (helps)
    {
      const int excessAfter = this->ExcessAround(cell);
      const std::vector<Contacts> contactsAfter = this->ContactsAround(cell);
      this->Mesh.SetMaterial(cell, own);
      const std::vector<Contacts> contacts = this->ContactsAround(cell);
      helps = excessAfter < this->ExcessAround(cell);
      for (std::size_t corner = 0; corner < 4 && helps; ++corner)
      {
        helps = std::includes(contacts[corner].begin(), contacts[corner].end(),
          contactsAfter[corner].begin(), contactsAfter[corner].end());
      }
    }
    this->Mesh.SetMaterial(cell, own);
    return helps;
  }

  bool ChangeBest(std::int32_t point, std::vector<std::int32_t>& touched)
  {
    double least = 0;
    std::int32_t best = -1;
    std::int32_t bestMaterial = 0;
    for (const std::int32_t cell : this->Mesh.Star(point))
    {
      const double volume = this->Mesh.Volume(this->Mesh[cell].Ids);
      if ((best >= 0 && volume >= least) ||
        volume >
          this->Spare[static_cast<std::size_t>(this->Component[static_cast<std::size_t>(cell)])])
      {
        continue;
      }
      for (const std::int32_t material : this->NeighbourMaterials(cell))
      {
        if (this->Helps(cell, material, point))
        {
          least = volume;
          best = cell;
          bestMaterial = material;
          break;
        }
      }
    }
    if (best >= 0)
    {
      this->Spare[static_cast<std::size_t>(this->Component[static_cast<std::size_t>(best)])] -=
        least;
      this->Mesh.SetMaterial(best, bestMaterial);
      const std::array<std::int32_t, 4>& ids = this->Mesh[best].Ids;
      touched.insert(touched.end(), ids.begin(), ids.end());
    }
    return best >= 0;
  }

  /// Materials of the neighbours except the cell's own, ascending.
  std::set<std::int32_t> NeighbourMaterials(std::int32_t cell) const
  {
    std::set<std::int32_t> materials;
    const std::vector<std::int32_t> neighbours = this->FaceNeighbours(cell);
    for (const std::int32_t other : neighbours)
    {
      materials.insert(this->Mesh[other].Material);
    }
    if (neighbours.size() < 4)
    {
      materials.insert(0);
    }
    materials.erase(this->Mesh[cell].Material);
    return materials;
  }

  EditableMesh& Mesh;
  /// Initial connected component of every cell, and the volume that it may still lose.
  std::vector<std::int32_t> Component;
  std::vector<double> Spare;
};

/// Splits the edges that leave `points` (one point, or the two of an edge) and gives the cells
/// around them to one material. Adds the points around which cells change to `touched`.
void CutOut(EditableMesh& mesh, const std::vector<std::int32_t>& points,
  std::vector<std::int32_t>& touched)
{
  const auto isOwn = [&points](std::int32_t id)
  { return std::find(points.begin(), points.end(), id) != points.end(); };
  bool airPinched = false;
  bool surrounded = true;
  Contacts contacts;
  std::set<std::int32_t> materials;
  std::vector<std::pair<std::int32_t, std::int32_t>> leaving;
  for (const std::int32_t point : points)
  {
    contacts.merge(FindContacts(mesh, point));
    airPinched = airPinched || IsAirPinched(mesh, point);
    surrounded = surrounded && mesh.IsSurrounded(point);
    for (const std::int32_t neighbour : mesh.Neighbours(point))
    {
      if (!isOwn(neighbour))
      {
        leaving.emplace_back(point, neighbour);
      }
    }
  }
  for (const auto& [one, other] : contacts)
  {
    materials.insert({ one, other });
  }
  touched.insert(touched.end(), points.begin(), points.end());
  for (const auto& [point, neighbour] : leaving)
  {
    touched.push_back(neighbour);
    // A small change that leaves cells of usable size.
    touched.push_back(mesh.SplitEdge(point, neighbour, 1.0 / 3));
  }
  std::set<std::int32_t> cells;
  std::map<std::int32_t, double> volumes;
  for (const std::int32_t point : points)
  {
    for (const std::int32_t cell : mesh.Star(point))
    {
      if (cells.insert(cell).second)
      {
        volumes[mesh[cell].Material] += mesh.Volume(mesh[cell].Ids);
      }
    }
  }
  if (!airPinched)
  {
    volumes.erase(0);
  }
  else if (!surrounded)
  {
    volumes = { { 0, 0.0 } };
  }
  // Choose the material that changes least among those that met all others before, so that a thin
  // layer stays closed.
  const auto meetsAll = [&](std::int32_t material)
  {
    return std::all_of(materials.begin(), materials.end(),
      [&](std::int32_t other)
      {
        return other == material ||
          contacts.count({ std::min(material, other), std::max(material, other) }) > 0;
      });
  };
  const std::int32_t material = std::max_element(volumes.begin(), volumes.end(),
    [&](const auto& a, const auto& b) {
      return std::pair(meetsAll(a.first), a.second) < std::pair(meetsAll(b.first), b.second);
    })->first;
  for (const std::int32_t cell : cells)
  {
    if (airPinched || mesh[cell].Material != 0)
    {
      mesh.SetMaterial(cell, material);
    }
  }
}

/// The pinched points among the given ones, ascending.
std::vector<std::int32_t> FindPinchedPoints(const EditableMesh& mesh,
  std::vector<std::int32_t> among, const ProgressCallback& progress)
{
  std::sort(among.begin(), among.end());
  among.erase(std::unique(among.begin(), among.end()), among.end());
  std::vector<std::int32_t> pinched;
  for (std::size_t n = 0; n < among.size(); ++n)
  {
    if (n % 16384 == 0)
    {
      ReportProgress(progress, static_cast<double>(n) / among.size(), Stage);
    }
    if (PinchExcess(mesh, among[n]) > 0)
    {
      pinched.push_back(among[n]);
    }
  }
  return pinched;
}
}

Contacts FindContacts(const EditableMesh& mesh, std::int32_t point)
{
  Contacts contacts;
  for (const EditableMesh::Arc& arc : mesh.Arcs(point))
  {
    contacts.insert(arc.Materials);
  }
  return contacts;
}

int PinchExcess(const EditableMesh& mesh, std::int32_t point)
{
  const std::vector<EditableMesh::Arc> arcs = mesh.Arcs(point);
  int excess = 0;
  for (const std::int32_t material : MaterialsOf(arcs))
  {
    excess += Curves(arcs, material).Excess();
  }
  return excess;
}

std::size_t RepairPinches(EditableMesh& mesh, const ProgressCallback& progress)
{
  std::vector<std::int32_t> all(mesh.Points.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<std::int32_t> pinched =
    FindPinchedPoints(mesh, std::move(all), ShareOf(progress, 0.0, 0.2));
  const std::size_t found = pinched.size();
  if (found == 0)
  {
    return 0;
  }
  // After each round, only points around its changes can differ.
  Relabeller relabeller(mesh, ShareOf(progress, 0.2, 0.6));
  const int relabellings = 3;
  for (int round = 0; round < relabellings && !pinched.empty(); ++round)
  {
    std::vector<std::int32_t> touched;
    for (const std::int32_t point : pinched)
    {
      ReportProgress(progress, 0.6 + 0.05 * round, Stage);
      relabeller.Mend(point, touched);
    }
    if (touched.empty())
    {
      break;
    }
    std::copy(pinched.begin(), pinched.end(), std::back_inserter(touched));
    pinched = FindPinchedPoints(mesh, std::move(touched), {});
  }
  for (int round = 0; !pinched.empty(); ++round)
  {
    if (round > 2)
    {
      throw ConvergenceError("mesh: boundaries that touch themselves were left after the repair");
    }
    std::vector<std::int32_t> touched = pinched;
    for (const std::int32_t point : pinched)
    {
      ReportProgress(progress, 0.8 + 0.05 * round, Stage);
      const std::set<std::int32_t> ends = PinchedEdges(mesh, point);
      const bool alone = ends.size() == 1 && PinchedEdges(mesh, *ends.begin()).size() == 1;
      if (PinchExcess(mesh, point) == 0 || (ends.size() == 1 && !alone))
      {
        continue; // mended with another one, or to be done once its neighbour is
      }
      CutOut(mesh,
        alone ? std::vector<std::int32_t>{ point, *ends.begin() }
              : std::vector<std::int32_t>{ point },
        touched);
    }
    pinched = FindPinchedPoints(mesh, std::move(touched), {});
  }
  return found;
}
}
