// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Meshes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using mammoray::test::NotRefused;
using mammoray::test::RefusalOf;
using namespace mammoray;
using testing::HasSubstr;

namespace
{
MaterialTable TwoTissues()
{
  MaterialTable table;
  table.Name = "two tissues";
  table.Materials = { Material{ .Name = "air" }, Material{ .Name = "fat" },
    Material{ .Name = "gland" } };
  table.MaterialOfLabel = { { 0, 0 }, { 1, 1 }, { 2, 1 }, { 29, 2 } };
  return table;
}

template <typename Mesh>
std::string FitRefusal(Mesh mesh, const std::vector<std::string>& names)
{
  return RefusalOf([&] { TwoTissues().FitMesh(mesh, names, "mesh.vtu"); });
}
}

TEST(MaterialTable, MeshOfItsMaterialsPasses)
{
  TetrahedralMesh mesh;
  mesh.Materials = { 2, 1 };
  EXPECT_EQ(FitRefusal(mesh, {}), NotRefused);
  EXPECT_EQ(FitRefusal(mesh, { "air", "fat", "gland" }), NotRefused);
  // Names beyond the materials in use say nothing.
  mesh.Materials = { 1 };
  EXPECT_EQ(FitRefusal(mesh, { "air", "fat", "bone" }), NotRefused);
  SurfaceMesh surface;
  surface.FrontMaterials = { 0, 1 };
  surface.BackMaterials = { 1, 2 };
  EXPECT_EQ(FitRefusal(surface, { "", "fat", "gland" }), NotRefused);
}

TEST(MaterialTable, MeshOfOtherMaterialsIsRefused)
{
  TetrahedralMesh mesh;
  mesh.Materials = { 2, 3 };
  EXPECT_THAT(FitRefusal(mesh, {}),
    test::Mentions("mesh.vtu", "'two tissues'", "1 to 2", "found 3"));
  mesh.Materials = { 0, 1 };
  EXPECT_THAT(FitRefusal(mesh, {}), HasSubstr("found 0"));
  mesh.Materials = { 2, 1 };
  EXPECT_THAT(FitRefusal(mesh, { "air", "fat", "lesion" }),
    test::Mentions("mesh.vtu", "material 'lesion' is not in", "which has air, fat, gland"));
  // Whatever its number.
  mesh.Materials = { 1, 1 };
  EXPECT_THAT(FitRefusal(mesh, { "air", "tumour" }), HasSubstr("material 'tumour' is not in"));
  EXPECT_THAT(FitRefusal(mesh, { "air", "Air" }), HasSubstr("expected materials 1 to 2"));
  mesh.Materials = { 1, 2 };
  EXPECT_THAT(FitRefusal(mesh, { "air", "gland" }), HasSubstr("found none of material 2"));
  SurfaceMesh surface;
  surface.FrontMaterials = { 0 };
  surface.BackMaterials = { 3 };
  EXPECT_THAT(FitRefusal(surface, {}), HasSubstr("expected materials 0 to 2"));
}

TEST(MaterialTable, MeshesTakeTheirMaterialsByName)
{
  TetrahedralMesh mesh;
  mesh.Materials = { 1, 5, 1 };
  TwoTissues().FitMesh(mesh, { "air", "GLAND ", "", "", "", "Fat" }, "mesh.vtu");
  EXPECT_THAT(mesh.Materials, testing::ElementsAre(2, 1, 2));
  SurfaceMesh surface;
  surface.FrontMaterials = { 0, 1, 3 };
  surface.BackMaterials = { 1, 2, 2 };
  TwoTissues().FitMesh(surface, { "air", "gland", "fat", "Air" }, "mesh.vtp");
  EXPECT_THAT(surface.FrontMaterials, testing::ElementsAre(0, 2, 0));
  EXPECT_THAT(surface.BackMaterials, testing::ElementsAre(2, 1, 1));
}

TEST(MaterialTable, MergesLabelsAndRefusesUnknownOnes)
{
  LabelVolume volume;
  volume.Size = { 4, 1, 1 };
  volume.Voxels = { 0, 1, 2, 29 };
  EXPECT_THAT(TwoTissues().ToMaterials(volume, "v").Voxels, testing::ElementsAre(0, 1, 1, 2));
  volume.Voxels = { 7, 1, 7, 29 };
  EXPECT_THAT(RefusalOf([&] { TwoTissues().ToMaterials(volume, "v"); }),
    HasSubstr("label 7 (2 voxels)"));
  volume.Voxels = { 0, 0, 0, 0 };
  EXPECT_THAT(RefusalOf([&] { TwoTissues().ToMaterials(volume, "v"); }), HasSubstr("only air"));
}

TEST(MaterialTable, NamesOfLabelsDecideWhateverTheirNumbers)
{
  LabelVolume volume;
  volume.Size = { 4, 1, 1 };
  volume.Voxels = { 0, 1, 2, 3 };
  volume.Names = { { 1, "Gland" }, { 2, "fat" }, { 3, "AIR" }, { 9, "not there" } };
  NoteKeeper notes;
  const LabelVolume materials = TwoTissues().ToMaterials(volume, "v");
  EXPECT_THAT(materials.Voxels, testing::ElementsAre(0, 2, 1, 0));
  EXPECT_THAT(notes.Lines(),
    testing::ElementsAre("v: labels are taken by their names, against the numbers in the table "
                         "'two tissues': 1 'Gland' (not fat)"));
  EXPECT_THAT(materials.Names, testing::IsEmpty()); // they were those of the labels
  MaterialTable walled = TwoTissues();
  walled.Materials[2].Name = "chest-wall";
  volume.Names[1] = "Chest Wall";
  EXPECT_EQ(walled.ToMaterials(volume, "v").Voxels[1], 2);
}

TEST(MaterialTable, NumbersCountWhereNoNameIsKnown)
{
  LabelVolume volume;
  volume.Size = { 3, 1, 1 };
  volume.Voxels = { 0, 1, 29 };
  volume.Names = { { 1, "Fett" }, { 29, "Druese" } };
  NoteKeeper notes;
  EXPECT_THAT(TwoTissues().ToMaterials(volume, "v").Voxels, testing::ElementsAre(0, 1, 2));
  EXPECT_THAT(notes.Lines(),
    testing::ElementsAre("v: no name of its labels is one of the material table 'two tissues', so "
                         "that their numbers count: label 1 'Fett' is fat, 29 'Druese' is gland"));
  notes.Notes.clear();
  volume.Names = { { 1, "Segment_1" }, { 29, "Segment_29" } };
  EXPECT_THAT(TwoTissues().ToMaterials(volume, "v").Voxels, testing::ElementsAre(0, 1, 2));
  EXPECT_THAT(notes.Lines(), testing::IsEmpty());
}

TEST(MaterialTable, NamesMadeOfNumbersCountAsThem)
{
  LabelVolume volume;
  volume.Size = { 3, 1, 1 };
  volume.Voxels = { 29, 1, 2 };
  volume.Names = { { 29, "Segment_29" }, { 1, "Label 1" }, { 2, "fat" } };
  EXPECT_THAT(TwoTissues().ToMaterials(volume, "v").Voxels, testing::ElementsAre(2, 1, 1));
  // A program has renumbered it: what it was, nobody knows.
  volume.Names[1] = "Segment_29";
  EXPECT_THAT(RefusalOf([&] { TwoTissues().ToMaterials(volume, "v"); }),
    HasSubstr("v: label 1 'Segment_29' (1 voxels) is not in the material table 'two tissues', "
              "which has air, fat, gland"));
}

TEST(MaterialTable, UnknownNamesAreRefusedWithTheKnownOnes)
{
  LabelVolume volume;
  volume.Size = { 4, 1, 1 };
  volume.Voxels = { 1, 1, 2, 29 };
  volume.Names = { { 1, "tumour" }, { 2, "fat" } };
  const std::string refusal = RefusalOf([&] { TwoTissues().ToMaterials(volume, "v"); });
  EXPECT_THAT(refusal, HasSubstr("label 1 'tumour' (2 voxels) is not in the material table"));
  EXPECT_THAT(refusal, HasSubstr("which has air, fat, gland"));
  // What no segment has is not a question of the table, which has a 29.
  EXPECT_THAT(refusal,
    HasSubstr("v: value 29 (1 voxels) belongs to no segment of the file, which has 1 'tumour', "
              "2 'fat'"));
  volume.Names = { { 1, "fat" } };
  EXPECT_EQ(RefusalOf([&] { TwoTissues().ToMaterials(volume, "v"); }),
    "v: value 2 (1 voxels), 29 (1 voxels) belongs to no segment of the file, which has 1 'fat'");
}

TEST(MaterialTable, UnknownMaterialIsRefusedWithTheKnownOnes)
{
  EXPECT_EQ(TwoTissues().IndexOf("gland"), 2);
  EXPECT_EQ(TwoTissues().IndexOf("Gland"), 2);
  EXPECT_THAT(RefusalOf([&] { TwoTissues().IndexOf("bone"); }),
    testing::AllOf(HasSubstr("'bone'"), HasSubstr("air, fat, gland")));
}

TEST(MaterialTable, ListsWhatMaterialsAre)
{
  MaterialTable table = TwoTissues();
  table.Materials[1].Thin = true;
  table.Materials[2].Attenuation = "glandular";
  table.Materials.push_back(
    Material{ .Name = "muscle", .Attenuation = "glandular", .Fixed = true });
  EXPECT_THAT(table.Names(), testing::ElementsAre("air", "fat", "gland", "muscle"));
  EXPECT_THAT(table.LabelNames(),
    testing::ElementsAre(testing::Pair(1, "fat"), testing::Pair(2, "fat"),
      testing::Pair(29, "gland")));
  EXPECT_THAT(table.Fixed(), testing::ElementsAre(false, false, false, true));
  EXPECT_THAT(table.Thin(), testing::ElementsAre(1));
  EXPECT_THAT(table.Glandular(), testing::ElementsAre(2)); // muscle is held
}
