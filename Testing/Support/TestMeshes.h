// SPDX-License-Identifier: Apache-2.0
// Structured tetrahedral meshes for tests.
#ifndef mammoray_TestMeshes_h
#define mammoray_TestMeshes_h

#include "mammoray/Foundation/Meshes.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>

namespace mammoray::test
{
/**
 * The box from `low` to `high`, cut into count[0] x count[1] x count[2] bricks of six tetrahedra
 * each (Kuhn's subdivision: all share the brick's diagonal, neighbours fit). Material 1.
 */
inline TetrahedralMesh MakeBoxMesh(const Vector3& low, const Vector3& high,
  const std::array<int, 3>& count)
{
  TetrahedralMesh mesh;
  const auto index = [&](int i, int j, int k)
  { return static_cast<std::int32_t>((k * (count[1] + 1) + j) * (count[0] + 1) + i); };
  for (int k = 0; k <= count[2]; ++k)
  {
    for (int j = 0; j <= count[1]; ++j)
    {
      for (int i = 0; i <= count[0]; ++i)
      {
        const int ijk[3] = { i, j, k };
        for (int axis = 0; axis < 3; ++axis)
        {
          mesh.Points.push_back(low[axis] + (high[axis] - low[axis]) * ijk[axis] / count[axis]);
        }
      }
    }
  }
  constexpr int paths[6][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 0, 2, 1 }, { 2, 1, 0 },
    { 1, 0, 2 } };
  for (int k = 0; k < count[2]; ++k)
  {
    for (int j = 0; j < count[1]; ++j)
    {
      for (int i = 0; i < count[0]; ++i)
      {
        for (int path = 0; path < 6; ++path)
        {
          // From the brick's first to its last corner, one axis at a time.
          int corner[3] = { i, j, k };
          std::array<std::int32_t, 4> ids{ index(i, j, k) };
          for (int step = 0; step < 3; ++step)
          {
            ++corner[paths[path][step]];
            ids[step + 1] = index(corner[0], corner[1], corner[2]);
          }
          if (path >= 3)
          {
            std::swap(ids[1], ids[2]);
          }
          mesh.Cells.insert(mesh.Cells.end(), ids.begin(), ids.end());
          mesh.Materials.push_back(1);
        }
      }
    }
  }
  return mesh;
}

/**
 * Carries a mesh in the cube [-1, 1]^3 over to the ellipsoid with the half axes (a, b, c): volume
 * by volume as even as a closed form can be, x sqrt(1 - y^2/2 - z^2/2 + y^2 z^2/3).
 */
inline void MapCubeToBall(TetrahedralMesh& mesh, double a, double b, double c)
{
  for (std::size_t p = 0; p < mesh.NumberOfPoints(); ++p)
  {
    double* point = &mesh.Points[3 * p];
    const double x = point[0], y = point[1], z = point[2];
    point[0] = a * x * std::sqrt(1 - y * y / 2 - z * z / 2 + y * y * z * z / 3);
    point[1] = b * y * std::sqrt(1 - z * z / 2 - x * x / 2 + z * z * x * x / 3);
    point[2] = c * z * std::sqrt(1 - x * x / 2 - y * y / 2 + x * x * y * y / 3);
  }
}

/**
 * A breast in the frame x lateral, y anterior, z up: half an ellipsoid with the half axes (a, b,
 * c), its flat side on y = 0, of count[0] x count[1] x count[2] bricks. Material 1; the layer of
 * bricks at the flat side is of material 2 (for the chest wall) when `chestWall`.
 */
inline TetrahedralMesh MakeHalfEllipsoidMesh(double a, double b, double c,
  const std::array<int, 3>& count, bool chestWall = true)
{
  TetrahedralMesh mesh = MakeBoxMesh({ -1, 0, -1 }, { 1, 1, 1 }, count);
  for (std::size_t cell = 0; chestWall && cell < mesh.NumberOfCells(); ++cell)
  {
    double centre = 0;
    for (int corner = 0; corner < 4; ++corner)
    {
      centre += 0.25 * mesh.Points[3 * mesh.Cells[4 * cell + corner] + 1];
    }
    mesh.Materials[cell] = centre < 1.0 / count[1] ? 2 : 1;
  }
  MapCubeToBall(mesh, a, b, c);
  return mesh;
}

/// The same with `count` bricks across (x, z; even) and count / 2 along y.
inline TetrahedralMesh MakeHalfEllipsoidMesh(double a, double b, double c, int count,
  bool chestWall = true)
{
  return MakeHalfEllipsoidMesh(a, b, c, { count, count / 2, count }, chestWall);
}
}

#endif
