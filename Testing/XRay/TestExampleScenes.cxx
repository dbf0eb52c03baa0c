// SPDX-License-Identifier: Apache-2.0
#include "SurfaceMeasures.h"
#include "mammoray/XRay/ExampleScenes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
using namespace mammoray;
using test::IsClosed;
using test::MaterialVolumes;
}

TEST(ExampleScenes, PlateIsThePublishedSizeAndSolid)
{
  const ExampleScene scene = MakePlateScene();
  EXPECT_EQ(scene.Surface.NumberOfTriangles(), 15626u);
  EXPECT_EQ(scene.Detector.Columns, 150);
  EXPECT_EQ(scene.Detector.Rows, 200);
  scene.Surface.Validate("test");
  EXPECT_TRUE(IsClosed(scene.Surface));
  EXPECT_NEAR(MaterialVolumes(scene.Surface)[1], 80 * 110 * 5, 1e-7); // rounding of 15,626 terms
}

TEST(ExampleScenes, BoxesAreThePublishedSizeAndSolid)
{
  const ExampleScene scene = MakeBoxesScene();
  EXPECT_EQ(scene.Surface.NumberOfTriangles(), 47580u);
  EXPECT_EQ(scene.Detector.Columns, 250);
  EXPECT_EQ(scene.Detector.Rows, 200);
  scene.Surface.Validate("boxes");
  EXPECT_TRUE(IsClosed(scene.Surface));
  const auto volumes = MaterialVolumes(scene.Surface);
  ASSERT_EQ(volumes.size(), scene.Materials.Materials.size());
  EXPECT_NEAR(volumes[1], 1322 * 60.0, 1e-7);
  EXPECT_NEAR(volumes[2], 1322 * 60.0, 1e-7);
  EXPECT_NEAR(volumes[3], 1321 * 60.0, 1e-7);
}

TEST(ExampleScenes, VeinsAreThePublishedSizeAndSolid)
{
  const ExampleScene scene = MakeVeinsScene();
  EXPECT_EQ(scene.Surface.NumberOfTriangles(), 215728u);
  EXPECT_EQ(scene.Detector.Columns, 1681);
  EXPECT_EQ(scene.Detector.Rows, 2071);
  scene.Surface.Validate("veins");
  EXPECT_TRUE(IsClosed(scene.Surface));
  // Octagons of radius r every 80 / 140 mm, a cone at each end: sheared prisms keep their volume.
  double expected = 0;
  for (int tube = 0; tube < 97; ++tube)
  {
    const double radius = 1 + 0.3 * std::sin(0.8 * tube);
    expected += 2 * std::sqrt(2.0) * radius * radius * 80.0 / 140 * (138 + 2.0 / 3);
  }
  EXPECT_NEAR(MaterialVolumes(scene.Surface)[1], expected, 1e-7);
}

TEST(ExampleScenes, MiddleRaysOfThePlateMatchClosedForm)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const ExampleScene scene = MakePlateScene();
  const auto projector = MakeProjector({ .Validation = true });
  projector->SetSurface(scene.Surface);
  const PathLengthImage image = projector->Project(scene.Source, scene.Detector);
  EXPECT_EQ(image.NumberOfInconsistentRays(), 0u);
  int checked = 0;
  for (int row = 0; row < image.Rows; ++row)
  {
    for (int column = 0; column < image.Columns; ++column)
    {
      const Vector3 pixel =
        scene.Detector.Origin + column * scene.Detector.ColumnStep + row * scene.Detector.RowStep;
      const bool crossesBothFaces = std::abs(pixel[0]) < 40 && std::abs(pixel[1]) < 55;
      const bool outside = std::abs(pixel[0]) > 42 || std::abs(pixel[1]) > 58;
      const double expected = crossesBothFaces ? 5 * Norm(pixel - scene.Source.Position) / 650 : 0;
      if (crossesBothFaces || outside)
      {
        // A float of 5 mm.
        ASSERT_NEAR(image.Material(1)[row * image.Columns + column], expected, 1e-6)
          << column << " " << row;
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 27500); // all but the rim, of 30,000
}
