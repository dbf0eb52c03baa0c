// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "Refusals.h"
#include "TestMeshes.h"
#include "mammoray/Foundation/Meshes.h"

#include <gtest/gtest.h>

namespace
{
using mammoray::test::RefusalOf;
using namespace mammoray;

TetrahedralMesh OneCell()
{
  TetrahedralMesh mesh;
  mesh.Points = { 1, 2, 3, 3, 2, 3, 1, 5, 3, 1, 2, 7 };
  mesh.Cells = { 0, 1, 2, 3 };
  mesh.Materials = { 1 };
  return mesh;
}

TEST(TetrahedralMesh, CornerOfABoxHasASixthOfIt)
{
  const TetrahedralMesh mesh = OneCell();
  EXPECT_DOUBLE_EQ(mesh.CellVolume(0), 2 * 3 * 4 / 6.0);
  EXPECT_EQ(mesh.CellCentre(0), (Vector3{ 1.5, 2.75, 4 }));
  EXPECT_EQ(mesh.Point(3), (Vector3{ 1, 2, 7 }));
}

TEST(TetrahedralMesh, CellsFillABox)
{
  const TetrahedralMesh box = test::MakeBoxMesh({ -1, 2, 3 }, { 4, 8, 10 }, { 3, 4, 5 });
  EXPECT_NO_THROW(box.Validate("box"));
  double volume = 0;
  for (std::size_t cell = 0; cell < box.NumberOfCells(); ++cell)
  {
    volume += box.CellVolume(cell);
  }
  EXPECT_NEAR(volume, 5 * 6 * 7, 1e-10); // rounding of 360 terms
}

TEST(TetrahedralMesh, ValidateNamesWhatIsWrong)
{
  TetrahedralMesh mesh = OneCell();
  std::swap(mesh.Cells[0], mesh.Cells[1]);
  EXPECT_NO_THROW(mesh.ValidateIndices("mesh"));
  EXPECT_THAT(RefusalOf([&] { mesh.Validate("breast.vtu"); }),
    test::Mentions("breast.vtu", "cell 0", "-4"));
  mesh.Cells[2] = 4;
  EXPECT_THAT(RefusalOf([&] { mesh.Validate("mesh"); }),
    test::Mentions("cell 0", "point 4", "0 to 3"));
  mesh = OneCell();
  mesh.Materials.clear();
  EXPECT_THAT(RefusalOf([&] { mesh.Validate("mesh"); }), test::Mentions("found 4 and 0"));
  EXPECT_THAT(RefusalOf([&] { TetrahedralMesh().Validate("mesh"); }),
    test::Mentions("mesh", "none"));
}
}
