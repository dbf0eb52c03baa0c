// SPDX-License-Identifier: Apache-2.0
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/XRay/ExampleScenes.h"

#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDoubleArray.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

using namespace mammoray;

namespace
{
TetrahedralMesh TwoCells()
{
  TetrahedralMesh mesh;
  mesh.Points = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1.0 / 3 };
  mesh.Cells = { 0, 1, 2, 3, 1, 2, 3, 4 };
  mesh.Materials = { 1, 2 };
  return mesh;
}

/// The surface of a tetrahedron in air, its triangles seen from outside.
SurfaceMesh Tetrahedron()
{
  SurfaceMesh mesh;
  mesh.Points = { 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 4 };
  mesh.Triangles = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 };
  mesh.FrontMaterials = { 0, 0, 0, 0 };
  mesh.BackMaterials = { 2, 2, 2, 2 };
  return mesh;
}
}

TEST(MeshConversion, GridsGiveTheMeshBack)
{
  const TetrahedralMesh mesh = TwoCells();
  std::vector<std::string> names;
  const TetrahedralMesh back = FromGrid(ToGrid(mesh, { "air", "fat", "gland" }), &names);
  EXPECT_EQ(back.Points, mesh.Points);
  EXPECT_EQ(back.Cells, mesh.Cells);
  EXPECT_EQ(back.Materials, mesh.Materials);
  EXPECT_THAT(names, testing::ElementsAre("air", "fat", "gland"));
  FromGrid(ToGrid(mesh, {}), &names);
  EXPECT_TRUE(names.empty());
}

TEST(MeshConversion, OtherGridsAreRefused)
{
  const auto unnamed = ToGrid(TwoCells(), {});
  unnamed->GetCellData()->RemoveArray(MaterialArrayName);
  EXPECT_THROW(FromGrid(unnamed), InputError);
  const auto mixed = ToGrid(TwoCells(), {});
  const vtkIdType corners[3] = { 0, 1, 2 };
  mixed->InsertNextCell(VTK_TRIANGLE, 3, corners);
  EXPECT_THROW(FromGrid(mixed), InputError);
}

TEST(MeshConversion, MaterialsThatAreNoWholeNumbersAreRefused)
{
  const auto grid = ToGrid(TwoCells(), {});
  // As a program leaves them that averages the values of points.
  vtkNew<vtkDoubleArray> materials;
  materials->SetName(MaterialArrayName);
  materials->InsertNextValue(2);
  materials->InsertNextValue(1);
  grid->GetCellData()->AddArray(materials);
  EXPECT_THAT(FromGrid(grid).Materials, testing::ElementsAre(2, 1));
  for (const auto& [value, found] : { std::pair{ 1.5, "found 1.5" }, std::pair{ -1.0, "found -1" },
         std::pair{ 1e10, "found 1e+10" }, std::pair{ std::nan(""), "found nan" } })
  {
    materials->SetValue(1, value);
    EXPECT_THAT(test::RefusalOf([&] { FromGrid(grid); }),
      testing::AllOf(testing::HasSubstr("cell 1: expected 'Material' to be a whole number"),
        testing::EndsWith(found)));
  }
  materials->SetNumberOfComponents(2);
  materials->SetNumberOfTuples(2);
  EXPECT_THAT(test::RefusalOf([&] { FromGrid(grid); }), testing::EndsWith("found 2 numbers"));
}

TEST(MeshConversion, MaterialsOfASurfaceThatAreNoNumbersOfCellsAreRefused)
{
  const auto surface = ToPolyData(Tetrahedron(), {});
  surface->GetCellData()->RemoveArray(FrontMaterialArrayName);
  surface->GetCellData()->RemoveArray(BackMaterialArrayName);
  EXPECT_EQ(FromPolyData(surface).BackMaterials[0], 1);
  vtkNew<vtkDoubleArray> ofPoints;
  ofPoints->SetName(MaterialArrayName);
  ofPoints->SetNumberOfTuples(4);
  ofPoints->Fill(2);
  surface->GetPointData()->AddArray(ofPoints);
  EXPECT_THAT(test::RefusalOf([&] { FromPolyData(surface); }),
    testing::HasSubstr("a cell array 'Material' of whole numbers, found one of points"));
  vtkNew<vtkStringArray> texts;
  texts->SetName(MaterialArrayName);
  texts->SetNumberOfValues(4);
  surface->GetCellData()->AddArray(texts);
  EXPECT_THAT(test::RefusalOf([&] { FromPolyData(surface); }),
    testing::HasSubstr("found one of texts"));
}

TEST(MeshConversion, GridsAreFittedToATableByNames)
{
  MaterialTable table;
  table.Name = "two tissues";
  table.Materials = { Material{ .Name = "air" }, Material{ .Name = "fat" },
    Material{ .Name = "gland" } };
  const auto grid = ToGrid(TwoCells(), { "air", "Gland", "Fat" });
  EXPECT_THAT(FitGrid(grid, table, "a.vtu").Materials, testing::ElementsAre(2, 1));
  std::vector<std::string> names;
  EXPECT_THAT(FromGrid(grid, &names).Materials, testing::ElementsAre(2, 1));
  EXPECT_THAT(names, testing::ElementsAre("air", "fat", "gland"));
  // Once more it fits already.
  EXPECT_THAT(FitGrid(grid, table, "a.vtu").Materials, testing::ElementsAre(2, 1));
  EXPECT_THAT(test::RefusalOf(
                [&] {
                  FitGrid(ToGrid(TwoCells(), { "air", "fat", "cyst" }), table, "a.vtu");
                }),
    testing::HasSubstr("a.vtu: material 'cyst' is not in the material table 'two tissues'"));
  // Of gmsh by way of meshio.
  const auto physical = ToGrid(TwoCells(), { "air", "fat", "gland" });
  physical->GetCellData()->GetArray(MaterialArrayName)->SetName("gmsh:physical");
  EXPECT_THAT(FitGrid(physical, table, "a.vtu").Materials,
    testing::ElementsAreArray(TwoCells().Materials));
  grid->GetCellData()->RemoveArray(MaterialArrayName);
  EXPECT_THAT(test::RefusalOf([&] { FitGrid(grid, table, "a.vtu"); }),
    testing::HasSubstr("a.vtu: grid: expected the cell array 'Material'"));
}

TEST(MeshConversion, PlacementsComeBack)
{
  const auto grid = ToGrid(TwoCells(), {});
  EXPECT_FALSE(FindPlacement(grid));
  VolumeFromGantry placed;
  placed.Origin = { 1, 2, 3 };
  placed.X = { 0, 1, 0 };
  placed.Y = { 0, 0, 1 };
  placed.Z = { 1, 0, 0 };
  AddPlacement(grid, placed);
  const auto found = FindPlacement(grid);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->Origin, placed.Origin);
  EXPECT_EQ(found->X, placed.X);
  EXPECT_EQ(found->Y, placed.Y);
  EXPECT_EQ(found->Z, placed.Z);
}

TEST(MeshConversion, PolyDataGiveTheSurfaceBack)
{
  const SurfaceMesh mesh = Tetrahedron();
  std::vector<std::string> names;
  const SurfaceMesh back = FromPolyData(ToPolyData(mesh, { "air", "fat", "gland" }), &names);
  EXPECT_EQ(back.Points, mesh.Points);
  EXPECT_EQ(back.Triangles, mesh.Triangles);
  EXPECT_EQ(back.FrontMaterials, mesh.FrontMaterials);
  EXPECT_EQ(back.BackMaterials, mesh.BackMaterials);
  EXPECT_THAT(names, testing::ElementsAre("air", "fat", "gland"));
}

TEST(MeshConversion, TheInsideIsFoundWhicheverWayTrianglesTurn)
{
  for (const bool inwards : { false, true })
  {
    SurfaceMesh mesh = Tetrahedron();
    for (std::size_t corner = 0; inwards && corner < mesh.Triangles.size(); corner += 3)
    {
      std::swap(mesh.Triangles[corner + 1], mesh.Triangles[corner + 2]);
    }
    const auto surface = ToPolyData(mesh, {});
    surface->GetCellData()->RemoveArray(FrontMaterialArrayName);
    surface->GetCellData()->RemoveArray(BackMaterialArrayName);
    vtkNew<vtkIntArray> inside;
    inside->SetName(MaterialArrayName);
    for (int cell = 0; cell < 4; ++cell)
    {
      inside->InsertNextValue(5);
    }
    surface->GetCellData()->AddArray(inside);
    const SurfaceMesh found = FromPolyData(surface);
    const std::vector<std::uint16_t> air(4, 0);
    const std::vector<std::uint16_t> tissue(4, 5);
    EXPECT_EQ(found.BackMaterials, inwards ? air : tissue);
    EXPECT_EQ(found.FrontMaterials, inwards ? tissue : air);
    inside->SetValue(2, 70000);
    EXPECT_THROW(FromPolyData(surface), InputError);
  }
}

TEST(MeshConversion, ThePoseTurnsAboutTheHeldTissuesFront)
{
  // LPS: left is +x, anterior -y, superior +z; the box is 2 x 3 x 4 from the origin.
  const AnatomicalAxes axes;
  const Vector3 free = FindPoseFrame(Tetrahedron(), { false, false, false }, axes).Anchor;
  EXPECT_LT(Norm(free - Vector3{ 1, 3, 2 }), 1e-12) << "the posterior end";
  const Vector3 held = FindPoseFrame(Tetrahedron(), { false, false, true }, axes).Anchor;
  EXPECT_LT(Norm(held - Vector3{ 1, 0, 2 }), 1e-12) << "the front of what is held";
}

TEST(SurfaceConversion, PolyDataRoundTrips)
{
  const SurfaceMesh mesh = MakeBoxesScene().Surface;
  std::vector<std::string> names;
  const SurfaceMesh back =
    FromPolyData(ToPolyData(mesh, { "air", "fat", "gland", "muscle" }), &names);
  EXPECT_EQ(back.Triangles, mesh.Triangles);
  EXPECT_EQ(back.FrontMaterials, mesh.FrontMaterials);
  EXPECT_EQ(back.BackMaterials, mesh.BackMaterials);
  EXPECT_THAT(names, testing::ElementsAre("air", "fat", "gland", "muscle"));
  ASSERT_EQ(back.Points.size(), mesh.Points.size());
  for (std::size_t index = 0; index < mesh.Points.size(); ++index)
  {
    ASSERT_EQ(back.Points[index], static_cast<double>(static_cast<float>(mesh.Points[index])));
  }
}
