// SPDX-License-Identifier: Apache-2.0
// One scene's file through the command, the VTK filter, C++, Python and Octave: the same bytes.
#include "CommandTest.h"
#include "DicomTesting.h"
#include "SurfaceShapes.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Filters/vtkXRayProjector.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/SceneIO.h"
#include "mammoray/XRay/Exposer.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>

using namespace mammoray;

namespace
{
/// Transmission, and the path lengths of both materials one after the other.
struct Pictures
{
  std::vector<float> Transmission;
  std::vector<float> Lengths;
  bool operator==(const Pictures&) const = default;
};

class SameScene : public test::CommandTest
{
protected:
  void SetUp() override
  {
    if (ListDevices().empty())
    {
      GTEST_SKIP() << "no Vulkan device";
    }
    SurfaceMesh body;
    shapes::AddBox(body, { -20, -30, 20 }, { 30, 25, 60 }, 1, 0, shapes::Rotation(0.2, 0.3, 0.1));
    shapes::AddSphere(body, { 4, 2, 41 }, 9, 3, 2, 1);
    WriteMesh(ToPolyData(body, { "air", "fat", "gland" }), this->Folder.File("body.vtp"));
    this->Folder.Write("table.json", R"({"materials": [{"name": "air", "labels": [0]},
      {"name": "fat", "labels": [1], "attenuation": "H:0.114 C:0.598 N:0.007 O:0.281",
       "density_g_per_cm3": 0.95},
      {"name": "gland", "labels": [2], "attenuation": "H2O", "density_g_per_cm3": 1.04}]})");
  }

  /// A scene with more in its detector, and more parts.
  std::string WriteScene(const std::string& detection, const std::string& parts)
  {
    return this->Folder.Write("scene.json",
      R"({ "mesh": "body.vtp", "materials": "table.json",
      "source": { "position": [3, -7, 650] },
      "detector": { "origin": [-30, -40, 1], "column-direction": [1, 0, 0],
        "row-direction": [0, 1, 0], "columns": 41, "rows": 33, "pixel-spacing": 1.75,
        "samples": 2)" +
        detection + " }, \"beam\": { \"spectrum\": \"W28kVp_Rh50um_Be1mm\" }" + parts + " }");
  }

  Pictures ByCommand(const std::string& path)
  {
    EXPECT_EQ(this->Run("project --scene " + path + " --overwrite -o " +
                this->Folder.File("t.mha") + " --path-lengths " + this->Folder.File("l.mha")),
      0)
      << this->Errors;
    // Path lengths are the channels of a pixel there.
    const std::vector<float> channels = MhaValues(this->Folder.File("l.mha"));
    Pictures pictures{ MhaValues(this->Folder.File("t.mha")), {} };
    const std::size_t materials = channels.size() / pictures.Transmission.size();
    for (std::size_t material = 0; material < materials; ++material)
    {
      for (std::size_t pixel = material; pixel < channels.size(); pixel += materials)
      {
        pictures.Lengths.push_back(channels[pixel]);
      }
    }
    return pictures;
  }

  static Pictures ByExposer(const Scene& scene)
  {
    Exposer exposer;
    Exposure exposure = exposer.Expose(scene);
    const std::vector<float>& all = exposure.Lengths->Lengths;
    return { std::move(exposure.Transmission),
      { all.begin() + static_cast<std::ptrdiff_t>(exposure.Lengths->NumberOfPixels()),
        all.end() } };
  }

  static Pictures PicturesOf(vtkXRayProjector* filter, const Scene& scene)
  {
    filter->Update();
    const auto add = [&](const std::string& array, std::vector<float>& values)
    {
      vtkDataArray* found = filter->GetOutput()->GetPointData()->GetArray(array.c_str());
      ASSERT_NE(found, nullptr) << array;
      const auto* begin = static_cast<const float*>(found->GetVoidPointer(0));
      values.insert(values.end(), begin, begin + found->GetNumberOfTuples());
    };
    Pictures pictures;
    add("Transmission", pictures.Transmission);
    for (std::size_t material = 1; material < scene.Materials.Materials.size(); ++material)
    {
      add("PathLength_" + scene.Materials.Materials[material].Name, pictures.Lengths);
    }
    return pictures;
  }

  Pictures ByFilterOfFile(const std::string& path, const Scene& scene)
  {
    vtkNew<vtkXRayProjector> filter;
    filter->SetSceneFile(path.c_str());
    const Pictures pictures = PicturesOf(filter, scene);
    int extent[6];
    filter->GetOutput()->GetExtent(extent);
    EXPECT_EQ(extent[1], scene.Detector.Columns - 1);
    return pictures;
  }

  Pictures ByFilter(const Scene& scene)
  {
    std::vector<std::string> names;
    const SurfaceMesh read = ReadSurface(this->Folder.File("body.vtp"), &names);
    const auto body = ToPolyData(read, names);
    const XRayDetector& detector = scene.Detector;
    vtkNew<vtkXRayProjector> filter;
    filter->SetInputData(body);
    filter->SetSourcePosition(scene.Source.Position.data());
    filter->SetDetectorOrigin(detector.Origin.data());
    filter->SetPixelSpacing(Norm(detector.ColumnStep), Norm(detector.RowStep));
    filter->SetDetectorSize(detector.Columns, detector.Rows);
    filter->SetMaterialTable(this->Folder.File("table.json").c_str());
    filter->SetSpectrum("W28kVp_Rh50um_Be1mm");
    const auto set = [&](const char* key, const auto& value)
    { filter->SetKey(key, nlohmann::json(value).dump().c_str()); };
    set("detector.samples", detector.Samples);
    set("detector.photons", scene.Detection.PhotonsPerPixel);
    set("detector.seed", scene.Detection.Seed);
    set("scatter.air-gap", scene.Scatter.AirGapMm);
    if (scene.Scatter.Method == SceneScatter::Model::Kernels)
    {
      filter->SetKey("scatter.method", "kernels");
    }
    if (scene.Refraction)
    {
      filter->SetKey("refraction.law", "geometric");
      set("refraction.distance", *scene.BendDistanceMm);
    }
    return PicturesOf(filter, scene);
  }

  template <typename Value>
  void Write(const std::string& name, const std::vector<Value>& values) const
  {
    std::ofstream file(this->Folder.File(name), std::ios::binary);
    file.write(reinterpret_cast<const char*>(values.data()),
      static_cast<std::streamsize>(values.size() * sizeof(Value)));
  }

  template <typename Value>
  std::vector<Value> Read(const std::string& name) const
  {
    const std::string bytes = test::ReadFile(this->Folder.File(name));
    std::vector<Value> values(bytes.size() / sizeof(Value));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(Value));
    return values;
  }

  /// Writes the scene as plain arrays.
  void WriteArrays(const Scene& scene)
  {
    const SurfaceMesh& surface = *scene.Samples.front().Surface;
    std::vector<double> sides;
    for (std::size_t triangle = 0; triangle < surface.NumberOfTriangles(); ++triangle)
    {
      sides.push_back(surface.FrontMaterials[triangle]);
      sides.push_back(surface.BackMaterials[triangle]);
    }
    std::vector<double> weights;
    std::vector<double> mu;
    for (std::size_t bin = 0; bin < scene.XRays.Weights.size(); ++bin)
    {
      const double energy = scene.XRays.EnergiesKeV[bin];
      weights.push_back(scene.XRays.Weights[bin] * scene.Response.Signal(energy));
      for (std::size_t material = 1; material < 3; ++material)
      {
        mu.push_back(scene.Attenuations[material].MuAt(energy,
          scene.Materials.Materials[material].DensityGPerCm3));
      }
    }
    this->Write("points", surface.Points);
    this->Write("triangles",
      std::vector<double>(surface.Triangles.begin(), surface.Triangles.end()));
    this->Write("sides", sides);
    this->Write("weights", weights);
    this->Write("mu", mu);
    const XRayDetector& detector = scene.Detector;
    std::vector<double> place(scene.Source.Position.begin(), scene.Source.Position.end());
    for (const Vector3& vector : { detector.Origin, detector.ColumnStep, detector.RowStep })
    {
      place.insert(place.end(), vector.begin(), vector.end());
    }
    const bool bends = scene.Refraction.has_value();
    place.insert(place.end(),
      { double(detector.Columns), double(detector.Rows), double(detector.Samples),
        scene.Detection.PhotonsPerPixel, double(scene.Detection.Seed), bends ? 1.0 : 0.0,
        bends ? *scene.BendDistanceMm : 0.0 });
    this->Write("place", place);
  }

  /// Runs a script in the folder of the test.
  Pictures RunScript(const std::string& command)
  {
    const std::string log = this->Folder.File("log");
    EXPECT_EQ(std::system(
                ("cd " + this->Folder.File("") + " && " + command + " >" + log + " 2>&1").c_str()),
      0)
      << test::ReadFile(log);
    return { this->Read<float>("transmission"), this->Read<float>("lengths") };
  }

  /// Compares all that read the scene's file.
  Pictures ExpectTheSameOfFile(const std::string& path, const Scene& scene)
  {
    Pictures expected = ByExposer(scene);
    EXPECT_TRUE(this->ByCommand(path) == expected);
    EXPECT_TRUE(this->ByFilterOfFile(path, scene) == expected);
    if (*MAMMORAY_TEST_PYTHON)
    {
      EXPECT_TRUE(
        this->RunScript(std::string(MAMMORAY_TEST_PYTHON) + "/sameScene.py file") == expected);
    }
    if (*MAMMORAY_TEST_OCTAVE)
    {
      EXPECT_TRUE(
        this->RunScript(std::string(MAMMORAY_TEST_OCTAVE) + "/sameScene.m file") == expected);
    }
    return expected;
  }

  /// Compares, beside these, properties and arrays that say the same as a file of body and table.
  void ExpectTheSame(const std::string& path, bool octaveToo, bool pythonToo = true)
  {
    const Scene scene = LoadScene(path);
    const Pictures expected = this->ExpectTheSameOfFile(path, scene);
    ASSERT_EQ(expected.Transmission.size(), 41u * 33);
    EXPECT_TRUE(this->ByFilter(scene) == expected);
    this->WriteArrays(scene);
    if (pythonToo && *MAMMORAY_TEST_PYTHON)
    {
      EXPECT_TRUE(this->RunScript(std::string(MAMMORAY_TEST_PYTHON) + "/sameScene.py") == expected);
    }
    if (octaveToo && *MAMMORAY_TEST_OCTAVE)
    {
      EXPECT_TRUE(this->RunScript(std::string(MAMMORAY_TEST_OCTAVE) + "/sameScene.m") == expected);
    }
  }
};
}

TEST_F(SameScene, HasTheSameBytesFromEverySurface)
{
  this->ExpectTheSame(this->WriteScene("", ""), true);
}

TEST_F(SameScene, HasTheSameNoise)
{
  this->ExpectTheSame(this->WriteScene(R"(, "photons": 1000, "seed": 7)", ""), false);
}

TEST_F(SameScene, IsBentAlike)
{
  this->ExpectTheSame(
    this->WriteScene("", R"(, "refraction": { "law": "geometric", "distance": 250 })"), false);
}

TEST_F(SameScene, ScattersAlike)
{
  this->ExpectTheSame(
    this->WriteScene("", R"(, "scatter": { "method": "kernels", "air-gap": 20 })"), false, false);
}

// Everything that a file can say at once, but what excludes each other.
TEST_F(SameScene, OfManySamplesInAWholeUnit)
{
  SurfaceMesh box;
  shapes::AddBox(box, { -10, -10, -10 }, { 10, 10, 10 }, 1);
  WriteMesh(ToPolyData(box, {}), this->Folder.File("box.stl"));
  SurfaceMesh ball;
  shapes::AddSphere(ball, { 0, 0, 0 }, 12, 3, 1);
  WriteMesh(ToPolyData(ball, {}), this->Folder.File("ball.obj"));
  const std::string path = this->Folder.Write("scene.json", R"({ "unit": "cm",
    "materials": "table.json", "attenuations": { "gland": "Water, Liquid@1.05" },
    "iodine": { "gland": 2 },
    "samples": [ { "file": "box.stl", "material": "fat", "translation": [0, 0, 4],
        "rotation": { "axis": [1, 2, 3], "angle": 40 } },
      { "file": "ball.obj", "material": "gland", "translation": [0.5, 0.2, 4] },
      { "file": "ball.obj", "material": "Al", "unit": "mm", "translation": [2, -1, 5] },
      { "file": "box.stl", "material": "CaCO3@2.7", "unit": "mm", "translation": [-2, 1, 3] } ],
    "overlap-priority": [ "gland", "fat" ],
    "source": { "position": [0.3, -0.7, 65], "focal-spot": [0.03, 0.03], "focal-spot-samples": 2,
      "inverse-square": true, "heel": { "angle": 20 } },
    "detector": { "origin": [-3, -3, 0.1], "column-direction": [1, 0.1, 0],
      "row-direction": [-0.1, 1, 0], "columns": 31, "rows": 27, "pixel-spacing": 0.2, "samples": 2,
      "scintillator": "CsI@4.51:0.15", "photons": 5000, "electronic-noise": 3,
      "half-modulation": 0.3, "seed": 11 },
    "beam": { "tube": "W", "kvp": 30, "filter": [ "Rh:0.05", "Air, Dry (near sea level):600" ] },
    "scatter": { "method": "kernels", "air-gap": 2, "grid": { "ratio": 5 } } })");
  const Scene scene = LoadScene(path);
  const Pictures pictures = this->ExpectTheSameOfFile(path, scene);
  EXPECT_EQ(pictures.Transmission.size(), 31u * 27);
  EXPECT_EQ(pictures.Lengths.size(), 4u * 31 * 27);
  // What is written makes the same picture.
  const std::string written =
    this->Folder.Write("written.json", mammoray::WriteScene(ReadScene(path)));
  const Pictures again = ByExposer(LoadScene(written));
  EXPECT_EQ(again.Lengths, pictures.Lengths);
  EXPECT_EQ(again.Transmission, pictures.Transmission);
}

TEST_F(SameScene, BendsRaysFromTheMiddleOfTheSamples)
{
  const std::string path = this->WriteScene("", R"(, "refraction": { "law": "near-field" })");
  this->ExpectTheSameOfFile(path, LoadScene(path));
}

TEST_F(SameScene, IsTheSameMammogramOfCommandAndPython)
{
  if (!*MAMMORAY_TEST_PYTHON)
  {
    GTEST_SKIP() << "no Python";
  }
  const std::string path = this->WriteScene("", "");
  const std::string log = this->Folder.File("log");
  ASSERT_EQ(std::system(("cd " + this->Folder.File("") +
              " && " MAMMORAY_TEST_PYTHON "/sameScene.py dicom >" + log + " 2>&1")
                          .c_str()),
    0)
    << test::ReadFile(log);
  const std::pair<const char*, std::string> cases[] = {
    { "placed.dcm",
      "--scene " + path +
        " --side left --view CC --for-processing --patient-name Phantom^Body --patient-id 7" },
    { "unit.dcm",
      "--mesh " + this->Folder.File("body.vtp") + " --materials " +
        this->Folder.File("table.json") +
        " --kev 20 --columns 41 --rows 33 --pixel-spacing 1.75 --orientation LAS --thickness 40 "
        "--side right" }
  };
  for (const auto& [name, options] : cases)
  {
    const std::string other = this->Folder.File("command.dcm");
    ASSERT_EQ(this->Run("project " + options + " --overwrite -o " + other), 0) << this->Errors;
    const Mammogram python = ReadMammogram(this->Folder.File(name));
    const Mammogram command = ReadMammogram(other);
    // Python places the unit by its own arithmetic: a rounding of the stored values.
    EXPECT_THAT(python.Pixels, testing::Pointwise(testing::FloatNear(1), command.Pixels)) << name;
    EXPECT_EQ(python.View, command.View);
    EXPECT_EQ(python.Laterality, command.Laterality);
    EXPECT_EQ(python.RowDirection, command.RowDirection);
    EXPECT_EQ(python.ColumnDirection, command.ColumnDirection);
    EXPECT_EQ(python.BodyPartThicknessMm, command.BodyPartThicknessMm);
    EXPECT_EQ(python.SourceToPatientMm, command.SourceToPatientMm);
    EXPECT_EQ(python.SourceToDetectorMm, command.SourceToDetectorMm);
    EXPECT_EQ(python.PeakKilovoltage, command.PeakKilovoltage);
    EXPECT_EQ(python.PresentationIntent, command.PresentationIntent);
    // Name, ID and derivation.
    for (const auto& [group, element] : { std::pair<std::uint16_t, std::uint16_t>{ 0x0010, 0x0010 },
           { 0x0010, 0x0020 }, { 0x0008, 0x2111 } })
    {
      EXPECT_EQ(test::DicomTextOf(this->Folder.File(name), group, element),
        test::DicomTextOf(other, group, element));
    }
  }
}
