// SPDX-License-Identifier: Apache-2.0
#include "SurfaceShapes.h"
#include "mammoray/XRay/Exposure.h"
#include "mammoray/XRay/Scene.h"
#include "mammoray/XRay/Shadow.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using namespace mammoray;
using testing::HasSubstr;

namespace
{
/// 100 x 60 pixels of 1 mm in the plane z = 0, whose edges are those of 0 to 100 and 0 to 60 mm.
XRayDetector ShadowPlate()
{
  return { { 0.5, 0.5, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, 100, 60 };
}

XRaySource SourceAt(double x, double y, double z)
{
  XRaySource source;
  source.Position = { x, y, z };
  return source;
}

SurfaceMesh ShadowBox(const Vector3& low, const Vector3& high, int inside = 1)
{
  SurfaceMesh box;
  shapes::AddBox(box, low, high, inside);
  return box;
}

std::string ShadowReason(const SurfaceMesh& surface, const XRaySource& source)
{
  return MeasureShadow(surface, source, ShadowPlate()).Reason(ShadowPlate());
}
}

TEST(Shadow, OfAThinPlateIsItsMagnifiedArea)
{
  // Half way to the source: twice as wide. From 40 to 60 mm by 20 to 40 mm: all of it.
  const XRaySource source = SourceAt(50, 30, 200);
  const SurfaceMesh plate = ShadowBox({ 45, 25, 100 }, { 55, 35, 100.001 });
  const Shadow whole = MeasureShadow(plate, source, ShadowPlate());
  EXPECT_NEAR(whole.Share(), 1, 1e-9);
  EXPECT_NEAR(whole.Columns.Low, 40 - 0.5, 1e-3);
  EXPECT_NEAR(whole.Columns.High, 60 - 0.5, 1e-3);
  EXPECT_NEAR(whole.Rows.Length(), 20, 1e-3);
  // From -10 to 10 mm: half of it; its corner: a quarter.
  EXPECT_NEAR(
    MeasureShadow(ShadowBox({ 20, 25, 100 }, { 30, 35, 100.001 }), source, ShadowPlate()).Share(),
    0.5, 1e-4);
  EXPECT_NEAR(
    MeasureShadow(ShadowBox({ 20, 10, 100 }, { 30, 20, 100.001 }), source, ShadowPlate()).Share(),
    0.25, 1e-4);
  XRaySource parallel;
  parallel.Type = XRaySource::Kind::Parallel;
  parallel.Direction = { 0, 0, -3 };
  EXPECT_NEAR(
    MeasureShadow(ShadowBox({ 95, 10, 100 }, { 115, 20, 101 }), parallel, ShadowPlate()).Share(),
    0.25, 1e-9);
}

TEST(Shadow, ReasonsOfEmptyPicturesAreTold)
{
  const XRaySource source = SourceAt(50, 30, 200);
  EXPECT_THAT(ShadowReason(ShadowBox({ 45, 25, 100 }, { 55, 35, 110 }, 0), source),
    HasSubstr("all regions 0"));
  EXPECT_THAT(ShadowReason(ShadowBox({ 45, 25, 210 }, { 55, 35, 220 }), source),
    HasSubstr("behind the source"));
  EXPECT_THAT(ShadowReason(ShadowBox({ 45, 25, -20 }, { 55, 35, -10 }), source),
    HasSubstr("behind the detector"));
  EXPECT_THAT(ShadowReason(ShadowBox({ 300, 25, 10 }, { 310, 35, 20 }), source),
    testing::AllOf(HasSubstr("of 100 x 60 pixels"), testing::Not(HasSubstr("a file in"))));
  // 40 mm that are stated in metres, 4 m for 40 mm in micrometres.
  EXPECT_THAT(ShadowReason(ShadowBox({ 50.3, 30.3, 10 }, { 50.34, 30.34, 10.04 }), source),
    HasSubstr("0.04 mm wide: a file in metres?"));
  EXPECT_THAT(ShadowReason(ShadowBox({ -20000, -20000, 10 }, { 20000, 20000, 20 }), source),
    HasSubstr("40000 mm wide: a file in micrometres?"));
  EXPECT_EQ(ShadowReason(ShadowBox({ -20000, -20000, -20000 }, { 20000, 20000, 20000 }), source),
    "the source lies within the box around the object; 40000 mm wide: a file in micrometres?");
  EXPECT_EQ(ShadowReason(ShadowBox({ 60, -20000, -20000 }, { 20000, 20000, 20000 }), source),
    "the object lies in part behind the source; 40000 mm wide: a file in micrometres?");
}

TEST(Shadow, AWarningNeedsAnEmptyOrACutPicture)
{
  Scene scene;
  scene.Materials.Materials = { { .Name = "air" }, { .Name = "one" } };
  scene.Source = SourceAt(50, 30, 200);
  scene.Detector = ShadowPlate();
  const auto warning = [&](const SurfaceMesh& surface, float length, bool wantsAll)
  {
    scene.Samples = { { std::make_shared<const SurfaceMesh>(surface) } };
    auto lengths = std::make_shared<PathLengthImage>();
    lengths->Lengths = { 0, length };
    Exposure exposure;
    exposure.Lengths = lengths;
    return ShadowWarning(scene, exposure, wantsAll);
  };
  const SurfaceMesh cut = ShadowBox({ 20, 25, 100 }, { 30, 35, 100.001 });
  EXPECT_EQ(warning(cut, 1, false), "");
  EXPECT_THAT(warning(cut, 1, true), testing::StartsWith("50 % of the shadow falls on the"));
  EXPECT_EQ(warning(ShadowBox({ 45, 25, 100 }, { 55, 35, 110 }), 1, true), "");
  EXPECT_EQ(warning(ShadowBox({ 45, 25, -10 }, { 55, 35, 10 }), 1, true),
    "the object lies in part behind the detector's plane");
  EXPECT_EQ(warning(ShadowBox({ 45, 25, 190 }, { 55, 35, 210 }), 1, true),
    "the source lies within the box around the object");
  EXPECT_THAT(warning(ShadowBox({ 45, 25, 210 }, { 55, 35, 220 }), 0, false),
    testing::StartsWith("the picture is empty: the object lies behind the source"));
}

TEST(Shadow, ASurfaceThatEnclosesNothingIsTold)
{
  SurfaceMesh twoSided = ShadowBox({ 45, 25, 100 }, { 55, 35, 110 });
  const std::vector<std::uint32_t> there = twoSided.Triangles;
  for (std::size_t corner = 0; corner < there.size(); corner += 3)
  {
    shapes::AddTriangle(twoSided, there[corner + 1], there[corner], there[corner + 2], 1, 0);
  }
  Scene scene;
  scene.Materials.Materials = { { .Name = "air" }, { .Name = "one" } };
  scene.Source = SourceAt(50, 30, 200);
  scene.Detector = ShadowPlate();
  scene.Samples = { { std::make_shared<const SurfaceMesh>(twoSided) } };
  auto lengths = std::make_shared<PathLengthImage>();
  lengths->Lengths = { 0, 0 };
  Exposure exposure;
  exposure.Lengths = lengths;
  EXPECT_THAT(ShadowWarning(scene, exposure), HasSubstr("its triangles enclose nothing"));
}

TEST(Shadow, PartsOfWhichNothingIsSeenAreTold)
{
  Scene scene;
  scene.Materials.Materials = { { .Name = "air" }, { .Name = "water" }, { .Name = "Al" } };
  scene.Source = SourceAt(50, 30, 200);
  scene.Detector = ShadowPlate();
  const auto part = [](const Vector3& low, const Vector3& high, int material) {
    return SceneSample{ std::make_shared<const SurfaceMesh>(ShadowBox(low, high)), material };
  };
  const SceneSample water = part({ 45, 25, 10 }, { 55, 35, 20 }, 1);
  const auto warning = [&](const SceneSample& other, bool wantsAll)
  {
    scene.Samples = { water, other };
    auto lengths = std::make_shared<PathLengthImage>();
    lengths->Lengths = { 0, 1 };
    Exposure exposure;
    exposure.Lengths = lengths;
    return ShadowWarning(scene, exposure, wantsAll);
  };
  EXPECT_EQ(warning(part({ 25, 25, 10 }, { 35, 35, 20 }, 2), true), "");
  EXPECT_EQ(warning(part({ 45, 25, 210 }, { 55, 35, 220 }, 2), false),
    "nothing is seen of part 2 (Al): the part lies behind the source");
  EXPECT_EQ(warning(part({ 45, 25, -20 }, { 55, 35, -10 }, 2), true),
    "nothing is seen of part 2 (Al): the part lies behind the detector");
  EXPECT_THAT(warning(part({ 300, 25, 10 }, { 310, 35, 20 }, 2), false),
    HasSubstr("nothing is seen of part 2 (Al): the part's shadow reaches from column 3"));
  // Moved out of the picture; the mesh itself lies in it.
  SceneSample moved = part({ 25, 25, 10 }, { 35, 35, 20 }, 2);
  moved.TranslationMm = { 0, 0, 300 };
  EXPECT_THAT(warning(moved, false), HasSubstr("behind the source"));
  EXPECT_THAT(warning(part({ 50.3, 30.3, 10 }, { 50.34, 30.34, 10.04 }, 2), true),
    testing::AllOf(testing::StartsWith("part 2 (Al)'s shadow reaches"),
      HasSubstr("0.04 mm wide: a file in metres?")));
  // One row sees a slice.
  scene.Detector.Rows = 1;
  EXPECT_EQ(warning(part({ 25, 40, 10 }, { 35, 45, 20 }, 2), true), "");
}

TEST(Shadow, PlanesThroughAPartAreTold)
{
  const SurfaceMesh box = ShadowBox({ 45, 25, -10 }, { 55, 35, 10 });
  EXPECT_EQ(ShadowReason(box, SourceAt(50, 30, 200)),
    "the object lies in part behind the detector's plane");
  EXPECT_EQ(ShadowReason(box, SourceAt(50, 30, 5)),
    "the source lies within the box around the object");
  EXPECT_EQ(ShadowReason(box, SourceAt(70, 30, 5)), "the object lies in part behind the source");
  // On the detector, not behind it.
  const Shadow on =
    MeasureShadow(ShadowBox({ 45, 25, 0 }, { 55, 35, 10 }), SourceAt(50, 30, 200), ShadowPlate());
  EXPECT_FALSE(on.IsBehindDetector);
  EXPECT_NEAR(on.Share(), 1, 1e-9);
}
