// SPDX-License-Identifier: Apache-2.0
#include "CommandTest.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"

#include "vtkUnstructuredGrid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

using namespace mammoray;
using test::ReadFile;

namespace
{
class MeshCommand : public test::CommandTest
{
protected:
  void SetUp() override
  {
    LabelVolume volume;
    volume.Size = { 16, 16, 16 };
    volume.Voxels.assign(4096, 0);
    for (int k = 3; k < 13; ++k)
    {
      for (int j = 3; j < 13; ++j)
      {
        for (int i = 3; i < 13; ++i)
        {
          volume.Voxels[volume.Index(i, j, k)] = i < 8 ? 1 : 2;
        }
      }
    }
    WriteLabelVolume(volume, this->Labels);
    this->Volume = volume;
    this->Folder.Write("table.json", R"({"materials": [{"name": "air", "labels": [0]},
      {"name": "fat", "labels": [1], "attenuation": "adipose"},
      {"name": "gland", "labels": [2], "attenuation": "glandular"}]})");
  }

  void ExpectRefused(const std::string& arguments, const std::string& text)
  {
    this->CommandTest::ExpectRefused(arguments, text);
    EXPECT_FALSE(std::filesystem::exists(this->Mesh));
  }

  std::string Labels = this->Folder.File("labels.nrrd");
  std::string Mesh = this->Folder.File("mesh.vtu");
  std::string Inputs =
    "--labels " + this->Labels + " --materials " + this->Folder.File("table.json");
  LabelVolume Volume;
};
}

TEST_F(MeshCommand, WritesMeshReportAndTable)
{
  const std::string report = this->Folder.File("report.json");
  ASSERT_EQ(this->Run("mesh " + this->Inputs + " --facet-distance 0.1 -o " + this->Mesh +
              " --report " + report),
    0)
    << this->Errors;
  EXPECT_EQ(this->Errors, "");
  EXPECT_THAT(this->Output, testing::AllOf(testing::HasSubstr("fat"), testing::HasSubstr("gland")));
  std::vector<std::string> names;
  const TetrahedralMesh mesh = FromGrid(ReadMesh(this->Mesh), &names);
  EXPECT_NO_THROW(mesh.Validate("mesh"));
  EXPECT_THAT(names, testing::ElementsAre("air", "fat", "gland"));
  double volume = 0;
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    volume += mesh.CellVolume(cell);
  }
  // 5 %: the cube's edges are rounded.
  EXPECT_NEAR(volume, 1000, 50);
  EXPECT_THAT(ReadFile(report), testing::HasSubstr("\"volume_in_mm3\": 500.0"));
  EXPECT_EQ(this->Run("mesh " + this->Inputs + " -o " + this->Mesh), 1);
  EXPECT_THAT(this->Errors, testing::HasSubstr("--overwrite"));
  EXPECT_EQ(this->Run("mesh " + this->Inputs +
              " --overwrite --label-spacing 2 --thin fat --cell-size-of gland=2 -o " + this->Mesh),
    0)
    << this->Errors;
}

TEST_F(MeshCommand, VolumesAreInUnitsThatFit)
{
  // Boxes of 100, 1 and 0.01 mm.
  for (const auto& [edge, expected] :
    { std::pair{ "100", "[cm3]" }, { "1", "[mm3]" }, { "0.01", "[um3]" } })
  {
    std::string box;
    for (int corner = 0; corner < 8; ++corner)
    {
      const auto at = [&](int bit) { return (corner & bit) != 0 ? std::string(edge) : "0"; };
      box += "v " + at(1) + " " + at(2) + " " + at(4) + "\n";
    }
    box +=
      "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4\nf 1 5 7\nf 1 7 3\n"
      "f 2 4 8\nf 2 8 6\n";
    ASSERT_EQ(this->Run("mesh --check " + this->Folder.Write("box.obj", box)), 0) << this->Errors;
    EXPECT_THAT(this->Output, testing::HasSubstr(std::string("volume ") + expected));
    // 1000 cm3, 1 mm3, 1000 um3.
    EXPECT_THAT(this->Output,
      testing::HasSubstr(edge == std::string("1") ? " 1.000" : " 1000.000"));
  }
}

TEST_F(MeshCommand, ChecksMeshesAndSurfaces)
{
  const std::string report = this->Folder.File("report.json");
  ASSERT_EQ(this->Run("mesh " + this->Inputs + " -o " + this->Mesh), 0) << this->Errors;
  ASSERT_EQ(this->Run("mesh --check " + this->Mesh + " --report " + report), 0) << this->Errors;
  EXPECT_EQ(this->Errors, "");
  EXPECT_THAT(this->Output,
    testing::AllOf(testing::HasSubstr("gland"),
      testing::HasSubstr("sound: every cell is upright, every boundary a closed surface")));
  EXPECT_THAT(ReadFile(report), testing::HasSubstr("\"sound\": true"));
  EXPECT_THAT(ReadFile(report), testing::HasSubstr("\"dihedral_histogram\""));

  // One cell turned round and one point moved far out: two kinds of trouble, a line each.
  TetrahedralMesh mesh = FromGrid(ReadMesh(this->Mesh));
  std::swap(mesh.Cells[0], mesh.Cells[1]);
  WriteMesh(ToGrid(mesh, { "air", "fat", "gland" }), this->Mesh);
  EXPECT_EQ(this->Run("mesh --check " + this->Mesh), 1);
  EXPECT_THAT(this->Errors, testing::HasSubstr("1 cells of no or negative volume: "));
  EXPECT_THAT(this->Errors, testing::HasSubstr("from one side: "));
  EXPECT_EQ(std::count(this->Errors.begin(), this->Errors.end(), '\n'), 2) << this->Errors;

  // A tetrahedron of three facets.
  const std::string surface = this->Folder.Write("open.obj",
    "v 0 0 0\nv 3 0 0\nv 0 4 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n");
  EXPECT_EQ(this->Run("mesh --check " + surface), 1);
  EXPECT_THAT(this->Errors, testing::HasSubstr("1 holes in the boundary of a material"));
  EXPECT_EQ(this->Run("mesh "), 2);
  EXPECT_EQ(this->Run("mesh --check " + this->Folder.File("absent.vtu")), 1);
  EXPECT_THAT(this->Errors, testing::HasSubstr("no such file"));
}

TEST_F(MeshCommand, ChecksTheSidesOfAGmshFileAsASurface)
{
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n";
  for (int corner = 0; corner < 8; ++corner)
  {
    text += std::to_string(corner + 1) + " " + std::to_string(10 * (corner & 1)) + " " +
      std::to_string(10 * (corner >> 1 & 1)) + " " + std::to_string(10 * (corner >> 2)) + "\n";
  }
  text += "$EndNodes\n$Elements\n6\n";
  for (const char* quad : { "1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6" })
  {
    text += "1 3 2 1 1 " + std::string(quad) + "\n";
  }
  const std::string file = this->Folder.Write("cube.msh", text + "$EndElements\n");
  ASSERT_EQ(this->Run("mesh --check " + file), 0) << this->Errors;
  EXPECT_THAT(this->Output, testing::HasSubstr("8 points, 0 tetrahedra, 12 interface triangles"));
  EXPECT_THAT(this->Output, testing::HasSubstr("sound"));
}

TEST_F(MeshCommand, FillsSurfacesAndLabelsByTetGen)
{
  // Two tetrahedra with a face in common, of 3 x 4 x 1 / 6 and 3 x 4 x 2 / 6 mm3.
  const std::string above = this->Folder.Write("above.obj",
    "v 0 0 0\nv 3 0 0\nv 0 4 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const std::string below = this->Folder.Write("below.obj",
    "v 0 0 0\nv 3 0 0\nv 0 4 0\nv 0 0 -2\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n");
  const std::string surfaces = "--surface fat=" + above + " --surface gland=" + below;
  const int status = this->Run("mesh " + surfaces + " -o " + this->Mesh);
  if (status == 1 && this->Errors.find("no TetGen") != std::string::npos)
  {
    GTEST_SKIP() << this->Errors;
  }
  ASSERT_EQ(status, 0) << this->Errors;
  std::vector<std::string> names;
  const TetrahedralMesh mesh = FromGrid(ReadMesh(this->Mesh), &names);
  EXPECT_THAT(names, testing::ElementsAre("air", "fat", "gland"));
  double volumes[3] = { 0, 0, 0 };
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    volumes[mesh.Materials[cell]] += mesh.CellVolume(cell);
  }
  // Closed forms, to rounding.
  EXPECT_NEAR(volumes[1], 2, 1e-12);
  EXPECT_NEAR(volumes[2], 4, 1e-12);
  EXPECT_EQ(this->Run("mesh --check " + this->Mesh), 0) << this->Errors;

  ASSERT_EQ(this->Run("mesh " + this->Inputs + " --method tetgen --overwrite -o " + this->Mesh), 0)
    << this->Errors;
  EXPECT_EQ(this->Run("mesh --check " + this->Mesh), 0) << this->Errors;
  EXPECT_EQ(this->Run("mesh " + surfaces + " " + this->Inputs + " --overwrite -o " + this->Mesh),
    2);
  EXPECT_EQ(this->Run("mesh --surface fat --overwrite -o " + this->Mesh), 1);
  EXPECT_THAT(this->Errors, testing::HasSubstr("expected MATERIAL=FILE"));
}

TEST_F(MeshCommand, SurfacesThatCutEachOtherByVoxels)
{
  // Two tetrahedra of 6 x 6 x 6 / 6 mm3, the second moved by 1 mm along x.
  const char* faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  const std::string one =
    this->Folder.Write("one.obj", std::string("v 0 0 0\nv 6 0 0\nv 0 6 0\nv 0 0 6\n") + faces);
  const std::string other =
    this->Folder.Write("other.obj", std::string("v 1 0 0\nv 7 0 0\nv 1 6 0\nv 1 0 6\n") + faces);
  const std::string surfaces = "mesh --surface fat=" + one + " --surface fat=" + other;
  ASSERT_EQ(this->Run(surfaces + " --surface-voxels 0.25 -o " + this->Mesh), 0) << this->Errors;
  const TetrahedralMesh mesh = FromGrid(ReadMesh(this->Mesh));
  double volume = 0;
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    volume += mesh.CellVolume(cell);
  }
  // The union: 36, and 36 less the 5 x 5 x 5 / 6 they share. 4 %: voxels of 0.25 mm at 100 mm2 of
  // surface miss less than a twentieth of a voxel's height on average.
  EXPECT_NEAR(volume, 72 - 125.0 / 6, 0.04 * 51);
  EXPECT_EQ(this->Run("mesh --check " + this->Mesh), 0) << this->Errors;
  EXPECT_EQ(this->Run("mesh " + this->Inputs + " --surface-voxels 0.25 -o " + this->Mesh), 2);
  EXPECT_EQ(this->Run(surfaces + " --surface-voxels 0 --overwrite -o " + this->Mesh), 2);
}

TEST_F(MeshCommand, ThinMaterialsAreThoseOfTheTable)
{
  const std::string table = this->Folder.Write("thin.json",
    R"({"materials": [{"name": "air", "labels": [0]}, {"name": "fat", "labels": [1], "attenuation": "adipose"},
      {"name": "gland", "labels": [2], "attenuation": "glandular", "thin": true}]})");
  const auto cellsWith = [&](const std::string& options)
  {
    EXPECT_EQ(this->Run("mesh --labels " + this->Labels + " --materials " + table + options +
                " --overwrite -o " + this->Mesh),
      0)
      << this->Errors;
    return FromGrid(ReadMesh(this->Mesh)).NumberOfCells();
  };
  const std::size_t byTable = cellsWith("");
  EXPECT_EQ(byTable, cellsWith(" --thin gland"));
  EXPECT_GT(byTable, cellsWith(" --thin none"));
}

TEST_F(MeshCommand, CropsAddsSkinAndKnowsTables)
{
  // Fat and gland as the segmentation's labels, cropped at the back, with skin on all other sides.
  ASSERT_EQ(this->Run("mesh --labels " + this->Labels +
              " --materials segment --crop : : 5: --skin 1 --facet-distance 0.1 -o " + this->Mesh),
    0)
    << this->Errors;
  std::vector<std::string> names;
  const TetrahedralMesh mesh = FromGrid(ReadMesh(this->Mesh), &names);
  EXPECT_EQ(names[3], "skin");
  double volumes[5] = { 0, 0, 0, 0, 0 };
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    volumes[mesh.Materials[cell]] += mesh.CellVolume(cell);
  }
  // 10 x 10 x 8 without a layer on five sides, 5 %: edges are rounded.
  EXPECT_NEAR(volumes[3], 800 - 8 * 8 * 7, 0.05 * 800);
  EXPECT_NEAR(volumes[1] + volumes[2], 8 * 8 * 7, 0.05 * 800);
  EXPECT_EQ(this->Run("mesh --check " + this->Mesh), 0) << this->Errors;

  const std::string output = " --overwrite -o " + this->Mesh;
  const auto refused = [&](const std::string& arguments, const std::string& text)
  { this->CommandTest::ExpectRefused("mesh " + arguments + output, text); };
  refused("--labels " + this->Labels + " --materials segmant", "did you mean segment?");
  refused(this->Inputs + " --crop : : 5:16", "within the volume's voxels 0:15 0:15 0:15");
  refused(this->Inputs + " --crop 3 4 5", "FIRST:LAST");
  refused(this->Inputs + " --skin 1=hide", "unknown material 'hide'");
  refused(this->Inputs + " --skin 1", "0 thin materials");
  refused(this->Inputs + " --skin 1=gland --cut-side back", "expected i-, i+, j-, j+, k- or k+");
  EXPECT_EQ(this->Run("mesh " + this->Inputs + " --crop 3:4" + output), 2);
}

TEST_F(MeshCommand, RefusesInOneLine)
{
  const std::string output = " -o " + this->Mesh;
  const std::string table = " --materials " + this->Folder.File("table.json");
  this->ExpectRefused("mesh --labels " + this->Folder.File("absent.nrrd") + table + output,
    "no such file");
  this->ExpectRefused("mesh --labels " + this->Labels + " --materials /nowhere.json" + output,
    "no such file");
  this->ExpectRefused("mesh " + this->Inputs + " -o " + this->Folder.File("mesh.stl"), ".vtu");
  this->ExpectRefused("mesh " + this->Inputs + " -o /nowhere/mesh.vtu", "no folder");
  this->ExpectRefused("mesh " + this->Inputs + output + " --config " +
      this->Folder.Write("angle.json", R"({ "facet-angle": 60 })"),
    "facet angle");
  this->ExpectRefused("mesh " + this->Inputs + output + " --cell-size-of bone=2",
    "unknown material 'bone'");
  this->ExpectRefused("mesh " + this->Inputs + output + " --cell-size-of gland", "MATERIAL=MM");
  this->Volume.Voxels[0] = 77;
  WriteLabelVolume(this->Volume, this->Labels);
  this->ExpectRefused("mesh " + this->Inputs + output, "label 77 (1 voxels)");
  std::fill(this->Volume.Voxels.begin(), this->Volume.Voxels.end(), 0);
  WriteLabelVolume(this->Volume, this->Labels);
  this->ExpectRefused("mesh " + this->Inputs + output, "only air");
  EXPECT_EQ(this->Run("mesh --labels"), 2);
}

TEST_F(MeshCommand, RepairsASurface)
{
  // A cube of quads, one of them turned, one there twice, every corner with points of its own.
  const int faces[][4] = { { 0, 2, 3, 1 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 }, { 2, 6, 7, 3 },
    { 2, 6, 4, 0 }, { 1, 3, 7, 5 }, { 1, 3, 7, 5 } };
  std::string text;
  for (const auto& face : faces)
  {
    for (const int corner : face)
    {
      text += "v " + std::to_string(10 * (corner & 1)) + " " +
        std::to_string(10 * (corner >> 1 & 1)) + " " + std::to_string(10 * (corner >> 2)) + "\n";
    }
    text += "f -4 -3 -2 -1\n";
  }
  const std::string bad = this->Folder.Write("bad.obj", text);
  EXPECT_EQ(this->Run("mesh --check " + bad), 1);
  EXPECT_THAT(this->Errors, testing::HasSubstr("7 borders that coincide"));
  EXPECT_THAT(this->Errors, testing::HasSubstr("mesh --repair welds them"));
  const std::string good = this->Folder.File("good.vtp");
  ASSERT_EQ(this->Run("mesh --repair " + bad + " -o " + good), 0) << this->Errors;
  EXPECT_THAT(this->Output,
    testing::HasSubstr("20 points welded, 0 flat and 2 doubled triangles left out, 2 turned"));
  EXPECT_THAT(this->Output, testing::HasSubstr("sound: every boundary"));
  EXPECT_EQ(this->Run("mesh --check " + good), 0) << this->Errors;
  EXPECT_THAT(this->Output, testing::HasSubstr("1.000"));
  EXPECT_EQ(this->Run("mesh --repair " + bad), 2);
  EXPECT_EQ(this->Run("mesh --weld 1 --check " + bad), 2);
  // Half of a face is open: its border of 34 mm is left unless it is asked for.
  const std::string open = this->Folder.Write("open.obj",
    "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 10 10 0\nv 0 0 10\nv 10 0 10\nv 0 10 10\nv 10 10 10\n"
    "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8\n");
  const std::string whole = this->Folder.File("whole.stl");
  EXPECT_EQ(this->Run("mesh --repair " + open + " -o " + whole), 1);
  EXPECT_THAT(this->Errors, testing::HasSubstr("1 holes in the boundary"));
  EXPECT_EQ(this->Run("mesh --repair " + open + " --close-holes 40 --overwrite -o " + whole), 0)
    << this->Errors;
  EXPECT_THAT(this->Output, testing::HasSubstr("1 holes closed, 0 left"));
  EXPECT_EQ(this->Run("mesh --check " + whole), 0) << this->Errors;
}

TEST_F(MeshCommand, ConfigurationRoundTrips)
{
  const std::string arguments =
    this->Inputs + " -o " + this->Mesh + " --cell-size 3.5 --thin fat --thin gland --overwrite";
  ASSERT_EQ(this->Run("mesh " + arguments + " --print-config"), 0) << this->Errors;
  EXPECT_FALSE(std::filesystem::exists(this->Mesh));
  const std::string printed = this->Output;
  EXPECT_THAT(printed, testing::HasSubstr("\"cell-size\": 3.5"));
  const std::string config = this->Folder.Write("config.json", printed);
  ASSERT_EQ(this->Run("mesh --config " + config + " --print-config"), 0) << this->Errors;
  EXPECT_EQ(this->Output, printed);
  ASSERT_EQ(this->Run("mesh --config " + config), 0) << this->Errors;
  EXPECT_TRUE(std::filesystem::exists(this->Mesh));
  this->Folder.Write("config.json", R"({"cel-size": 3})");
  EXPECT_EQ(this->Run("mesh --config " + config + " " + arguments), 2) << this->Errors;
}

TEST_F(MeshCommand, MakesOneCoarseBodyOfAllFreeTissueForTheMechanics)
{
  ASSERT_EQ(this->Run("mesh " + this->Inputs + " --for-mechanics --cell-size 4 -o " + this->Mesh),
    0)
    << this->Errors;
  const TetrahedralMesh mesh = FromGrid(ReadMesh(this->Mesh));
  double volume = 0;
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    EXPECT_EQ(mesh.Materials[cell], mesh.Materials[0]); // nothing is held
    volume += mesh.CellVolume(cell);
  }
  // Edges of a cube of two and a half cells, rounded by a third of a cell, take a tenth of it.
  EXPECT_NEAR(volume, 1000, 110);
  EXPECT_EQ(this->Run("mesh --for-mechanics --surface fat=fat.stl -o " + this->Mesh), 2);
  EXPECT_THAT(this->Errors, testing::HasSubstr("--surface"));
}

TEST_F(MeshCommand, WarnsOfPlatesThinnerThanTheirFacets)
{
  // Two plates of 1 mm, apart, with nothing in the middle of the mesh.
  LabelVolume volume;
  volume.Size = { 60, 60, 60 };
  volume.Spacing = { 0.5, 0.5, 0.5 };
  volume.Voxels.assign(216000, 0);
  for (int j = 10; j < 50; ++j)
  {
    for (int i = 10; i < 50; ++i)
    {
      for (const int k : { 10, 11, 48, 49 })
      {
        volume.Voxels[volume.Index(i, j, k)] = 1;
      }
    }
  }
  WriteLabelVolume(volume, this->Labels);
  const std::string picture = this->Folder.File("cut.png");
  const std::string command = "mesh " + this->Inputs + " -o " + this->Mesh;
  ASSERT_EQ(this->Run(command + " --cut-picture " + picture), 0) << this->Errors;
  EXPECT_THAT(this->Errors, testing::HasSubstr("warning: fat: "));
  EXPECT_THAT(this->Errors, testing::HasSubstr("--thin and --facet-size-of make finer ones"));
  EXPECT_GT(std::filesystem::file_size(picture), 1000u);
  ASSERT_EQ(this->Run(command + " --overwrite --thin fat"), 0) << this->Errors;
  EXPECT_THAT(this->Errors, testing::Not(testing::HasSubstr("warning")));
}

// After 4 of 41 s of work.
TEST_F(MeshCommand, EndsCleanlyWhenTerminated)
{
  const std::string fine = "mesh " + this->Inputs + " --cell-size 0.15 -o " + this->Mesh;
  this->CommandTest::ExpectRefused(fine, "interrupted",
    "timeout --preserve-status --signal=TERM 4");
  EXPECT_FALSE(std::filesystem::exists(this->Mesh));
  EXPECT_FALSE(std::filesystem::exists(this->Mesh + ".partial"));
}
