// SPDX-License-Identifier: Apache-2.0
// Every label volume and closed surface at hand, by both ways. All but one of them run only with
// MAMMORAY_LONG_TESTS=1, and each only where its file is. With MAMMORAY_MESH_PAGE=FOLDER they leave
// the rows of Validation/reports/meshes.md (table.md) and pictures of the cuts in that folder.
#include "CommandTest.h"
#include "Files.h"
#include "SurfaceShapes.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"

#include "vtkUnstructuredGrid.h"

#include <nlohmann/json.hpp>

#include <cstdlib>
#include <fstream>
#include <random>

using namespace mammoray;
using test::ReadFile;

namespace
{
const std::string Shared = test::SharedDataFolder();
const std::string Victre = test::DataFolder() + "/materials/victre.json";

struct Phantom
{
  const char* Name;
  std::string Labels;
  /// A file, or "" for the table below.
  std::string Materials;
  const char* Table;
  const char* Options;
  double VoxelMm;
  /// False for data whose licence keeps it out of the documents.
  bool Shown = true;
};

/// What a mesh leaves in the folder of MAMMORAY_MESH_PAGE.
enum class Page
{
  Nothing,
  Row,
  RowAndPicture
};

std::ostream& operator<<(std::ostream& stream, const Phantom& phantom)
{
  return stream << phantom.Name;
}

/// Meshes, checks and documents.
class MeshingTest : public test::CommandTest
{
protected:
  /// Makes `name`.vtu of `input`, with every volume within its bound and sound by a second look.
  void Mesh(const std::string& name, const std::string& input, double smallestDihedralDeg,
    Page left)
  {
    const std::string mesh = this->Folder.File(name + ".vtu");
    const std::string report = this->Folder.File(name + ".json");
    const char* page = std::getenv("MAMMORAY_MESH_PAGE");
    const std::string picture = page && left == Page::RowAndPicture
      ? " --cut-picture " + std::string(page) + "/" + name + ".png --overwrite"
      : "";
    ASSERT_EQ(this->Run("mesh " + input + " -o " + mesh + " --report " + report + picture), 0)
      << this->Errors;
    EXPECT_THAT(this->Errors, testing::Not(testing::HasSubstr("expected its voxels'")));
    const auto json = nlohmann::json::parse(ReadFile(report));
    EXPECT_TRUE(json["sound"]);
    EXPECT_GT(json["processor_seconds"], 0);
    EXPECT_GT(json["peak_memory_bytes"], 1e6); // libraries alone take more
    for (const auto& entry : json["volumes"])
    {
      EXPECT_TRUE(entry["volume_kept"]) << entry;
    }
    for (const auto& entry : json["per_material"])
    {
      EXPECT_GT(entry["smallest_dihedral_deg"], smallestDihedralDeg) << entry;
    }
    if (page && left != Page::Nothing)
    {
      WriteRow(std::string(page) + "/table.md", name, json);
    }
    EXPECT_EQ(this->Run("mesh --check " + mesh), 0) << this->Errors;
  }

private:
  /// Volumes that are off, in parts of what went in; angles; time and memory.
  static void WriteRow(const std::string& path, const std::string& name, const nlohmann::json& json)
  {
    double off = 0;
    for (const auto& entry : json["volumes"])
    {
      const double in = entry["volume_in_mm3"];
      off = std::max(off, std::abs(entry["volume_out_mm3"].get<double>() - in) / in);
    }
    double dihedral = 180;
    for (const auto& entry : json["per_material"])
    {
      dihedral = std::min(dihedral, entry["smallest_dihedral_deg"].get<double>());
    }
    char row[240];
    std::snprintf(row, sizeof(row), "| %s | %d | %d | %d | %.2f %% | %.1f° | %.0f | %.1f |\n",
      name.c_str(), json["components"].get<int>(), json["cells"].get<int>(),
      json["interface_triangles"].get<int>(), 100 * off, dihedral,
      json["processor_seconds"].get<double>(), json["peak_memory_bytes"].get<double>() / 1e9);
    std::ofstream(path, std::ios::app) << row;
  }
};

class PhantomMeshes
  : public MeshingTest
  , public testing::WithParamInterface<Phantom>
{
protected:
  void SetUp() override
  {
    const Phantom& phantom = GetParam();
    if (!std::filesystem::exists(phantom.Labels))
    {
      GTEST_SKIP() << "absent: " << phantom.Labels;
    }
    if (std::string(phantom.Name) != "example" && !std::getenv("MAMMORAY_LONG_TESTS"))
    {
      GTEST_SKIP() << "only with MAMMORAY_LONG_TESTS=1";
    }
  }

  std::string NameOf(const std::string& method) const { return GetParam().Name + ("-" + method); }

  void MeshBy(const std::string& method)
  {
    const Phantom& phantom = GetParam();
    std::string table = phantom.Materials;
    if (table.empty())
    {
      table = this->Folder.Write("table.json", phantom.Table);
    }
    // The goal is 12, which some cells between three interfaces do not reach.
    const double smallestDihedralDeg = 4;
    this->Mesh(this->NameOf(method),
      "--labels " + phantom.Labels + " --materials " + table + " " + phantom.Options +
        " --method " + method,
      smallestDihedralDeg, phantom.Shown ? Page::RowAndPicture : Page::Nothing);
  }

  SurfaceMesh Interfaces(const std::string& method)
  {
    return ExtractInterfaces(FromGrid(ReadMesh(this->Folder.File(this->NameOf(method) + ".vtu"))));
  }
};

std::string SegmentTable(const char* fat, const char* gland)
{
  return std::string(R"({"materials": [{"name": "air", "labels": [0]},
    {"name": "fat", "labels": )") +
    fat + R"(, "attenuation": "adipose"},
    {"name": "gland", "labels": )" +
    gland + R"(, "attenuation": "glandular"}]})";
}
const std::string OneSegment = SegmentTable("[1]", "[2]");
const std::string FiveSegments = SegmentTable("[3, 4, 5]", "[1, 2]");
const std::string WithPaddles = R"({"materials": [{"name": "air", "labels": [0]},
  {"name": "fat", "labels": [1], "attenuation": "adipose"},
  {"name": "gland", "labels": [29, 88, 95, 125, 150, 225], "attenuation": "glandular"},
  {"name": "skin", "labels": [2, 33], "attenuation": "skin", "thin": true},
  {"name": "paddle", "labels": [50], "attenuation": "polystyrene", "thin": true}]})";
}

TEST_P(PhantomMeshes, BothWaysAreSoundKeepVolumesAndAgree)
{
  this->MeshBy("cgal");
#ifndef MAMMORAY_HAS_TETGEN
  GTEST_SKIP() << "this build has no TetGen: one way only";
#endif
  this->MeshBy("tetgen");
  if (this->HasFatalFailure())
  {
    return;
  }
  const SurfaceMesh one = this->Interfaces("cgal");
  const SurfaceMesh other = this->Interfaces("tetgen");
  Vector3 low{ 1e9, 1e9, 1e9 };
  Vector3 high{ -1e9, -1e9, -1e9 };
  for (std::size_t value = 0; value < one.Points.size(); ++value)
  {
    low[value % 3] = std::min(low[value % 3], one.Points[value]);
    high[value % 3] = std::max(high[value % 3], one.Points[value]);
  }
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> share(0.2, 0.8);
  std::vector<double> differences;
  for (int ray = 0; ray < 60; ++ray)
  {
    const auto at = [&](double z)
    {
      const double x = share(generator);
      const double y = share(generator);
      return Vector3{ low[0] + x * (high[0] - low[0]), low[1] + y * (high[1] - low[1]), z };
    };
    const Vector3 from = at(low[2] - 50);
    const Vector3 to = at(high[2] + 50);
    const std::vector<double> a = shapes::ReferenceLengths(one, from, to);
    const std::vector<double> b = shapes::ReferenceLengths(other, from, to);
    ASSERT_FALSE(a.empty() || b.empty()) << "a ray met a leak";
    for (std::size_t material = 1; material < std::min(a.size(), b.size()); ++material)
    {
      differences.push_back(std::abs(a[material] - b[material]));
    }
  }
  std::sort(differences.begin(), differences.end());
  // The voxel's size, for all but one in twenty: rays that graze an interface have no bound.
  EXPECT_LT(differences[differences.size() * 95 / 100], GetParam().VoxelMm);
}

INSTANTIATE_TEST_SUITE_P(All, PhantomMeshes,
  testing::Values(Phantom{ "example", test::DataFolder() + "/victre-phantom-1/labels.nrrd", Victre,
                    "", "--label-spacing 0.8 --crop 90: 80:150 80:150 --thin skin", 0.8 },
    Phantom{ "scattered", Shared + "/breastphantom-scattered-1001/labels.nrrd", Victre, "",
      "--thin skin", 0.5 },
    Phantom{ "hetero", Shared + "/breastphantom-hetero-2002/labels.nrrd", Victre, "", "--thin skin",
      0.5 },
    Phantom{ "p_1", Shared + "/victre-pipeline-phantom-1/p_1.nhdr", Victre, "", "--thin skin",
      0.2 },
    Phantom{ "pc_1", Shared + "/victre-pipeline-phantom-1/pc_1.nhdr", Victre, "", "--thin skin",
      0.2 },
    Phantom{ "pc_1_crop", Shared + "/victre-pipeline-phantom-1/pc_1_crop.nhdr", "",
      WithPaddles.c_str(), "", 0.2 },
    Phantom{ "ispy1", Shared + "/ispy1-breast-voi-seg/ispy1_1001_breast_voi_seg.dcm", "",
      OneSegment.c_str(), "", 0.78 },
    Phantom{ "duke", Shared + "/duke-breast-mri-153-CC-BY-NC-4.0/seg_fgt_fat.dcm", "",
      FiveSegments.c_str(), "", 0.76, false }),
  [](const auto& instance) { return std::string(instance.param.Name); });

class SurfaceFiles : public MeshingTest
{
};

TEST_F(SurfaceFiles, ClosedSurfacesAreFilledAndMeshesChecked)
{
  if (!std::getenv("MAMMORAY_LONG_TESTS") || !std::filesystem::exists(Shared))
  {
    GTEST_SKIP() << "only with MAMMORAY_LONG_TESTS=1 and " << Shared;
  }
#ifndef MAMMORAY_HAS_TETGEN
  GTEST_SKIP() << "this build has no TetGen";
#endif
  for (const std::string shape : { "cubes", "spheres", "gVXR" })
  {
    // Creases are kept, and those of the letters come within 0.0015 mm of each other.
    const double smallestDihedralDeg = 0;
    this->Mesh(shape, "--surface body=" + Shared + "/gvxr-shapes/" + shape + "-bin.stl",
      smallestDihedralDeg, Page::Row);
  }
  // Vessels overlap where they join, and one is turned the wrong way round in places.
  const std::string vessels =
    "--surface vessel=" + Shared + "/hra-vasculature-mesh/VH_F_vasculature_mm_capped.stl";
  this->ExpectRefused("mesh " + vessels + " -o " + this->Folder.File("v.vtu"), "--surface-voxels");
  this->Mesh("vessels", vessels + " --surface-voxels 1", 4, Page::Row);
}
