// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Error.h"
#include "mammoray/Meshing/SurfaceMesher.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

namespace mammoray
{
namespace
{
namespace PMP = CGAL::Polygon_mesh_processing;
using RepairKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using RepairPoint = RepairKernel::Point_3;
using RepairMesh = CGAL::Surface_mesh<RepairPoint>;
using SoupPolygon = std::vector<std::size_t>;

/// Finds the first of the points that lie within a distance of each other.
class Welder
{
public:
  Welder(const SurfaceMesh& surface, double distanceMm)
    : Surface(surface)
    , Distance(distanceMm)
  {
  }

  std::size_t FirstNear(std::size_t point)
  {
    const Vector3 here = this->Surface.Point(point);
    std::array<std::int64_t, 3> cell{};
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      cell[axis] = static_cast<std::int64_t>(std::floor(here[axis] / this->Distance));
    }
    for (int neighbour = 0; neighbour < 27; ++neighbour)
    {
      const auto found = this->Cells.find(KeyOf({ cell[0] + neighbour % 3 - 1,
        cell[1] + neighbour / 3 % 3 - 1, cell[2] + neighbour / 9 - 1 }));
      for (const std::size_t other :
        found == this->Cells.end() ? std::vector<std::size_t>() : found->second)
      {
        if (Norm(this->Surface.Point(other) - here) <= this->Distance)
        {
          return other;
        }
      }
    }
    this->Cells[KeyOf(cell)].push_back(point);
    return point;
  }

private:
  /// Cells that share a key are looked through both.
  static std::uint64_t KeyOf(const std::array<std::int64_t, 3>& cell)
  {
    std::uint64_t key = 0;
    for (const std::int64_t index : cell)
    {
      key = (key ^ static_cast<std::uint64_t>(index)) * 0x9e3779b97f4a7c15u;
      key ^= key >> 29;
    }
    return key;
  }

  const SurfaceMesh& Surface;
  const double Distance;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> Cells;
};

double WidestMm(const SurfaceMesh& surface)
{
  double widest = 0;
  for (const Extent& extent :
    ExtentsAlong<3>({ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } }, surface.Points))
  {
    widest = std::max(widest, extent.Length());
  }
  return widest;
}

/// A triangle's corners in ascending order.
using TriangleKey = std::array<std::size_t, 3>;
/// A side of it.
using SideKey = std::pair<std::size_t, std::size_t>;

std::array<SideKey, 3> SidesOf(const TriangleKey& key)
{
  return { SideKey{ key[0], key[1] }, SideKey{ key[1], key[2] }, SideKey{ key[0], key[2] } };
}

TriangleKey KeyOf(const SoupPolygon& corners)
{
  TriangleKey key{ corners[0], corners[1], corners[2] };
  std::sort(key.begin(), key.end());
  return key;
}

/// 0 where the corners follow each other as in the key, 1 against it.
std::size_t SenseOf(const SoupPolygon& corners)
{
  return ((corners[0] > corners[1]) + (corners[0] > corners[2]) + (corners[1] > corners[2])) % 2;
}

/// How often each triangle is there, in either sense.
using TriangleCounts = std::map<TriangleKey, std::array<std::size_t, 2>>;

/**
 * Triangles that are there as often in one sense as in the other and enclose nothing, as where
 * parts touch: patches of them that end only where the others make a whole surface without them.
 */
std::set<TriangleKey> WallsIn(const TriangleCounts& counts)
{
  std::map<SideKey, std::size_t> others;
  std::map<SideKey, std::vector<TriangleKey>> facing;
  std::set<TriangleKey> left;
  for (const auto& [key, senses] : counts)
  {
    const bool faces = senses[0] == senses[1];
    for (const SideKey& side : SidesOf(key))
    {
      others[side] += faces ? 0 : 1;
      if (faces)
      {
        facing[side].push_back(key);
        left.insert(key);
      }
    }
  }
  std::set<TriangleKey> walls;
  while (!left.empty())
  {
    std::vector<TriangleKey> patch{ *left.begin() };
    left.erase(left.begin());
    bool meetsOthers = false;
    bool isWall = true;
    for (std::size_t index = 0; index < patch.size(); ++index)
    {
      for (const SideKey& side : SidesOf(patch[index]))
      {
        meetsOthers = meetsOthers || others[side] > 0;
        isWall = isWall && others[side] % 2 == 0;
        for (const TriangleKey& next : facing[side])
        {
          if (left.erase(next) > 0)
          {
            patch.push_back(next);
          }
        }
      }
    }
    if (meetsOthers && isWall)
    {
      walls.insert(patch.begin(), patch.end());
    }
  }
  return walls;
}

/// Leaves one of equal triangles, none of walls, and returns the number of the others.
std::size_t LeaveOutDoubled(std::vector<SoupPolygon>& polygons)
{
  TriangleCounts counts;
  for (const SoupPolygon& polygon : polygons)
  {
    ++counts[KeyOf(polygon)][SenseOf(polygon)];
  }
  std::set<TriangleKey> seen = WallsIn(counts);
  std::vector<SoupPolygon> kept;
  for (const SoupPolygon& polygon : polygons)
  {
    const TriangleKey key = KeyOf(polygon);
    const std::size_t sense = SenseOf(polygon);
    if (counts[key][sense] >= counts[key][1 - sense] && seen.insert(key).second)
    {
      kept.push_back(polygon);
    }
  }
  polygons.swap(kept);
  return kept.size() - polygons.size();
}

/// The triangles whose corners are apart, each once, with the points that they use.
void MakeSoup(const SurfaceMesh& surface, double weldMm, std::vector<RepairPoint>& points,
  std::vector<SoupPolygon>& polygons, RepairedSurface& repaired)
{
  Welder welder(surface, weldMm);
  std::vector<std::size_t> idOf(surface.NumberOfPoints());
  for (std::size_t point = 0; point < idOf.size(); ++point)
  {
    const std::size_t first = welder.FirstNear(point);
    repaired.WeldedPoints += first == point ? 0 : 1;
    idOf[point] = first == point ? points.size() : idOf[first];
    if (first == point)
    {
      const Vector3 at = surface.Point(point);
      points.emplace_back(at[0], at[1], at[2]);
    }
  }
  for (std::size_t triangle = 0; triangle < surface.NumberOfTriangles(); ++triangle)
  {
    const std::uint32_t* ids = &surface.Triangles[3 * triangle];
    const SoupPolygon corners{ idOf[ids[0]], idOf[ids[1]], idOf[ids[2]] };
    const bool isFlat =
      corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
    repaired.FlatTriangles += isFlat ? 1 : 0;
    if (!isFlat)
    {
      polygons.push_back(corners);
      if (surface.BackMaterials[triangle] == 0)
      {
        std::swap(polygons.back()[1], polygons.back()[2]);
      }
    }
  }
  repaired.DoubledTriangles = LeaveOutDoubled(polygons);
}

RepairKernel::Vector_3 NormalOf(const RepairMesh& mesh, RepairMesh::Face_index face)
{
  const RepairMesh::Halfedge_index edge = mesh.halfedge(face);
  const RepairPoint& a = mesh.point(mesh.source(edge));
  return CGAL::cross_product(mesh.point(mesh.target(edge)) - a,
    mesh.point(mesh.target(mesh.next(edge))) - a);
}

void CloseHoles(double longestMm, RepairMesh& mesh, RepairedSurface& repaired)
{
  std::vector<RepairMesh::Halfedge_index> borders;
  PMP::extract_boundary_cycles(mesh, std::back_inserter(borders));
  for (const RepairMesh::Halfedge_index border : borders)
  {
    double length = 0;
    for (const RepairMesh::Halfedge_index edge : CGAL::halfedges_around_face(border, mesh))
    {
      length += std::sqrt(
        CGAL::squared_distance(mesh.point(mesh.source(edge)), mesh.point(mesh.target(edge))));
    }
    std::vector<RepairMesh::Face_index> patch;
    if (length <= longestMm)
    {
#if CGAL_VERSION_NR >= CGAL_VERSION_NUMBER(5, 6, 0)
      PMP::triangulate_hole(mesh, border,
        CGAL::parameters::face_output_iterator(std::back_inserter(patch)));
#else
      PMP::triangulate_hole(mesh, border, std::back_inserter(patch));
#endif
    }
    ++(patch.empty() ? repaired.OpenHoles : repaired.ClosedHoles);
  }
}

SurfaceMesh ToSurface(const RepairMesh& mesh)
{
  SurfaceMesh surface;
  std::unordered_map<std::uint32_t, std::uint32_t> idOf;
  for (const RepairMesh::Vertex_index vertex : mesh.vertices())
  {
    if (!mesh.is_isolated(vertex))
    {
      idOf[vertex] = static_cast<std::uint32_t>(surface.NumberOfPoints());
      const RepairPoint& at = mesh.point(vertex);
      surface.Points.insert(surface.Points.end(), { at.x(), at.y(), at.z() });
    }
  }
  for (const RepairMesh::Face_index face : mesh.faces())
  {
    for (const RepairMesh::Vertex_index vertex :
      CGAL::vertices_around_face(mesh.halfedge(face), mesh))
    {
      surface.Triangles.push_back(idOf.at(vertex));
    }
  }
  surface.FrontMaterials.assign(surface.NumberOfTriangles(), 0);
  surface.BackMaterials.assign(surface.NumberOfTriangles(), 1);
  return surface;
}
}

RepairedSurface RepairSurface(const SurfaceMesh& surface, const std::optional<double>& weldMm,
  const std::optional<double>& longestHoleMm)
{
  surface.Validate("surface");
  if (surface.NumberOfMaterials() > 2)
  {
    throw InputError("surface: expected one material to repair, found " +
      std::to_string(surface.NumberOfMaterials() - 1));
  }
  const double widest = WidestMm(surface);
  const double weld = weldMm.value_or(1e-7 * widest);
  const double longest = longestHoleMm.value_or(0.1 * widest);
  if (!(widest > 0) || !(weld > 0) || !(longest >= 0))
  {
    throw InputError("surface: expected an extent, and a distance of points to weld, above 0");
  }
  RepairedSurface repaired;
  std::vector<RepairPoint> points;
  std::vector<SoupPolygon> polygons;
  MakeSoup(surface, weld, points, polygons, repaired);
  std::vector<RepairKernel::Vector_3> normals;
  normals.reserve(polygons.size());
  for (const SoupPolygon& polygon : polygons)
  {
    normals.push_back(CGAL::cross_product(points[polygon[1]] - points[polygon[0]],
      points[polygon[2]] - points[polygon[0]]));
  }
  PMP::orient_polygon_soup(points, polygons);
  RepairMesh mesh;
  PMP::polygon_soup_to_polygon_mesh(points, polygons, mesh);
  PMP::stitch_borders(mesh);
  const auto whole = mesh.number_of_faces();
  PMP::remove_degenerate_faces(mesh);
  repaired.FlatTriangles += whole - mesh.number_of_faces();
  CloseHoles(longest, mesh, repaired);
  if (CGAL::is_closed(mesh) && !PMP::does_self_intersect(mesh))
  {
    PMP::orient_to_bound_a_volume(mesh);
  }
  else if (CGAL::is_closed(mesh))
  {
    PMP::orient(mesh);
  }
  for (const RepairMesh::Face_index face : mesh.faces())
  {
    // Faces are numbered as the polygons of which they were made.
    const std::size_t polygon = face.idx();
    if (polygon < normals.size() && normals[polygon] * NormalOf(mesh, face) < 0)
    {
      ++repaired.TurnedTriangles;
    }
  }
  repaired.Surface = ToSurface(mesh);
  return repaired;
}
}
