// SPDX-License-Identifier: Apache-2.0
#include "TestMeshes.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Registration/Private/MeshVoxels.h"

#include <gtest/gtest.h>

namespace
{
using namespace mammoray;

TEST(MeshVoxels, FillABoxExactly)
{
  // Faces between voxel centres, so that every centre is clearly in or out.
  TetrahedralMesh box = test::MakeBoxMesh({ 0.1, -3, 2 }, { 12.1, 5, 8 }, { 3, 2, 2 });
  for (std::size_t cell = 0; cell < box.NumberOfCells(); ++cell)
  {
    box.Materials[cell] = box.Point(box.Cells[4 * cell])[0] < 4 ? 2 : 1; // lowest corner of a brick
  }
  const LabelVolume volume = Voxelize(box, 0.5);
  volume.Validate("voxels");
  const auto counts = volume.CountLabels();
  // 12 x 8 x 6 mm in voxels of 1/8 mm^3, a third of it of material 2.
  EXPECT_EQ(counts.at(1) + counts.at(2), 24u * 16 * 12);
  EXPECT_EQ(volume.LabelAt({ 0.4, 0, 5 }), 2);
  EXPECT_EQ(volume.LabelAt({ 11.9, 0, 5 }), 1);
  EXPECT_EQ(volume.LabelAt({ 12.6, 0, 5 }), 0);
  EXPECT_EQ(volume.LabelAt({ 5, 5.4, 5 }), 0);
}

TEST(MeshVoxels, KeepTheVolumeOfACurvedBody)
{
  const TetrahedralMesh body = test::MakeHalfEllipsoidMesh(20, 25, 15, 8, false);
  double inMesh = 0;
  for (std::size_t cell = 0; cell < body.NumberOfCells(); ++cell)
  {
    inMesh += body.CellVolume(cell);
  }
  for (const double spacing : { 2.0, 1.0, 0.5 })
  {
    const LabelVolume volume = Voxelize(body, spacing);
    const double inVoxels = volume.CountLabels().at(1) * volume.VoxelVolume();
    // A layer at the surface of 3900 mm^2, which a fair grid takes on one side and leaves out on
    // the other but for a part of its thickness.
    EXPECT_NEAR(inVoxels, inMesh, 0.07 * spacing * 3900) << spacing;
  }
}

TEST(MeshVoxels, RefuseWhatCannotBeFilled)
{
  const TetrahedralMesh box = test::MakeBoxMesh({ 0, 0, 0 }, { 1, 1, 1 }, { 1, 1, 1 });
  EXPECT_THROW(Voxelize(box, 0), InputError);
  EXPECT_THROW(Voxelize(box, 1e-6), InputError);
  EXPECT_THROW(Voxelize({}, 1), InputError);
}
}
