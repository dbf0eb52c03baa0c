// SPDX-License-Identifier: Apache-2.0
#include "CommandTest.h"
#include "SurfaceShapes.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include "vtkPolyData.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

using namespace mammoray;
using test::ReadFile;

namespace
{
class ProjectScene : public test::CommandTest
{
protected:
  void SetUp() override
  {
    if (ListDevices().empty())
    {
      GTEST_SKIP() << "no Vulkan device";
    }
    // 100 wide and deep, 200 high; its unit is the scene's to say.
    std::filesystem::create_directory(this->Folder.File("parts"));
    SurfaceMesh box;
    shapes::AddBox(box, { -50, -50, -100 }, { 50, 50, 100 }, 1);
    WriteMesh(ToPolyData(box, {}), this->Folder.File("parts/box.stl"));
  }

  std::string Scene(const std::string& text)
  {
    return "project --scene " + this->Folder.Write("scene.json", text) + " --overwrite -o " +
      this->Folder.File("image.mha");
  }
};

constexpr const char* WholeScene = R"({
  "source": { "position": [0, -500, 3] },
  "detector": { "origin": [-15.5, 200, 5.5], "column-direction": [1, 0, 0],
    "row-direction": [0, 0, -2], "columns": 32, "rows": 12, "pixel-spacing": 1 },
  "beam": { "kev": 60, "filter": [ "Al:1" ] },
  "samples": [ { "file": "parts/box.stl", "material": "Ti90Al6V4@4.43" } ] })";
}

TEST_F(ProjectScene, IsWhatItsOptionsAre)
{
  const std::string options =
    "project --surface 'Ti90Al6V4@4.43=" + this->Folder.File("parts/box.stl") +
    "' --kev 60 --filter Al:1 --source 0 -500 3 --detector-origin -15.5 200 5.5 "
    "--column-direction 1 0 0 --row-direction 0 0 -1 --columns 32 --rows 12 --pixel-spacing 1 "
    "--overwrite -o " +
    this->Folder.File("options.mha");
  for (const std::string more : { "", " --photons 1000 --samples 2", " --turn 3 --axis y" })
  {
    ASSERT_EQ(this->Run(this->Scene(WholeScene) + more), 0) << this->Errors;
    const std::string said = this->Output;
    ASSERT_EQ(this->Run(options + more), 0) << this->Errors;
    EXPECT_EQ(said, this->Output);
    EXPECT_EQ(ReadFile(this->Folder.File("image.mha")), ReadFile(this->Folder.File("options.mha")))
      << more;
  }
}

TEST_F(ProjectScene, PlacesMicrometresByClosedForm)
{
  // A box of 0.1 x 0.1 x 0.2 mm, turned by 30 degrees about z, a box beside it, and a parallel beam
  // along y: through its middle 0.1 mm / cos 30.
  const std::string scene = R"({ "unit": "um",
    "source": { "beam-direction": [0, 1, 0] },
    "detector": { "origin": [-199, 20000, 1], "column-direction": [1, 0, 0],
      "row-direction": [0, 0, 1], "columns": 200, "rows": 1, "pixel-spacing": 2 },
    "beam": { "kev": 20 },
    "samples": [
      { "file": "parts/box.stl", "material": "Al", "unit": "um",
        "rotation": { "axis": [0, 0, 1], "angle": 30 }, "translation": [-100, 3000, 20] },
      { "file": "parts/box.stl", "material": "Ti", "unit": "um",
        "rotation": { "axis": [1, 0, 0], "angle": 90 }, "translation": [100, -40, 0] } ] })";
  const std::string lengths = this->Folder.File("lengths.mha");
  for (const std::string method : { "rasterisation", "ray-tracing" })
  {
    const int status =
      this->Run(this->Scene(scene) + " --path-lengths " + lengths + " --projector " + method);
    if (status != 0 && method == "ray-tracing")
    {
      break; // a device without
    }
    ASSERT_EQ(status, 0) << this->Errors;
    EXPECT_EQ(this->Errors, "");
    const std::vector<float> length = MhaValues(this->Folder.File("lengths.mha"));
    ASSERT_EQ(length.size(), 400u);
    const double cosine = std::cos(std::numbers::pi / 6);
    const double sine = 0.5;
    for (int column = 0; column < 200; ++column)
    {
      const double x = -199 + 2 * column;
      // Across the turned square: full between its inner corners, falling to 0 at the outer ones.
      const double beside = std::abs(x + 100);
      const double inner = 50 * (cosine - sine);
      const double outer = 50 * (cosine + sine);
      const double full = 100 / cosine;
      const double expected = beside <= inner ? full
        : beside >= outer                     ? 0
                                              : full * (outer - beside) / (outer - inner);
      const double other = std::abs(x - 100) < 50 ? 200 : 0;
      // um; single precision of the path, 1e-6 of it, and of where the ray is.
      EXPECT_NEAR(1000 * length[2 * column], expected, 2e-3) << method << " at " << x;
      EXPECT_NEAR(1000 * length[2 * column + 1], other, 2e-3) << method << " at " << x;
    }
  }
  // NIST's mu of titanium at 20 keV, 15.85 cm2/g at 4.506 g/cm3, over 0.2 mm.
  const std::vector<float> image = MhaValues(this->Folder.File("image.mha"));
  EXPECT_NEAR(-std::log(image[149]), 0.02 * 4.506 * 15.85, 0.02 * 1.43);
}

TEST_F(ProjectScene, OverlapPriorityAndMaterialsOfATable)
{
  this->Folder.Write("table.json", R"({"materials": [{"name": "air", "labels": [0]},
    {"name": "water", "labels": [1], "attenuation": "Water, Liquid"},
    {"name": "stone", "labels": [2], "attenuation": "CaC2O4", "density_g_per_cm3": 2.1}]})");
  const std::string scene = R"({ "source": { "beam-direction": [0, 1, 0] },
    "detector": { "origin": [0, 200, 0], "column-direction": [1, 0, 0], "row-direction": [0, 0, 1],
      "columns": 1, "rows": 1, "pixel-spacing": 1 },
    "beam": { "kev": 60 }, "materials": "table.json", "samples": [
      { "file": "parts/box.stl", "material": "water" },
      { "file": "parts/box.stl", "unit": "um", "material": "stone" } ],
    "overlap-priority": ["stone"] })";
  ASSERT_EQ(this->Run(this->Scene(scene) + " --path-lengths " + this->Folder.File("l.mha")), 0)
    << this->Errors;
  EXPECT_EQ(this->Errors, "");
  const std::vector<float> length = MhaValues(this->Folder.File("l.mha"));
  EXPECT_NEAR(length[0], 99.9, 1e-4);
  EXPECT_NEAR(length[1], 0.1, 1e-4);
  ASSERT_EQ(this->Run(this->Scene(scene) + " --set overlap-priority=water --path-lengths " +
              this->Folder.File("l.mha")),
    0)
    << this->Errors;
  EXPECT_NEAR(MhaValues(this->Folder.File("l.mha"))[0], 100, 1e-4);
}

TEST_F(ProjectScene, OptionsGoBeforeTheFile)
{
  const std::string changed = " --kev 40 --filter Al:2 --columns 16 --detector-origin -7 200 5.5";
  ASSERT_EQ(this->Run(this->Scene(WholeScene) + changed), 0) << this->Errors;
  const std::string image = ReadFile(this->Folder.File("image.mha"));
  std::string scene = WholeScene;
  for (const auto& [what, by] : { std::pair("60", "40"), { "Al:1", "Al:2" },
         { "\"columns\": 32", "\"columns\": 16" }, { "-15.5", "-7" } })
  {
    scene.replace(scene.find(what), std::string(what).size(), by);
  }
  ASSERT_EQ(this->Run(this->Scene(scene)), 0) << this->Errors;
  EXPECT_EQ(ReadFile(this->Folder.File("image.mha")), image);
  // A scene that is printed makes the same picture.
  ASSERT_EQ(this->Run(this->Scene(WholeScene) + changed + " --print-scene"), 0) << this->Errors;
  EXPECT_THAT(this->Output, testing::HasSubstr("Ti90Al6V4@4.43"));
  ASSERT_EQ(this->Run(this->Scene(this->Output)), 0) << this->Errors;
  EXPECT_EQ(ReadFile(this->Folder.File("image.mha")), image);
}

TEST_F(ProjectScene, RefusesContradictions)
{
  this->ExpectRefused(this->Scene(WholeScene) + " --beam-direction 0 1 0", "found both");
  this->ExpectRefused(this->Scene(WholeScene) + " --tube W", "found several");
  this->ExpectRefused(this->Scene(WholeScene) + " --mesh x.vtu", "x.vtu: no such");
  this->ExpectRefused(this->Scene(WholeScene) + " --surface Al=x.stl", "expected no samples in ");
  this->ExpectRefused(this->Scene(WholeScene) + " --set detector.colums=3",
    "--set detector.colums: no quantity 'detector.colums'; did you mean detector.columns");
  this->ExpectRefused(this->Scene(WholeScene) + " --set detector.columns=3.5",
    "--set detector.columns: expected a whole number from 1 to 65535, found 3.5");
  this->ExpectRefused(this->Scene("{}"), "or a --scene with samples, found neither");
  this->ExpectRefused(this->Scene(R"({"samples": [{"file": "none.stl", "material": "Al"}]})"),
    "none.stl: no such");
  this->ExpectRefused(this->Scene(R"({"samples": [{"file": "parts/box.stl", "material": "?"}]})"),
    "scene.json: samples[0]: ");
  EXPECT_FALSE(std::filesystem::exists(this->Folder.File("image.mha")));
  // A scene is an input that no output replaces.
  this->ExpectRefused("project --scene " + this->Folder.Write("scene.json", WholeScene) +
      " --overwrite --turn 2 -o " + this->Folder.File("scene.tif"),
    "scene.json: expected a file that is not an input");
  EXPECT_EQ(ReadFile(this->Folder.File("scene.json")), WholeScene);
  // Setups without samples serve many.
  const std::string whole = WholeScene;
  const std::string setup = whole.substr(0, whole.find(",\n  \"samples\"")).append(1, '}');
  EXPECT_EQ(this->Run(this->Scene(setup) + " --surface Al=" + this->Folder.File("parts/box.stl")),
    0)
    << this->Errors;
}
