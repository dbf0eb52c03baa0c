// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/ExampleScenes.h"

#include "mammoray/XRay/LabelSurface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

namespace mammoray
{
namespace
{
constexpr std::size_t PlateTriangleCount = 15'626;
constexpr std::size_t BreastTriangleCount = 5'185'458;

std::uint32_t AddPoint(SurfaceMesh& mesh, const Vector3& point)
{
  mesh.Points.insert(mesh.Points.end(), point.begin(), point.end());
  return static_cast<std::uint32_t>(mesh.NumberOfPoints() - 1);
}

/// A triangle of a closed surface in air that is seen counter-clockwise from outside.
void AddTriangle(SurfaceMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c,
  std::uint16_t inside)
{
  mesh.Triangles.insert(mesh.Triangles.end(), { a, b, c });
  mesh.BackMaterials.push_back(inside);
  mesh.FrontMaterials.push_back(0);
}

/// A box in air whose faces are grids of cells[0] x cells[1] x cells[2] squares.
QuadMesh GridBox(const Vector3& low, const Vector3& high, const std::array<int, 3>& cells)
{
  QuadMesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> ids;
  const auto id = [&](const std::array<int, 3>& index)
  {
    const auto [entry, isNew] =
      ids.try_emplace(index, static_cast<std::uint32_t>(mesh.Points.size()));
    if (isNew)
    {
      Vector3 point{};
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        point[axis] = low[axis] + (high[axis] - low[axis]) * index[axis] / cells[axis];
      }
      mesh.Points.push_back(point);
    }
    return entry->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const std::size_t first = (axis + 1) % 3;
    const std::size_t second = (axis + 2) % 3;
    for (const int end : { 0, cells[axis] })
    {
      for (int i = 0; i < cells[first]; ++i)
      {
        for (int j = 0; j < cells[second]; ++j)
        {
          const auto corner = [&](int di, int dj)
          {
            std::array<int, 3> index{};
            index[axis] = end;
            index[first] = i + di;
            index[second] = j + dj;
            return id(index);
          };
          // Normals along +axis: outwards at the high end only.
          mesh.Quads.push_back({ corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1) });
          mesh.FrontMaterials.push_back(end == 0 ? 1 : 0);
          mesh.BackMaterials.push_back(end == 0 ? 0 : 1);
        }
      }
    }
  }
  return mesh;
}

Vector3 RotateAbout(std::size_t axis, double angle, const Vector3& v)
{
  const std::size_t first = (axis + 1) % 3;
  const std::size_t second = (axis + 2) % 3;
  Vector3 rotated = v;
  rotated[first] = std::cos(angle) * v[first] - std::sin(angle) * v[second];
  rotated[second] = std::sin(angle) * v[first] + std::cos(angle) * v[second];
  return rotated;
}

/// A box of 12 triangles; `place` turns and moves its corners, which stand at -half or +half.
void AddBox(SurfaceMesh& mesh, const Vector3& half, std::uint16_t inside,
  const std::function<Vector3(const Vector3&)>& place)
{
  const auto base = static_cast<std::uint32_t>(mesh.NumberOfPoints());
  for (int corner = 0; corner < 8; ++corner)
  {
    AddPoint(mesh,
      place({ (corner & 1) != 0 ? half[0] : -half[0], (corner & 2) != 0 ? half[1] : -half[1],
        (corner & 4) != 0 ? half[2] : -half[2] }));
  }
  static constexpr std::uint32_t Faces[6][4] = { { 0, 4, 6, 2 }, { 1, 3, 7, 5 }, { 0, 1, 5, 4 },
    { 2, 6, 7, 3 }, { 0, 2, 3, 1 }, { 4, 5, 7, 6 } };
  for (const std::uint32_t* face : Faces)
  {
    AddTriangle(mesh, base + face[0], base + face[1], base + face[2], inside);
    AddTriangle(mesh, base + face[0], base + face[2], base + face[3], inside);
  }
}

/**
 * A tube closed by a cone at each end, 2 x around x rings triangles; `axis` gives the middle line's
 * point at 0 to 1. Its cross-sections are horizontal circles.
 */
void AddTube(SurfaceMesh& mesh, std::uint32_t around, std::uint32_t rings, double radius,
  std::uint16_t inside, const std::function<Vector3(double)>& axis)
{
  const std::uint32_t bottom = AddPoint(mesh, axis(0));
  const std::uint32_t base = bottom + 1;
  for (std::uint32_t ring = 0; ring < rings; ++ring)
  {
    const Vector3 center = axis((ring + 1.0) / (rings + 1.0));
    for (std::uint32_t k = 0; k < around; ++k)
    {
      const double angle = 2 * std::numbers::pi * k / around;
      AddPoint(mesh, center + radius * Vector3{ std::cos(angle), std::sin(angle), 0 });
    }
  }
  const std::uint32_t top = AddPoint(mesh, axis(1));
  for (std::uint32_t k = 0; k < around; ++k)
  {
    const std::uint32_t next = (k + 1) % around;
    AddTriangle(mesh, bottom, base + next, base + k, inside);
    for (std::uint32_t ring = 0; ring + 1 < rings; ++ring)
    {
      const std::uint32_t low = base + ring * around;
      const std::uint32_t high = low + around;
      AddTriangle(mesh, low + k, low + next, high + next, inside);
      AddTriangle(mesh, low + k, high + next, high + k, inside);
    }
    const std::uint32_t last = base + (rings - 1) * around;
    AddTriangle(mesh, last + k, last + next, top, inside);
  }
}

Material XRayMaterial(const char* name, const char* attenuation, double densityGPerCm3)
{
  Material material;
  material.Name = name;
  material.Attenuation = attenuation;
  material.DensityGPerCm3 = densityGPerCm3;
  return material;
}

/// Source at (x, y, 650); a detector of `width` x `height` mm in the plane z = 0 about (x, y).
void PlaceAbove(ExampleScene& scene, double x, double y, int columns, int rows, double width,
  double height)
{
  scene.Source.Position = { x, y, 650 };
  scene.Detector.Columns = columns;
  scene.Detector.Rows = rows;
  const double column = width / columns;
  const double row = height / rows;
  scene.Detector.ColumnStep = { column, 0, 0 };
  scene.Detector.RowStep = { 0, -row, 0 };
  scene.Detector.Origin = { x - 0.5 * (columns - 1) * column, y + 0.5 * (rows - 1) * row, 0 };
}

/// The largest x of tissue that is fixed to the body, mm; 0 if there is none.
double FrontOfFixed(const QuadMesh& mesh, const MaterialTable& table)
{
  double front = 0;
  for (std::size_t quad = 0; quad < mesh.Quads.size(); ++quad)
  {
    if (table.Materials[mesh.FrontMaterials[quad]].Fixed ||
      table.Materials[mesh.BackMaterials[quad]].Fixed)
    {
      front = std::max(front, mesh.Points[mesh.Quads[quad][0]][0]);
    }
  }
  return front;
}
}

const std::vector<std::string>& ExampleNames()
{
  static const std::vector<std::string> names{ "test", "boxes", "veins", "breast" };
  return names;
}

ExampleScene MakePlateScene()
{
  ExampleScene scene;
  scene.Name = "test";
  scene.Surface =
    GridBox({ -40, -55, 20 }, { 40, 55, 25 }, { 44, 83, 2 }).Triangulate(PlateTriangleCount);
  scene.Materials.Name = scene.Name;
  scene.Materials.Materials = { { "air" }, XRayMaterial("gland", "glandular", 1.035) };
  PlaceAbove(scene, 0, 0, 150, 200, 100, 133);
  return scene;
}

ExampleScene MakeBoxesScene()
{
  ExampleScene scene;
  scene.Name = "boxes";
  for (int box = 0; box < 3965; ++box)
  {
    const int row = box / 18 % 18;
    const int layer = box / 324;
    const Vector3 center{ -70 + 8.0 * (box % 18), -70 + 8.0 * row, 20 + 8.0 * layer };
    AddBox(scene.Surface, { 2, 2.5, 1.5 }, static_cast<std::uint16_t>(1 + box % 3),
      [&](const Vector3& corner)
      {
        return center +
          RotateAbout(2, 0.3 * box, RotateAbout(1, 0.7 * box, RotateAbout(0, 0.1 * box, corner)));
      });
  }
  scene.Materials.Name = scene.Name;
  scene.Materials.Materials = { { "air" }, XRayMaterial("fat", "adipose", 0.92),
    XRayMaterial("gland", "glandular", 1.035), XRayMaterial("muscle", "muscle", 1.05) };
  PlaceAbove(scene, 0, 0, 250, 200, 200, 160);
  return scene;
}

ExampleScene MakeVeinsScene()
{
  ExampleScene scene;
  scene.Name = "veins";
  for (int tube = 0; tube < 97; ++tube)
  {
    const double phase = 0.8 * tube;
    AddTube(scene.Surface, 8, 139, 1.0 + 0.3 * std::sin(phase), 1,
      [&](double height)
      {
        return Vector3{ 0.6 * (tube - 48) + 30 * std::sin(3 * height + phase),
          40 * std::cos(2 * height + 1.7 * phase), 10 + 0.8 * (tube % 7) + 80 * height };
      });
  }
  scene.Materials.Name = scene.Name;
  scene.Materials.Materials = { { "air" }, XRayMaterial("blood", "blood", 1.06) };
  PlaceAbove(scene, 0, 0, 1681, 2071, 168.1, 207.1);
  return scene;
}

ExampleScene MakeBreastScene(const LabelVolume& labels, const MaterialTable& table)
{
  constexpr double thicknessMm = 50;
  ExampleScene scene;
  scene.Name = "breast";
  scene.Materials = table;
  QuadMesh mesh = ExtractInterfaces(table.ToMaterials(labels, "breast"), 8);
  Box3 box;
  for (const Vector3& point : mesh.Points)
  {
    box.Add(point);
  }
  const Vector3& low = box.Low;
  const Vector3& high = box.High;
  const double squeezed = thicknessMm / (high[2] - low[2]);
  const double widened = 1 / std::sqrt(squeezed);
  const Vector3 middle = 0.5 * (low + high);
  constexpr double heightMm = 20; // of the breast's lower side above the detector
  for (Vector3& point : mesh.Points)
  {
    point = { widened * (point[0] - low[0]), widened * (point[1] - middle[1]),
      squeezed * (point[2] - low[2]) + heightMm };
  }
  scene.Surface = mesh.Triangulate(BreastTriangleCount);
  // The whole breast from left to right; the chest muscle stays out of view, as in mammography.
  const double edge = 1.12 * widened * (high[1] - low[1]);
  const double chestWall = FrontOfFixed(mesh, table);
  PlaceAbove(scene, chestWall + 0.5 * edge, 0, 1080, 1080, edge, edge);
  scene.Source.Position[0] = chestWall;
  return scene;
}
}
