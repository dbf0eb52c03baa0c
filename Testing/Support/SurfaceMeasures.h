// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Testing_SurfaceMeasures_h
#define mammoray_Testing_SurfaceMeasures_h

#include "mammoray/Foundation/Meshes.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace mammoray::test
{
/**
 * Whether the boundary of every material is closed: each of its edges is run through as often one
 * way as the other. Sums a hash of edge and material with that sign, so a false "yes" has a chance
 * of 2^-64.
 */
inline bool IsClosed(const SurfaceMesh& mesh)
{
  const auto hash = [](std::uint64_t value)
  {
    value += 0x9e3779b97f4a7c15; // splitmix64
    value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9;
    value = (value ^ (value >> 27)) * 0x94d049bb133111eb;
    return value ^ (value >> 31);
  };
  std::uint64_t sum = 0;
  for (std::size_t triangle = 0; triangle < mesh.NumberOfTriangles(); ++triangle)
  {
    const std::uint64_t sides =
      hash(mesh.BackMaterials[triangle]) - hash(mesh.FrontMaterials[triangle]);
    for (std::size_t corner = 0; corner < 3; ++corner)
    {
      const std::uint64_t a = mesh.Triangles[3 * triangle + corner];
      const std::uint64_t b = mesh.Triangles[3 * triangle + (corner + 1) % 3];
      const std::uint64_t edge = hash(a < b ? (a << 32) | b : (b << 32) | a) | 1;
      sum += a < b ? edge * sides : 0 - edge * sides;
    }
  }
  return sum == 0;
}

/// Volume of each material, mm^3, by the divergence theorem.
inline std::vector<double> MaterialVolumes(const SurfaceMesh& mesh)
{
  std::vector<double> volumes(static_cast<std::size_t>(mesh.NumberOfMaterials()), 0.0);
  const auto point = [&mesh](std::size_t corner)
  {
    const std::size_t id = mesh.Triangles[corner];
    return Vector3{ mesh.Points[3 * id], mesh.Points[3 * id + 1], mesh.Points[3 * id + 2] };
  };
  const Vector3 origin = point(0);
  for (std::size_t triangle = 0; triangle < mesh.NumberOfTriangles(); ++triangle)
  {
    const double volume =
      Dot(point(3 * triangle) - origin,
        Cross(point(3 * triangle + 1) - origin, point(3 * triangle + 2) - origin)) /
      6;
    volumes[mesh.BackMaterials[triangle]] += volume;
    volumes[mesh.FrontMaterials[triangle]] -= volume;
  }
  return volumes;
}
}

#endif
