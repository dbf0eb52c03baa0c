// SPDX-License-Identifier: Apache-2.0
// Closed surfaces with known chords, and a slow reference for the path lengths of any of them.
#ifndef mammoray_SurfaceShapes_h
#define mammoray_SurfaceShapes_h

#include "mammoray/Foundation/Meshes.h"

#include <algorithm>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

namespace mammoray::shapes
{
/// Columns of a rotation: about x, then y, then z, radians.
inline std::array<Vector3, 3> Rotation(double x, double y, double z)
{
  std::array<Vector3, 3> columns{ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } };
  for (Vector3& v : columns)
  {
    v = { v[0], std::cos(x) * v[1] - std::sin(x) * v[2], std::sin(x) * v[1] + std::cos(x) * v[2] };
    v = { std::cos(y) * v[0] + std::sin(y) * v[2], v[1], -std::sin(y) * v[0] + std::cos(y) * v[2] };
    v = { std::cos(z) * v[0] - std::sin(z) * v[1], std::sin(z) * v[0] + std::cos(z) * v[1], v[2] };
  }
  return columns;
}

inline Vector3 Apply(const std::array<Vector3, 3>& columns, const Vector3& v)
{
  return v[0] * columns[0] + v[1] * columns[1] + v[2] * columns[2];
}

inline void AddTriangle(SurfaceMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c,
  int back, int front)
{
  mesh.Triangles.insert(mesh.Triangles.end(), { a, b, c });
  mesh.BackMaterials.push_back(static_cast<std::uint16_t>(back));
  mesh.FrontMaterials.push_back(static_cast<std::uint16_t>(front));
}

inline std::uint32_t AddPoint(SurfaceMesh& mesh, const Vector3& point)
{
  mesh.Points.insert(mesh.Points.end(), point.begin(), point.end());
  return static_cast<std::uint32_t>(mesh.NumberOfPoints() - 1);
}

/// A box of 12 triangles with normals outwards.
inline void AddBox(SurfaceMesh& mesh, const Vector3& low, const Vector3& high, int inside,
  int outside = 0, const std::array<Vector3, 3>& axes = Rotation(0, 0, 0))
{
  const auto base = static_cast<std::uint32_t>(mesh.NumberOfPoints());
  for (int corner = 0; corner < 8; ++corner)
  {
    AddPoint(mesh,
      Apply(axes,
        { (corner & 1) != 0 ? high[0] : low[0], (corner & 2) != 0 ? high[1] : low[1],
          (corner & 4) != 0 ? high[2] : low[2] }));
  }
  static constexpr int Faces[6][4] = { { 0, 4, 6, 2 }, { 1, 3, 7, 5 }, { 0, 1, 5, 4 },
    { 2, 6, 7, 3 }, { 0, 2, 3, 1 }, { 4, 5, 7, 6 } };
  for (const int* face : Faces)
  {
    AddTriangle(mesh, base + face[0], base + face[1], base + face[2], inside, outside);
    AddTriangle(mesh, base + face[0], base + face[2], base + face[3], inside, outside);
  }
}

/// Where the segment from `a` to `b` enters and leaves a box of AddBox, by its three pairs of
/// planes, as lengths from `a`; both 0 where it misses it.
inline std::array<double, 2> BoxInterval(const Vector3& low, const Vector3& high,
  const std::array<Vector3, 3>& axes, const Vector3& a, const Vector3& b)
{
  double enter = 0;
  double leave = 1;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    // The axes are columns of the rotation: coordinates are dot products with them.
    const double start = Dot(axes[axis], a);
    const double run = Dot(axes[axis], b - a);
    const double t0 = (low[axis] - start) / run;
    const double t1 = (high[axis] - start) / run;
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  const double length = Norm(b - a);
  return leave > enter ? std::array<double, 2>{ enter * length, leave * length }
                       : std::array<double, 2>{ 0, 0 };
}

/// Chord of that segment in the box.
inline double BoxChord(const Vector3& low, const Vector3& high, const std::array<Vector3, 3>& axes,
  const Vector3& a, const Vector3& b)
{
  const auto [enter, leave] = BoxInterval(low, high, axes, a, b);
  return leave - enter;
}

/// Slabs stacked along z that share their interfaces: material m + 1 between heights[m] and
/// heights[m + 1].
inline SurfaceMesh Layers(const std::vector<double>& heights, double halfWidth)
{
  SurfaceMesh mesh;
  const int layers = static_cast<int>(heights.size()) - 1;
  for (const double z : heights)
  {
    AddPoint(mesh, { -halfWidth, -halfWidth, z });
    AddPoint(mesh, { halfWidth, -halfWidth, z });
    AddPoint(mesh, { halfWidth, halfWidth, z });
    AddPoint(mesh, { -halfWidth, halfWidth, z });
  }
  for (int plane = 0; plane <= layers; ++plane)
  {
    const auto base = static_cast<std::uint32_t>(4 * plane);
    const int above = plane < layers ? plane + 1 : 0;
    AddTriangle(mesh, base, base + 1, base + 2, plane, above);
    AddTriangle(mesh, base, base + 2, base + 3, plane, above);
    for (std::uint32_t side = 0; plane < layers && side < 4; ++side)
    {
      const std::uint32_t next = (side + 1) % 4;
      AddTriangle(mesh, base + side, base + next, base + 4 + next, above, 0);
      AddTriangle(mesh, base + side, base + 4 + next, base + 4 + side, above, 0);
    }
  }
  return mesh;
}

/// An icosahedron, each triangle split in four `levels` times, points on the sphere.
inline void AddSphere(SurfaceMesh& mesh, const Vector3& center, double radius, int levels,
  int inside, int outside = 0)
{
  std::vector<Vector3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles{ { 0, 11, 5 }, { 0, 5, 1 }, { 0, 1, 7 },
    { 0, 7, 10 }, { 0, 10, 11 }, { 1, 5, 9 }, { 5, 11, 4 }, { 11, 10, 2 }, { 10, 7, 6 },
    { 7, 1, 8 }, { 3, 9, 4 }, { 3, 4, 2 }, { 3, 2, 6 }, { 3, 6, 8 }, { 3, 8, 9 }, { 4, 9, 5 },
    { 2, 4, 11 }, { 6, 2, 10 }, { 8, 6, 7 }, { 9, 8, 1 } };
  const double g = std::numbers::phi;
  for (const Vector3& p : std::initializer_list<Vector3>{ { -1, g, 0 }, { 1, g, 0 }, { -1, -g, 0 },
         { 1, -g, 0 }, { 0, -1, g }, { 0, 1, g }, { 0, -1, -g }, { 0, 1, -g }, { g, 0, -1 },
         { g, 0, 1 }, { -g, 0, -1 }, { -g, 0, 1 } })
  {
    points.push_back((1 / Norm(p)) * p);
  }
  for (int level = 0; level < levels; ++level)
  {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b)
    {
      const auto [entry, isNew] = middles.try_emplace({ std::min(a, b), std::max(a, b) },
        static_cast<std::uint32_t>(points.size()));
      if (isNew)
      {
        const Vector3 sum = points[a] + points[b];
        points.push_back((1 / Norm(sum)) * sum);
      }
      return entry->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : triangles)
    {
      const std::uint32_t ab = middle(a, b);
      const std::uint32_t bc = middle(b, c);
      const std::uint32_t ca = middle(c, a);
      finer.insert(finer.end(), { { a, ab, ca }, { b, bc, ab }, { c, ca, bc }, { ab, bc, ca } });
    }
    triangles = std::move(finer);
  }
  const auto base = static_cast<std::uint32_t>(mesh.NumberOfPoints());
  for (const Vector3& p : points)
  {
    AddPoint(mesh, center + radius * p);
  }
  for (const auto& [a, b, c] : triangles)
  {
    AddTriangle(mesh, base + a, base + b, base + c, inside, outside);
  }
}

inline Vector3 PointOf(const SurfaceMesh& mesh, std::uint32_t index)
{
  return { mesh.Points[3 * index], mesh.Points[3 * index + 1], mesh.Points[3 * index + 2] };
}

/**
 * Path lengths of one segment by testing every triangle in double precision; the hits of the whole
 * line are sorted and walked through, which is not how the projector does it. Empty when the walk
 * meets a wrong material.
 */
inline std::vector<double> ReferenceLengths(const SurfaceMesh& mesh, const Vector3& from,
  const Vector3& to)
{
  struct Hit
  {
    double T;
    int Left;
    int Entered;
  };
  const double length = Norm(to - from);
  const Vector3 d = (1 / length) * (to - from);
  std::vector<Hit> hits;
  for (std::size_t triangle = 0; triangle < mesh.NumberOfTriangles(); ++triangle)
  {
    const Vector3 p0 = PointOf(mesh, mesh.Triangles[3 * triangle]) - from;
    const Vector3 p1 = PointOf(mesh, mesh.Triangles[3 * triangle + 1]) - from;
    const Vector3 p2 = PointOf(mesh, mesh.Triangles[3 * triangle + 2]) - from;
    const double u = Dot(d, Cross(p1, p2));
    const double v = Dot(d, Cross(p2, p0));
    const double w = Dot(d, Cross(p0, p1));
    const bool front = u > 0 && v > 0 && w > 0;
    if (!front && !(u < 0 && v < 0 && w < 0))
    {
      continue;
    }
    const Vector3 normal = Cross(p1 - p0, p2 - p0);
    const int frontMaterial = mesh.FrontMaterials[triangle];
    const int backMaterial = mesh.BackMaterials[triangle];
    const bool facesSource = Dot(normal, d) < 0;
    hits.push_back({ Dot(normal, p0) / Dot(normal, d), facesSource ? frontMaterial : backMaterial,
      facesSource ? backMaterial : frontMaterial });
  }
  std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) { return a.T < b.T; });
  std::vector<double> lengths(static_cast<std::size_t>(mesh.NumberOfMaterials()), 0.0);
  int material = 0;
  double previous = 0; // in air, where it starts, nothing is counted
  for (std::size_t index = 0; index < hits.size(); ++index)
  {
    // Of surfaces that coincide, the one that continues the walk comes first.
    for (std::size_t other = index + 1; other < hits.size() && hits[index].Left != material &&
         hits[other].T < hits[index].T + 1e-9;
         ++other)
    {
      std::swap(hits[index], hits[other]);
    }
    const Hit& hit = hits[index];
    if (hit.Left != material)
    {
      return {};
    }
    const double t = std::clamp(hit.T, 0.0, length);
    lengths[static_cast<std::size_t>(material)] += t - previous;
    previous = t;
    material = hit.Entered;
  }
  lengths[0] = 0;
  return material == 0 ? lengths : std::vector<double>{};
}
}

#endif
