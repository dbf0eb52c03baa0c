// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MeshConversion.h"

#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkUnstructuredGrid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
