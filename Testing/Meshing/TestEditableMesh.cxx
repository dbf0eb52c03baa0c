// SPDX-License-Identifier: Apache-2.0
#include "TestMeshes.h"
#include "mammoray/Meshing/Private/EditableMesh.h"

#include <gmock/gmock.h>

#include <cmath>

namespace
{
using namespace mammoray;

double VolumeOfMaterial(const TetrahedralMesh& mesh, int material)
{
  double volume = 0;
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    volume += mesh.Materials[cell] == material ? mesh.CellVolume(cell) : 0;
  }
  return volume;
}

/// A cube of 2 mm in 2^3 bricks, its inner point in the middle; the upper half is of material 2.
TetrahedralMesh TwoHalves()
{
  TetrahedralMesh mesh = test::MakeBoxMesh({ -1, -1, -1 }, { 1, 1, 1 }, { 2, 2, 2 });
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    mesh.Materials[cell] = mesh.CellCentre(cell)[2] > 0 ? 2 : 1;
  }
  return mesh;
}
constexpr std::int32_t Inner = 13; // of 3^3 points

TEST(EditableMesh, QualityIsTheSmallestSine)
{
  TetrahedralMesh mesh;
  mesh.Points = { 1, -1, -1, 1, 1, 1, -1, 1, -1, -1, -1, 1 };
  mesh.Cells = { 0, 1, 2, 3 };
  mesh.Materials = { 1 };
  const EditableMesh regular(mesh);
  // Closed form: the angles' cosine is 1/3.
  EXPECT_NEAR(regular.Quality({ 0, 1, 2, 3 }), std::sqrt(8.0 / 9), 1e-14);
  EXPECT_LT(regular.Quality({ 1, 0, 2, 3 }), 0);
  EXPECT_EQ(regular.Quality({ 0, 1, 2, 3 }, 0), 1); // air may have any shape
}

TEST(EditableMesh, SplittingAnEdgeKeepsSpaceAndMaterials)
{
  const TetrahedralMesh mesh = TwoHalves();
  EditableMesh editable(mesh);
  const std::size_t around = editable.Ring(0, Inner).size();
  ASSERT_GE(around, 3u);
  const std::int32_t middle = editable.SplitEdge(0, Inner, 0.25);
  EXPECT_EQ(editable.Point(middle), (Vector3{ -0.75, -0.75, -0.75 }));
  EXPECT_TRUE(editable.Ring(0, Inner).empty());
  EXPECT_EQ(editable.Star(middle).size(), 2 * around);
  const TetrahedralMesh split = editable.Finish();
  EXPECT_NO_THROW(split.Validate("split"));
  EXPECT_EQ(split.NumberOfCells(), mesh.NumberOfCells() + around);
  EXPECT_NEAR(VolumeOfMaterial(split, 1), 4, 1e-13);
  EXPECT_NEAR(VolumeOfMaterial(split, 2), 4, 1e-13);
}

TEST(EditableMesh, RemovedCellsComeBackAndAirIsLeftOut)
{
  const TetrahedralMesh mesh = TwoHalves();
  EditableMesh editable(mesh);
  const std::vector<std::int32_t> star = editable.Star(Inner);
  for (const std::int32_t cell : star)
  {
    editable.Remove(cell);
  }
  EXPECT_TRUE(editable.Star(Inner).empty());
  EXPECT_FALSE(editable.IsAlive(star.front()));
  for (const std::int32_t cell : star)
  {
    editable.Restore(cell);
  }
  EXPECT_THAT(editable.Star(Inner), testing::UnorderedElementsAreArray(star));
  EXPECT_EQ(editable.Finish().NumberOfCells(), mesh.NumberOfCells());
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    if (mesh.Materials[cell] == 2)
    {
      editable.SetMaterial(static_cast<std::int32_t>(cell), 0);
    }
  }
  const TetrahedralMesh half = editable.Finish();
  EXPECT_NO_THROW(half.Validate("half"));
  EXPECT_NEAR(VolumeOfMaterial(half, 1), 4, 1e-13);
  EXPECT_EQ(half.NumberOfPoints(), 18u); // 3 x 3 x 2
}

TEST(EditableMesh, MaterialsMeetAroundPointsOfTheirInterface)
{
  const EditableMesh editable(TwoHalves());
  EXPECT_TRUE(editable.IsSurrounded(Inner));
  const auto arcs = editable.Arcs(Inner);
  EXPECT_GE(arcs.size(), 3u); // a closed polygon around the point
  for (const EditableMesh::Arc& arc : arcs)
  {
    EXPECT_THAT(arc.Materials, testing::ElementsAre(1, 2));
    EXPECT_EQ(editable.Point(arc.A)[2], 0);
    EXPECT_EQ(editable.Point(arc.B)[2], 0);
  }
  EXPECT_FALSE(editable.IsSurrounded(0)); // a corner of the cube
  EXPECT_THAT(editable.Neighbours(Inner), testing::Not(testing::Contains(Inner)));
}
}
