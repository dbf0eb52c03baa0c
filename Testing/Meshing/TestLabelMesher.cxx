// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "Refusals.h"
#include "mammoray/Meshing/LabelMesher.h"
#include "mammoray/Meshing/MeshCheck.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <numbers>
#include <random>
#include <set>

using mammoray::test::RefusalOf;
using namespace mammoray;
using namespace mammoray::test;

namespace
{
LabelVolume SphereInSphere()
{
  return LabelledCube(44, 0.5,
    [](const Vector3& p)
    {
      const double r = Norm(p);
      return r < 5 ? 2 : r < 10 ? 1 : 0;
    });
}

MeshingOptions Fine()
{
  MeshingOptions options;
  options.CellSizeMm = 2.5;
  options.FacetSizeMm = 1.5;
  options.FacetDistanceMm = 0.06;
  options.SmallestComponentMm3 = 1.0;
  options.OptimisationSeconds = 0;
  return options;
}

double VolumeOf(const MeshingResult& result, int material)
{
  return VolumeIn(result.Reports, material, &MaterialReport::VolumeOutMm3);
}

void ExpectSoundMesh(const TetrahedralMesh& mesh)
{
  const MeshCheck check = CheckMesh(mesh);
  EXPECT_TRUE(check.Sound()) << check.Defects[0].Text({});
}
}

TEST(LabelMesher, SphereInSphereHasTheVolumesOfTheSpheres)
{
  const MeshingResult result = MeshMaterials(SphereInSphere(), Fine());
  ExpectSoundMesh(result.Mesh);
  const double inner = 4.0 / 3.0 * std::numbers::pi * 125;
  const double both = 4.0 / 3.0 * std::numbers::pi * 1000;
  // 2 %: facets sag by up to 0.06 mm below a sphere of 5 mm, by half of it in the mean: 3 x 0.03
  // / 5.
  EXPECT_NEAR(VolumeOf(result, 2), inner, 0.02 * inner);
  EXPECT_NEAR(VolumeOf(result, 1), both - inner, 0.02 * (both - inner));
  EXPECT_EQ(result.Components, 2u);
  EXPECT_EQ(result.MergedVoxels, 0u);
}

TEST(LabelMesher, SliversAreRemoved)
{
  MeshingOptions options;
  options.FacetDistanceMm = 0.3;
  options.SmallestDihedralDeg = 12;
  const MeshingResult result = MeshMaterials(SphereInSphere(), options);
  ExpectSoundMesh(result.Mesh);
  EXPECT_FALSE(result.TimeLimitReached);
  ASSERT_EQ(result.Reports.size(), 2u);
  for (const MaterialReport& report : result.Reports)
  {
    // The bound is reached on bodies as plain as this one; 10 leaves room for another CGAL.
    EXPECT_GT(report.SmallestDihedralDeg, 10) << report.Material;
    EXPECT_LT(report.LargestRadiusEdgeRatio, 4) << report.Material;
  }
}

TEST(LabelMesher, StairsAreSmoothedToTheSphere)
{
  const MeshingResult result = MeshMaterials(SphereInSphere(), Fine());
  // Points on the outer boundary: no point of the smoothed interface is half a voxel from the
  // sphere.
  double farthest = 0;
  for (std::size_t point = 0; point < result.Mesh.NumberOfPoints(); ++point)
  {
    farthest = std::max(farthest, Norm(result.Mesh.Point(point)));
  }
  EXPECT_NEAR(farthest, 10.0, 0.25);
}

TEST(LabelMesher, SameInputGivesTheSameMesh)
{
  const MeshingResult a = MeshMaterials(SphereInSphere(), MeshingOptions{});
  const MeshingResult b = MeshMaterials(SphereInSphere(), MeshingOptions{});
  EXPECT_EQ(a.Mesh.Points, b.Mesh.Points);
  EXPECT_EQ(a.Mesh.Cells, b.Mesh.Cells);
  EXPECT_EQ(a.Mesh.Materials, b.Mesh.Materials);
}

TEST(LabelMesher, IsolatedInclusionsSurviveACoarseMesh)
{
  // 27 balls of radius 1.3 mm in cells four times as large.
  const auto label = [](const Vector3& p)
  {
    Vector3 local;
    for (int a = 0; a < 3; ++a)
    {
      const double cell = std::round(p[a] / 8.0);
      local[a] = p[a] - 8.0 * std::clamp(cell, -1.0, 1.0);
    }
    return Norm(local) < 1.3 ? 2 : Norm(p) < 17 ? 1 : 0;
  };
  MeshingOptions options;
  options.CellSizeMm = 10;
  options.FacetSizeMm = 6;
  options.FacetDistanceMm = 0.5;
  options.SmallestComponentMm3 = 5;
  const LabelVolume volume = LabelledCube(72, 0.5, label);
  const MeshingResult result = MeshMaterials(volume, options);
  EXPECT_EQ(result.Components, 28u);
  ExpectSoundMesh(result.Mesh);
  std::set<std::array<int, 3>> found;
  for (std::size_t cell = 0; cell < result.Mesh.NumberOfCells(); ++cell)
  {
    if (result.Mesh.Materials[cell] == 2)
    {
      const Vector3 p = result.Mesh.Point(result.Mesh.Cells[4 * cell]);
      found.insert({ static_cast<int>(std::lround(p[0] / 8)),
        static_cast<int>(std::lround(p[1] / 8)), static_cast<int>(std::lround(p[2] / 8)) });
    }
  }
  EXPECT_EQ(found.size(), 27u);
}

TEST(LabelMesher, SmallComponentsGoToTheirSurroundings)
{
  LabelVolume volume = SphereInSphere();
  const int m = 22;
  volume.Voxels[volume.Index(m, m, m)] = 3;      // in material 2
  volume.Voxels[volume.Index(m + 15, m, m)] = 0; // a hole in material 1
  volume.Voxels[volume.Index(1, 1, 1)] = 1;      // a speck in air
  volume.Voxels[volume.Index(m, m + 15, m)] = 3; // one in material 1,
  volume.Voxels[volume.Index(m, m + 16, m)] = 2; // and one beside it
  const MeshingResult result = MeshMaterials(volume, Fine());
  EXPECT_EQ(result.MergedVoxels, 5u);
  EXPECT_EQ(result.Components, 2u);
  EXPECT_DOUBLE_EQ(VolumeOf(result, 3), 0);
  for (const std::int32_t material : result.Mesh.Materials)
  {
    EXPECT_TRUE(material == 1 || material == 2);
  }
}

TEST(LabelMesher, TissueAtTheBorderIsClosedThere)
{
  const LabelVolume volume =
    LabelledCube(20, 1.0, [](const Vector3& p) { return p[0] < 0 ? 1 : 2; });
  const MeshingResult result = MeshMaterials(volume, Fine());
  ExpectSoundMesh(result.Mesh);
  // The cube of 20 mm loses rounded edges: 12 edges of 20 mm, about (1 - pi/4) (0.5 mm)^2 each, and
  // sags.
  EXPECT_NEAR(VolumeOf(result, 1), 4000, 0.02 * 4000);
  EXPECT_NEAR(VolumeOf(result, 2), 4000, 0.02 * 4000);
}

TEST(LabelMesher, OneVoxel)
{
  LabelVolume volume;
  volume.Size = { 1, 1, 1 };
  volume.Spacing = { 2, 2, 2 };
  volume.Voxels = { 4 };
  MeshingOptions options = Fine();
  options.FacetSizeMm = 0.5;
  const MeshingResult result = MeshMaterials(volume, options);
  ExpectSoundMesh(result.Mesh);
  // Half-way to its neighbours' centres along the axes: at least that octahedron, 4/3 mm3, at most
  // the voxel.
  EXPECT_GT(VolumeOf(result, 4), 0.95 * 4.0 / 3.0);
  EXPECT_LT(VolumeOf(result, 4), 8);
}

TEST(LabelMesher, ObliqueAnisotropicAndLeftHandedGrids)
{
  const LabelVolume straight = SphereInSphere();
  LabelVolume volume = straight;
  volume.Spacing = { 0.5, 0.7, 0.9 };
  volume.Origin = { 30, -40, 50 };
  for (const double handedness : { 1.0, -1.0 })
  {
    volume.Direction = { { { 0.6, 0.8, 0 }, { -0.8, 0.6, 0 }, { 0, 0, handedness } } };
    const MeshingResult result = MeshMaterials(volume, Fine());
    ExpectSoundMesh(result.Mesh);
    // Ellipsoids: the spheres stretched by 1 x 1.4 x 1.8. 2 % as for the spheres.
    const double inner = 4.0 / 3.0 * std::numbers::pi * 125 * 1.4 * 1.8;
    EXPECT_NEAR(VolumeOf(result, 2), inner, 0.02 * inner);
    // Cells lie in the voxels of their material; 98 %: those at interfaces may not.
    std::size_t right = 0;
    for (std::size_t cell = 0; cell < result.Mesh.NumberOfCells(); ++cell)
    {
      Vector3 centre{ 0, 0, 0 };
      for (int c = 0; c < 4; ++c)
      {
        centre = centre + 0.25 * result.Mesh.Point(result.Mesh.Cells[4 * cell + c]);
      }
      right += volume.LabelAt(centre) == result.Mesh.Materials[cell];
    }
    EXPECT_GT(right, 0.98 * static_cast<double>(result.Mesh.NumberOfCells()));
  }
}

TEST(LabelMesher, FacetsAreNoLargerThanCells)
{
  MeshingOptions fine;
  fine.CellSizeMm = 3;
  fine.CellSizeOfMaterialMm[2] = 1;
  fine.FacetSizeMm = 3;
  fine.FacetSizeOfMaterialMm[2] = 1;
  fine.OptimisationSeconds = 0;
  MeshingOptions wide = fine;
  wide.FacetSizeMm = 8;
  wide.FacetSizeOfMaterialMm.clear();
  EXPECT_EQ(MeshMaterials(SphereInSphere(), wide).Mesh.Points,
    MeshMaterials(SphereInSphere(), fine).Mesh.Points);
}

TEST(LabelMesher, ThinLayerIsClosedAtCoarseSizes)
{
  // A skin of 1 mm around a ball, with facets of 4 mm.
  const LabelVolume volume = LabelledCube(64, 0.5,
    [](const Vector3& p)
    {
      const double r = Norm(p);
      return r < 13 ? 1 : r < 14 ? 2 : 0;
    });
  MeshingOptions options;
  options.FacetSizeMm = 4;
  options.CellSizeMm = 5;
  options.FacetDistanceMm = 0.5;
  options.LayerFacetSizeMm = 0.3;
  options.OptimisationSeconds = 0;
  const MeshingResult result = MeshMaterials(volume, options);
  ExpectSoundMesh(result.Mesh);
  std::map<std::array<std::int32_t, 3>, std::vector<int>> faces;
  for (std::size_t cell = 0; cell < result.Mesh.NumberOfCells(); ++cell)
  {
    for (int left = 0; left < 4; ++left)
    {
      std::array<std::int32_t, 3> key{};
      for (int c = 0, n = 0; c < 4; ++c)
      {
        if (c != left)
        {
          key[n++] = result.Mesh.Cells[4 * cell + c];
        }
      }
      std::sort(key.begin(), key.end());
      faces[key].push_back(result.Mesh.Materials[cell]);
    }
  }
  std::size_t outer = 0;
  std::size_t holes = 0;
  for (const auto& [key, materials] : faces)
  {
    outer += materials.size() == 1;
    holes += materials.size() == 1 && materials[0] == 1;
  }
  EXPECT_LT(static_cast<double>(holes), 0.01 * static_cast<double>(outer));
  const double layer = 4.0 / 3.0 * std::numbers::pi * (14.0 * 14 * 14 - 13.0 * 13 * 13);
  // 5 %: a layer as thin as two voxels.
  EXPECT_NEAR(VolumeOf(result, 2), layer, 0.05 * layer);
}

TEST(LabelMesher, RandomVolumesMakeSoundMeshes)
{
  for (unsigned seed = 1; seed <= 4; ++seed)
  {
    // Four materials and air, with kinks and triple lines.
    const LabelVolume volume = Mosaic(20, 0.8, 8, 25, 5, seed);
    MeshingOptions options = Fine();
    options.OptimisationSeconds = seed == 1 ? 60 : 0;
    options.SmallestDihedralDeg = 5;
    const MeshingResult result = MeshMaterials(volume, options);
    SCOPED_TRACE("seed " + std::to_string(seed));
    ExpectSoundMesh(result.Mesh);
    for (const MaterialReport& report : result.Reports)
    {
      // 5 %: pieces of some hundred voxels with sharp edges, which smoothing rounds.
      EXPECT_NEAR(report.VolumeOutMm3, report.VolumeInMm3, 0.05 * report.VolumeInMm3)
        << report.Material;
    }
  }
}

TEST(LabelMesher, AsManyTrianglesAsAskedFor)
{
  for (const std::size_t wanted : { 1500, 20000 })
  {
    MeshingOptions options;
    options.OptimisationSeconds = 0;
    options.Triangles = wanted;
    const MeshingResult result = MeshMaterials(SphereInSphere(), options);
    const MeshCheck check = CheckMesh(result.Mesh);
    EXPECT_TRUE(check.Sound());
    // What is promised.
    EXPECT_NEAR(static_cast<double>(check.Triangles), wanted, 0.1 * wanted);
    for (const MaterialReport& report : result.Reports)
    {
      EXPECT_TRUE(report.KeepsVolume()) << report.Material;
    }
  }
  MeshingOptions options;
  options.Triangles = 100'000'000;
  EXPECT_THAT(RefusalOf([&] { MeshMaterials(SphereInSphere(), options); }),
    test::Mentions("triangles", "voxel face"));
}

TEST(LabelMesher, ThinLayersKeepTheirVolume)
{
  // A skin one voxel thin around a ball of fat with a ball of gland.
  const LabelVolume volume = LabelledCube(48, 0.5,
    [](const Vector3& p)
    {
      const double r = Norm(p);
      return r < 5 ? 2 : r < 10 ? 1 : r < 10.5 ? 3 : 0;
    });
  MeshingOptions options = MeshingOptions::Anatomy({ 3 });
  const MeshingResult result = MeshMaterials(volume, options);
  ExpectSoundMesh(result.Mesh);
  ASSERT_EQ(result.Reports.size(), 3u);
  for (const MaterialReport& report : result.Reports)
  {
    // 2 %: what is asked of any material above 1 cm^3, here of smaller ones too.
    EXPECT_NEAR(report.VolumeOutMm3, report.VolumeInMm3, 0.02 * report.VolumeInMm3)
      << report.Material;
    EXPECT_GT(report.SmallestDihedralDeg, 8) << report.Material;
  }
}

TEST(LabelMesher, EdgesOfTheLabelWorldMeshOrAreRefused)
{
  MeshingOptions options = Fine();
  options.SmallestComponentMm3 = 0;
  // All one label, to the border on all sides.
  const MeshingResult full =
    MeshMaterials(LabelledCube(8, 1, [](const Vector3&) { return 1; }), options);
  ExpectSoundMesh(full.Mesh);
  // Rounded edges: 12 of 8 mm, and corners.
  EXPECT_NEAR(VolumeOf(full, 1), 512, 0.02 * 512);
  // A checkerboard of two materials without air.
  const MeshingResult board = MeshMaterials(
    LabelledCube(6, 1,
      [](const Vector3& p)
      {
        return 1 +
          (std::lround(p[0] + 10.5) + std::lround(p[1] + 10.5) + std::lround(p[2] + 10.5)) % 2;
      }),
    options);
  ExpectSoundMesh(board.Mesh);
  LabelVolume volume = SphereInSphere();
  volume.Spacing[1] = std::nan("");
  EXPECT_THROW(MeshMaterials(volume, options), InputError);
  volume.Spacing[1] = -0.5;
  EXPECT_THROW(MeshMaterials(volume, options), InputError);
  volume.Spacing[1] = 0.5;
  volume.Direction[2] = volume.Direction[1];
  EXPECT_THROW(MeshMaterials(volume, options), InputError);
  volume = {};
  EXPECT_THROW(MeshMaterials(volume, options), InputError);
}

TEST(LabelMesher, RefusesWhatCannotBeMeshed)
{
  LabelVolume volume = LabelledCube(6, 1.0, [](const Vector3&) { return 0; });
  EXPECT_THAT(RefusalOf([&] { MeshMaterials(volume, Fine()); }), testing::HasSubstr("found none"));
  volume.Voxels[volume.Index(3, 3, 3)] = 1;
  MeshingOptions options = Fine();
  options.SmallestComponentMm3 = 2;
  EXPECT_THAT(RefusalOf([&] { MeshMaterials(volume, options); }),
    test::Mentions("component", "2 mm3"));
  options = Fine();
  options.FacetAngleDeg = 40;
  EXPECT_THAT(RefusalOf([&] { MeshMaterials(volume, options); }),
    test::Mentions("facet angle", "0 to 30"));
  options = Fine();
  options.CellSizeMm = -1;
  EXPECT_THAT(RefusalOf([&] { MeshMaterials(volume, options); }), testing::HasSubstr("cell size"));
}

TEST(LabelMesher, ProgressRisesAndCanStopTheWork)
{
  double last = -1;
  MeshMaterials(SphereInSphere(), MeshingOptions{},
    [&](double fraction, const char*)
    {
      EXPECT_GE(fraction, last);
      last = fraction;
      return true;
    });
  EXPECT_EQ(last, 1.0);
  EXPECT_THROW(MeshMaterials(SphereInSphere(), Fine(),
                 [](double fraction, const char*) { return fraction <= 0.1; }),
    Interrupted);
}
