// SPDX-License-Identifier: Apache-2.0
#include "Refusals.h"
#include "SurfaceShapes.h"
#include "TestMeshes.h"
#include "mammoray/Meshing/MeshCheck.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <utility>
#include <vector>

using namespace mammoray;
using namespace shapes;
using Kind = MeshDefect::Kind;

namespace
{
/// A cube of `mm` in six tetrahedra around its diagonal (Kuhn's division).
TetrahedralMesh Cube(double mm, const Vector3& low = { 0, 0, 0 }, int material = 1)
{
  TetrahedralMesh mesh;
  for (int corner = 0; corner < 8; ++corner)
  {
    for (int a = 0; a < 3; ++a)
    {
      mesh.Points.push_back(low[a] + ((corner >> a & 1) != 0 ? mm : 0));
    }
  }
  for (const auto& [first, second] : { std::pair{ 1, 3 }, std::pair{ 3, 2 }, std::pair{ 2, 6 },
         std::pair{ 6, 4 }, std::pair{ 4, 5 }, std::pair{ 5, 1 } })
  {
    mesh.Cells.insert(mesh.Cells.end(), { 0, first, second, 7 });
    mesh.Materials.push_back(material);
  }
  return mesh;
}

void Append(TetrahedralMesh& mesh, const TetrahedralMesh& other)
{
  const auto base = static_cast<std::int32_t>(mesh.NumberOfPoints());
  mesh.Points.insert(mesh.Points.end(), other.Points.begin(), other.Points.end());
  for (const std::int32_t id : other.Cells)
  {
    mesh.Cells.push_back(base + id);
  }
  mesh.Materials.insert(mesh.Materials.end(), other.Materials.begin(), other.Materials.end());
}
}

TEST(MeshCheck, CubeIsSoundWithKnownMeasures)
{
  TetrahedralMesh mesh = Cube(2);
  mesh.Materials[0] = 2;
  const MeshCheck check = CheckMesh(mesh);
  EXPECT_TRUE(check.Sound());
  EXPECT_TRUE(check.Defects.empty());
  EXPECT_EQ(check.Points, 8u);
  // Twelve on the cube, and the two faces between the first cell and its neighbours.
  EXPECT_EQ(check.Triangles, 14u);
  ASSERT_EQ(check.Materials.size(), 2u);
  // Closed forms: a sixth of the cube each; dihedral angles 45, 60 and 90 degrees; half the cube's
  // diagonal over its edge. A dozen double operations.
  EXPECT_NEAR(check.Materials[0].VolumeMm3, 8.0 * 5 / 6, 1e-12);
  EXPECT_NEAR(check.Materials[1].VolumeMm3, 8.0 / 6, 1e-12);
  EXPECT_NEAR(check.Materials[1].SmallestDihedralDeg, 45, 1e-12);
  EXPECT_NEAR(check.Materials[1].LargestRadiusEdgeRatio, std::sqrt(3.0) / 2, 1e-12);
  EXPECT_EQ(check.Materials[1].BoundaryTriangles, 4u);
  // Two half faces, and two triangles of an edge and a face's diagonal.
  EXPECT_NEAR(check.Materials[1].BoundaryAreaMm2, 4 + 4 * std::sqrt(2.0), 1e-12);
  EXPECT_EQ(check.Materials[0].DihedralHistogram[15] + check.Materials[0].DihedralHistogram[14],
    5u);
  EXPECT_EQ(check.Materials[0].RadiusEdgeHistogram[4], 5u);
}

TEST(MeshCheck, FindsInvertedCells)
{
  TetrahedralMesh mesh = Cube(2);
  std::swap(mesh.Cells[4 * 3], mesh.Cells[4 * 3 + 1]);
  const MeshCheck check = CheckMesh(mesh);
  EXPECT_FALSE(check.Sound());
  const MeshDefect* defect = check.Find(Kind::InvertedCells);
  ASSERT_TRUE(defect);
  EXPECT_EQ(defect->Count, 1u);
  // The fourth cell, of corners 0, 6, 4 and 7: (0, 0, 0), (0, 2, 2), (0, 0, 2), (2, 2, 2).
  EXPECT_THAT(defect->Text({ "air", "fat" }),
    testing::AllOf(test::Mentions("1 cells"), testing::HasSubstr("fat at (0.5, 1, 1.5) mm")));
  // Its faces are seen from the wrong side.
  EXPECT_TRUE(check.Find(Kind::OverlappingCells));
}

TEST(MeshCheck, FindsCellsThatAreNotJoined)
{
  TetrahedralMesh mesh = Cube(1);
  Append(mesh, Cube(1, { 1, 0, 0 }, 2));
  const MeshCheck check = CheckMesh(mesh);
  ASSERT_TRUE(check.Find(Kind::CoincidentPoints));
  EXPECT_EQ(check.Find(Kind::CoincidentPoints)->Count, 4u);
  EXPECT_FALSE(check.Sound());
}

TEST(MeshCheck, FindsFacesOfThreeCellsAndUnusedPoints)
{
  TetrahedralMesh mesh = Cube(1);
  const auto id = static_cast<std::int32_t>(mesh.NumberOfPoints());
  mesh.Points.insert(mesh.Points.end(), { 0.9, 0.1, 0.8, 5, 5, 5 });
  mesh.Cells.insert(mesh.Cells.end(), { 0, 1, 7, id }); // shares the face 0 1 7 of two cells
  mesh.Materials.push_back(1);
  const MeshCheck check = CheckMesh(mesh);
  ASSERT_TRUE(check.Find(Kind::OverlappingCells));
  EXPECT_EQ(check.Find(Kind::OverlappingCells)->Count, 1u);
  ASSERT_TRUE(check.Find(Kind::UnusedPoints));
  EXPECT_EQ(check.Find(Kind::UnusedPoints)->Places[0].Point, (Vector3{ 5, 5, 5 }));
}

TEST(MeshCheck, CubesThatTouchAtAnEdgeOrCornerArePinched)
{
  for (const bool edge : { true, false })
  {
    TetrahedralMesh mesh = Cube(1);
    TetrahedralMesh other = Cube(1, { 1, 1, edge ? 0.0 : 1.0 });
    // Joined: points at the same place become one.
    std::vector<std::int32_t> ids;
    for (std::size_t point = 0; point < other.NumberOfPoints(); ++point)
    {
      std::size_t same = 0;
      while (same < 8 && mesh.Point(same) != other.Point(point))
      {
        ++same;
      }
      if (same == 8)
      {
        same = mesh.NumberOfPoints();
        const Vector3 at = other.Point(point);
        mesh.Points.insert(mesh.Points.end(), at.begin(), at.end());
      }
      ids.push_back(static_cast<std::int32_t>(same));
    }
    for (const std::int32_t id : other.Cells)
    {
      mesh.Cells.push_back(ids[static_cast<std::size_t>(id)]);
    }
    mesh.Materials.resize(12, 1);
    const MeshCheck check = CheckMesh(mesh);
    EXPECT_FALSE(check.Sound());
    ASSERT_TRUE(check.Find(Kind::Pinches)) << edge;
    EXPECT_EQ(check.Find(Kind::Pinches)->Count, 1u) << edge;
    EXPECT_EQ(check.Find(Kind::Pinches)->Places[0].Point, (Vector3{ 1, 1, edge ? 0.5 : 1.0 }));
  }
}

TEST(MeshCheck, ABodyOfTwoMaterialsThatHangsByAnEdgeIsPinched)
{
  // Either material is a box of its own; the air around them touches itself at their edge.
  TetrahedralMesh mesh = test::MakeBoxMesh({ 0, 0, 0 }, { 2, 2, 1 }, { 2, 2, 1 });
  TetrahedralMesh diagonal;
  diagonal.Points = mesh.Points;
  for (const std::size_t brick : { std::size_t{ 0 }, std::size_t{ 3 } })
  {
    const auto begin = mesh.Cells.begin() + static_cast<std::ptrdiff_t>(24 * brick);
    diagonal.Cells.insert(diagonal.Cells.end(), begin, begin + 24);
    diagonal.Materials.insert(diagonal.Materials.end(), 6, brick == 0 ? 1 : 2);
  }
  const MeshCheck check = CheckMesh(diagonal);
  const MeshDefect* pinches = check.Find(Kind::Pinches);
  ASSERT_TRUE(pinches);
  EXPECT_EQ(pinches->Count, 1u);
  EXPECT_EQ(pinches->Places[0].Material, 0);
  EXPECT_EQ(pinches->Places[0].Point, (Vector3{ 1, 1, 0.5 }));
}

TEST(MeshCheck, SphereSurfaceAndItsHoles)
{
  SurfaceMesh surface;
  AddSphere(surface, { 10, 20, 30 }, 5, 3, 3);
  MeshCheck check = CheckSurface(surface);
  EXPECT_TRUE(check.Sound());
  EXPECT_TRUE(check.Defects.empty());
  ASSERT_EQ(check.Materials.size(), 1u);
  // 1 %: 1280 facets inscribed in the sphere; the deficit of three divisions is about 0.9 %.
  EXPECT_NEAR(check.Materials[0].VolumeMm3, 523.6, 6);

  // Two triangles far from each other taken away: two holes, each as long as its triangle.
  for (const std::size_t triangle : { std::size_t{ 900 }, std::size_t{ 10 } })
  {
    surface.Triangles.erase(surface.Triangles.begin() + 3 * triangle,
      surface.Triangles.begin() + 3 * triangle + 3);
    surface.FrontMaterials.pop_back();
    surface.BackMaterials.pop_back();
  }
  check = CheckSurface(surface);
  EXPECT_FALSE(check.Sound());
  const MeshDefect* holes = check.Find(Kind::Holes);
  ASSERT_TRUE(holes);
  EXPECT_EQ(holes->Count, 2u);
  for (const MeshDefect::Place& hole : holes->Places)
  {
    // The centre of a facet of about 0.7 mm lies 0.02 mm within the sphere.
    EXPECT_NEAR(Norm(hole.Point - Vector3{ 10, 20, 30 }), 5, 0.1);
    EXPECT_GT(hole.LengthMm, 1);
    EXPECT_LT(hole.LengthMm, 3);
    EXPECT_EQ(hole.Material, 3);
  }
  EXPECT_GE(holes->Places[0].LengthMm, holes->Places[1].LengthMm);
}

TEST(MeshCheck, DoubledTrianglesAreNoHoles)
{
  SurfaceMesh surface;
  AddSphere(surface, { 10, 20, 30 }, 5, 2, 3);
  const double volume = CheckSurface(surface).Materials[0].VolumeMm3;
  for (const std::size_t triangle : { std::size_t{ 7 }, std::size_t{ 90 } })
  {
    // From another corner on.
    const std::uint32_t* ids = &surface.Triangles[3 * triangle];
    AddTriangle(surface, ids[1], ids[2], ids[0], 3, 0);
  }
  const MeshCheck check = CheckSurface(surface);
  EXPECT_FALSE(check.Find(Kind::Holes));
  ASSERT_TRUE(check.Find(Kind::DoubledTriangles));
  EXPECT_EQ(check.Find(Kind::DoubledTriangles)->Count, 2u);
  EXPECT_THAT(check.Find(Kind::DoubledTriangles)->Text({}),
    testing::HasSubstr("2 triangles that are there twice: material 3 at"));
  EXPECT_NEAR(check.Materials[0].VolumeMm3, volume, 1e-9);
}

TEST(MeshCheck, TrianglesThatNameAPointTwiceAreNoHoles)
{
  SurfaceMesh surface;
  AddSphere(surface, { 10, 20, 30 }, 5, 2, 3);
  AddTriangle(surface, 4, 4, 9, 3, 0);
  const MeshCheck check = CheckSurface(surface);
  EXPECT_FALSE(check.Find(Kind::Holes));
  EXPECT_FALSE(check.Find(Kind::Pinches));
  ASSERT_TRUE(check.Find(Kind::FlatTriangles));
  EXPECT_EQ(check.Find(Kind::FlatTriangles)->Count, 1u);
}

TEST(MeshCheck, TurnedAndDoubledTrianglesAndHolesAreToldApart)
{
  SurfaceMesh surface;
  AddSphere(surface, { 10, 20, 30 }, 5, 3, 3);
  const double volume = CheckSurface(surface).Materials[0].VolumeMm3;
  const auto ids = [&surface](std::size_t triangle) { return &surface.Triangles[3 * triangle]; };
  // Two far from each other.
  for (const std::size_t triangle : { 7, 900 })
  {
    std::swap(ids(triangle)[1], ids(triangle)[2]);
  }
  MeshCheck check = CheckSurface(surface);
  ASSERT_TRUE(check.Find(Kind::TurnedTriangles));
  EXPECT_EQ(check.Find(Kind::TurnedTriangles)->Count, 2u);
  EXPECT_THAT(check.Find(Kind::TurnedTriangles)->Text({}),
    testing::HasSubstr("2 triangles turned against their neighbours: material 3 at"));
  EXPECT_FALSE(check.Find(Kind::Holes));
  EXPECT_NEAR(check.Materials[0].VolumeMm3, volume, 1e-9);
  // One there twice in the same sense, one in the other, and a hole.
  const std::vector<std::uint32_t> given = surface.Triangles;
  AddTriangle(surface, given[3 * 100], given[3 * 100 + 1], given[3 * 100 + 2], 3, 0);
  AddTriangle(surface, given[3 * 300], given[3 * 300 + 2], given[3 * 300 + 1], 3, 0);
  surface.Triangles.erase(surface.Triangles.begin() + 3 * 600, surface.Triangles.begin() + 3 * 601);
  surface.FrontMaterials.pop_back();
  surface.BackMaterials.pop_back();
  check = CheckSurface(surface);
  for (const auto& [kind, count] : { std::pair{ Kind::TurnedTriangles, 2u },
         std::pair{ Kind::DoubledTriangles, 2u }, std::pair{ Kind::Holes, 1u } })
  {
    ASSERT_TRUE(check.Find(kind)) << static_cast<int>(kind);
    EXPECT_EQ(check.Find(kind)->Count, count) << static_cast<int>(kind);
  }
  EXPECT_LT(check.Find(Kind::Holes)->Places[0].LengthMm, 3);
  EXPECT_FALSE(check.Find(Kind::Pinches));
}

TEST(MeshCheck, FacesThatBodiesShareAreNotDoubled)
{
  // Two boxes of one material, a face of each at the same points.
  const auto boxes = [](bool isWhole)
  {
    TetrahedralMesh both = test::MakeBoxMesh({ 0, 0, 0 }, { 2, 2, 2 }, { 2, 2, 2 });
    for (std::size_t cell = 0; cell < both.NumberOfCells(); ++cell)
    {
      both.Materials[cell] = both.CellCentre(cell)[0] < 1 ? 1 : 2;
    }
    SurfaceMesh found = ExtractInterfaces(both);
    const std::size_t count = found.NumberOfTriangles();
    for (std::size_t triangle = 0; triangle < count; ++triangle)
    {
      std::uint16_t& front = found.FrontMaterials[triangle];
      std::uint16_t& back = found.BackMaterials[triangle];
      const std::uint32_t* const ids = &found.Triangles[3 * triangle];
      const std::array<std::uint32_t, 3> turned{ ids[0], ids[2], ids[1] };
      const bool isBetween = front != 0 && back != 0;
      front = front == 0 ? 0 : 1;
      back = back == 0 ? 0 : 1;
      if (isBetween)
      {
        front = 0;
        back = 1;
        if (isWhole)
        {
          AddTriangle(found, turned[0], turned[1], turned[2], 1, 0);
        }
      }
    }
    return CheckSurface(found);
  };
  const MeshCheck whole = boxes(true);
  EXPECT_FALSE(whole.Find(Kind::DoubledTriangles));
  EXPECT_FALSE(whole.Find(Kind::TurnedTriangles));
  EXPECT_FALSE(whole.Find(Kind::Holes));
  EXPECT_NEAR(whole.Materials[0].VolumeMm3, 8, 1e-12);
  EXPECT_FALSE(boxes(false).Sound());
}

TEST(MeshCheck, BordersThatCoincideAreNoHoles)
{
  // A cube whose faces have points of their own, as programs write it that give points normals.
  SurfaceMesh cube;
  AddBox(cube, { 0, 0, 0 }, { 10, 10, 10 }, 1);
  SurfaceMesh split;
  std::map<std::array<std::uint32_t, 2>, std::uint32_t> own;
  for (std::size_t triangle = 0; triangle < cube.NumberOfTriangles(); ++triangle)
  {
    const Vector3 normal = Cross(cube.Corner(triangle, 1) - cube.Corner(triangle, 0),
      cube.Corner(triangle, 2) - cube.Corner(triangle, 0));
    std::uint32_t side = 0;
    for (std::uint32_t axis = 0; axis < 3; ++axis)
    {
      side = normal[axis] > 1 ? axis : normal[axis] < -1 ? axis + 3 : side;
    }
    std::uint32_t ids[3];
    for (std::size_t corner = 0; corner < 3; ++corner)
    {
      const std::array key{ side, cube.Triangles[3 * triangle + corner] };
      if (own.count(key) == 0)
      {
        own[key] = AddPoint(split, cube.Corner(triangle, corner));
      }
      ids[corner] = own[key];
    }
    AddTriangle(split, ids[0], ids[1], ids[2], 1, 0);
  }
  ASSERT_EQ(split.NumberOfPoints(), 24u);
  MeshCheck check = CheckSurface(split);
  ASSERT_TRUE(check.Find(Kind::OpenSeams));
  EXPECT_EQ(check.Find(Kind::OpenSeams)->Count, 6u);
  EXPECT_THAT(check.Find(Kind::OpenSeams)->Text({}),
    testing::AllOf(testing::HasSubstr("6 borders that coincide"),
      testing::HasSubstr("border 40 mm")));
  EXPECT_FALSE(check.Find(Kind::Holes));
  // A face that is not there leaves a hole; the other borders still meet each other in part.
  split.Triangles.resize(split.Triangles.size() - 6);
  split.FrontMaterials.resize(10);
  split.BackMaterials.resize(10);
  check = CheckSurface(split);
  EXPECT_TRUE(check.Find(Kind::Holes));
}

TEST(MeshCheck, TouchingSurfacesThatShareTheirInterface)
{
  const SurfaceMesh layers = Layers({ 0, 1, 3 }, 2);
  MeshCheck check = CheckSurface(layers);
  EXPECT_TRUE(check.Sound());
  ASSERT_EQ(check.Materials.size(), 2u);
  // Closed form, to rounding.
  EXPECT_NEAR(check.Materials[0].VolumeMm3, 16, 1e-12);
  EXPECT_NEAR(check.Materials[1].VolumeMm3, 32, 1e-12);
  SurfaceMesh turned = layers;
  std::swap(turned.FrontMaterials[0], turned.BackMaterials[0]);
  check = CheckSurface(turned);
  ASSERT_TRUE(check.Find(Kind::TurnedTriangles));
  EXPECT_EQ(check.Find(Kind::TurnedTriangles)->Count, 1u);
  EXPECT_EQ(check.Defects.size(), 1u);
}

TEST(MeshCheck, SurfacesThatCrossAndPartsInsideOfOthers)
{
  SurfaceMesh surface;
  AddSphere(surface, { -3, 0, 0 }, 5, 3, 1);
  AddSphere(surface, { 3, 0, 0 }, 5, 3, 2);
  MeshCheck check = CheckSurface(surface);
  EXPECT_FALSE(check.Sound());
  const MeshDefect* crossings = check.Find(Kind::Crossings);
  ASSERT_TRUE(crossings);
  EXPECT_GT(crossings->Count, 50u);
  EXPECT_EQ(crossings->Places.size(), MeshDefect::MostPlaces);
  // They meet in the circle of radius 4 at x = 0, to a facet of 0.8 mm.
  EXPECT_NEAR(std::hypot(crossings->Places[0].Point[1], crossings->Places[0].Point[2]), 4, 0.8);
  EXPECT_NE(crossings->Text({ "air", "a", "b" }).find("pairs of triangles that cross"),
    std::string::npos);

  surface = {};
  AddSphere(surface, { 0, 0, 0 }, 5, 2, 1);
  AddSphere(surface, { 0, 0, 1 }, 2, 2, 2); // says air around it
  check = CheckSurface(surface);
  EXPECT_FALSE(check.Find(Kind::Crossings));
  ASSERT_TRUE(check.Find(Kind::DoubledParts));
  EXPECT_EQ(check.Find(Kind::DoubledParts)->Count, 1u);
  EXPECT_GT(check.Find(Kind::DoubledParts)->Places[0].LengthMm, 0.5);

  surface = {};
  AddSphere(surface, { 0, 0, 0 }, 5, 2, 1);
  AddSphere(surface, { 0, 0, 1 }, 2, 2, 2, 1);
  EXPECT_TRUE(CheckSurface(surface).Sound());
}

TEST(MeshCheck, RefusesWhatIsNoMesh)
{
  EXPECT_THROW(CheckMesh({}), InputError);
  TetrahedralMesh mesh = Cube(1);
  mesh.Cells[5] = 77;
  EXPECT_THROW(CheckMesh(mesh), InputError);
  mesh = Cube(1);
  mesh.Points[4] = std::nan("");
  EXPECT_THROW(CheckMesh(mesh), InputError);
  mesh = Cube(1);
  mesh.Materials[2] = 0;
  EXPECT_THROW(CheckMesh(mesh), InputError);
  EXPECT_THROW(CheckMesh(Cube(1), [](double, const char*) { return false; }), Interrupted);
}
