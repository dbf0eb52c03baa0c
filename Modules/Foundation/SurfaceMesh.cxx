// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/SurfaceMesh.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace mammoray
{
namespace
{
/// Whether it takes an odd number of exchanges to sort three indices.
bool IsOdd(const std::array<std::int32_t, 3>& ids)
{
  return ((ids[0] > ids[1]) != (ids[0] > ids[2])) != (ids[1] > ids[2]);
}

/// The turned-over cells of a mesh, and whether their neighbours vouch for them.
class TurnedCells
{
public:
  explicit TurnedCells(const TetrahedralMesh& mesh)
    : Turned(mesh.NumberOfCells(), false)
  {
    for (std::size_t cell = 0; cell < this->Turned.size(); ++cell)
    {
      this->Turned[cell] = !(mesh.CellVolume(cell) > 0);
    }
  }

  void AddNeighbours(std::size_t a, std::size_t b)
  {
    if (this->Turned[a] || this->Turned[b])
    {
      this->Pairs.push_back({ a, b });
    }
  }

  /// Throws unless neighbours lead from every turned cell to an upright one.
  void Check()
  {
    for (bool spread = true; spread;)
    {
      spread = false;
      for (const auto& [a, b] : this->Pairs)
      {
        spread = spread || this->Turned[a] != this->Turned[b];
        this->Turned[a] = this->Turned[b] = this->Turned[a] && this->Turned[b];
      }
    }
    const auto left = std::find(this->Turned.begin(), this->Turned.end(), true);
    if (left != this->Turned.end())
    {
      throw InputError("interfaces: cell " + std::to_string(left - this->Turned.begin()) +
        " and its neighbours are turned inside out, expected positive volumes");
    }
  }

private:
  std::vector<bool> Turned;
  std::vector<std::array<std::size_t, 2>> Pairs;
};
}

int SurfaceMesh::NumberOfMaterials() const
{
  std::uint16_t largest = 0;
  for (const std::vector<std::uint16_t>* side : { &this->FrontMaterials, &this->BackMaterials })
  {
    for (const std::uint16_t material : *side)
    {
      largest = std::max(largest, material);
    }
  }
  return 1 + largest;
}

void SurfaceMesh::Validate(const std::string& name) const
{
  const std::size_t triangleCount = this->NumberOfTriangles();
  if (this->Points.size() % 3 != 0 || this->Triangles.size() % 3 != 0)
  {
    throw InputError(name +
      ": expected three coordinates per point and three points per triangle, found " +
      std::to_string(this->Points.size()) + " coordinates and " +
      std::to_string(this->Triangles.size()) + " indices");
  }
  if (triangleCount == 0)
  {
    throw InputError(name + ": expected triangles, found none");
  }
  if (this->FrontMaterials.size() != triangleCount || this->BackMaterials.size() != triangleCount)
  {
    throw InputError(name + ": expected " + std::to_string(triangleCount) +
      " materials on each side of the triangles, found " +
      std::to_string(this->FrontMaterials.size()) + " and " +
      std::to_string(this->BackMaterials.size()));
  }
  const std::size_t pointCount = this->NumberOfPoints();
  for (std::size_t index = 0; index < this->Triangles.size(); ++index)
  {
    if (this->Triangles[index] >= pointCount)
    {
      throw InputError(name + ": triangle " + std::to_string(index / 3) + " uses point " +
        std::to_string(this->Triangles[index]) + ", expected 0 to " +
        std::to_string(static_cast<std::int64_t>(pointCount) - 1));
    }
  }
  for (std::size_t index = 0; index < this->Points.size(); ++index)
  {
    if (!std::isfinite(this->Points[index]))
    {
      throw InputError(name + ": point " + std::to_string(index / 3) +
        ": expected finite coordinates, found " + std::to_string(this->Points[index]));
    }
  }
}

SurfaceMesh ExtractInterfaces(const TetrahedralMesh& mesh, std::vector<std::int32_t>* pointIds)
{
  mesh.ValidateIndices("interfaces");
  // The face opposite to each corner, seen counter-clockwise from outside a positive tetrahedron.
  static constexpr int FaceCorners[4][3] = { { 1, 2, 3 }, { 0, 3, 2 }, { 0, 1, 3 }, { 0, 2, 1 } };

  const std::size_t faceCount = 4 * mesh.NumberOfCells();
  const auto corners = [&mesh](std::size_t face)
  {
    const std::int32_t* cell = &mesh.Cells[face & ~static_cast<std::size_t>(3)];
    const int* local = FaceCorners[face & 3];
    return std::array<std::int32_t, 3>{ cell[local[0]], cell[local[1]], cell[local[2]] };
  };
  const auto sorted = [&corners](std::size_t face)
  {
    std::array<std::int32_t, 3> ids = corners(face);
    std::sort(ids.begin(), ids.end());
    return ids;
  };

  // Faces grouped by their smallest point (counting sort); groups are small, so pairs are found by
  // looking at each other member.
  std::vector<std::size_t> groupBegin(mesh.NumberOfPoints() + 1, 0);
  for (std::size_t face = 0; face < faceCount; ++face)
  {
    const auto ids = corners(face);
    ++groupBegin[1 + static_cast<std::size_t>(std::min({ ids[0], ids[1], ids[2] }))];
  }
  for (std::size_t point = 0; point < mesh.NumberOfPoints(); ++point)
  {
    groupBegin[point + 1] += groupBegin[point];
  }
  struct Entry
  {
    std::int32_t Middle;
    std::int32_t Last;
    std::size_t Face;
  };
  std::vector<Entry> entries(faceCount);
  std::vector<std::size_t> next(groupBegin.begin(), groupBegin.end() - 1);
  for (std::size_t face = 0; face < faceCount; ++face)
  {
    const auto ids = sorted(face);
    entries[next[static_cast<std::size_t>(ids[0])]++] = { ids[1], ids[2], face };
  }

  SurfaceMesh surface;
  TurnedCells turned(mesh);
  std::vector<std::int32_t> newId(mesh.NumberOfPoints(), -1);
  std::vector<std::int32_t> oldIds;
  const auto material = [&mesh](std::size_t face)
  {
    const std::int32_t value = mesh.Materials[face / 4];
    if (value < 0 || value > 65535)
    {
      throw InputError("interfaces: cell " + std::to_string(face / 4) + " has material " +
        std::to_string(value) + ", expected 0 to 65535");
    }
    return static_cast<std::uint16_t>(value);
  };
  for (std::size_t group = 0; group + 1 < groupBegin.size(); ++group)
  {
    const auto begin = entries.begin() + static_cast<std::ptrdiff_t>(groupBegin[group]);
    const auto end = entries.begin() + static_cast<std::ptrdiff_t>(groupBegin[group + 1]);
    std::sort(begin, end,
      [](const Entry& a, const Entry& b)
      { return std::tie(a.Middle, a.Last, a.Face) < std::tie(b.Middle, b.Last, b.Face); });
    for (auto first = begin; first != end;)
    {
      auto last = first + 1;
      while (last != end && last->Middle == first->Middle && last->Last == first->Last)
      {
        ++last;
      }
      if (last - first > 2)
      {
        throw InputError("interfaces: cells " + std::to_string(first->Face / 4) + ", " +
          std::to_string((first + 1)->Face / 4) + " and " + std::to_string((first + 2)->Face / 4) +
          " share a face, expected at most two cells per face");
      }
      const bool shared = last - first == 2;
      if (shared)
      {
        const std::size_t other = (first + 1)->Face;
        if (IsOdd(corners(first->Face)) == IsOdd(corners(other)))
        {
          throw InputError("interfaces: cells " + std::to_string(first->Face / 4) + " and " +
            std::to_string(other / 4) + " list their corners in contrary senses");
        }
        turned.AddNeighbours(first->Face / 4, other / 4);
      }
      const std::uint16_t back = material(first->Face);
      const std::uint16_t front = shared ? material((first + 1)->Face) : 0;
      if (front != back)
      {
        for (const std::int32_t id : corners(first->Face))
        {
          if (newId[static_cast<std::size_t>(id)] < 0)
          {
            newId[static_cast<std::size_t>(id)] = static_cast<std::int32_t>(oldIds.size());
            oldIds.push_back(id);
          }
          surface.Triangles.push_back(
            static_cast<std::uint32_t>(newId[static_cast<std::size_t>(id)]));
        }
        surface.FrontMaterials.push_back(front);
        surface.BackMaterials.push_back(back);
      }
      first = last;
    }
  }
  turned.Check();
  surface.Points.reserve(3 * oldIds.size());
  for (const std::int32_t id : oldIds)
  {
    const Vector3 point = mesh.Point(static_cast<std::size_t>(id));
    surface.Points.insert(surface.Points.end(), point.begin(), point.end());
  }
  if (pointIds)
  {
    *pointIds = std::move(oldIds);
  }
  return surface;
}
}
