// SPDX-License-Identifier: Apache-2.0
#include "Refusals.h"
#include "SurfaceMeasures.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ExampleData.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/ShippedData.h"

#include "vtkPolyData.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using mammoray::testing_support::RefusalOf;
using namespace mammoray;

TEST(ExampleData, BreastIsThePublishedSizeAndKeepsTheTissues)
{
  const ExampleScene scene = MakeExampleScene("breast");
  EXPECT_EQ(scene.Surface.NumberOfTriangles(), 5185458u);
  EXPECT_EQ(scene.Detector.Columns, 1080);
  EXPECT_EQ(scene.Detector.Rows, 1080);
  scene.Surface.Validate("breast");
  EXPECT_TRUE(testing_support::IsClosed(scene.Surface));

  const LabelVolume voxels = scene.Materials.ToMaterials(
    ReadLabelVolume(DataDirectory() + "/victre-phantom-1/labels.nrrd"), "labels");
  const auto counts = voxels.CountLabels();
  const auto volumes = testing_support::MaterialVolumes(scene.Surface);
  ASSERT_EQ(volumes.size(), 5u);
  for (int material = 1; material < 5; ++material)
  {
    // Smoothing rounds corners off within half a voxel of 0.4 mm. That moves volume between gland
    // and fat, whose structures are a few voxels wide; 3 % of either.
    const double expected = static_cast<double>(counts.at(material)) * voxels.VoxelVolume();
    EXPECT_NEAR(volumes[static_cast<std::size_t>(material)], expected, 0.03 * expected)
      << scene.Materials.Materials[static_cast<std::size_t>(material)].Name;
  }
}

TEST(ExampleData, UnknownNamesGetNearOnes)
{
  EXPECT_THAT(RefusalOf([&] { MakeExampleScene("boxs"); }),
    testing::HasSubstr("did you mean boxes?"));
}

TEST(SurfaceConversion, PolyDataRoundTrips)
{
  const SurfaceMesh mesh = MakeBoxesScene().Surface;
  std::vector<std::string> names;
  const SurfaceMesh back =
    FromPolyData(ToPolyData(mesh, { "air", "fat", "gland", "muscle" }), &names);
  EXPECT_EQ(back.Triangles, mesh.Triangles);
  EXPECT_EQ(back.FrontMaterials, mesh.FrontMaterials);
  EXPECT_EQ(back.BackMaterials, mesh.BackMaterials);
  EXPECT_THAT(names, testing::ElementsAre("air", "fat", "gland", "muscle"));
  ASSERT_EQ(back.Points.size(), mesh.Points.size());
  for (std::size_t index = 0; index < mesh.Points.size(); ++index)
  {
    ASSERT_EQ(back.Points[index], static_cast<double>(static_cast<float>(mesh.Points[index])));
  }
}
