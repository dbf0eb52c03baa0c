// SPDX-License-Identifier: Apache-2.0
// The series of a compression; what its grids hold is tested with the filter and the command that
// make them (TestBreastCompression, TestCompressCommand).
#include "Files.h"
#include "TestMeshes.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/Study/CompressionGrids.h"

#include "vtkUnstructuredGrid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

using namespace mammoray;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

TEST(CompressionGrids, TimesGoFromOpenToClosed)
{
  EXPECT_EQ(TimeOf(0, 5), 0);
  EXPECT_EQ(TimeOf(1, 5), 0.25);
  EXPECT_EQ(TimeOf(4, 5), 1);
  EXPECT_EQ(TimeOf(0, 1), 1);
}

TEST(CompressionGrids, ASeriesNamesItsFiles)
{
  const test::TemporaryFolder folder;
  const std::string path = folder.File("open.pvd");
  const std::vector<std::string> files = SeriesFiles(path, 2);
  EXPECT_THAT(files, ElementsAre(folder.File("open_000.vtu"), folder.File("open_001.vtu")));
  const auto grid =
    ToGrid(test::MakeBoxMesh({ 0, 0, 0 }, { 1, 1, 1 }, { 1, 1, 1 }), { "air", "a" });
  WriteSeries(path, { grid, grid });
  const std::string collection = test::ReadFile(path);
  EXPECT_THAT(collection, HasSubstr("file=\"open_000.vtu\""));
  EXPECT_THAT(collection, HasSubstr("file=\"open_001.vtu\""));
  EXPECT_THAT(collection, HasSubstr("timestep=\"1\""));
  EXPECT_EQ(ReadMesh(files[1])->GetNumberOfCells(), grid->GetNumberOfCells());
}

TEST(CompressionGrids, AFailedSeriesLeavesNoFile)
{
  const test::TemporaryFolder folder;
  const auto grid =
    ToGrid(test::MakeBoxMesh({ 0, 0, 0 }, { 1, 1, 1 }, { 1, 1, 1 }), { "air", "a" });
  fs::create_directories(folder.File("open.pvd/within")); // a folder of that name
  EXPECT_THROW(WriteSeries(folder.File("open.pvd"), { grid, grid }), InputError);
  EXPECT_FALSE(fs::exists(folder.File("open_000.vtu")));
  EXPECT_FALSE(fs::exists(folder.File("open_001.vtu")));
}
