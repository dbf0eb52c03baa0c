// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "Refusals.h"
#include "SurfaceShapes.h"
#include "mammoray/Meshing/MeshCheck.h"
#include "mammoray/Meshing/SurfaceMesher.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <numbers>
#include <random>

using mammoray::test::RefusalOf;
using namespace mammoray;
using namespace shapes;
using namespace mammoray::test;

namespace
{
MeshingOptions Coarse()
{
  MeshingOptions options;
  options.CellSizeMm = 4;
  options.CellRadiusEdgeRatio = 2;
  options.OptimisationSeconds = 0;
  return options;
}

double VolumeOf(const MeshCheck& check, int material)
{
  return VolumeIn(check.Materials, material, &MaterialQuality::VolumeMm3);
}

LabelVolume NestedBalls()
{
  return LabelledCube(40, 0.6,
    [](const Vector3& p) {
      return Norm(p - Vector3{ 2, 1, 0 }) < 5 ? 2 : Norm(p) < 10 ? 1 : 0;
    });
}
}

TEST(SurfaceMesher, NestedShellsGiveTheInnerMaterialItsSpace)
{
  // Three balls, one within the other.
  SurfaceMesh surfaces;
  AddSphere(surfaces, { 0, 0, 0 }, 10, 3, 1);
  AddSphere(surfaces, { 2, 0, 0 }, 6, 3, 2);
  AddSphere(surfaces, { 3, 0, 0 }, 3, 3, 3);
  std::map<int, double> enclosed;
  for (const MaterialQuality& entry : CheckSurface(surfaces).Materials)
  {
    enclosed[entry.Material] = entry.VolumeMm3;
  }
  const MeshingResult result = MeshSurfaces(surfaces, Coarse());
  const MeshCheck check = CheckMesh(result.Mesh);
  EXPECT_TRUE(check.Sound());
  // The polyhedra themselves, kept exactly: rounding of some thousand double sums.
  EXPECT_NEAR(VolumeOf(check, 3), enclosed[3], 1e-9 * enclosed[1]);
  EXPECT_NEAR(VolumeOf(check, 2), enclosed[2] - enclosed[3], 1e-9 * enclosed[1]);
  EXPECT_NEAR(VolumeOf(check, 1), enclosed[1] - enclosed[2], 1e-9 * enclosed[1]);
  EXPECT_EQ(result.Components, 3u);
  for (const MaterialReport& report : result.Reports)
  {
    EXPECT_NEAR(report.VolumeInMm3, report.VolumeOutMm3, 1e-9 * enclosed[1]);
    // TetGen keeps 2 where no angle of the surface is sharp; taking slivers away gives up a part.
    EXPECT_LT(report.LargestRadiusEdgeRatio, 2.6) << report.Material;
  }
}

TEST(SurfaceMesher, ShellWithACavityStaysEmptyInside)
{
  SurfaceMesh surfaces;
  AddSphere(surfaces, { 0, 0, 0 }, 10, 3, 1);
  AddSphere(surfaces, { 0, 0, 0 }, 5, 3, 0, 1); // material 1 lies outside of it
  const double shell = CheckSurface(surfaces).Materials[0].VolumeMm3;
  const MeshCheck check = CheckMesh(MeshSurfaces(surfaces, Coarse()).Mesh);
  EXPECT_TRUE(check.Sound());
  EXPECT_NEAR(VolumeOf(check, 1), shell, 1e-9 * shell);
  // Closed form; 3 %: spheres of 1280 facets.
  EXPECT_NEAR(shell, 4.0 / 3 * std::numbers::pi * 875, 0.03 * 3665);
}

TEST(SurfaceMesher, TouchingBodiesAreJoined)
{
  // Two boxes with a face in common, each a closed surface with points of its own, and a slab that
  // shares its interfaces.
  SurfaceMesh boxes;
  AddBox(boxes, { 0, 0, 0 }, { 2, 3, 4 }, 1);
  AddBox(boxes, { 2, 0, 0 }, { 5, 3, 4 }, 2);
  for (const auto& [surface, area] :
    { std::pair{ boxes, 12.0 }, std::pair{ Layers({ 0, 2, 5 }, 1.5), 9.0 } })
  {
    const MeshCheck check = CheckMesh(MeshSurfaces(surface, Coarse()).Mesh);
    EXPECT_TRUE(check.Sound());
    // Closed forms, to rounding.
    EXPECT_NEAR(VolumeOf(check, 1), 2 * area, 1e-10);
    EXPECT_NEAR(VolumeOf(check, 2), 3 * area, 1e-10);
  }
}

TEST(SurfaceMesher, CellSizesAreKept)
{
  SurfaceMesh box;
  AddBox(box, { 0, 0, 0 }, { 20, 20, 20 }, 1);
  MeshingOptions options = Coarse();
  options.CellSizeOfMaterialMm[1] = 2;
  const MeshingResult result = MeshSurfaces(box, options);
  // A regular tetrahedron of circumradius 2: 8 sqrt(3) / 27 R^3.
  const double bound = 8 * std::sqrt(3.0) / 27 * 8;
  for (std::size_t cell = 0; cell < result.Mesh.NumberOfCells(); ++cell)
  {
    // TetGen flips and moves cells a little after it has refined; 1.5 is less than a step of size.
    ASSERT_LE(result.Mesh.CellVolume(cell), 1.5 * bound);
  }
  EXPECT_GT(static_cast<double>(result.Mesh.NumberOfCells()), 8000 / bound);
}

TEST(SurfaceMesher, NeedlesInAPlaneAreTriangulatedAnew)
{
  // A bar of 30 x 1 x 1 mm with points at each mm of its long edges, top and bottom as fans from a
  // corner: angles down to 0.06 degrees.
  SurfaceMesh bar;
  const std::uint32_t length = 30;
  for (std::uint32_t row = 0; row < 4; ++row) // y, z: 0 0, 1 0, 1 1, 0 1
  {
    for (std::uint32_t x = 0; x <= length; ++x)
    {
      AddPoint(bar, { double(x), row == 1 || row == 2 ? 1.0 : 0.0, row >= 2 ? 1.0 : 0.0 });
    }
  }
  const auto at = [&](std::uint32_t row, std::uint32_t x) { return row % 4 * (length + 1) + x; };
  for (std::uint32_t row = 0; row < 4; ++row)
  {
    for (std::uint32_t x = 0; x < length; ++x)
    {
      if (row % 2 == 0) // a fan over y from the corner at x = 0 of the next row, then back
      {
        AddTriangle(bar, at(row, x), at(row + 1, 0), at(row, x + 1), 1, 0);
        AddTriangle(bar, at(row + 1, x), at(row + 1, x + 1), at(row, length), 1, 0);
      }
      else
      {
        AddTriangle(bar, at(row, x), at(row + 1, x), at(row + 1, x + 1), 1, 0);
        AddTriangle(bar, at(row, x), at(row + 1, x + 1), at(row, x + 1), 1, 0);
      }
    }
  }
  for (const auto& [x, back] : { std::pair{ 0u, 0u }, std::pair{ length, 2u } })
  {
    AddTriangle(bar, at(0, x), at(3 - back, x), at(2, x), 1, 0);
    AddTriangle(bar, at(0, x), at(2, x), at(1 + back, x), 1, 0);
  }
  const MeshCheck check = CheckMesh(MeshSurfaces(bar, Coarse()).Mesh);
  EXPECT_TRUE(check.Sound());
  EXPECT_NEAR(VolumeOf(check, 1), length, 1e-9);
  // Cubes of 1 mm, each in five or six tetrahedra, and what refinement adds.
  EXPECT_LT(check.Cells, 20u * length);
  EXPECT_GT(check.Materials[0].SmallestDihedralDeg, 10);
}

TEST(SurfaceMesher, RefusesOpenAndCuttingSurfaces)
{
  SurfaceMesh surfaces;
  AddBox(surfaces, { 0, 0, 0 }, { 2, 2, 2 }, 1);
  AddBox(surfaces, { 1, 0.5, 0.5 }, { 3, 1.5, 1.5 }, 2);
  testing::internal::CaptureStdout();
  EXPECT_THAT(RefusalOf([&] { MeshSurfaces(surfaces, Coarse()); }),
    test::Mentions("cut others", "("));
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  surfaces = {};
  AddSphere(surfaces, { 0, 0, 0 }, 5, 2, 1);
  surfaces.Triangles.resize(surfaces.Triangles.size() - 3);
  surfaces.FrontMaterials.pop_back();
  surfaces.BackMaterials.pop_back();
  EXPECT_THAT(RefusalOf([&] { MeshSurfaces(surfaces, Coarse()); }),
    test::Mentions("closed", "1 holes"));
  MeshingOptions options = Coarse();
  options.CellSizeMm = -1;
  EXPECT_THAT(RefusalOf([&] { MeshSurfaces(surfaces, options); }), testing::HasSubstr("cell size"));
  EXPECT_THROW(MeshSurfaces({}, Coarse()), InputError);
}

TEST(SurfaceMesher, StopsWhenAsked)
{
  SurfaceMesh box;
  AddBox(box, { 0, 0, 0 }, { 20, 20, 20 }, 1);
  MeshingOptions options = Coarse();
  options.CellSizeMm = 0.8;
  EXPECT_THROW(
    MeshSurfaces(box, options, [](double fraction, const char*) { return fraction <= 0.4; }),
    Interrupted);
}

TEST(SurfaceMesher, BothWaysFromLabelsAgree)
{
  const LabelVolume volume = NestedBalls();
  MeshingOptions options = Coarse();
  options.FacetDistanceMm = 0.1;
  options.FacetSizeMm = 2;
  const MeshingResult byCgal = MeshMaterials(volume, options);
  const MeshingResult byTetGen = MeshMaterialSurfaces(volume, options);
  EXPECT_TRUE(CheckMesh(byTetGen.Mesh).Sound());
  EXPECT_EQ(byTetGen.Components, 2u);
  ASSERT_EQ(byTetGen.Reports.size(), 2u);
  for (const MaterialReport& report : byTetGen.Reports)
  {
    // 2 %: what is asked of either way.
    EXPECT_NEAR(report.VolumeOutMm3, report.VolumeInMm3, 0.02 * report.VolumeInMm3);
  }
  const SurfaceMesh one = ExtractInterfaces(byCgal.Mesh);
  const SurfaceMesh other = ExtractInterfaces(byTetGen.Mesh);
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> coordinate(-8, 8);
  int compared = 0;
  double largest = 0;
  for (int ray = 0; ray < 60; ++ray)
  {
    const Vector3 from{ coordinate(generator), coordinate(generator), -40 };
    const Vector3 to{ coordinate(generator), coordinate(generator), 40 };
    const std::vector<double> a = ReferenceLengths(one, from, to);
    const std::vector<double> b = ReferenceLengths(other, from, to);
    // Grazing rays, along which a shift of a fraction of a voxel has no bound, are left out.
    const Vector3 along = (1 / Norm(to - from)) * (to - from);
    bool grazing = a.size() != 3 || b.size() != 3;
    for (const auto& [centre, radius] :
      { std::pair{ Vector3{ 2, 1, 0 }, 5.0 }, std::pair{ Vector3{ 0, 0, 0 }, 10.0 } })
    {
      grazing = grazing || std::abs(Norm(Cross(centre - from, along)) - radius) < 0.3 * radius;
    }
    if (!grazing)
    {
      ++compared;
      largest = std::max({ largest, std::abs(a[1] - b[1]), std::abs(a[2] - b[2]) });
    }
  }
  EXPECT_GT(compared, 15);
  // The voxel's size: each of two crossings of either mesh lies within half a voxel of the voxels'.
  EXPECT_LT(largest, 0.6);
}

TEST(SurfaceMesher, ThinLayersFromLabelsHaveNoSlivers)
{
  // A shell of one voxel around two tissues, as skin: all corners of its cells lie on interfaces.
  // Where points of the body's surface could not move, an angle of 0.45 degrees was left.
  const LabelVolume volume = LabelledCube(44, 0.5,
    [](const Vector3& p) {
      return Norm(p) > 9.5 ? 0 : Norm(p) > 9 ? 3 : Norm(p - Vector3{ 4, 2, 0 }) < 6 ? 2 : 1;
    });
  MeshingOptions options = MeshingOptions::Anatomy({ 3 });
  const MeshingResult result = MeshMaterialSurfaces(volume, options);
  EXPECT_TRUE(CheckMesh(result.Mesh).Sound());
  ASSERT_EQ(result.Reports.size(), 3u);
  for (const MaterialReport& report : result.Reports)
  {
    EXPECT_TRUE(report.KeepsVolume()) << report.Material;
    // The goal, to rounding.
    EXPECT_GT(report.SmallestDihedralDeg, options.SmallestDihedralDeg - 1e-6) << report.Material;
  }
}

TEST(SurfaceMesher, VoxelsThatTouchAtEdgesAndCorners)
{
  // A checkerboard, which touches itself everywhere; and a random volume, where smoothing could
  // cut.
  const LabelVolume board = LabelledCube(6, 1,
    [](const Vector3& p) {
      return (std::lround(p[0] + 10.5) + std::lround(p[1] + 10.5) + std::lround(p[2] + 10.5)) % 2;
    });
  MeshingOptions options = Coarse();
  options.SmallestComponentMm3 = 0;
  MeshingResult result = MeshMaterialSurfaces(board, options);
  EXPECT_TRUE(CheckMesh(result.Mesh).Sound());
  EXPECT_EQ(result.Components, 108u);
  std::mt19937 generator(3);
  LabelVolume noise = board;
  for (std::uint16_t& voxel : noise.Voxels)
  {
    voxel = static_cast<std::uint16_t>(generator() % 4);
  }
  result = MeshMaterialSurfaces(noise, options);
  EXPECT_TRUE(CheckMesh(result.Mesh).Sound());
}

TEST(SurfaceMesher, BothWaysKeepRandomVolumes)
{
  // Mosaics of three materials and air on anisotropic oblique grids.
  const unsigned seeds = std::getenv("MAMMORAY_LONG_TESTS") ? 300 : 24;
  for (unsigned seed = 1; seed <= seeds; ++seed)
  {
    SCOPED_TRACE("seed " + std::to_string(seed));
    LabelVolume volume = Mosaic(14, 1, 7, 12, 4, seed);
    volume.Spacing = { 1, 0.8, 1.3 };
    volume.Direction = { { { 0.6, 0.8, 0 }, { -0.8, 0.6, 0 },
      { 0, 0, seed % 2 == 0 ? 1.0 : -1.0 } } };
    MeshingOptions options = Coarse();
    options.FacetDistanceMm = 0.15;
    options.FacetSizeMm = 2;
    options.SmallestComponentMm3 = 3;
    for (const bool byTetGen : { false, true })
    {
      const MeshingResult result =
        byTetGen ? MeshMaterialSurfaces(volume, options) : MeshMaterials(volume, options);
      const MeshCheck check = CheckMesh(result.Mesh);
      EXPECT_TRUE(check.Sound());
      EXPECT_GE(check.Materials.size(), 1u);
      for (const MaterialReport& report : result.Reports)
      {
        // Facets may lie FacetDistanceMm off, over the surface of a cube of that volume; and what
        // was merged.
        const double surface = 6 * std::pow(report.VolumeInMm3, 2.0 / 3);
        EXPECT_NEAR(report.VolumeOutMm3, report.VolumeInMm3,
          options.FacetDistanceMm * surface +
            static_cast<double>(result.MergedVoxels) * volume.VoxelVolume())
          << report.Material << (byTetGen ? " by TetGen" : " by CGAL");
      }
    }
  }
}

TEST(SurfaceMesher, CheckerboardByCgal)
{
  // Nothing but cubes that touch at edges: as a body of one material with cavities of air.
  const LabelVolume board = LabelledCube(8, 1,
    [](const Vector3& p)
    {
      const long sum =
        std::lround(p[0] + 10.5) / 2 + std::lround(p[1] + 10.5) / 2 + std::lround(p[2] + 10.5) / 2;
      return sum % 2;
    });
  MeshingOptions options = Coarse();
  options.FacetDistanceMm = 0.1;
  options.FacetSizeMm = 1;
  options.SmallestComponentMm3 = 0;
  const MeshingResult result = MeshMaterials(board, options);
  EXPECT_TRUE(CheckMesh(result.Mesh).Sound());
}
