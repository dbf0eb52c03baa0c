// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Meshing/MeshCheck.h"

#include "Private/MeshingSteps.h"
#include "mammoray/Foundation/FaceTable.h"
#include "mammoray/Foundation/SurfaceOverlap.h"

#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <numeric>
#include <set>
#include <span>
#include <unordered_map>

namespace mammoray
{
namespace
{
using Kind = MeshDefect::Kind;

/// Collects defects, one entry per kind.
class DefectList
{
public:
  void Add(Kind kind, const MeshDefect::Place& place)
  {
    MeshDefect& defect = this->ByKind[kind];
    defect.What = kind;
    ++defect.Count;
    if (place.LengthMm > 0 || defect.Places.size() < MeshDefect::MostPlaces)
    {
      defect.Places.push_back(place);
    }
  }
  /// Adds a defect that was counted elsewhere.
  void AddCounted(Kind kind, std::size_t count, const std::vector<MeshDefect::Place>& places)
  {
    if (count > 0)
    {
      this->ByKind[kind] = { kind, count, places };
    }
  }
  std::vector<MeshDefect> Finish()
  {
    std::vector<MeshDefect> list;
    for (auto& [kind, defect] : this->ByKind)
    {
      std::stable_sort(defect.Places.begin(), defect.Places.end(),
        [](const auto& a, const auto& b) { return a.LengthMm > b.LengthMm; });
      defect.Places.resize(std::min(defect.Places.size(), MeshDefect::MostPlaces));
      list.push_back(defect);
    }
    return list;
  }

private:
  std::map<Kind, MeshDefect> ByKind;
};

/// Corners of a triangle in ascending order.
using TriangleKey = std::array<std::uint32_t, 3>;

TriangleKey KeyOfTriangle(std::vector<std::uint32_t>::const_iterator corners)
{
  TriangleKey key{ corners[0], corners[1], corners[2] };
  std::sort(key.begin(), key.end());
  return key;
}

/// Pinched edges and points and turned triangles, each recorded once even if several materials meet
/// there.
struct SharedPlaces
{
  std::set<std::uint64_t> PinchedEdges;
  std::set<std::uint32_t> PinchedPoints;
  std::set<TriangleKey> TurnedTriangles;
};

/// Checks the boundary of one material, oriented outwards: is it closed and manifold?
class BoundaryCheck
{
public:
  BoundaryCheck(const SurfaceMesh& surface, int material, SharedPlaces& shared, DefectList& defects)
    : Surface(surface)
    , Material(material)
    , Shared(shared)
    , Defects(defects)
  {
    for (std::size_t triangle = 0; triangle < surface.NumberOfTriangles(); ++triangle)
    {
      const bool back = surface.BackMaterials[triangle] == material;
      const bool front = surface.FrontMaterials[triangle] == material;
      const std::uint32_t* ids = &surface.Triangles[3 * triangle];
      // A triangle that names a point twice bounds nothing.
      if (back != front && ids[0] != ids[1] && ids[1] != ids[2] && ids[2] != ids[0])
      {
        this->Corners.insert(this->Corners.end(), { ids[0], ids[back ? 1 : 2], ids[back ? 2 : 1] });
      }
    }
    this->LeaveOutDoubled();
  }

  std::size_t NumberOfTriangles() const { return this->Corners.size() / 3; }

  double Volume() const
  {
    if (this->Corners.empty())
    {
      return 0;
    }
    const Vector3 origin = this->Point(0);
    double sixfold = 0;
    for (std::size_t corner = 0; corner < this->Corners.size(); corner += 3)
    {
      sixfold += Dot(this->Point(corner) - origin,
        Cross(this->Point(corner + 1) - origin, this->Point(corner + 2) - origin));
    }
    return sixfold / 6;
  }

  double Area() const
  {
    double twice = 0;
    for (std::size_t corner = 0; corner < this->Corners.size(); corner += 3)
    {
      twice += Norm(Cross(this->Point(corner + 1) - this->Point(corner),
        this->Point(corner + 2) - this->Point(corner)));
    }
    return twice / 2;
  }

  void Run()
  {
    this->CollectEdges();
    this->TurnAlike();
    DisjointSets fans(this->Corners.size());
    std::vector<HalfEdge> open;
    for (std::size_t begin = 0; begin < this->Edges.size();)
    {
      std::size_t end = begin;
      int balance = 0;
      while (end < this->Edges.size() && this->Edges[end].Key == this->Edges[begin].Key)
      {
        balance += this->Edges[end].Forward ? 1 : -1;
        ++end;
      }
      if (balance != 0)
      {
        open.push_back(this->Edges[begin]);
      }
      else if (end - begin == 2)
      {
        this->JoinAcross(this->Edges[begin].Corner, this->Edges[begin + 1].Corner, fans);
      }
      else
      {
        this->AddPinch(this->Edges[begin]);
      }
      begin = end;
    }
    if (open.empty())
    {
      this->FindPinchedPoints(fans);
    }
    if (this->Material != 0) // air ends where a material does
    {
      this->AddHoles(open);
    }
  }

private:
  struct HalfEdge
  {
    std::uint64_t Key = 0;
    /// First corner; the edge leads to the next corner of the triangle.
    std::uint32_t Corner = 0;
    bool Forward = true;
  };

  Vector3 PointOf(std::uint32_t id) const
  {
    const double* at = &this->Surface.Points[3 * static_cast<std::size_t>(id)];
    return { at[0], at[1], at[2] };
  }
  Vector3 Point(std::size_t corner) const { return this->PointOf(this->Corners[corner]); }
  static std::uint32_t Next(std::uint32_t corner)
  {
    return corner % 3 == 2 ? corner - 2 : corner + 1;
  }

  /// Whether a triangle goes through its corners as through its key.
  bool IsForward(std::uint32_t corner, const TriangleKey& key) const
  {
    const std::uint32_t* ids = &this->Corners[corner];
    const auto place = std::find(ids, ids + 3, key[0]) - ids;
    return ids[(place + 1) % 3] == key[1];
  }

  /// Triangles that are there twice would leave their edges open.
  void LeaveOutDoubled()
  {
    std::vector<std::pair<TriangleKey, std::uint32_t>> order;
    for (std::uint32_t corner = 0; corner < this->Corners.size(); corner += 3)
    {
      order.emplace_back(KeyOfTriangle(this->Corners.begin() + corner), corner);
    }
    std::sort(order.begin(), order.end());
    std::vector<std::uint32_t> doubled;
    // The second of those that are there in both senses.
    std::map<TriangleKey, std::uint32_t> opposed;
    for (std::size_t n = 1, first = 0; n < order.size(); ++n)
    {
      const auto& [key, corner] = order[n];
      if (key != order[first].first)
      {
        first = n;
        continue;
      }
      const bool isOther =
        this->IsForward(corner, key) != this->IsForward(order[first].second, key);
      if (!isOther || !opposed.emplace(key, corner).second)
      {
        doubled.push_back(corner);
      }
    }
    if (!opposed.empty())
    {
      this->KeepContacts(opposed);
    }
    for (const auto& [key, corner] : opposed)
    {
      doubled.push_back(corner);
      this->Opposed.insert(key);
    }
    std::sort(doubled.begin(), doubled.end());
    std::vector<std::uint32_t> once;
    auto next = doubled.begin();
    for (std::uint32_t corner = 0; !doubled.empty() && corner < this->Corners.size(); corner += 3)
    {
      if (next == doubled.end() || *next != corner)
      {
        const auto begin = this->Corners.begin() + corner;
        once.insert(once.end(), begin, begin + 3);
        continue;
      }
      if (this->Material != 0) // air has the same
      {
        this->Defects.Add(Kind::DoubledTriangles, { this->Point(corner), this->Material, 0 });
      }
      ++next;
    }
    if (!doubled.empty())
    {
      this->Corners = std::move(once);
    }
  }

  /// Removes from the triangles that are there in both senses those of faces that two bodies share:
  /// an even number of other triangles meets such a face at all of its border.
  void KeepContacts(std::map<TriangleKey, std::uint32_t>& opposed) const
  {
    struct Edge
    {
      std::vector<std::uint32_t> Faces;
      std::size_t Others = 0;
    };
    std::map<std::uint64_t, Edge> edges;
    std::vector<TriangleKey> faces;
    const auto edgesOf = [](const TriangleKey& key)
    {
      const auto edge = [](std::uint64_t a, std::uint64_t b) { return a << 32 | b; };
      return std::array{ edge(key[0], key[1]), edge(key[1], key[2]), edge(key[0], key[2]) };
    };
    for (const auto& [key, corner] : opposed)
    {
      for (const std::uint64_t edge : edgesOf(key))
      {
        edges[edge].Faces.push_back(static_cast<std::uint32_t>(faces.size()));
      }
      faces.push_back(key);
    }
    for (std::uint32_t corner = 0; corner < this->Corners.size(); corner += 3)
    {
      const TriangleKey key = KeyOfTriangle(this->Corners.begin() + corner);
      for (const std::uint64_t edge : edgesOf(key))
      {
        const auto found = edges.find(edge);
        if (found != edges.end() && opposed.count(key) == 0)
        {
          ++found->second.Others;
        }
      }
    }
    DisjointSets joined(faces.size());
    for (const auto& [key, edge] : edges)
    {
      for (const std::uint32_t face : edge.Faces)
      {
        joined.Join(face, edge.Faces.front());
      }
    }
    std::set<std::uint32_t> met;
    std::set<std::uint32_t> odd;
    for (const auto& [key, edge] : edges)
    {
      const bool isEnd = edge.Others == 0 && edge.Faces.size() == 1; // of a sheet
      if (isEnd || edge.Others % 2 == 1)
      {
        odd.insert(joined.Root(edge.Faces.front()));
      }
      else if (edge.Others > 0)
      {
        met.insert(joined.Root(edge.Faces.front()));
      }
    }
    for (std::uint32_t face = 0; face < faces.size(); ++face)
    {
      if (met.count(joined.Root(face)) > 0 && odd.count(joined.Root(face)) == 0)
      {
        opposed.erase(faces[face]);
      }
    }
  }

  /// Turns the triangles that are turned against most of those joined to them, and records them.
  void TurnAlike()
  {
    DisjointSets parts(this->NumberOfTriangles());
    bool isAlike = true;
    for (std::size_t begin = 0; begin < this->Edges.size();)
    {
      std::size_t end = begin + 1;
      while (end < this->Edges.size() && this->Edges[end].Key == this->Edges[begin].Key)
      {
        ++end;
      }
      if (end - begin == 2)
      {
        parts.Join(this->Edges[begin].Corner / 3, this->Edges[begin + 1].Corner / 3);
        isAlike = isAlike && this->Edges[begin].Forward != this->Edges[begin + 1].Forward;
      }
      begin = end;
    }
    if (isAlike)
    {
      return;
    }
    const std::vector<bool> reversed = this->ReversedByCgal();
    // Of each part, how many triangles stay and how many are reversed.
    std::unordered_map<std::uint32_t, std::array<std::size_t, 2>> counts;
    for (std::uint32_t triangle = 0; triangle < reversed.size(); ++triangle)
    {
      ++counts[parts.Root(triangle)][reversed[triangle] ? 1 : 0];
    }
    for (std::uint32_t triangle = 0; triangle < reversed.size(); ++triangle)
    {
      const auto& [staying, turned] = counts[parts.Root(triangle)];
      if (reversed[triangle] == (turned <= staying))
      {
        this->Turn(triangle);
      }
    }
    this->Edges.clear();
    this->CollectEdges();
  }

  /// Which triangles CGAL reverses to orient those of each part alike, as RepairSurface does.
  std::vector<bool> ReversedByCgal() const
  {
    struct Visitor : CGAL::Polygon_mesh_processing::Default_orientation_visitor
    {
      void polygon_orientation_reversed(std::size_t polygon)
      {
        const std::size_t triangle = (*this->Triangles)[polygon];
        (*this->Reversed)[triangle] = !(*this->Reversed)[triangle];
      }
      const std::vector<std::size_t>* Triangles = nullptr;
      std::vector<bool>* Reversed = nullptr;
    };
    std::vector<Vector3> points(this->Surface.NumberOfPoints()); // their places do not matter
    std::vector<std::vector<std::size_t>> polygons;
    std::vector<std::size_t> triangles;
    for (std::size_t triangle = 0; triangle < this->NumberOfTriangles(); ++triangle)
    {
      const std::uint32_t* ids = &this->Corners[3 * triangle];
      if (ids[0] != ids[1] && ids[1] != ids[2] && ids[2] != ids[0])
      {
        polygons.push_back({ ids[0], ids[1], ids[2] });
        triangles.push_back(triangle);
      }
    }
    std::vector<bool> reversed(this->NumberOfTriangles(), false);
    Visitor visitor;
    visitor.Triangles = &triangles;
    visitor.Reversed = &reversed;
    CGAL::Polygon_mesh_processing::orient_polygon_soup(points, polygons,
      CGAL::parameters::visitor(visitor));
    return reversed;
  }

  void Turn(std::uint32_t triangle)
  {
    const std::size_t corner = 3 * static_cast<std::size_t>(triangle);
    const TriangleKey key =
      KeyOfTriangle(this->Corners.begin() + static_cast<std::ptrdiff_t>(corner));
    std::swap(this->Corners[corner + 1], this->Corners[corner + 2]);
    // Of a triangle in both senses, either may have been left out.
    if (this->Material != 0 && this->Opposed.count(key) == 0 &&
      this->Shared.TurnedTriangles.insert(key).second)
    {
      this->Defects.Add(Kind::TurnedTriangles,
        { (1.0 / 3) * (this->Point(corner) + this->Point(corner + 1) + this->Point(corner + 2)),
          this->Material, 0 });
    }
  }

  void CollectEdges()
  {
    this->Edges.reserve(this->Corners.size());
    for (std::uint32_t corner = 0; corner < this->Corners.size(); ++corner)
    {
      const std::uint64_t a = this->Corners[corner];
      const std::uint64_t b = this->Corners[Next(corner)];
      this->Edges.push_back({ a < b ? (a << 32) | b : (b << 32) | a, corner, a < b });
    }
    std::sort(this->Edges.begin(), this->Edges.end(),
      [](const HalfEdge& a, const HalfEdge& b)
      { return a.Key != b.Key ? a.Key < b.Key : a.Corner < b.Corner; });
  }

  /// Joins the fans at both ends of an edge between two triangles, which traverse it in opposite
  /// directions.
  void JoinAcross(std::uint32_t one, std::uint32_t other, DisjointSets& fans) const
  {
    fans.Join(one, Next(other));
    fans.Join(Next(one), other);
  }

  void AddPinch(const HalfEdge& edge)
  {
    const std::uint32_t next = Next(edge.Corner);
    if (this->Shared.PinchedEdges.insert(edge.Key).second)
    {
      this->Defects.Add(Kind::Pinches,
        { 0.5 * (this->Point(edge.Corner) + this->Point(next)), this->Material, 0 });
    }
    this->Shared.PinchedPoints.insert({ this->Corners[edge.Corner], this->Corners[next] });
  }

  /// Finds points with more than one fan of triangles, except those on pinched edges.
  void FindPinchedPoints(DisjointSets& fans)
  {
    std::unordered_map<std::uint32_t, std::uint32_t> fanOf;
    fanOf.reserve(this->Corners.size() / 5);
    for (std::uint32_t corner = 0; corner < this->Corners.size(); ++corner)
    {
      const std::uint32_t id = this->Corners[corner];
      const std::uint32_t fan = fans.Root(corner);
      const auto [entry, first] = fanOf.emplace(id, fan);
      if (!first && entry->second != fan && this->Shared.PinchedPoints.insert(id).second)
      {
        this->Defects.Add(Kind::Pinches, { this->PointOf(id), this->Material, 0 });
      }
    }
  }

  /// Joins connected open edges to holes, or to seams where all of them lie on others.
  void AddHoles(const std::vector<HalfEdge>& open)
  {
    std::map<std::uint32_t, std::uint32_t> places;
    const auto placeOf = [&](std::uint64_t id)
    {
      return places
        .emplace(static_cast<std::uint32_t>(id), static_cast<std::uint32_t>(places.size()))
        .first->second;
    };
    DisjointSets joined(2 * open.size());
    for (const HalfEdge& edge : open)
    {
      joined.Join(placeOf(edge.Key >> 32), placeOf(edge.Key & 0xffffffff));
    }
    std::map<std::array<Vector3, 2>, int> edgesAt;
    const auto endsOf = [this](const HalfEdge& edge)
    {
      const Vector3 a = this->PointOf(static_cast<std::uint32_t>(edge.Key >> 32));
      const Vector3 b = this->PointOf(static_cast<std::uint32_t>(edge.Key));
      return a < b ? std::array{ a, b } : std::array{ b, a };
    };
    for (const HalfEdge& edge : open)
    {
      ++edgesAt[endsOf(edge)];
    }
    std::set<std::uint32_t> ends;
    std::map<std::uint32_t, MeshDefect::Place> holes;
    for (const HalfEdge& edge : open)
    {
      const Vector3 a = this->PointOf(static_cast<std::uint32_t>(edge.Key >> 32));
      const Vector3 b = this->PointOf(static_cast<std::uint32_t>(edge.Key));
      MeshDefect::Place& hole = holes[joined.Root(placeOf(edge.Key >> 32))];
      const double length = Norm(b - a);
      hole.Material = this->Material;
      hole.LengthMm += length;
      hole.Point = hole.Point + 0.5 * length * (a + b);
      if (edgesAt[endsOf(edge)] < 2)
      {
        ends.insert(joined.Root(placeOf(edge.Key >> 32)));
      }
    }
    for (auto& [root, hole] : holes)
    {
      hole.Point = hole.LengthMm > 0 ? (1 / hole.LengthMm) * hole.Point : hole.Point;
      this->Defects.Add(ends.count(root) > 0 ? Kind::Holes : Kind::OpenSeams, hole);
    }
  }

  const SurfaceMesh& Surface;
  int Material;
  SharedPlaces& Shared;
  DefectList& Defects;
  /// Point of every corner of the triangles that bound the material.
  std::vector<std::uint32_t> Corners;
  std::vector<HalfEdge> Edges;
  /// Triangles that were there in both senses.
  std::set<TriangleKey> Opposed;
};

void FindCoincidentPoints(const std::vector<double>& points, DefectList& defects)
{
  const auto at = [&points](std::uint32_t id)
  {
    const double* point = &points[3 * static_cast<std::size_t>(id)];
    return Vector3{ point[0], point[1], point[2] };
  };
  std::vector<std::uint32_t> order(points.size() / 3);
  std::iota(order.begin(), order.end(), std::uint32_t{ 0 });
  std::sort(order.begin(), order.end(),
    [&](std::uint32_t a, std::uint32_t b) { return at(a) < at(b); });
  for (std::size_t n = 1; n < order.size(); ++n)
  {
    if (at(order[n - 1]) == at(order[n]))
    {
      defects.Add(Kind::CoincidentPoints, { at(order[n]), -1, 0 });
    }
  }
}

void FindUnusedPoints(const TetrahedralMesh& mesh, DefectList& defects)
{
  std::vector<char> used(mesh.NumberOfPoints(), 0);
  for (const std::int32_t id : mesh.Cells)
  {
    used[static_cast<std::size_t>(id)] = 1;
  }
  for (std::size_t point = 0; point < used.size(); ++point)
  {
    if (!used[point])
    {
      defects.Add(Kind::UnusedPoints, { mesh.Point(point), -1, 0 });
    }
  }
}

/// Finds faces of more than two cells and of two cells on the same side. Returns true if there are
/// none.
bool CheckFaces(const TetrahedralMesh& mesh, DefectList& defects)
{
  bool good = true;
  FaceTable faces(mesh);
  faces.ForEachFace(
    [&](std::span<const FaceTable::Entry> same)
    {
      if (same.size() > 2 ||
        (same.size() == 2 && !faces.OnDifferentSides(same[0].Face, same[1].Face)))
      {
        const std::size_t cell = same.back().Face / 4;
        defects.Add(Kind::OverlappingCells, { mesh.CellCentre(cell), mesh.Materials[cell], 0 });
        good = false;
      }
    });
  return good;
}

void CheckIndices(const TetrahedralMesh& mesh)
{
  mesh.ValidateIndices("mesh");
  for (std::size_t value = 0; value < mesh.Points.size(); ++value)
  {
    if (!std::isfinite(mesh.Points[value]))
    {
      throw InputError("mesh: point " + std::to_string(value / 3) +
        ": expected finite coordinates, found " + std::to_string(mesh.Points[value]));
    }
  }
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    if (mesh.Materials[cell] < 1 || mesh.Materials[cell] > 65535)
    {
      throw InputError("mesh: cell " + std::to_string(cell) +
        ": expected a material from 1 to 65535, found " + std::to_string(mesh.Materials[cell]));
    }
  }
}

/// Measures volume and quality by material and records inverted cells.
std::map<int, MaterialQuality> MeasureCells(const TetrahedralMesh& mesh, DefectList& defects)
{
  std::map<int, MaterialQuality> qualities;
  const auto count = [](std::vector<std::size_t>& histogram, double place, std::size_t bins)
  {
    histogram.resize(bins, 0);
    ++histogram[static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(bins - 1)))];
  };
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    MaterialQuality& quality = qualities[mesh.Materials[cell]];
    quality.Material = mesh.Materials[cell];
    const double volume = mesh.CellVolume(cell);
    quality.VolumeMm3 += volume;
    if (!(volume > 0))
    {
      defects.Add(Kind::InvertedCells, { mesh.CellCentre(cell), quality.Material, 0 });
    }
    const double dihedral = SmallestDihedralDeg(mesh, cell);
    const double ratio = RadiusEdgeRatio(mesh, cell);
    if (quality.Cells == 0 || dihedral < quality.SmallestDihedralDeg)
    {
      quality.SmallestDihedralDeg = dihedral;
      quality.SmallestDihedralPlace = mesh.CellCentre(cell);
    }
    if (!(ratio <= quality.LargestRadiusEdgeRatio))
    {
      quality.LargestRadiusEdgeRatio = ratio;
      quality.LargestRadiusEdgePlace = mesh.CellCentre(cell);
    }
    count(quality.DihedralHistogram, dihedral / MeshCheck::DihedralStepDeg, 24);
    count(quality.RadiusEdgeHistogram,
      std::isfinite(ratio) ? ratio / MeshCheck::RadiusEdgeStep : 1e9, 25);
    ++quality.Cells;
  }
  return qualities;
}

/// Checks the boundaries of all materials; that of air comes last, and is closed if all others are.
void CheckBoundaries(const SurfaceMesh& surface, std::map<int, MaterialQuality>& qualities,
  bool measureVolumes, DefectList& defects, const ProgressCallback& progress)
{
  std::set<int> materials(surface.BackMaterials.begin(), surface.BackMaterials.end());
  materials.insert(surface.FrontMaterials.begin(), surface.FrontMaterials.end());
  std::vector<int> order(materials.upper_bound(0), materials.end());
  order.push_back(0);
  SharedPlaces shared;
  std::size_t done = 0;
  for (const int material : order)
  {
    ReportProgress(progress, 0.4 + 0.6 * static_cast<double>(done++) / order.size(),
      "checking boundaries");
    BoundaryCheck check(surface, material, shared, defects);
    check.Run();
    if (material == 0)
    {
      break;
    }
    MaterialQuality& quality = qualities[material];
    quality.Material = material;
    quality.BoundaryTriangles = check.NumberOfTriangles();
    quality.BoundaryAreaMm2 = check.Area();
    if (measureVolumes)
    {
      quality.VolumeMm3 = check.Volume();
    }
  }
}

/// Finds intersecting triangles and parts inside each other.
void CheckOverlap(const SurfaceMesh& surface, DefectList& defects, const ProgressCallback& progress)
{
  const TriangleTree tree(surface);
  const SurfaceOverlap overlap = FindOverlap(surface, tree, progress);
  std::vector<MeshDefect::Place> crossings;
  for (std::size_t n = 0; n < overlap.CrossingPlaces.size(); ++n)
  {
    crossings.push_back({ overlap.CrossingPlaces[n], overlap.CrossingMaterials[n], 0 });
  }
  defects.AddCounted(Kind::Crossings, overlap.Crossings, crossings);
  for (const bool negative : { false, true })
  {
    std::vector<MeshDefect::Place> places;
    for (const SurfaceContradiction& stretch : overlap.Contradictions)
    {
      if (stretch.Negative == negative)
      {
        places.push_back({ stretch.Place, stretch.Materials.empty() ? -1 : stretch.Materials[0],
          stretch.LengthMm });
      }
    }
    defects.AddCounted(negative ? Kind::InsideOutParts : Kind::DoubledParts,
      negative ? overlap.NegativeParts : overlap.DoubledParts, places);
  }
}

MeshCheck Finish(MeshCheck&& check, const std::map<int, MaterialQuality>& qualities,
  DefectList& defects, const ProgressCallback& progress)
{
  for (const auto& [material, quality] : qualities)
  {
    check.Materials.push_back(quality);
  }
  check.Defects = defects.Finish();
  ReportProgress(progress, 1.0, "checking boundaries");
  return std::move(check);
}

const char* Describe(Kind kind)
{
  switch (kind)
  {
    case Kind::InvertedCells:
      return "cells of no or negative volume";
    case Kind::OverlappingCells:
      return "faces shared by more than two cells or from one side";
    case Kind::CoincidentPoints:
      return "points at the place of another";
    case Kind::UnusedPoints:
      return "points without a cell";
    case Kind::FlatTriangles:
      return "triangles of no area";
    case Kind::DoubledTriangles:
      return "triangles that are there twice";
    case Kind::TurnedTriangles:
      return "triangles turned against their neighbours";
    case Kind::OpenSeams:
      return "borders that coincide with others point for point, which a repair welds";
    case Kind::Holes:
      return "holes in the boundary of a material";
    case Kind::Crossings:
      return "pairs of triangles that cross each other";
    case Kind::DoubledParts:
      return "parts inside of others whose labels say air there, which rays count twice";
    case Kind::InsideOutParts:
      return "parts turned inside out, which rays count negatively";
    default:
      return "edges or points where the boundary of a material touches itself";
  }
}
}

std::string MeshDefect::Text(const std::vector<std::string>& names) const
{
  std::string text = std::to_string(this->Count) + " " + Describe(this->What) + ": ";
  constexpr std::size_t shown = 3;
  for (std::size_t n = 0; n < std::min(shown, this->Places.size()); ++n)
  {
    const Place& place = this->Places[n];
    char at[120];
    std::snprintf(at, sizeof(at), "(%.6g, %.6g, %.6g) mm", place.Point[0], place.Point[1],
      place.Point[2]);
    text += n > 0 ? "; " : "";
    if (place.Material >= 0)
    {
      const auto m = static_cast<std::size_t>(place.Material);
      text += (m < names.size() ? names[m] : "material " + std::to_string(m)) + " at ";
    }
    text += at;
    if (place.LengthMm > 0)
    {
      const bool isBorder = this->What == Kind::Holes || this->What == Kind::OpenSeams;
      std::snprintf(at, sizeof(at), isBorder ? ", border %.3g mm" : ", %.3g mm", place.LengthMm);
      text += at;
    }
  }
  return text + (this->Count > shown ? "; and more" : "");
}

bool MeshCheck::Sound() const
{
  return this->Defects.empty();
}

const MeshDefect* MeshCheck::Find(MeshDefect::Kind kind) const
{
  const auto found = std::find_if(this->Defects.begin(), this->Defects.end(),
    [kind](const MeshDefect& defect) { return defect.What == kind; });
  return found == this->Defects.end() ? nullptr : &*found;
}

MeshCheck CheckMesh(const TetrahedralMesh& mesh, const ProgressCallback& progress)
{
  ReportProgress(progress, 0.0, "checking cells");
  CheckIndices(mesh);
  MeshCheck check;
  check.Points = mesh.NumberOfPoints();
  check.Cells = mesh.NumberOfCells();
  DefectList defects;
  FindCoincidentPoints(mesh.Points, defects);
  FindUnusedPoints(mesh, defects);
  auto qualities = MeasureCells(mesh, defects);
  ReportProgress(progress, 0.2, "checking cells");
  if (CheckFaces(mesh, defects))
  {
    ReportProgress(progress, 0.3, "checking boundaries");
    const SurfaceMesh surface = ExtractInterfaces(mesh);
    check.Triangles = surface.NumberOfTriangles();
    CheckBoundaries(surface, qualities, false, defects, progress);
  }
  return Finish(std::move(check), qualities, defects, progress);
}

MeshCheck CheckSurface(const SurfaceMesh& surface, const ProgressCallback& progress)
{
  ReportProgress(progress, 0.0, "checking triangles");
  surface.Validate("surface");
  MeshCheck check;
  check.Points = surface.NumberOfPoints();
  check.Triangles = surface.NumberOfTriangles();
  DefectList defects;
  for (std::size_t triangle = 0; triangle < surface.NumberOfTriangles(); ++triangle)
  {
    Vector3 corner[3];
    for (std::size_t c = 0; c < 3; ++c)
    {
      corner[c] = surface.Corner(triangle, c);
    }
    if (Norm(Cross(corner[1] - corner[0], corner[2] - corner[0])) == 0)
    {
      defects.Add(Kind::FlatTriangles, { corner[0], surface.BackMaterials[triangle], 0 });
    }
  }
  std::map<int, MaterialQuality> qualities;
  CheckBoundaries(surface, qualities, true, defects, ShareOf(progress, 0, 0.6));
  CheckOverlap(surface, defects, ShareOf(progress, 0.6, 1));
  return Finish(std::move(check), qualities, defects, progress);
}
}
