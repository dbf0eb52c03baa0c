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
  repaired.DoubledTriangles = PMP::merge_duplicate_polygons_in_polygon_soup(points, polygons);
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
