// SPDX-License-Identifier: Apache-2.0
#include "FileSizeLimit.h"
#include "Files.h"
#include "GlbBytes.h"
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"

#include "vtkCellArray.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkUnstructuredGrid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <string>
#include <tuple>
#include <vector>

using mammoray::test::RefusalOf;
using namespace mammoray;
using test::TemporaryFolder;

namespace
{
TetrahedralMesh FatAndGland()
{
  TetrahedralMesh mesh;
  mesh.Points = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1.25, 1, 1 };
  mesh.Cells = { 0, 1, 2, 3, 1, 4, 2, 3 };
  mesh.Materials = { 1, 2 };
  return mesh;
}

/// One polygon, 2 x 1 mm.
vtkSmartPointer<vtkPolyData> Rectangle()
{
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(0, 0, 0);
  points->InsertNextPoint(2, 0, 0);
  points->InsertNextPoint(2, 1, 0);
  points->InsertNextPoint(0, 1, 0);
  vtkNew<vtkCellArray> polygons;
  polygons->InsertNextCell({ 0, 1, 2, 3 });
  surface->SetPoints(points);
  surface->SetPolys(polygons);
  return surface;
}

/// Lowest and highest x, then y and z; rounded to 1e-6 mm, as sines are.
std::vector<double> BoundsOf(const SurfaceMesh& surface)
{
  double bounds[6];
  ToPolyData(surface, {})->GetBounds(bounds);
  std::transform(std::begin(bounds), std::end(bounds), bounds,
    [](double bound) { return std::round(1e6 * bound) / 1e6; });
  return { std::begin(bounds), std::end(bounds) };
}
}

TEST(MeshIO, VolumeMeshComesBack)
{
  const TemporaryFolder folder;
  const std::string path = folder.File("mesh.vtu");
  WriteMesh(ToGrid(FatAndGland(), { "air", "fat", "gland" }), path);
  std::vector<std::string> names;
  const TetrahedralMesh mesh = FromGrid(ReadMesh(path), &names);
  EXPECT_EQ(mesh.Points, FatAndGland().Points);
  EXPECT_EQ(mesh.Cells, FatAndGland().Cells);
  EXPECT_EQ(mesh.Materials, FatAndGland().Materials);
  EXPECT_THAT(names, testing::ElementsAre("air", "fat", "gland"));
}

TEST(MeshIO, ReadsLegacyFiles)
{
  const TemporaryFolder folder;
  const std::string path = folder.Write("mesh.vtk",
    "# vtk DataFile Version 3.0\nby hand\nASCII\nDATASET UNSTRUCTURED_GRID\n"
    "POINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 2\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"
    "CELL_DATA 1\nSCALARS Material int 1\nLOOKUP_TABLE default\n7\n");
  const TetrahedralMesh mesh = FromGrid(ReadMesh(path));
  ASSERT_EQ(mesh.NumberOfCells(), 1u);
  EXPECT_EQ(mesh.Materials[0], 7);
  EXPECT_DOUBLE_EQ(mesh.CellVolume(0), 1.0 / 3);
  EXPECT_THAT(RefusalOf([&] { ReadMesh(folder.Write("bad.vtk", "not a mesh at all")); }),
    testing::HasSubstr("bad.vtk: expected a mesh"));
  EXPECT_THAT(RefusalOf(
                [&]
                {
                  ReadMesh(folder.Write("surface.vtk",
                    "# vtk DataFile Version 3.0\nby hand\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n"
                    "0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 1 2\n"));
                }),
    testing::HasSubstr("surface.vtk: expected a volume mesh (UNSTRUCTURED_GRID), found a surface"));
}

TEST(MeshIO, SurfacesComeBackInEveryFormat)
{
  const TemporaryFolder folder;
  const auto surface = Rectangle();
  for (const char* name : { "s.vtp", "s.stl", "s.ply", "s.OBJ" })
  {
    WriteMesh(surface, folder.File(name));
    const SurfaceMesh read = ReadSurface(folder.File(name));
    EXPECT_THAT(BoundsOf(read), testing::ElementsAre(0, 2, 0, 1, 0, 0)) << name;
    EXPECT_EQ(read.NumberOfTriangles(), 2u) << name;
  }
}

TEST(MeshIO, FullDisksAreNamedForEveryFormat)
{
  const TemporaryFolder folder;
  const auto surface = Rectangle();
  const auto grid = ToGrid(FatAndGland(), { "air", "fat", "gland" });
  for (const std::string name : { "s.vtp", "s.stl", "s.ply", "s.obj", "s.vtu" })
  {
    const std::string path = folder.File(name);
    const auto write = [&] { name == "s.vtu" ? WriteMesh(grid, path) : WriteMesh(surface, path); };
    write();
    const std::string whole = test::ReadFile(path);
    for (std::size_t most = 8; most < whole.size(); most *= 2)
    {
      const test::FileSizeLimit limit(most);
      EXPECT_THROW(write(), InputError) << name << " at " << most;
    }
    EXPECT_EQ(test::ReadFile(path), whole) << name;
  }
}

TEST(MeshIO, ScenesOfGltfAreOneSurfaceInMillimetres)
{
  const TemporaryFolder folder;
  const SurfaceMesh surface = ReadSurface(folder.Write("scene.glb", test::GlbOfTetrahedron()));
  // Its faces meet again where its vertices are the same.
  EXPECT_EQ(surface.NumberOfPoints(), 4u);
  EXPECT_EQ(surface.NumberOfTriangles(), 4u);
  EXPECT_THAT(BoundsOf(surface), testing::ElementsAre(1000, 3000, 2000, 4000, 3000, 5000));

  const std::string vessels =
    test::SharedDataFolder() + "/hra-vasculature-mesh/VH_F_Vasculature.glb";
  if (!std::filesystem::exists(vessels))
  {
    GTEST_SKIP() << "no " << vessels;
  }
  // As its README says; parts.csv counts 218,216 triangles.
  const auto read = ReadSurface(vessels);
  EXPECT_EQ(read.NumberOfTriangles(), 218216u);
  const std::vector<double> bounds = BoundsOf(read);
  const double expected[6] = { -77.31, 117.67, -12.43, 570.70, -110.51, 55.08 };
  for (int side = 0; side < 6; ++side)
  {
    EXPECT_NEAR(bounds[side], expected[side], 0.006);
  }
}

TEST(MeshIO, NodesOfGltfPlaceTheirMeshes)
{
  using testing::ElementsAre;
  using testing::HasSubstr;
  const TemporaryFolder folder;
  const std::string buffer = test::TetrahedronBuffer();
  const auto read = [&](const std::string& text)
  { return ReadSurface(folder.Write("scene.glb", test::Glb(text, buffer))); };
  const auto placed = [&](const std::string& nodes)
  { return BoundsOf(read(test::GltfText(nodes))); };
  // Scaled, then turned by 90 degrees about z, then moved; mm.
  EXPECT_THAT(placed(R"([{"mesh":0,"rotation":[0,0,0.7071067811865476,0.7071067811865476],
    "translation":[10,0,0],"scale":[1,2,3]}])"),
    ElementsAre(8000, 10000, 0, 1000, 0, 3000));
  // The same by columns of a matrix.
  EXPECT_THAT(placed(R"([{"mesh":0,"matrix":[0,1,0,0, -2,0,0,0, 0,0,3,0, 10,0,0,1]}])"),
    ElementsAre(8000, 10000, 0, 1000, 0, 3000));
  // One mesh in two places of a tree; the second is mirrored, and keeps what is inside inside.
  const SurfaceMesh mesh = read(test::GltfText(
    R"([{"children":[1,2],"scale":[2,2,2],"translation":[10,0,0]},
    {"mesh":0,"translation":[1,0,0]},{"mesh":0,"translation":[5,0,0],"scale":[1,1,-3]}])"));
  EXPECT_THAT(BoundsOf(mesh), ElementsAre(12000, 22000, 0, 2000, -6000, 2000));
  ASSERT_EQ(mesh.NumberOfTriangles(), 8u);
  double volumes[2] = { 0, 0 };
  for (std::size_t triangle = 0; triangle < 8; ++triangle)
  {
    const auto point = [&](int corner)
    {
      const std::size_t id = mesh.Triangles[3 * triangle + corner];
      return Vector3{ mesh.Points[3 * id], mesh.Points[3 * id + 1], mesh.Points[3 * id + 2] };
    };
    volumes[point(0)[0] > 17000 ? 1 : 0] += Dot(point(0), Cross(point(1), point(2))) / 6e9;
  }
  EXPECT_NEAR(volumes[0], 8 / 6.0, 1e-9);
  EXPECT_NEAR(volumes[1], 24 / 6.0, 1e-9);

  // Buffers within JSON, and in a file beside it.
  std::ofstream(folder.File("part 1.bin"), std::ios::binary) << buffer;
  EXPECT_THAT(BoundsOf(ReadSurface(folder.Write("scene.gltf",
                test::GltfText(R"([{"mesh":0}])", R"("attributes":{"POSITION":0},"indices":1)",
                  R"("byteLength":168,"uri":"part%201.bin")")))),
    ElementsAre(0, 1000, 0, 1000, 0, 1000));
  // Two triangles of a strip, one of a fan of three corners: base64 of (0 0 0) (1 0 0) (0 1 0).
  const std::string three = R"("byteLength":36,"uri":"data:application/octet-stream;base64,)"
                            R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA")";
  std::string fan =
    test::GltfText(R"([{"mesh":0}])", R"("attributes":{"POSITION":0},"mode":6)", three);
  fan.replace(fan.find("\"byteLength\":144"), 16, "\"byteLength\":36")
    .replace(fan.find("\"count\":12"), 10, "\"count\":3");
  EXPECT_EQ(ReadSurface(folder.Write("fan.gltf", fan)).NumberOfTriangles(), 1u);
}

TEST(MeshIO, RefusesOfGltfWhatItCannotShow)
{
  using testing::HasSubstr;
  const TemporaryFolder folder;
  const std::string good = test::GltfText(R"([{"mesh":0}])");
  const auto refusal = [&](const std::string& what, const std::string& by)
  {
    std::string text = good;
    text.replace(text.find(what), what.size(), by);
    const std::string path = folder.Write("bad.glb", test::Glb(text, test::TetrahedronBuffer()));
    const std::string message = RefusalOf([&] { ReadSurface(path); });
    EXPECT_THAT(message, testing::StartsWith(path + ": expected "));
    return message;
  };
  const std::tuple<const char*, std::string, const char*> wrong[] = {
    { "{\"asset\"", R"({"extensionsRequired":["KHR_draco_mesh_compression"],"asset")",
      "without required extensions, found KHR_draco_mesh_compression" },
    { "\"2.0\"", "\"1.0\"", "version 2 of glTF, found 1.0" },
    { "\"indices\":1", "\"indices\":1,\"mode\":1", "triangles, found points or lines" },
    { "\"indices\":1", "\"indices\":7", "a mesh in glTF: primitive indices accessor" },
    { "{\"mesh\":0}", R"({"mesh":0,"skin":0})", "found a skin in node 0" },
    { "{\"mesh\":0}", R"({"mesh":0,"weights":[0,0.5]})", "found morph targets" },
    { "{\"mesh\":0}", R"({"mesh":0,"children":[0]})", "node 0 in several places" },
    { "{\"mesh\":0}", R"({"mesh":0,"scale":[1,2]})", "3 numbers of a node's scale" },
    { "{\"mesh\":0}", R"({"mesh":-1})", "found no triangles" },
    { "\"nodes\":[0]", "\"nodes\":[]", "found no triangles" },
    { "5126", "5123", "positions in floats" },
    { "\"count\":12", "\"count\":13", "accessor 0 to lie in its buffer, found 13 elements" },
    { "\"count\":12", "\"count\":12,\"byteOffset\":24", "to lie in its buffer" },
    { "\"count\":12", "\"count\":18446744073709551615", "to lie in its buffer" },
    { "\"count\":12",
      R"("count":12,"sparse":{"count":1,"indices":{"bufferView":1,"componentType":5123},)"
      R"("values":{"bufferView":0}})",
      "to be a plain list" },
    { "\"byteLength\":168", "\"byteLength\":169", "a mesh in glTF: Invalid `byteLength'" },
    { "\"byteLength\":168", R"("byteLength":168,"uri":"http://x.org/a.bin")", "File not found" },
    { "\"byteLength\":168", R"("byteLength":168,"uri":"none.bin")", "File not found" },
    { "\"byteLength\":168", R"("byteLength":168,"uri":")" + std::string(300, 'n') + '"',
      "File not found" },
    { "\"byteLength\":168", R"("byteLength":168,"uri":"../a.bin")", "File not found" },
    { "\"byteLength\":168", R"("byteLength":168,"uri":"b/%2e%2e/..%2Fa.bin")", "File not found" },
    { "\"byteLength\":168", R"("byteLength":168,"uri":"%2Fetc/passwd")", "File not found" },
    { "\"type\":\"VEC3\"", "\"typ\":\"VEC3\"", "a mesh in glTF: " },
    { "{\"asset\"", "{\"asset", "a mesh in glTF: " },
  };
  for (const auto& [what, by, text] : wrong)
  {
    EXPECT_THAT(refusal(what, by), HasSubstr(text)) << by;
  }
  const std::string whole = test::Glb(good, test::TetrahedronBuffer());
  EXPECT_THAT(RefusalOf([&] { ReadSurface(folder.Write("cut.glb", whole.substr(0, 400))); }),
    HasSubstr("a mesh in glTF: "));
}

TEST(MeshIO, RefusesInOneLine)
{
  using testing::HasSubstr;
  const TemporaryFolder folder;
  const auto grid = ToGrid(FatAndGland(), {});
  EXPECT_THAT(RefusalOf([&] { WriteMesh(grid, folder.File("mesh.stl")); }),
    HasSubstr("expected the extension .vtu"));
  EXPECT_THAT(RefusalOf([&] { WriteMesh(grid, folder.File("none/mesh.vtu")); }),
    HasSubstr("cannot be written"));
  EXPECT_THAT(RefusalOf([&] { ReadMesh(folder.File("absent.vtu")); }), HasSubstr("no such file"));
  EXPECT_THAT(RefusalOf([&] { ReadMesh(folder.Write("empty.vtu", "")); }),
    HasSubstr("found an empty file"));
  EXPECT_THAT(RefusalOf([&] { ReadMesh(folder.Write("bad.vtu", "not a mesh at all")); }),
    HasSubstr("bad.vtu: expected a mesh"));
  EXPECT_THAT(RefusalOf([&] { ReadSurface(folder.Write("bad.stl", "garbage")); }),
    HasSubstr("bad.stl: expected a mesh in STL"));
  EXPECT_THAT(RefusalOf([&] { ReadSurface(folder.Write("bad.glb", "garbage")); }),
    HasSubstr("bad.glb: expected a mesh"));
  EXPECT_THAT(RefusalOf([&] { ReadSurface(folder.Write("bad.ply", "garbage")); }),
    HasSubstr("bad.ply: line 1: expected a mesh in PLY"));
  EXPECT_THAT(RefusalOf([&] { ReadSurface(folder.Write("s.xyz", "1 2 3")); }),
    HasSubstr(".vtp, .stl, .ply"));
  const std::string path = folder.File("cut.vtu");
  WriteMesh(grid, path);
  const std::string whole = test::ReadFile(path);
  folder.Write("cut.vtu", whole.substr(0, whole.size() / 2));
  EXPECT_THAT(RefusalOf([&] { ReadMesh(path); }), HasSubstr("cut.vtu: expected a mesh"));
}

TEST(MeshIO, RefusesWhatVtkDiesOf)
{
  const TemporaryFolder folder;
  const auto legacy = [&](const std::string& points, const std::string& cells)
  {
    return folder.Write("mesh.vtk",
      "# vtk DataFile Version 3.0\nby hand\nASCII\nDATASET UNSTRUCTURED_GRID\n" + points + cells +
        "CELL_TYPES 1\n10\n");
  };
  const std::string points = "POINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 2\n";
  EXPECT_THAT(RefusalOf([&] { ReadMesh(legacy(points, "CELLS 1 5\n4 0 1 2 4\n")); }),
    testing::EndsWith("mesh.vtk: cell 0: expected points 0 to 3, found 4"));
  EXPECT_THAT(RefusalOf([&] { ReadMesh(legacy(points, "CELLS 1 4\n3 0 1 2\n")); }),
    testing::EndsWith("cell 0: expected the four points of a tetrahedron, found 3"));
  EXPECT_THAT(
    RefusalOf(
      [&] { ReadMesh(legacy("POINTS 4000000000000 float\n0 0 0\n", "CELLS 1 5\n4 0 1 2 3\n")); }),
    testing::HasSubstr("mesh.vtk: expected a mesh, found"));
  // A point far outside: VTK 9.1 looks there.
  EXPECT_THAT(RefusalOf(
                [&]
                {
                  ReadSurface(folder.Write("faces.ply",
                    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                    "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                    "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 70000\n"));
                }),
    testing::HasSubstr("faces.ply: "));
}

TEST(MeshIO, RefusesVerticesThatAreNowhere)
{
  const TemporaryFolder folder;
  for (const std::string number : { "nan", "inf", "1e400", "", "x" })
  {
    EXPECT_THAT(RefusalOf(
                  [&] {
                    ReadSurface(
                      folder.Write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 " + number + " 0\nf 1 2 3\n"));
                  }),
      testing::HasSubstr("a.obj: line 3: expected three numbers for a vertex, found 'v 0 "))
      << number;
  }
  EXPECT_THAT(
    RefusalOf(
      [&] { ReadSurface(folder.Write("b.obj", "v 0 0 0\nv 1 0 0\nv 0 -1e30 0\nf 1 2 3\n")); }),
    testing::HasSubstr("b.obj: point 2: expected coordinates below 1e9 mm, found"));
}

TEST(MeshIO, NamesOfMaterialsDoNotHinderAnyFormat)
{
  const TemporaryFolder folder;
  SurfaceMesh surface;
  surface.Points = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  surface.Triangles = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 };
  surface.FrontMaterials.assign(4, 0);
  surface.BackMaterials.assign(4, 1);
  for (const char* const name : { "a.vtp", "a.stl", "a.ply", "a.obj" })
  {
    WriteMesh(ToPolyData(surface, { "air", "fat" }), folder.File(name));
    EXPECT_EQ(ReadSurface(folder.File(name)).NumberOfTriangles(), 4u) << name;
  }
}
