// SPDX-License-Identifier: Apache-2.0
#include "TestMeshes.h"
#include "mammoray/Meshing/Private/EditableMesh.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
using namespace mammoray;

/// A box of 4 x 4 x 4 mm; what lies above z = 2 is of material 2.
EditableMesh Layers()
{
  TetrahedralMesh mesh = test::MakeBoxMesh({ 0, 0, 0 }, { 4, 4, 4 }, { 4, 4, 4 });
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    mesh.Materials[cell] = mesh.CellCentre(cell)[2] > 2 ? 2 : 1;
  }
  return EditableMesh(mesh);
}

double FittedVolume(const EditableMesh& mesh, int material)
{
  double volume = 0;
  for (std::size_t n = 0; n < mesh.NumberOfCells(); ++n)
  {
    const auto cell = static_cast<std::int32_t>(n);
    volume +=
      mesh.IsAlive(cell) && mesh[cell].Material == material ? mesh.Volume(mesh[cell].Ids) : 0;
  }
  return volume;
}

double LargestMove(const EditableMesh& mesh, const EditableMesh& before)
{
  double largest = 0;
  for (std::size_t point = 0; point < mesh.Points.size(); ++point)
  {
    largest = std::max(largest, Norm(mesh.Points[point] - before.Points[point]));
  }
  return largest;
}

TEST(VolumeFit, ReachesTheVolumesOfTwoMaterials)
{
  // 32 mm3 each: one grows by 5 %, the other shrinks by 3 %.
  const EditableMesh before = Layers();
  EditableMesh mesh = before;
  FitVolumes(mesh, { { 1, 33.6 }, { 2, 31.04 } }, 0.5, 5, {});
  // The stated end: a thousandth.
  EXPECT_NEAR(FittedVolume(mesh, 1), 33.6, 1e-3 * 33.6);
  EXPECT_NEAR(FittedVolume(mesh, 2), 31.04, 1e-3 * 31.04);
  EXPECT_LE(LargestMove(mesh, before), 0.5 + 1e-12);
  // Points within a material stay where they are: of 5^3 the 3^3 inner ones but 3^2 in the middle.
  std::size_t unmoved = 0;
  for (std::size_t point = 0; point < mesh.Points.size(); ++point)
  {
    unmoved += mesh.Points[point] == before.Points[point] ? 1 : 0;
  }
  EXPECT_EQ(unmoved, 18u);
  EXPECT_NO_THROW(mesh.Finish().Validate("fitted"));
}

TEST(VolumeFit, MetVolumesMoveNothing)
{
  const EditableMesh before = Layers();
  EditableMesh mesh = before;
  // A thousandth of 32 mm3 is near enough.
  FitVolumes(mesh, { { 1, 32.03 }, { 2, 31.97 } }, 0.5, 5, {});
  EXPECT_EQ(LargestMove(mesh, before), 0);
}

TEST(VolumeFit, NoPointGoesBeyondTheLimit)
{
  const EditableMesh before = Layers();
  EditableMesh mesh = before;
  FitVolumes(mesh, { { 1, 40 }, { 2, 40 } }, 0.05, 5, {});
  EXPECT_LE(LargestMove(mesh, before), 0.05 + 1e-12);
  EXPECT_GT(FittedVolume(mesh, 1), 32);
  // A shell of 0.05 mm on 96 mm2 is 4.8 mm3 of the 16 that are wanted.
  EXPECT_LT(FittedVolume(mesh, 1) + FittedVolume(mesh, 2), 64 + 5.2);
}

TEST(VolumeFit, CellsStayUpright)
{
  // Much more than there is room for: material 1 wants almost nothing.
  const EditableMesh before = Layers();
  EditableMesh mesh = before;
  FitVolumes(mesh, { { 1, 1 }, { 2, 63 } }, 10, 5, {});
  EXPECT_LT(FittedVolume(mesh, 1), 32);
  EXPECT_NO_THROW(mesh.Finish().Validate("squeezed"));
  double worst = 1;
  for (std::size_t n = 0; n < mesh.NumberOfCells(); ++n)
  {
    worst = std::min(worst, mesh.Quality(mesh[static_cast<std::int32_t>(n)].Ids));
  }
  EXPECT_GE(worst, std::sin(5 * 3.14159 / 180) - 1e-6); // before, 45 degrees
}

TEST(VolumeFit, AirTakesTheRest)
{
  // Material 2 as air around nothing: only the volume of 1 is asked for.
  EditableMesh mesh = Layers();
  for (std::size_t n = 0; n < mesh.NumberOfCells(); ++n)
  {
    const auto cell = static_cast<std::int32_t>(n);
    mesh.SetMaterial(cell, mesh[cell].Material == 2 ? 0 : 1);
  }
  FitVolumes(mesh, { { 1, 33 } }, 0.5, 5, {});
  EXPECT_NEAR(FittedVolume(mesh, 1), 33, 0.033);
}

TEST(VolumeFit, MaterialsThatAreNotThereChangeNothing)
{
  EditableMesh mesh = Layers();
  FitVolumes(mesh, { { 1, 33 }, { 2, 33 }, { 9, 5 } }, 0.5, 5, {});
  EXPECT_NEAR(FittedVolume(mesh, 1), 33, 0.033);
  EXPECT_NEAR(FittedVolume(mesh, 2), 33, 0.033);
}
}
