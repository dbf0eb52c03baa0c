// SPDX-License-Identifier: Apache-2.0
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Meshes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

namespace
{
using namespace mammoray;

/// A block of n^3 cubes, six tetrahedra each (Kuhn's division), with random materials 1 to 5.
TetrahedralMesh RandomBlock(int n, unsigned seed)
{
  TetrahedralMesh mesh;
  for (int k = 0; k <= n; ++k)
  {
    for (int j = 0; j <= n; ++j)
    {
      for (int i = 0; i <= n; ++i)
      {
        mesh.Points.insert(mesh.Points.end(), { 1.5 * i, 2.0 * j, 1.0 * k });
      }
    }
  }
  std::mt19937 generator(seed);
  for (int cube = 0; cube < n * n * n; ++cube)
  {
    int axes[3] = { 0, 1, 2 };
    do
    {
      int position[3] = { cube % n, cube / n % n, cube / n / n };
      std::int32_t ids[4];
      for (int corner = 0; corner < 4; ++corner)
      {
        ids[corner] = (position[2] * (n + 1) + position[1]) * (n + 1) + position[0];
        if (corner < 3)
        {
          ++position[axes[corner]];
        }
      }
      mesh.Cells.insert(mesh.Cells.end(), { ids[0], ids[1], ids[2], ids[3] });
      mesh.Materials.push_back(static_cast<std::int32_t>(1 + generator() % 5));
      if (mesh.CellVolume(mesh.NumberOfCells() - 1) < 0)
      {
        std::swap(mesh.Cells[mesh.Cells.size() - 1], mesh.Cells[mesh.Cells.size() - 2]);
      }
    } while (std::next_permutation(axes, axes + 3));
  }
  return mesh;
}

TEST(SurfaceMesh, InterfacesOfRandomLabelsAreClosedAndKeepVolumes)
{
  const TetrahedralMesh mesh = RandomBlock(5, 3);
  std::vector<std::int32_t> pointIds;
  const SurfaceMesh surface = ExtractInterfaces(mesh, &pointIds);
  surface.Validate("surface");
  ASSERT_EQ(surface.NumberOfMaterials(), 6);
  ASSERT_EQ(pointIds.size(), surface.NumberOfPoints());
  for (std::size_t point = 0; point < pointIds.size(); ++point)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      ASSERT_EQ(surface.Points[3 * point + axis],
        mesh.Points[3 * static_cast<std::size_t>(pointIds[point]) + axis]);
    }
  }

  for (int material = 1; material <= 5; ++material)
  {
    double expected = 0;
    for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
    {
      expected += mesh.Materials[cell] == material ? mesh.CellVolume(cell) : 0;
    }
    // Divergence theorem over the material's boundary; and each of its directed edges has a
    // partner.
    double volume = 0;
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (std::size_t triangle = 0; triangle < surface.NumberOfTriangles(); ++triangle)
    {
      ASSERT_NE(surface.FrontMaterials[triangle], surface.BackMaterials[triangle]);
      const int sign = (surface.BackMaterials[triangle] == material ? 1 : 0) -
        (surface.FrontMaterials[triangle] == material ? 1 : 0);
      const std::uint32_t* ids = &surface.Triangles[3 * triangle];
      Vector3 p[3];
      for (int corner = 0; corner < 3; ++corner)
      {
        p[corner] = { surface.Points[3 * ids[corner]], surface.Points[3 * ids[corner] + 1],
          surface.Points[3 * ids[corner] + 2] };
        const std::uint32_t a = ids[corner];
        const std::uint32_t b = ids[(corner + 1) % 3];
        edges[{ std::min(a, b), std::max(a, b) }] += a < b ? sign : -sign;
      }
      volume += sign * Dot(p[0], Cross(p[1], p[2])) / 6;
    }
    EXPECT_NEAR(volume, expected, 1e-9); // sums of some hundred terms of size 100
    for (const auto& [edge, count] : edges)
    {
      ASSERT_EQ(count, 0);
    }
  }
}

TEST(SurfaceMesh, InterfacesOutliveCellsThatAreTurnedOver)
{
  TetrahedralMesh mesh = RandomBlock(5, 3);
  const SurfaceMesh before = ExtractInterfaces(mesh);
  // An inner point goes beyond the cells around it.
  const std::size_t inner = 3 * (2 * 36 + 2 * 6 + 2);
  mesh.Points[inner] += 4;
  ASSERT_THROW(mesh.Validate("mesh"), InputError) << "expected cells that are turned over";
  const SurfaceMesh after = ExtractInterfaces(mesh);
  EXPECT_EQ(after.Triangles, before.Triangles);
  EXPECT_EQ(after.FrontMaterials, before.FrontMaterials);
  EXPECT_EQ(after.BackMaterials, before.BackMaterials);
}

TEST(SurfaceMesh, InterfacesRefuseCellsListedInsideOut)
{
  const TetrahedralMesh mesh = RandomBlock(2, 3);
  TetrahedralMesh one = mesh;
  std::swap(one.Cells[0], one.Cells[1]);
  EXPECT_THROW(ExtractInterfaces(one), InputError);
  TetrahedralMesh all = mesh;
  for (std::size_t cell = 0; cell < all.NumberOfCells(); ++cell)
  {
    std::swap(all.Cells[4 * cell], all.Cells[4 * cell + 1]);
  }
  EXPECT_THROW(ExtractInterfaces(all), InputError);
}

TEST(SurfaceMesh, InterfacesRefuseThreeCellsOnAFace)
{
  TetrahedralMesh mesh;
  mesh.Points = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 2, 0, 0, 3 };
  mesh.Cells = { 0, 1, 2, 3, 0, 1, 2, 4, 0, 1, 2, 5 };
  mesh.Materials = { 1, 1, 1 };
  EXPECT_THROW(ExtractInterfaces(mesh), InputError);
}

TEST(SurfaceMesh, ValidateNamesWhatIsWrong)
{
  SurfaceMesh mesh;
  mesh.Points = { 0, 0, 0, 1, 0, 0, 0, 1, 0 };
  mesh.Triangles = { 0, 1, 3 };
  mesh.FrontMaterials = { 0 };
  mesh.BackMaterials = { 1 };
  try
  {
    mesh.Validate("skin.stl");
    FAIL() << "expected an InputError";
  }
  catch (const InputError& error)
  {
    EXPECT_THAT(error.what(), test::Mentions("skin.stl", "triangle 0", "point 3", "0 to 2"));
  }
  mesh.Triangles[2] = 2;
  EXPECT_NO_THROW(mesh.Validate("skin.stl"));
  mesh.BackMaterials.clear();
  EXPECT_THROW(mesh.Validate("skin.stl"), InputError);
}
}
