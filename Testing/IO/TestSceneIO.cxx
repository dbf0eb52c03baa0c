// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/SceneIO.h"

#include "Files.h"
#include "GlbBytes.h"
#include "Refusals.h"
#include "SurfaceShapes.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"

#include "vtkPolyData.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

namespace
{
using namespace mammoray;
using test::RefusalOf;
using test::TemporaryFolder;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;

/// A scene of one sample with some of its text replaced.
std::string SceneText(const std::string& what = "", const std::string& by = "")
{
  std::string text = R"({ "description": "a rod", "unit": "um",
    "source": { "position": [0, -500000, 3], "focal-spot": [50, 25] },
    "detector": { "origin": [-16, 200, 6], "column-direction": [1, 0, 0],
      "row-direction": [0, 0, -1], "columns": 320, "rows": 60, "pixel-spacing": 100 },
    "beam": { "kev": 60, "filter": ["Al:1"] },
    "materials": "table.json",
    "samples": [ { "file": "parts/rod.stl", "material": "Ti90Al6V4@4.43", "unit": "cm",
      "rotation": { "axis": [0, 0, 2], "angle": 30 }, "translation": [1, 2, 3] } ],
    "overlap-priority": ["stone", "water"] })";
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

std::string SceneRefusal(const std::string& json)
{
  const TemporaryFolder folder;
  const std::string path = folder.Write("scene.json", json);
  const std::string message = RefusalOf([&] { ReadScene(path); });
  EXPECT_THAT(message, testing::StartsWith(path + ": ")) << json;
  return message.substr(std::min(path.size() + 2, message.size()));
}

std::array<Extent, 3> Bounds(const SurfaceMesh& mesh)
{
  return ExtentsAlong<3>({ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } }, mesh.Points);
}

TEST(SceneIO, LengthsBecomeMillimetres)
{
  const TemporaryFolder folder;
  const SceneDescription scene = ReadScene(folder.Write("scene.json", SceneText()));
  EXPECT_TRUE(scene.Has("source") && scene.Has("detector") && scene.Has("beam"));
  EXPECT_TRUE(scene.Has("source.focal-spot"));
  EXPECT_FALSE(scene.Has("scatter"));
  const XRaySource& source = scene.Fixed.Source;
  EXPECT_EQ(source.Position, (Vector3{ 0, -500, 0.003 }));
  EXPECT_EQ(source.Type, XRaySource::Kind::Point);
  EXPECT_EQ(scene.Fixed.Detection.FocalSpotColumnMm, 0.05);
  EXPECT_EQ(scene.Fixed.Detection.FocalSpotRowMm, 0.025);
  const XRayDetector& detector = scene.Fixed.Detector;
  EXPECT_EQ(detector.Origin, (Vector3{ -0.016, 0.2, 0.006 }));
  EXPECT_EQ(scene.PixelSpacingMm, 0.1);
  EXPECT_EQ(detector.ColumnStep, (Vector3{ 1, 0, 0 }));
  EXPECT_EQ(detector.RowStep, (Vector3{ 0, 0, -1 }));
  EXPECT_EQ(detector.Columns, 320);
  EXPECT_EQ(detector.Rows, 60);
  EXPECT_EQ(scene.EnergyKeV, 60);
  EXPECT_THAT(scene.Filters, ElementsAre("Al:1"));
  EXPECT_EQ(scene.Materials, "table.json"); // not beside it: may be a shipped one's name
  EXPECT_THAT(scene.OverlapPriority, ElementsAre("stone", "water"));
  ASSERT_EQ(scene.Samples.size(), 1u);
  const SurfaceSample& sample = scene.Samples.front();
  EXPECT_EQ(sample.File, folder.File("parts/rod.stl"));
  EXPECT_EQ(sample.Material, "Ti90Al6V4@4.43");
  EXPECT_EQ(sample.UnitMm, 10);
  EXPECT_EQ(sample.RotationDeg, 30);
  EXPECT_EQ(sample.TranslationMm, (Vector3{ 0.001, 0.002, 0.003 }));

  folder.Write("table.json", "");
  const SceneDescription tube =
    ReadScene(folder.Write("scene.json", SceneText("\"kev\": 60", R"("tube": "W", "kvp": 40)")));
  EXPECT_EQ(tube.Materials, folder.File("table.json"));
  EXPECT_EQ(tube.Tube.Anode, "W");
  EXPECT_EQ(tube.Tube.KilovoltagePeak, 40);
  // What is left out is left to options.
  const SceneDescription empty = ReadScene(folder.Write("scene.json", "{}"));
  EXPECT_TRUE(empty.Keys.empty());
  EXPECT_TRUE(empty.Samples.empty());
}

TEST(SceneIO, WholeDetectionScatterAndMaterials)
{
  const TemporaryFolder folder;
  const SceneDescription scene = ReadScene(folder.Write("scene.json", R"({ "unit": "cm",
    "mesh": "breast.vtu", "materials": "victre",
    "attenuations": { "gland": "H2O@1.04" }, "iodine": { "gland": 2.5 },
    "source": { "position": [0, 0, 65], "focal-spot-samples": 3, "inverse-square": true,
      "heel": { "angle": 20, "depth-um": 0.25 } },
    "detector": { "origin": [0, 0, 0], "column-direction": [1, 0, 0], "row-direction": [0, 1, 0],
      "columns": 4, "rows": 3, "pixel-spacing": 0.01, "samples": 2, "response": "counting",
      "scintillator": "CsI@4.51:0.15", "photons": 1e4, "electronic-noise": 5,
      "half-modulation": 4, "seed": 7 },
    "scatter": { "method": "kernels", "air-gap": 1.5, "photons": 1e6, "voxel": 0.2,
      "grid": { "ratio": 6, "interspace": "air" } },
    "dose": true })"));
  EXPECT_EQ(scene.Mesh, folder.File("breast.vtu"));
  EXPECT_EQ(scene.Attenuations.at("gland"), "H2O@1.04");
  EXPECT_EQ(scene.IodineMgPerMl.at("gland"), 2.5);
  const Scene& fixed = scene.Fixed;
  EXPECT_TRUE(fixed.Field.InverseSquare && fixed.Dose);
  EXPECT_EQ(fixed.Field.Heel.TargetAngleDeg, 20);
  EXPECT_EQ(fixed.Field.Heel.DepthMm, 0.25e-3);
  EXPECT_EQ(fixed.Detector.Samples, 2);
  EXPECT_FALSE(fixed.Response.ByEnergy);
  EXPECT_EQ(scene.Scintillator, "CsI@4.51:0.15");
  EXPECT_EQ(fixed.Detection.FocalSpotSamples, 3);
  EXPECT_EQ(fixed.Detection.PhotonsPerPixel, 1e4);
  EXPECT_EQ(fixed.Detection.ElectronicNoisePhotons, 5);
  EXPECT_EQ(fixed.Detection.HalfModulationPerMm, 4);
  EXPECT_EQ(fixed.Detection.Seed, 7u);
  EXPECT_EQ(fixed.Scatter.Method, SceneScatter::Model::Kernels);
  EXPECT_EQ(fixed.Scatter.AirGapMm, 15);
  EXPECT_EQ(scene.VoxelMm, 2);
  ASSERT_TRUE(fixed.Scatter.Grid);
  EXPECT_EQ(*fixed.Scatter.Grid, AntiscatterGridOptions::OfLead({ 6, 31, 65 }, "air"));

  const SceneDescription bent = ReadScene(folder.Write("scene.json",
    R"({ "unit": "um", "refraction": { "law": "near-field", "distance": 2000 } })"));
  ASSERT_TRUE(bent.Fixed.Refraction);
  EXPECT_EQ(*bent.Fixed.Refraction, RefractionOptions::Law::NearField);
  EXPECT_EQ(bent.Fixed.BendDistanceMm, 2);
  const std::pair<const char*, const char*> wrong[] = { { R"({ "dose": 1 })",
                                                          "dose: expected true or false, found 1" },
    { R"({ "scatter": { "method": "magic" } })", "scatter.method: expected one of" },
    { R"({ "scatter": { "air-gap": 3000 } })", "scatter.air-gap: expected a number from 0 mm" },
    { R"({ "scatter": { "grid": { "ratio": 40 } } })", "scatter.grid.ratio: expected a number" },
    { R"({ "refraction": { "law": "Snell" } })", "refraction.law: expected one of" },
    { R"({ "attenuations": { "fat": 3 } })", "attenuations.fat: expected a text" },
    { R"({ "iodine": { "fat": -1 } })", "iodine.fat: expected a number from 0 to 500" },
    { R"({ "iodine": [] })", "iodine: expected an object" } };
  for (const auto& [json, text] : wrong)
  {
    EXPECT_THAT(SceneRefusal(json), HasSubstr(text));
  }
}

TEST(SceneIO, WhatIsWrittenIsReadAgain)
{
  const TemporaryFolder folder;
  const std::string all = R"({ "description": "all", "materials": "victre",
    "attenuations": { "gland": "H2O@1.04" }, "iodine": { "gland": 2.5 },
    "samples": [ { "file": "rod.stl", "material": "Ti", "unit": "um", "translation": [1, 2, 3],
      "rotation": { "axis": [0, 1, 1], "angle": 30 } }, { "file": "chip.stl", "material": "Al" } ],
    "overlap-priority": [ "Ti", "Al" ], "realistic": true,
    "source": { "position": [0, 1, 650], "focal-spot": [0.3, 0.1], "focal-spot-samples": 3,
      "inverse-square": true, "heel": { "angle": 20, "depth-um": 0.25 } },
    "detector": { "origin": [1, 2, 3], "column-direction": [0, 1, 0], "row-direction": [-1, 0, 0],
      "columns": 4, "rows": 3, "pixel-spacing": 0.07, "samples": 2, "response": "counting",
      "scintillator": "CsI@4.51:0.15", "photons": 10000.5, "electronic-noise": 5,
      "half-modulation": 4, "gain-spread": 0.01, "dead-pixels": 0.001, "dark-level": 0.02,
      "bits": 14, "seed": 7 },
    "beam": { "tube": "W", "kvp": 27.5, "target-angle": 15, "filter": [ "Mo:0.03", "Al:1" ] },
    "scatter": { "method": "kernels", "kernels": "scene", "air-gap": 15, "photons": 1000000,
      "voxel": 2,
      "grid": { "ratio": 6, "lines-per-cm": 40, "septum-um": 50, "interspace": "air" } },
    "refraction": { "law": "near-field", "distance": 2 }, "dose": true })";
  const std::string written = WriteScene(ReadScene(folder.Write("scene.json", all)));
  // Every key but the excluded ones: a beam is one of four, a mesh stands in place of samples.
  for (const SceneQuantity& quantity : SceneQuantities())
  {
    if (quantity.Key == "unit")
    {
      continue; // that of a sample is there
    }
    const std::string last = quantity.Key.substr(quantity.Key.rfind('.') + 1);
    const bool isOther = quantity.Key.starts_with("mesh") || last == "kev" || last == "spectrum" ||
      last == "energies" || last == "beam-direction" || last == "response-table" ||
      last == "line-spread";
    EXPECT_EQ(written.find('"' + last + '"') == std::string::npos, isOther) << quantity.Key;
  }
  EXPECT_THAT(written, HasSubstr(folder.File("rod.stl")));
  EXPECT_THAT(written, HasSubstr("\"photons\": 10000.5"));
  EXPECT_THAT(written, HasSubstr("\"interspace\": \"air\""));
  const TemporaryFolder elsewhere;
  const SceneDescription again = ReadScene(elsewhere.Write("scene.json", written));
  EXPECT_EQ(WriteScene(again), written);
  EXPECT_EQ(again.Fixed.Scatter.Grid->LinesPerMm, 4);
  EXPECT_EQ(again.Samples[0].UnitMm, 1e-3);
  // Defaults are left out.
  EXPECT_EQ(WriteScene({}), "{}\n");
}

TEST(SceneIO, TableAndSpectrumMayBeInTheFile)
{
  const TemporaryFolder folder;
  SurfaceMesh box;
  shapes::AddBox(box, { 0, 0, 0 }, { 10, 20, 40 }, 1);
  WriteMesh(ToPolyData(box, {}), folder.File("box.vtp"));
  const auto text = [](const std::string& attenuation)
  {
    return R"({ "materials": { "materials": [ { "name": "air", "labels": [0] },
      { "name": "fat", "labels": [1], "attenuation": ")" +
      attenuation + R"(" } ] }, "samples": [ { "file": "box.vtp" } ],
      "beam": { "energies": [20, 30], "photons": [1, 3] } })";
  };
  const SceneDescription description =
    ReadScene(folder.Write("scene.json", text("20:0.05 30:0.02/mm")));
  const Scene scene = LoadScene(description);
  ASSERT_EQ(scene.Materials.Materials.size(), 2u);
  EXPECT_EQ(scene.Materials.Materials[1].Name, "fat");
  EXPECT_DOUBLE_EQ(scene.Attenuations[1].MuAt(30, 1), 0.02);
  EXPECT_EQ(scene.XRays.Weights, (std::vector<double>{ 1, 3 }));
  EXPECT_EQ(Assemble(scene)->BackMaterials.front(), 1);
  // It is written with them.
  const std::string written = WriteScene(description);
  EXPECT_EQ(WriteScene(ReadScene(folder.Write("written.json", written))), written);
  EXPECT_THAT(written, HasSubstr("20:0.05 30:0.02/mm"));
  // A surface in memory stands for its file, and photons have any energy.
  SceneDescription inMemory = ReadScene(folder.Write("scene.json", text("0.07/mm")));
  inMemory.Samples[0].File.clear();
  inMemory.Samples[0].Surface = std::make_shared<const SurfaceMesh>(box);
  EXPECT_NEAR(MakeScene(inMemory).Attenuations[1].MuAt(450, 1), 0.07, 1e-12);
  EXPECT_THAT(RefusalOf([&] { LoadScene(ReadScene(folder.Write("s.json", text("0.07x/mm")))); }),
    HasSubstr("expected numbers, as 0.05/mm, found '0.07x'"));
  EXPECT_THAT(RefusalOf([&] { LoadScene(ReadScene(folder.Write("s.json", text("butter")))); }),
    HasSubstr("materials[1].density_g_per_cm3: unknown attenuation 'butter'"));
  EXPECT_THAT(SceneRefusal(R"({ "materials": 3 })"), HasSubstr("materials: expected the name of"));
  inMemory.Materials.clear();
  EXPECT_THAT(RefusalOf([&] { MakeScene(inMemory); }),
    HasSubstr("samples[0].material: expected one, or materials of the scene, found neither"));
}

TEST(SceneIO, ARealisticUnitHasWhatNoKeyGives)
{
  SceneDescription description =
    ReadScene(TemporaryFolder().Write("scene.json", R"({ "realistic": true,
      "detector": { "photons": 5 }, "scatter": { "grid": { "ratio": 8 } } })"));
  const Scene scene = MakeScene(description);
  EXPECT_THAT(scene.XRays.Name, HasSubstr("W 29 kVp"));
  EXPECT_TRUE(scene.Field.InverseSquare);
  EXPECT_EQ(scene.Field.Heel.TargetAngleDeg, 20);
  EXPECT_EQ(scene.Scatter.Method, SceneScatter::Model::Kernels);
  EXPECT_EQ(scene.Scatter.Grid->Ratio, 8);
  EXPECT_EQ(scene.Detection.PhotonsPerPixel, 5);
  EXPECT_EQ(scene.Detection.HalfModulationPerMm, 5);
  SetQuantity({ "kev", "beam.kev", { "20" } }, description);
  EXPECT_EQ(MakeScene(description).XRays.MeanEnergyKeV(), 20);
}

TEST(SceneIO, SettingsAreChecked)
{
  SceneDescription scene;
  SetQuantity({ "--kev", "beam.kev", { "60" } }, scene);
  SetQuantity({ "--source", "source.position", { "1", "2", "3" } }, scene);
  SetQuantity({ "--set", "source.focal-spot", { "[0.3, 0.1]" } }, scene);
  SetQuantity({ "--set", "attenuations.gland", { "12" } }, scene);
  EXPECT_EQ(scene.EnergyKeV, 60);
  EXPECT_EQ(scene.Fixed.Source.Position, (Vector3{ 1, 2, 3 }));
  EXPECT_EQ(scene.Fixed.Detection.FocalSpotRowMm, 0.1);
  EXPECT_EQ(scene.Attenuations.at("gland"), "12");
  EXPECT_TRUE(scene.HasSource());
  EXPECT_FALSE(scene.HasDetector());
  const auto refusal = [&](const std::string& key, const std::string& value) {
    return RefusalOf([&] { SetQuantity({ "--set x", key, { value } }, scene); });
  };
  EXPECT_EQ(refusal("beam.kev", "1000"), "--set x: expected a number from 1 to 500, found 1000");
  EXPECT_EQ(refusal("beam.kev", "ten"), "--set x: expected a number from 1 to 500, found \"ten\"");
  EXPECT_THAT(refusal("beam.kve", "20"), HasSubstr("beam.kev?"));
  EXPECT_THAT(refusal("beam", "20"), HasSubstr("no quantity 'beam'"));
  EXPECT_THAT(refusal("samples", "[]"), HasSubstr("no quantity 'samples'"));
  EXPECT_THAT(refusal("iodine.gland", "-1"), HasSubstr("from 0 to 500"));
}

TEST(SceneIO, AloneAFileMustBeComplete)
{
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& json)
  {
    const std::string path = folder.Write("scene.json", json);
    return RefusalOf([&] { LoadScene(path); });
  };
  EXPECT_THAT(refusal("{}"), HasSubstr("expected source.position or source.beam-direction"));
  EXPECT_THAT(refusal(R"({ "source": { "position": [0, 0, 650] } })"),
    HasSubstr("expected detector.origin"));
}

TEST(SceneIO, RefusesByPlace)
{
  const struct
  {
    const char* What;
    const char* By;
    const char* Text;
  } wrong[] = {
    { "\"um\"", "\"inch\"", R"(unit: expected one of "um", "mm", "cm", "m", "in", found "inch")" },
    { "\"cm\"", "10", R"(samples[0].unit: expected one of "um", "mm", "cm", "m", "in", found 10)" },
    { "\"columns\"", "\"colums\"", "detector: unknown key 'colums', expected origin, " },
    { "\"angle\"", "\"angel\"", "samples[0].rotation: unknown key 'angel'" },
    { "-500000", "null",
      "source.position: expected three numbers from -1e+09 um to 1e+09 um, found [0,null,3]" },
    { "-500000", "1e10", "source.position: expected three numbers from" },
    { "0, -500000, 3", "0, 3", "source.position: expected three numbers" },
    { "\"focal-spot\"", "\"beam-direction\": [0, 1, 0], \"focal-spot\"", "found both" },
    { "[50, 25]", "[50, -25]", "source.focal-spot: expected two numbers from 0 um to 100000 um" },
    { "[1, 0, 0]", "[0, 0, 0]",
      "detector.column-direction: expected three numbers from -1e6 to 1e6 that are not all 0" },
    { "320", "0", "detector.columns: expected a whole number from 1 to 65535, found 0" },
    { "320", "32.5", "detector.columns: expected a whole number" },
    { "320", "1e300", "detector.columns: expected a whole number" },
    { ", \"rows\": 60", "", "detector.rows: expected a whole number" },
    { "\"pixel-spacing\": 100", "\"pixel-spacing\": 0",
      "detector.pixel-spacing: expected a number from 0.001 um to 1e+06 um, found 0" },
    { ", \"pixel-spacing\": 100", "", "detector.pixel-spacing: expected a number" },
    { "\"kev\": 60", "\"kev\": 501", "beam.kev: expected a number from 1 to 500, found 501" },
    { "\"kev\": 60", "\"kev\": \"60\"", "beam.kev: expected a number from 1 to 500" },
    { "\"kev\": 60", R"("kev": 60, "spectrum": "W")", "found several" },
    { "\"kev\": 60", R"("kvp": 30)", "beam.tube: expected beside kvp, found none" },
    { "\"focal-spot\": [50, 25]", R"("heel": { "depth-um": 1 })",
      "source.heel.angle: expected a " },
    { "\"origin\": [-16, 200, 6], ", "", "detector: expected origin, column-direction and " },
    { "\"kev\": 60", R"("tube": "Cu", "kvp": 30)", R"(beam.tube: expected one of "W")" },
    { "\"kev\": 60", R"("tube": "W", "kvp": 500)", "beam.kvp: expected a number from 18 to 450" },
    { "\"kev\": 60", R"("target-angle": 12)", "beam.target-angle: expected a tube beside it" },
    { "[\"Al:1\"]", "\"Al:1\"", "beam.filter: expected a list of texts" },
    { "\"parts/rod.stl\"", "\"\"", "samples[0].file: expected a text that is not empty" },
    { "\"Ti90Al6V4@4.43\", ", "\"\", ", "samples[0].material: expected a text" },
    { "\"kev\": 60", R"("energies": [20, 30], "photons": [1])",
      "beam.photons: expected a number for each of 2 energies, found 1" },
    { "\"kev\": 60", R"("energies": [20, "x"], "photons": [1, 1])",
      "beam.energies: expected a list of numbers from 1 to 500" },
    { "\"angle\": 30", "\"angle\": 4000",
      "samples[0].rotation.angle: expected a number of degrees from -3600 to 3600, found 4000" },
    { ", \"angle\": 30", "", "samples[0].rotation.angle: expected a number of degrees" },
    { "[1, 2, 3]", "[1, 2, true]", "samples[0].translation: expected three numbers" },
    { "[\"stone\", \"water\"]", "[]", "overlap-priority: expected a list of texts" },
    { "\"a rod\"", "7", "description: expected a text" },
    { "-500000", "NaN", "expected a scene in JSON" },
    { "\"rows\": 60", "\"rows\": 60, \"rows\": 61", "key 'rows': expected once" },
  };
  for (const auto& [what, by, text] : wrong)
  {
    EXPECT_THAT(SceneRefusal(SceneText(what, by)), HasSubstr(text));
  }
  EXPECT_THAT(SceneRefusal("[]"), HasSubstr("expected a JSON object"));
  EXPECT_THAT(SceneRefusal("{\"samples\": []}"), HasSubstr("samples: expected a list of at least"));
  EXPECT_THAT(SceneRefusal("{\"samples\": {}}"), HasSubstr("samples: expected a list of at least"));
  EXPECT_THAT(SceneRefusal("{\"samples\": [3]}"), HasSubstr("samples[0]: expected a JSON object"));
  EXPECT_THAT(RefusalOf([] { ReadScene("/nowhere/scene.json"); }), HasSubstr("no such file"));
}

TEST(SceneIO, PlacesSurfacesByUnitTurnAndShift)
{
  const TemporaryFolder folder;
  SurfaceMesh box;
  shapes::AddBox(box, { 0, 0, 0 }, { 10, 20, 40 }, 1);
  const std::string path = folder.File("box.stl");
  WriteMesh(ToPolyData(box, {}), path);
  const SurfaceSample as{ .Name = "a", .File = path, .Material = "Al" };
  SurfaceSample micrometres = as;
  micrometres.UnitMm = 1e-3;
  micrometres.RotationAxis = { 0, 0, 5 };
  micrometres.RotationDeg = 90;
  micrometres.TranslationMm = { 1, 2, 3 };
  micrometres.Material = "SiO2@2.2";
  const Scene scene = LoadScene({ .Samples = { as, micrometres } });
  const std::shared_ptr<const SurfaceMesh> surface = Assemble(scene);
  ASSERT_EQ(scene.Materials.Materials.size(), 3u);
  EXPECT_EQ(scene.Materials.Materials[2].DensityGPerCm3, 2.2);
  EXPECT_EQ(surface->NumberOfTriangles(), 24u);
  EXPECT_EQ(surface->BackMaterials.front(), 1);
  EXPECT_EQ(surface->BackMaterials.back(), 2);
  SurfaceMesh second = *surface;
  second.Points.erase(second.Points.begin(),
    second.Points.begin() + static_cast<std::ptrdiff_t>(second.Points.size() / 2));
  // x to y, y to -x: the box lies between -20 and 0 um of x, 0 and 10 um of y.
  const std::array<Extent, 3> at = Bounds(second);
  EXPECT_THAT(at[0].Low, DoubleNear(1 - 0.02, 1e-12));
  EXPECT_THAT(at[0].High, DoubleNear(1, 1e-12));
  EXPECT_THAT(at[1].Low, DoubleNear(2, 1e-12));
  EXPECT_THAT(at[1].High, DoubleNear(2.01, 1e-12));
  EXPECT_THAT(at[2].Low, DoubleNear(3, 1e-12));
  EXPECT_THAT(at[2].High, DoubleNear(3.04, 1e-12));
  // About (1, 1, 1) by 120 degrees x becomes y, y becomes z, z becomes x.
  SurfaceSample cycled = as;
  cycled.RotationAxis = { 1, 1, 1 };
  cycled.RotationDeg = 120;
  const std::array<Extent, 3> turned = Bounds(*Assemble(LoadScene({ .Samples = { cycled } })));
  EXPECT_NEAR(turned[0].Length(), 40, 1e-12);
  EXPECT_NEAR(turned[1].Length(), 10, 1e-12);
  EXPECT_NEAR(turned[2].Length(), 20, 1e-12);
}

TEST(SceneIO, GltfHasMetresUnlessSaidOtherwise)
{
  const TemporaryFolder folder;
  SurfaceSample sample{ .Name = "a", .Material = "Al" };
  sample.File = folder.Write("scene.glb", test::GlbOfTetrahedron());
  EXPECT_NEAR(Bounds(*Assemble(LoadScene({ .Samples = { sample } })))[0].Low, 1000, 1e-9);
  sample.UnitMm = 1e-3; // made by a program that has no unit
  EXPECT_NEAR(Bounds(*Assemble(LoadScene({ .Samples = { sample } })))[0].Low, 1e-3, 1e-12);
}

TEST(SceneIO, RefusesSamplesByName)
{
  const TemporaryFolder folder;
  SurfaceMesh box;
  shapes::AddBox(box, { 0, 0, 0 }, { 10, 20, 40 }, 1);
  SurfaceSample sample{ .Name = "s.json: samples[3]", .File = folder.File("b.stl") };
  WriteMesh(ToPolyData(box, {}), sample.File);
  const auto refusal = [&] { return RefusalOf([&] { LoadScene({ .Samples = { sample } }); }); };
  for (const auto& [material, text] :
    { std::pair{ "butter", "butter" }, std::pair{ "Al@0", "density" },
      std::pair{ "Al@x", "density" }, std::pair{ "Al@inf", "density" },
      std::pair{ "Al@2699", "(in kg/m3?)" }, std::pair{ "SiO2", "expected a density" },
      std::pair{ "H:0.112 O:0.888", "a density" }, std::pair{ "air", "found air" } })
  {
    sample.Material = material;
    EXPECT_THAT(refusal(), testing::StartsWith("s.json: samples[3]: "));
    EXPECT_THAT(refusal(), HasSubstr(text));
  }
  for (const auto& [material, density] : { std::pair{ "Al", 2.70 }, std::pair{ "adipose", 0.92 },
         std::pair{ "Water, Liquid", 1.0 }, std::pair{ "SiO2@2.2", 2.2 } })
  {
    sample.Material = material;
    EXPECT_NEAR(LoadScene({ .Samples = { sample } }).Materials.Materials.at(1).DensityGPerCm3,
      density, 5e-3)
      << material;
  }
  const SceneDescription mesh{ .Mesh = sample.File, .MeshUnit = "in", .Materials = "victre" };
  EXPECT_NEAR(Bounds(*Assemble(LoadScene(mesh)))[2].High, 1016, 1e-9);
  sample.Material = "Al";
  sample.UnitMm = 1e6;
  EXPECT_THAT(refusal(),
    HasSubstr("expected a surface within 1e+06 mm of the origin, found a coordinate of 4e+07 mm"));
}
}
