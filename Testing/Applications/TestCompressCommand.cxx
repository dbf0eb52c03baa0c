// SPDX-License-Identifier: Apache-2.0
#include "CommandTest.h"
#include "TestMeshes.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkPointData.h"
#include "vtkUnstructuredGrid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <optional>

using namespace mammoray;
using test::ReadFile;

namespace
{
class CompressCommand : public test::CommandTest
{
protected:
  void SetUp() override
  {
    // x left, y anterior, z superior; a chest wall of 15 mm.
    WriteMesh(ToGrid(test::MakeHalfEllipsoidMesh(40, 45, 38, 6), { "air", "fat", "muscle" }),
      this->Folder.File("breast.vtu"));
    WriteMesh(ToGrid(test::MakeHalfEllipsoidMesh(40, 45, 38, 16), { "air", "fat", "muscle" }),
      this->Folder.File("fine.vtu"));
    this->Folder.Write("table.json", R"({"materials": [{"name": "air", "labels": [0]},
      {"name": "fat", "labels": [1], "attenuation": "adipose"},
      {"name": "muscle", "labels": [2], "attenuation": "muscle", "fixed": true}]})");
  }

  std::string Result = this->Folder.File("compressed.vtu");
  std::string Common = "--orientation LAS --materials " + this->Folder.File("table.json") + " -o " +
    this->Result + " --mesh ";
  std::string Coarse = this->Common + this->Folder.File("breast.vtu");
};
}

TEST_F(CompressCommand, WritesTheCompressedMesh)
{
  ASSERT_EQ(this->Run("compress " + this->Coarse + " --thickness 46 --anterior 5 --roll 10"), 0)
    << this->Errors;
  EXPECT_EQ(this->Errors, "");
  const vtkSmartPointer<vtkUnstructuredGrid> grid = ReadMesh(this->Result);
  const TetrahedralMesh rest = test::MakeHalfEllipsoidMesh(40, 45, 38, 6);
  const TetrahedralMesh deformed = FromGrid(grid);
  vtkDataArray* displacement = grid->GetPointData()->GetArray("Displacement");
  ASSERT_TRUE(displacement);
  ASSERT_EQ(displacement->GetNumberOfComponents(), 3);
  double largest = 0;
  for (std::size_t p = 0; p < rest.NumberOfPoints(); ++p)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      const double by = displacement->GetComponent(static_cast<vtkIdType>(p), axis);
      EXPECT_NEAR(rest.Point(p)[axis] + by, deformed.Point(p)[axis], 1e-9);
      largest = std::max(largest, std::abs(by));
    }
  }
  EXPECT_GT(largest, 5);
  // As the unit stands, the tissue in front of the plates' edges fills what is between them; the
  // corners of these coarse quadratic cells leave up to a mm to their curved faces.
  const std::optional<VolumeFromGantry> placed = FindPlacement(grid);
  ASSERT_TRUE(placed);
  const MammographyUnit unit;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (std::size_t p = 0; p < deformed.NumberOfPoints(); ++p)
  {
    const Vector3 at = placed->ToGantry(deformed.Point(p));
    if (at[1] > unit.EdgeRadiusMm)
    {
      low = std::min(low, at[2]);
      high = std::max(high, at[2]);
    }
  }
  EXPECT_NEAR(low, unit.SupportHeightMm, 1);
  EXPECT_NEAR(high, unit.SupportHeightMm + 46, 1);
  ASSERT_TRUE(grid->GetCellData()->GetArray("J"));
  std::size_t inverted = 0;
  for (std::size_t cell = 0; cell < rest.NumberOfCells(); ++cell)
  {
    const double ratio =
      grid->GetCellData()->GetArray("J")->GetTuple1(static_cast<vtkIdType>(cell));
    EXPECT_NEAR(ratio, deformed.CellVolume(cell) / rest.CellVolume(cell), 1e-9);
    inverted += ratio > 0 ? 0 : 1;
  }
  EXPECT_EQ(grid->GetFieldData()->GetArray("InvertedCells")->GetTuple1(0), inverted);
  // Flat bricks at the rim of the chest wall, squeezed most; the rest must be sound.
  EXPECT_LT(inverted, rest.NumberOfCells() / 100);
  for (const char* name : { "PaddleForceN", "SupportForceN", "LargestPenetrationMm", "SmallestJ" })
  {
    ASSERT_TRUE(grid->GetFieldData()->GetArray(name)) << name;
    EXPECT_GT(grid->GetFieldData()->GetArray(name)->GetTuple1(0), 0) << name;
  }
  EXPECT_EQ(grid->GetFieldData()->GetArray("ThicknessMm")->GetTuple1(0), 46);
}

TEST_F(CompressCommand, TakesMaterialsByNameWhateverTheirOrder)
{
  TetrahedralMesh mesh = test::MakeHalfEllipsoidMesh(40, 45, 38, 6);
  for (std::int32_t& material : mesh.Materials)
  {
    material = 3 - material;
  }
  WriteMesh(ToGrid(mesh, { "air", "Muscle", "Fat" }), this->Folder.File("other.vtu"));
  ASSERT_EQ(this->Run("compress " + this->Coarse + " --thickness 46"), 0) << this->Errors;
  const TetrahedralMesh expected = FromGrid(ReadMesh(this->Result));
  ASSERT_EQ(this->Run("compress " + this->Common + this->Folder.File("other.vtu") +
              " --thickness 46 --overwrite"),
    0)
    << this->Errors;
  std::vector<std::string> names;
  const TetrahedralMesh found = FromGrid(ReadMesh(this->Result), &names);
  EXPECT_EQ(found.Materials, expected.Materials);
  EXPECT_EQ(found.Points, expected.Points);
  EXPECT_THAT(names, testing::ElementsAre("air", "fat", "muscle"));
}

TEST_F(CompressCommand, MovesAFineMeshWithACoarseOne)
{
  const std::string fine = this->Common + this->Folder.File("fine.vtu") + " --thickness 60";
  EXPECT_EQ(this->Run("compress " + fine + " --simulation-mesh " + this->Folder.File("breast.vtu")),
    0)
    << this->Errors;
  const TetrahedralMesh deformed = FromGrid(ReadMesh(this->Result));
  EXPECT_EQ(deformed.NumberOfCells(), test::MakeHalfEllipsoidMesh(1, 1, 1, 16).NumberOfCells());
}

TEST_F(CompressCommand, MakesACoarseMeshForOneOfManyCells)
{
  const TetrahedralMesh rest = test::MakeHalfEllipsoidMesh(40, 45, 38, 20);
  WriteMesh(ToGrid(rest, { "air", "fat", "muscle" }), this->Folder.File("finest.vtu"));
  const std::string run =
    "compress " + this->Common + this->Folder.File("finest.vtu") + " --thickness 60 --anterior 5";
  ASSERT_EQ(this->Run(run), 0) << this->Errors;
  const std::string out = ReadFile(this->Folder.File("out"));
  EXPECT_THAT(out, testing::MatchesRegex("[1-7][0-9][0-9][0-9] simulation cells,.*"));
  const TetrahedralMesh deformed = FromGrid(ReadMesh(this->Result));
  ASSERT_EQ(deformed.NumberOfCells(), rest.NumberOfCells());
  double low = 0, high = 0;
  for (std::size_t p = 0; p < deformed.NumberOfPoints(); ++p)
  {
    if (rest.Point(p)[1] > 25) // well in front of the plates' edges
    {
      low = std::min(low, deformed.Point(p)[2]);
      high = std::max(high, deformed.Point(p)[2]);
    }
  }
  // The coarse mesh follows the skin to 1 mm on either side.
  EXPECT_NEAR(high - low, 60, 2.5);
}

TEST_F(CompressCommand, TakesLinearElements)
{
  const std::string fine =
    "compress " + this->Common + this->Folder.File("fine.vtu") + " --thickness 60 --element ";
  ASSERT_EQ(this->Run(fine + "linear"), 0) << this->Errors;
  // 17 x 17 x 9 nodes, the first two of nine layers held.
  EXPECT_THAT(ReadFile(this->Folder.File("out")),
    testing::StartsWith("12288 simulation cells, 6069 unknowns"));
  EXPECT_EQ(this->Run(fine + "cubic"), 2);
  EXPECT_THAT(this->Errors, testing::HasSubstr("--element"));
}

TEST_F(CompressCommand, FindsTheThicknessOfAForceInAnObliqueView)
{
  const std::string oblique = "compress " + this->Coarse + " --view MLO --anterior 5 --tilt 3";
  ASSERT_EQ(this->Run(oblique + " --side left --force 6"), 0) << this->Errors;
  vtkSmartPointer<vtkUnstructuredGrid> grid = ReadMesh(this->Result);
  const auto value = [&](const char* name)
  { return grid->GetFieldData()->GetArray(name)->GetTuple1(0); };
  EXPECT_NEAR(value("PaddleForceN"), 6, 6e-4);
  const double thickness = value("ThicknessMm");
  EXPECT_GT(thickness, 30);
  EXPECT_LT(thickness, 79);
  // The source of a left MLO view is turned to the patient's right, 45 degrees.
  ASSERT_EQ(this->Run("compress " + this->Coarse +
              " --roll -45 --anterior 5 --tilt 3 --overwrite --thickness " +
              std::to_string(thickness)),
    0)
    << this->Errors;
  grid = ReadMesh(this->Result);
  // On either way contact may have been made stiffer to keep its penetration: up to 0.04 mm at each
  // plate, a tenth of the force for a millimetre.
  EXPECT_NEAR(value("PaddleForceN"), 6, 0.05);
  EXPECT_EQ(this->Run(oblique + " --overwrite --thickness 60"), 1);
  EXPECT_THAT(this->Errors, testing::HasSubstr("--side"));
  EXPECT_EQ(this->Run("compress " + this->Coarse + " --force 5 --thickness 60"), 2);
}

TEST_F(CompressCommand, WritesATimeSeriesOfABreastUnloadedFromProne)
{
  this->Folder.Write("soft.json", R"({"materials": [{"name": "air", "labels": [0]},
    {"name": "fat", "labels": [1], "attenuation": "adipose", "youngs_modulus_kpa": 3},
    {"name": "muscle", "labels": [2], "attenuation": "muscle", "fixed": true}]})");
  const std::string pvd = this->Folder.File("series.pvd");
  const std::string run = "compress --orientation LAS --materials " +
    this->Folder.File("soft.json") + " -o " + this->Result + " --mesh " +
    this->Folder.File("breast.vtu") +
    " --thickness 54 --anterior 5 --mri-position prone --chest-wall elastic --pull 0.5"
    " --friction 0.2 --series " +
    pvd + " --config " +
    this->Folder.Write("wall.json",
      R"({ "wall-normal-stiffness": 50, "wall-tangential-stiffness": 5 })");
  ASSERT_EQ(this->Run(run + " --series-steps 3"), 0) << this->Errors;
  EXPECT_EQ(this->Errors, "");
  EXPECT_THAT(this->Output, testing::HasSubstr("MiB to factorise"));
  EXPECT_THAT(this->Output, testing::HasSubstr("chest wall: glided"));
  const std::string collection = ReadFile(pvd);
  for (const char* entry : { "timestep=\"0\"", "timestep=\"0.5\"", "timestep=\"1\"",
         "file=\"series_000.vtu\"", "file=\"series_002.vtu\"" })
  {
    EXPECT_THAT(collection, testing::HasSubstr(entry));
  }
  double last = 1e9;
  for (const char* file : { "series_000.vtu", "series_001.vtu", "series_002.vtu" })
  {
    const auto grid = ReadMesh(this->Folder.File(file));
    const double thickness = grid->GetFieldData()->GetArray("ThicknessMm")->GetTuple1(0);
    EXPECT_LT(thickness, last - 3);
    last = thickness;
    for (const char* name : { "Displacement", "ContactPressureKPa" })
    {
      EXPECT_TRUE(grid->GetPointData()->GetArray(name)) << name;
    }
    EXPECT_TRUE(grid->GetCellData()->GetArray("VonMisesStressKPa"));
    const double force = grid->GetFieldData()->GetArray("PaddleForceN")->GetTuple1(0);
    if (file == std::string("series_000.vtu"))
    {
      EXPECT_NEAR(force, 0, 1e-12); // roundoff of the plates' places
    }
    else
    {
      EXPECT_GT(force, 0);
    }
  }
  EXPECT_NEAR(last, 54, 1e-9);
  // Nothing is replaced unasked, and no file twice.
  EXPECT_EQ(this->Run(run), 1);
  std::filesystem::remove(this->Result);
  EXPECT_EQ(this->Run(run), 1);
  EXPECT_THAT(this->Errors, testing::HasSubstr("series.pvd: exists already"));
  std::filesystem::remove(pvd);
  EXPECT_EQ(this->Run(run), 1);
  EXPECT_THAT(this->Errors, testing::HasSubstr("series_000.vtu: exists already"));
}

TEST_F(CompressCommand, RefusesInOneLine)
{
  const auto expectRefused = [this](const std::string& arguments, const std::string& text)
  {
    EXPECT_EQ(this->Run("compress " + arguments), 1) << arguments;
    EXPECT_THAT(this->Errors, testing::StartsWith("mammoray: "));
    EXPECT_THAT(this->Errors, testing::HasSubstr(text));
    EXPECT_EQ(std::count(this->Errors.begin(), this->Errors.end(), '\n'), 1) << this->Errors;
    EXPECT_FALSE(std::filesystem::exists(this->Result));
  };
  expectRefused("--orientation LLS" + this->Coarse.substr(std::string("--orientation LAS").size()) +
      " --thickness 50",
    "orientation 'LLS'");
  expectRefused(this->Common + this->Folder.File("none.vtu") + " --thickness 50", "no such file");
  this->Folder.Write("loose.json", R"({"materials": [{"name": "air", "labels": [0]},
    {"name": "fat", "labels": [1], "attenuation": "adipose"},
    {"name": "muscle", "labels": [2], "attenuation": "muscle"}]})");
  expectRefused("--orientation LAS --materials " + this->Folder.File("loose.json") + " -o " +
      this->Result + " --mesh " + this->Folder.File("breast.vtu") + " --thickness 50",
    "fixed");
  expectRefused(this->Coarse + " --thickness 50 --series " + this->Folder.File("series.vtu"),
    "expected the extension .pvd");
  expectRefused(this->Coarse + " --thickness 1e9",
    "expected a compressed thickness from 5 to 150 mm, found 1e+09; set --accept-unusual");
  // Thinner than any equilibrium this mesh can show.
  WriteMesh(ToGrid(test::MakeHalfEllipsoidMesh(40, 45, 38, 4), { "air", "fat", "muscle" }),
    this->Folder.File("coarser.vtu"));
  expectRefused(this->Common + this->Folder.File("coarser.vtu") +
      " --thickness 0.02 --accept-unusual",
    "last one reached is at");
  EXPECT_THAT(this->Errors, testing::HasSubstr("--anterior 5 moves them off"));
  EXPECT_EQ(this->Run("compress " + this->Coarse + " --thickness -3"), 2);
  EXPECT_EQ(this->Run("compress " + this->Coarse), 2);
  EXPECT_EQ(this->Run("compress " + this->Coarse + " --thickness 50 --chest-wall loose"), 2);
  EXPECT_EQ(this->Run("compress " + this->Coarse + " --thickness 50 --friction -1"), 2);
  const std::string wall = this->Folder.Write("wall.json", R"({ "wall-normal-stiffness": 0 })");
  EXPECT_EQ(this->Run("compress " + this->Coarse + " --thickness 50 --config " + wall), 2);
  EXPECT_EQ(this->Run("compress " + this->Coarse + " --thickness 50 --mri-position left"), 2);
}

TEST_F(CompressCommand, ReadsBackItsConfiguration)
{
  ASSERT_EQ(this->Run("compress " + this->Coarse +
              " --force 61 --view MLO --side right --roll -12.5 --print-config"),
    0)
    << this->Errors;
  std::filesystem::copy_file(this->Folder.File("out"), this->Folder.File("config.json"));
  EXPECT_THAT(ReadFile(this->Folder.File("config.json")), testing::HasSubstr("\"roll\": -12.5"));
  ASSERT_EQ(this->Run("compress --config " + this->Folder.File("config.json") + " --print-config"),
    0)
    << this->Errors;
  EXPECT_EQ(ReadFile(this->Folder.File("out")), ReadFile(this->Folder.File("config.json")));
}
