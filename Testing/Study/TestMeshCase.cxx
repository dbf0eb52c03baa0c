// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/Study/MeshCase.h"

#include "vtkUnstructuredGrid.h"

#include <nlohmann/json.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

using namespace mammoray;

namespace
{
/// A cube of 10 mm, half fat (label 1), half gland (label 2), 2 mm from the volume's border.
class MeshCaseTest : public testing::Test
{
protected:
  void SetUp() override
  {
    LabelVolume volume;
    volume.Size = { 14, 14, 14 };
    volume.Voxels.assign(14 * 14 * 14, 0);
    for (int k = 2; k < 12; ++k)
    {
      for (int j = 2; j < 12; ++j)
      {
        for (int i = 2; i < 12; ++i)
        {
          volume.Voxels[volume.Index(i, j, k)] = i < 7 ? 1 : 2;
        }
      }
    }
    this->Input.Labels.Path = this->Folder.File("labels.nrrd");
    WriteLabelVolume(volume, this->Input.Labels.Path);
    this->Input.Materials = this->Folder.Write("table.json", R"({"materials": [
      {"name": "air", "labels": [0]},
      {"name": "fat", "labels": [1], "attenuation": "adipose"},
      {"name": "gland", "labels": [2], "attenuation": "glandular", "thin": true}]})");
  }

  test::TemporaryFolder Folder;
  MeshCase Input;
};
}

TEST_F(MeshCaseTest, MeshesLabelsAndChecksThem)
{
  const MeshCaseResult result = RunMeshCase(this->Input);
  EXPECT_EQ(result.Materials.Names(), (std::vector<std::string>{ "air", "fat", "gland" }));
  EXPECT_TRUE(result.Check.Sound());
  EXPECT_EQ(result.Meshed.Mesh.NumberOfCells(), result.Check.Cells);
  EXPECT_TRUE(result.TooThin.empty());
}

TEST_F(MeshCaseTest, SizesOfMaterialsGoByName)
{
  this->Input.CellSizeOfMm = { { "fat", 1.5 } };
  this->Input.FacetSizeOfMm = { { "gland", 2.5 } };
  const MeshingOptions options = RunMeshCase(this->Input).Options;
  EXPECT_EQ(options.CellSizeOfMaterialMm.at(1), 1.5);
  EXPECT_EQ(FacetSizeMm(options, 2), 2.5);
  EXPECT_EQ(FacetSizeMm(options, 1), options.FacetSizeMm);
  // Gland is thin by the table, and nothing is where 'none' is said.
  EXPECT_EQ(options.FacetDistanceOfMaterialMm.count(2), 1u);
  this->Input.Thin = { "none" };
  EXPECT_TRUE(RunMeshCase(this->Input).Options.FacetDistanceOfMaterialMm.empty());
  this->Input.FacetSizeOfMm = { { "bone", 0.3 } };
  EXPECT_THROW(RunMeshCase(this->Input), InputError);
}

TEST_F(MeshCaseTest, AMeshForTheMechanicsIsOneBodyOfTheTissue)
{
  this->Input.MechanicsCellSizeMm = 4;
  const MeshCaseResult result = RunMeshCase(this->Input);
  ASSERT_GT(result.Meshed.Mesh.NumberOfCells(), 0u);
  for (const int material : result.Meshed.Mesh.Materials)
  {
    EXPECT_EQ(material, result.Meshed.Mesh.Materials.front());
  }
}

TEST_F(MeshCaseTest, SurfacesNameTheirMaterialsInTheirOrder)
{
  // Tetrahedra of 6 x 6 x 6 / 6 = 36 mm3, 10 mm apart, labelled by voxels.
  const auto write = [&](const char* name, const char* points) {
    return this->Folder.Write(name, std::string(points) + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  };
  const std::string one = write("one.obj", "v 0 0 0\nv 6 0 0\nv 0 6 0\nv 0 0 6\n");
  const std::string other = write("other.obj", "v 10 0 0\nv 16 0 0\nv 10 6 0\nv 10 0 6\n");
  MeshCase input;
  input.Surfaces = { { "tumour", one }, { "cyst", other } };
  input.SurfaceVoxelsMm = 0.25;
  const MeshCaseResult result = RunMeshCase(input);
  EXPECT_EQ(result.Materials.Names(), (std::vector<std::string>{ "air", "tumour", "cyst" }));
  ASSERT_EQ(result.Meshed.Reports.size(), 2u);
  for (const MaterialReport& report : result.Meshed.Reports)
  {
    EXPECT_NEAR(report.VolumeOutMm3, 36, 0.05 * 36); // edges are rounded
  }
  // Two surfaces of one material are one body.
  input.Surfaces[1].first = "tumour";
  EXPECT_EQ(RunMeshCase(input).Materials.Names(), (std::vector<std::string>{ "air", "tumour" }));
}

TEST_F(MeshCaseTest, ReportTellsWhatWasMeshedAndWhatBecameOfIt)
{
  const MeshCaseResult result = RunMeshCase(this->Input);
  const nlohmann::json report = nlohmann::json::parse(MeshReport(this->Input, result));
  EXPECT_EQ(report.at("method"), "cgal");
  EXPECT_EQ(report.at("labels"), this->Input.Labels.Path);
  EXPECT_EQ(report.at("volumes").at(0).at("material"), "fat");
  EXPECT_EQ(report.at("volumes").at(0).at("volume_in_mm3"), 500.0);
  EXPECT_TRUE(report.at("sound").get<bool>());
  EXPECT_EQ(report.at("cells"), result.Check.Cells);
  EXPECT_GT(report.at("peak_memory_bytes").get<double>(), 1e6);
  const nlohmann::json check =
    nlohmann::json::parse(CheckReport(result.Check, result.Materials.Names()));
  EXPECT_EQ(check.at("per_material"), report.at("per_material"));
  EXPECT_FALSE(check.contains("volumes"));
  EXPECT_EQ(NameOfMaterial(2, result.Materials.Names()), "gland");
  EXPECT_EQ(NameOfMaterial(7, result.Materials.Names()), "material 7");
}

TEST_F(MeshCaseTest, CutsAreDrawn)
{
  const MeshCaseResult result = RunMeshCase(this->Input);
  const std::vector<std::string> names = result.Materials.Names();
  const auto grid = ToGrid(result.Meshed.Mesh, names);
  const std::string cuts = this->Folder.File("cuts.png");
  WriteMeshCuts(grid, names, cuts);
  EXPECT_THAT(test::ReadFile(cuts), testing::StartsWith("\x89PNG"));
}
