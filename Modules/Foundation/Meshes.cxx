// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Meshes.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/FaceTable.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

namespace mammoray
{
namespace
{
/// The inverted cells of a mesh, and whether neighbours lead from them to upright cells.
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

  /// Throws unless neighbours lead from every inverted cell to an upright one.
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

std::uint16_t MaterialOf(const TetrahedralMesh& mesh, std::size_t cell)
{
  const std::int32_t value = mesh.Materials[cell];
  if (value < 0 || value > 65535)
  {
    throw InputError("interfaces: cell " + std::to_string(cell) + " has material " +
      std::to_string(value) + ", expected 0 to 65535");
  }
  return static_cast<std::uint16_t>(value);
}

/// Builds a surface from faces of a mesh; points are numbered in the order in which they occur.
class InterfaceCollector
{
public:
  explicit InterfaceCollector(const TetrahedralMesh& mesh)
    : Mesh(mesh)
    , NewId(mesh.NumberOfPoints(), -1)
  {
  }

  void Add(const std::array<std::int32_t, 3>& corners, std::uint16_t front, std::uint16_t back)
  {
    for (const std::int32_t id : corners)
    {
      std::int32_t& newId = this->NewId[static_cast<std::size_t>(id)];
      if (newId < 0)
      {
        newId = static_cast<std::int32_t>(this->OldIds.size());
        this->OldIds.push_back(id);
      }
      this->Surface.Triangles.push_back(static_cast<std::uint32_t>(newId));
    }
    this->Surface.FrontMaterials.push_back(front);
    this->Surface.BackMaterials.push_back(back);
  }

  /// Returns the surface; `pointIds`, if given, receives the mesh's point of each of its points.
  SurfaceMesh Finish(std::vector<std::int32_t>* pointIds)
  {
    this->Surface.Points.reserve(3 * this->OldIds.size());
    for (const std::int32_t id : this->OldIds)
    {
      const Vector3 point = this->Mesh.Point(static_cast<std::size_t>(id));
      this->Surface.Points.insert(this->Surface.Points.end(), point.begin(), point.end());
    }
    if (pointIds)
    {
      *pointIds = std::move(this->OldIds);
    }
    return std::move(this->Surface);
  }

private:
  const TetrahedralMesh& Mesh;
  SurfaceMesh Surface;
  std::vector<std::int32_t> NewId;
  std::vector<std::int32_t> OldIds;
};
}

Vector3 TetrahedralMesh::CellCentre(std::size_t cell) const
{
  const std::int32_t* ids = &this->Cells[4 * cell];
  return 0.25 *
    (this->Point(ids[0]) + this->Point(ids[1]) + this->Point(ids[2]) + this->Point(ids[3]));
}

double TetrahedralMesh::CellVolume(std::size_t cell) const
{
  const std::int32_t* ids = &this->Cells[4 * cell];
  const Vector3 origin = this->Point(ids[0]);
  return Dot(this->Point(ids[1]) - origin,
           Cross(this->Point(ids[2]) - origin, this->Point(ids[3]) - origin)) /
    6.0;
}

void TetrahedralMesh::ValidateIndices(const std::string& name) const
{
  if (this->NumberOfCells() == 0)
  {
    throw InputError(name + ": expected tetrahedra, found none");
  }
  if (this->Cells.size() % 4 != 0 || this->Materials.size() != this->NumberOfCells())
  {
    throw InputError(name + ": expected 4 indices and 1 material per cell, found " +
      std::to_string(this->Cells.size()) + " and " + std::to_string(this->Materials.size()));
  }
  const auto pointCount = static_cast<std::int64_t>(this->NumberOfPoints());
  for (std::size_t index = 0; index < this->Cells.size(); ++index)
  {
    if (this->Cells[index] < 0 || this->Cells[index] >= pointCount)
    {
      throw InputError(name + ": cell " + std::to_string(index / 4) + " uses point " +
        std::to_string(this->Cells[index]) + ", expected 0 to " + std::to_string(pointCount - 1));
    }
  }
}

void TetrahedralMesh::Validate(const std::string& name) const
{
  this->ValidateIndices(name);
  for (std::size_t cell = 0; cell < this->NumberOfCells(); ++cell)
  {
    const double volume = this->CellVolume(cell);
    if (!(volume > 0))
    {
      throw InputError(name + ": cell " + std::to_string(cell) + " has volume " +
        std::to_string(volume) + " mm3, expected a positive one");
    }
  }
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
  FaceTable faces(mesh);
  TurnedCells turned(mesh);
  InterfaceCollector interfaces(mesh);
  faces.ForEachFace(
    [&](std::span<const FaceTable::Entry> same)
    {
      const std::size_t face = same[0].Face;
      const std::size_t cell = face / 4;
      std::uint16_t front = 0;
      if (same.size() > 2)
      {
        throw InputError("interfaces: cells " + std::to_string(cell) + ", " +
          std::to_string(same[1].Face / 4) + " and " + std::to_string(same[2].Face / 4) +
          " share a face, expected at most two cells per face");
      }
      if (same.size() == 2)
      {
        const std::size_t other = same[1].Face / 4;
        if (!faces.OnDifferentSides(face, same[1].Face))
        {
          throw InputError("interfaces: cells " + std::to_string(cell) + " and " +
            std::to_string(other) + " list their corners in contrary senses");
        }
        turned.AddNeighbours(cell, other);
        front = MaterialOf(mesh, other);
      }
      const std::uint16_t back = MaterialOf(mesh, cell);
      if (front != back)
      {
        interfaces.Add(faces.Corners(face), front, back);
      }
    });
  turned.Check();
  return interfaces.Finish(pointIds);
}

void AppendBoundary(const SurfaceMesh& boundary, int material, SurfaceMesh& all)
{
  const auto base = static_cast<std::uint32_t>(all.NumberOfPoints());
  all.Points.insert(all.Points.end(), boundary.Points.begin(), boundary.Points.end());
  for (const std::uint32_t id : boundary.Triangles)
  {
    all.Triangles.push_back(base + id);
  }
  const auto side = [material](std::uint16_t other)
  { return static_cast<std::uint16_t>(other == 0 ? 0 : material); };
  for (std::size_t triangle = 0; triangle < boundary.NumberOfTriangles(); ++triangle)
  {
    all.FrontMaterials.push_back(side(boundary.FrontMaterials[triangle]));
    all.BackMaterials.push_back(side(boundary.BackMaterials[triangle]));
  }
}
}
