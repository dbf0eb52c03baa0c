// SPDX-License-Identifier: Apache-2.0
// Path lengths along lists of rays.
#include "ProjectorTesting.h"
#include "mammoray/Foundation/Error.h"

#include <gmock/gmock.h>

#include <random>

namespace
{
using namespace mammoray;
using namespace mammoray::shapes;

class RayListTest : public ProjectorTest
{
};

TEST_P(RayListTest, RandomRaysMatchReference)
{
  // Ends anywhere in and around the body, so that many rays begin or end inside.
  const SurfaceMesh mesh = NestedBodies();
  std::mt19937 generator(41);
  std::uniform_real_distribution<double> place(-90, 90);
  std::vector<XRayLine> rays;
  for (int ray = 0; ray < 2000; ++ray)
  {
    rays.push_back({ { place(generator), place(generator), place(generator) },
      { place(generator), place(generator), place(generator) } });
  }
  this->Projector->SetSurface(mesh);
  const PathLengthImage image = this->Projector->ProjectRays(rays);
  EXPECT_EQ(image.Columns, 2000);
  EXPECT_EQ(image.Rows, 1);
  EXPECT_EQ(image.NumberOfInconsistentRays(), 0u);
  std::size_t compared = 0;
  for (std::size_t ray = 0; ray < rays.size(); ++ray)
  {
    const auto expected = ReferenceLengths(mesh, rays[ray].Begin, rays[ray].End);
    for (std::size_t material = 0; material < expected.size(); ++material)
    {
      // The tolerances are those of pixels; single: 1e-5 mm of rounding, magnified up to 200 times
      // by steep faces.
      ASSERT_NEAR(image.Material(static_cast<int>(material))[ray], expected[material],
        this->GetParam().Double ? 3e-5 : 2e-3)
        << "ray " << ray;
    }
    compared += expected.empty() ? 0 : 1;
  }
  EXPECT_GT(compared, rays.size() * 99 / 100);
}

TEST_P(RayListTest, RaysOfPixelsEqualTheImage)
{
  const XRaySource source = PointSource({ 20, 10, 500 });
  const XRayDetector detector =
    CentredDetector({ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 120, 90, 41, 33);
  const PathLengthImage image = this->Project(NestedBodies(), source, detector);
  std::vector<XRayLine> rays;
  for (int row = 0; row < detector.Rows; ++row)
  {
    for (int column = 0; column < detector.Columns; ++column)
    {
      rays.push_back({ source.Position, Pixel(detector, column, row) });
    }
  }
  const PathLengthImage list = this->Projector->ProjectRays(rays);
  EXPECT_THAT(list.Lengths,
    testing::Pointwise(testing::FloatNear(this->GetParam().Double ? 3e-5f : 2e-3f), image.Lengths));
  // Backwards they are as long.
  for (XRayLine& ray : rays)
  {
    std::swap(ray.Begin, ray.End);
  }
  EXPECT_THAT(this->Projector->ProjectRays(rays).Lengths,
    testing::Pointwise(testing::FloatNear(this->GetParam().Double ? 3e-5f : 2e-3f), list.Lengths));
}

TEST_P(RayListTest, MarksAHoleAndRefusesUnusableRays)
{
  SurfaceMesh mesh = Layers({ 0, 10 }, 20);
  mesh.Triangles.resize(mesh.Triangles.size() - 3); // half of the top
  mesh.FrontMaterials.pop_back();
  mesh.BackMaterials.pop_back();
  this->Projector->SetSurface(mesh);
  const PathLengthImage image = this->Projector->ProjectRays(std::vector<XRayLine>{
    { { 10, 5, 30 }, { 10, 5, -30 } }, { { -10, 5, 30 }, { -10, 5, -30 } } });
  EXPECT_THAT(image.Inconsistent, testing::ElementsAre(0, 1));
  EXPECT_NEAR(image.Material(1)[0], 10, 1e-5);
  EXPECT_EQ(image.Material(1)[1], 0.0f);
  EXPECT_THROW(this->Projector->ProjectRays(std::vector<XRayLine>{}), InputError);
  EXPECT_THROW(this->Projector->ProjectRays(std::vector<XRayLine>{ { { 1, 2, 3 }, { 1, 2, 3 } } }),
    InputError);
  EXPECT_THROW(
    this->Projector->ProjectRays(std::vector<XRayLine>{ { { 1, NAN, 3 }, { 1, 2, 4 } } }),
    InputError);
}

INSTANTIATE_TEST_SUITE_P(Methods, RayListTest,
  testing::Values(Variant{ Method::RayTracing, true }, Variant{ Method::RayTracing, false }),
  VariantName);

TEST(RayList, RasterisationRefuses)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const auto projector = MakeProjector({ .Projection = ProjectorOptions::Method::Rasterisation });
  projector->SetSurface(NestedBodies());
  EXPECT_THROW(projector->ProjectRays(std::vector<XRayLine>{ { { 0, 0, 1 }, { 0, 0, 2 } } }),
    InputError);
}
}
