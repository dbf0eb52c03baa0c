// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "Refusals.h"
#include "TestMeshes.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/Study/StudyPictures.h"

#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPNGReader.h"
#include "vtkUnstructuredGrid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

using mammoray::test::RefusalOf;
using namespace mammoray;

namespace
{
/// 20 mm x 10 mm x 10 mm; material 1 where x < 5 mm, 2 beyond.
vtkSmartPointer<vtkUnstructuredGrid> TwoMaterials()
{
  TetrahedralMesh mesh = test::MakeBoxMesh({ 0, 0, 0 }, { 20, 10, 10 }, { 8, 4, 4 });
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    double x = 0;
    for (int corner = 0; corner < 4; ++corner)
    {
      x += mesh.Point(static_cast<std::size_t>(mesh.Cells[4 * cell + corner]))[0] / 4;
    }
    mesh.Materials[cell] = x < 5 ? 1 : 2;
  }
  return ToGrid(mesh, { "air", "fat", "gland" });
}

/// Pixels that are orange or blue, the colours of materials 1 and 2, edges of cells included.
std::array<int, 2> CountColors(const std::string& path)
{
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  std::array<int, 2> counts{ 0, 0 };
  const int* size = image->GetDimensions();
  for (int y = 0; y < size[1]; ++y)
  {
    for (int x = 0; x < size[0]; ++x)
    {
      const auto* pixel = static_cast<unsigned char*>(image->GetScalarPointer(x, y, 0));
      counts[0] += pixel[0] > pixel[2] + 60 ? 1 : 0;
      counts[1] += pixel[2] > pixel[0] + 60 ? 1 : 0;
    }
  }
  return counts;
}
}

TEST(CutPicture, ShowsEachMaterialsShareOfThePlane)
{
  test::TemporaryFolder folder;
  const std::string path = folder.File("cut.png");
  WriteCutPicture({ { TwoMaterials(), { 0, 0, 5 }, { 1, 0, 0 }, { 0, 1, 0 }, "z", {} } },
    { "air", "fat", "gland" }, path);
  const std::array<int, 2> counts = CountColors(path);
  // 460 pixels are 20 mm; the legend's boxes are 14 x 14. 2 %: the border's pixels are mixed.
  EXPECT_NEAR(counts[0] - 196, 115 * 230, 0.02 * 115 * 230);
  EXPECT_NEAR(counts[1] - 196, 345 * 230, 0.02 * 345 * 230);
}

TEST(CutPicture, RefusesAPlaneBesideTheMesh)
{
  test::TemporaryFolder folder;
  const std::string path = folder.File("cut.png");
  EXPECT_THAT(RefusalOf(
                [&] {
                  WriteCutPicture(CutsThrough(TwoMaterials(), { 0, 0, 50 }), {}, path);
                }),
    testing::HasSubstr("z = 50.0 mm"));
  EXPECT_FALSE(std::filesystem::exists(path));
}
