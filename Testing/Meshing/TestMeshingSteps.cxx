// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "Refusals.h"
#include "TestMeshes.h"
#include "mammoray/Meshing/Private/MeshingSteps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace
{
using namespace mammoray;
using test::NotRefused;
using test::RefusalOf;
using testing::HasSubstr;

/// An oblique volume of noise with air at its borders.
LabelVolume ObliqueNoise()
{
  std::mt19937 generator(8);
  LabelVolume volume = test::LabelledCube(9, 1,
    [&](const Vector3& p)
    {
      return std::max({ std::abs(p[0]), std::abs(p[1]), std::abs(p[2]) }) > 2.5 ? 0
                                                                                : generator() % 4;
    });
  volume.Spacing = { 0.5, 1.1, 2 };
  volume.Direction = { { { 0.6, 0.8, 0 }, { 0, 0, 1 }, { 0.8, -0.6, 0 } } };
  volume.Origin = { 10, 20, 30 };
  return volume;
}

/// A box of tetrahedra over voxels (first to last, both with them) in the grid frame.
TetrahedralMesh BoxOver(const Vector3& spacing, const std::array<int, 3>& first,
  const std::array<int, 3>& last, int material)
{
  Vector3 low;
  Vector3 high;
  for (int axis = 0; axis < 3; ++axis)
  {
    low[axis] = (first[axis] - 0.5) * spacing[axis];
    high[axis] = (last[axis] + 0.5) * spacing[axis];
  }
  TetrahedralMesh mesh = test::MakeBoxMesh(low, high, { 2, 2, 2 });
  std::fill(mesh.Materials.begin(), mesh.Materials.end(), material);
  return mesh;
}

TEST(PrepareVolume, KeepsEveryVoxelInItsPlaceWithinItsMargin)
{
  const LabelVolume volume = ObliqueNoise();
  for (const int margin : { 0, 1, 5 })
  {
    const LabelVolume prepared = PrepareVolume(volume, margin);
    ASSERT_NO_THROW(prepared.Validate("prepared"));
    std::size_t tissue = 0;
    for (int k = 0; k < prepared.Size[2]; ++k)
    {
      for (int j = 0; j < prepared.Size[1]; ++j)
      {
        for (int i = 0; i < prepared.Size[0]; ++i)
        {
          const std::uint16_t label = prepared.Voxels[prepared.Index(i, j, k)];
          ASSERT_EQ(label, volume.LabelAt(prepared.PointAt(i, j, k)));
          const bool inMargin = std::min({ i, j, k }) < margin || i >= prepared.Size[0] - margin ||
            j >= prepared.Size[1] - margin || k >= prepared.Size[2] - margin;
          ASSERT_TRUE(label == 0 || !inMargin);
          tissue += label != 0;
        }
      }
    }
    EXPECT_EQ(tissue, volume.NumberOfVoxels() - volume.CountLabels()[0]);
    EXPECT_EQ(prepared.Size[0], 5 + 2 * margin); // -2 to 2
  }
  EXPECT_NE(
    RefusalOf([] { PrepareVolume(test::LabelledCube(3, 1, [](const Vector3&) { return 0; }), 1); }),
    NotRefused);
}

TEST(MergeTissue, RefusesToLoseAllOfIt)
{
  LabelVolume crumbs =
    test::LabelledCube(9, 1, [](const Vector3& p) { return Norm(p) < 1.2 ? 4 : 0; });
  EXPECT_THAT(RefusalOf([&] { MergeTissue(crumbs, 50); }), test::Mentions("component", "50 mm3"));
  LabelVolume whole =
    test::LabelledCube(9, 1, [](const Vector3& p) { return Norm(p) < 1.2 ? 4 : 0; });
  EXPECT_EQ(MergeTissue(whole, 7), 0u); // seven voxels
}

TEST(CheckComponents, NamesTheOneThatIsNotInTheMesh)
{
  LabelVolume volume;
  volume.Size = { 12, 4, 4 };
  volume.Spacing = { 1, 2, 1 };
  volume.Origin = { 100, 0, 0 };
  for (int voxel = 0; voxel < 12 * 4 * 4; ++voxel)
  {
    const int i = voxel % 12;
    volume.Voxels.push_back(i < 4 ? 1 : i < 8 ? 0 : 2);
  }
  LabelComponents found = FindComponents(volume);
  found.Components[2].Deepest = { 10, 1, 2 };
  found.Components[2].DepthMm = 1.5;
  const TetrahedralMesh one = BoxOver(volume.Spacing, { 0, 0, 0 }, { 3, 3, 3 }, 1);
  TetrahedralMesh both = BoxOver(volume.Spacing, { 8, 0, 0 }, { 11, 3, 3 }, 2);
  const std::string message = RefusalOf([&] { CheckComponents(one, volume, found); });
  EXPECT_THAT(message, test::Mentions("material 2", "(110.0, 2.0, 2.0) mm"));
  EXPECT_THAT(message, HasSubstr("of 128 mm3")); // 4 x 4 x 4 voxels of 2 mm3
  EXPECT_THAT(message, HasSubstr("thickness of about 3 mm"));
  // Cells of another material do not count, wherever they are.
  const TetrahedralMesh wrong = BoxOver(volume.Spacing, { 0, 0, 0 }, { 11, 3, 3 }, 1);
  EXPECT_THAT(RefusalOf([&] { CheckComponents(wrong, volume, found); }), HasSubstr("material 2"));
  const auto points = static_cast<std::int32_t>(both.NumberOfPoints());
  both.Points.insert(both.Points.end(), one.Points.begin(), one.Points.end());
  both.Materials.insert(both.Materials.end(), one.Materials.begin(), one.Materials.end());
  for (const std::int32_t id : one.Cells)
  {
    both.Cells.push_back(id + points);
  }
  EXPECT_EQ(RefusalOf([&] { CheckComponents(both, volume, found); }), NotRefused);
}

TEST(CheckClosed, RefusesSurfacesWithHoles)
{
  const TetrahedralMesh box = test::MakeBoxMesh({ 0, 0, 0 }, { 1, 1, 1 }, { 1, 1, 1 });
  SurfaceMesh surface = ExtractInterfaces(box);
  EXPECT_EQ(RefusalOf([&] { CheckClosed(surface); }), NotRefused);
  surface.Triangles.resize(surface.Triangles.size() - 3);
  surface.FrontMaterials.pop_back();
  surface.BackMaterials.pop_back();
  EXPECT_THAT(RefusalOf([&] { CheckClosed(surface); }), HasSubstr("expected closed ones"));
}

TEST(LargestShift, IsHalfAVoxelOrHalfTheFinestDistance)
{
  LabelVolume volume;
  volume.Spacing = { 0.8, 0.5, 3 };
  MeshingOptions options;
  options.FacetDistanceMm = 0.4;
  EXPECT_DOUBLE_EQ(LargestShift(volume, options), 0.25);
  options.FacetDistanceMm = 1.2;
  EXPECT_DOUBLE_EQ(LargestShift(volume, options), 0.6);
  options.FacetDistanceOfMaterialMm = { { 1, 0.7 }, { 2, 5 } };
  EXPECT_DOUBLE_EQ(LargestShift(volume, options), 0.35);
}

TEST(FinishMesh, GivesEveryMaterialItsVolume)
{
  // 8 x 8 x 8 voxels of 1 mm, 300 and 212 of two materials; the mesh halves the box.
  LabelVolume volume;
  volume.Size = { 8, 8, 8 };
  for (int voxel = 0; voxel < 512; ++voxel)
  {
    volume.Voxels.push_back(voxel < 272 ? 1 : 2);
  }
  TetrahedralMesh mesh = test::MakeBoxMesh({ 0, 0, 0 }, { 8, 8, 8 }, { 8, 8, 8 });
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    mesh.Materials[cell] = mesh.CellCentre(cell)[2] < 4 ? 1 : 2;
  }
  MeshingOptions options;
  FinishMesh(volume, options, mesh, {});
  ASSERT_NO_THROW(mesh.Validate("finished"));
  const std::vector<MaterialReport> reports = ReportMaterials(volume, mesh);
  ASSERT_EQ(reports.size(), 2u);
  for (const MaterialReport& report : reports)
  {
    // A thousandth (VolumeFit).
    EXPECT_NEAR(report.VolumeOutMm3 / report.VolumeInMm3, 1, 1e-3) << report.Material;
    EXPECT_GE(report.SmallestDihedralDeg, options.SmallestDihedralDeg) << report.Material;
  }
}

TEST(PlaceInVolumeFrame, KeepsCellsUprightInEveryFrame)
{
  LabelVolume volume = ObliqueNoise();
  for (const bool mirrored : { false, true })
  {
    if (mirrored)
    {
      volume.Direction[2] = -1.0 * volume.Direction[2];
    }
    TetrahedralMesh mesh = BoxOver(volume.Spacing, { 2, 3, 1 }, { 6, 5, 7 }, 3);
    const TetrahedralMesh grid = mesh;
    PlaceInVolumeFrame(volume, mesh);
    ASSERT_NO_THROW(mesh.Validate("placed"));
    double sum = 0;
    for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
    {
      sum += mesh.CellVolume(cell);
    }
    EXPECT_NEAR(sum, 5 * 3 * 7 * volume.VoxelVolume(), 1e-9);
    for (std::size_t point = 0; point < mesh.NumberOfPoints(); ++point)
    {
      const Vector3 index = volume.ContinuousIndex(mesh.Point(point));
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        EXPECT_NEAR(index[axis] * volume.Spacing[axis], grid.Point(point)[axis], 1e-9);
      }
    }
  }
}

TEST(MeshQuality, RegularTetrahedron)
{
  TetrahedralMesh mesh;
  mesh.Points = { 1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1 };
  mesh.Cells = { 0, 1, 2, 3 };
  mesh.Materials = { 1 };
  // Closed forms: arccos(1/3) and sqrt(6)/4; a dozen double operations.
  EXPECT_NEAR(SmallestDihedralDeg(mesh, 0), std::acos(1.0 / 3.0) * 180 / std::numbers::pi, 1e-12);
  EXPECT_NEAR(RadiusEdgeRatio(mesh, 0), std::sqrt(6.0) / 4.0, 1e-12);
}

TEST(MeshQuality, CornerAndSliver)
{
  TetrahedralMesh mesh;
  mesh.Points = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0, 0.5, 0.5, 1e-3 };
  mesh.Cells = { 0, 1, 2, 3, 0, 1, 4, 5 };
  mesh.Materials = { 1, 1 };
  // A cube's corner: the slanted face meets the others at arccos(1/sqrt(3)), its sphere is the
  // cube's.
  EXPECT_NEAR(SmallestDihedralDeg(mesh, 0), std::acos(1 / std::sqrt(3.0)) * 180 / std::numbers::pi,
    1e-12);
  EXPECT_NEAR(RadiusEdgeRatio(mesh, 0), std::sqrt(3.0) / 2.0, 1e-12);
  EXPECT_LT(SmallestDihedralDeg(mesh, 1), 0.2);
}

TEST(ReportMaterials, CountVoxelsAndCells)
{
  LabelVolume volume;
  volume.Size = { 4, 1, 1 };
  volume.Spacing = { 1, 2, 3 };
  volume.Voxels = { 0, 5, 5, 7 };
  TetrahedralMesh mesh;
  // The corner of a cube: angles of 54.7 and 90 degrees, radius sqrt(3)/2 over an edge of 1.
  mesh.Points = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  mesh.Cells = { 0, 1, 2, 3 };
  mesh.Materials = { 7 };
  const std::vector<MaterialReport> reports = ReportMaterials(volume, mesh);
  ASSERT_EQ(reports.size(), 2u);
  EXPECT_EQ(reports[0].Material, 5);
  EXPECT_DOUBLE_EQ(reports[0].VolumeInMm3, 12);
  EXPECT_EQ(reports[0].Cells, 0u);
  EXPECT_EQ(reports[0].SmallestDihedralDeg, 0);
  EXPECT_EQ(reports[1].Material, 7);
  EXPECT_DOUBLE_EQ(reports[1].VolumeInMm3, 6);
  EXPECT_DOUBLE_EQ(reports[1].VolumeOutMm3, 1.0 / 6);
  EXPECT_NEAR(reports[1].SmallestDihedralDeg,
    std::acos(1 / std::sqrt(3.0)) * 180 / 3.14159265358979, 1e-9);
  EXPECT_NEAR(reports[1].LargestRadiusEdgeRatio, std::sqrt(3.0) / 2, 1e-12);
}

TEST(FormattedText, NeverOverflows)
{
  EXPECT_EQ(FormattedText("%.1f of %g", 0.25, 3), "0.2 of 3");
  const std::string format = "%g" + std::string(200, ' '); // not seen by the compiler
  EXPECT_EQ(FormattedText(format.c_str(), 1).size(), 159u);
}
}
