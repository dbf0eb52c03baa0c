// SPDX-License-Identifier: Apache-2.0
#include "CommandTest.h"
#include "DicomTesting.h"
#include "SurfaceShapes.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include "vtkPolyData.h"

#include <nlohmann/json.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

using namespace mammoray;
using test::ReadFile;

namespace
{
class ProjectSeries : public test::CommandTest
{
protected:
  void SetUp() override
  {
    if (ListDevices().empty())
    {
      GTEST_SKIP() << "no Vulkan device";
    }
  }

  /// A closed box in a file.
  std::string Box(const std::string& name, const Vector3& low, const Vector3& high)
  {
    SurfaceMesh mesh;
    shapes::AddBox(mesh, low, high, 1);
    WriteMesh(ToPolyData(mesh, {}), this->Folder.File(name));
    return this->Folder.File(name);
  }

  std::string Stack = this->Folder.File("stack.mha");
};

/// A parallel beam along +y onto columns along +x and rows along -z.
const std::string Parallel = " --kev 20 --beam-direction 0 1 0 --column-direction 1 0 0 "
                             "--row-direction 0 0 -1 --detector-origin -24.5 60 4.5 --columns 50 "
                             "--rows 10 --pixel-spacing 1";
}

TEST_F(ProjectSeries, ATurnedBoxIsSeenFromItsSides)
{
  const std::string box = this->Box("box.vtp", { -10, -5, -20 }, { 10, 5, 20 });
  ASSERT_EQ(this->Run("project --surface 'Water, Liquid=" + box + "'" + Parallel +
              " --turn 8 --span 360 --axis z --axis-point 0 0 0 -o " + this->Stack),
    0)
    << this->Errors;
  // 10 of its 40 mm.
  EXPECT_THAT(this->Errors,
    testing::StartsWith("mammoray: warning: projection 0: 25 % of the shadow falls on the"));
  const IntensityVolume stack = ReadIntensityFile(this->Stack);
  ASSERT_EQ(stack.Size, (std::array<int, 3>{ 50, 10, 8 }));
  const auto at = [&](int projection, int column)
  { return stack.Voxels[static_cast<std::size_t>((projection * 10 + 5) * 50 + column)]; };
  // 10 mm thick and 20 wide, then 20 thick and 10 wide; on the diagonal what both faces leave.
  const double mu = -std::log(at(0, 25)) / 10;
  EXPECT_NEAR(mu, 0.081, 0.001); // NIST: 0.810 cm2/g
  EXPECT_NEAR(-std::log(at(2, 25)), 20 * mu, 1e-4);
  EXPECT_EQ(at(0, 14), 1);
  EXPECT_LT(at(0, 15), 1);
  EXPECT_EQ(at(2, 19), 1);
  EXPECT_LT(at(2, 20), 1);
  EXPECT_NEAR(-std::log(at(1, 25)), 10 * std::numbers::sqrt2 * mu, 1e-4);
  // Half a turn later all is mirrored about the axis' shadow.
  const nlohmann::json series = nlohmann::json::parse(ReadFile(this->Folder.File("stack.json")));
  EXPECT_NEAR(series.at("axis").at("columnInFirstRow").get<double>(), 24.5, 1e-9);
  EXPECT_NEAR(series.at("axis").at("columnInLastRow").get<double>(), 24.5, 1e-9);
  ASSERT_EQ(series.at("projections").size(), 8u);
  EXPECT_EQ(series.at("projections").at(3).at("angleDeg"), 135);
  for (int projection = 0; projection < 4; ++projection)
  {
    for (int column = 0; column < 50; ++column)
    {
      EXPECT_NEAR(at(projection, column), at(projection + 4, 49 - column), 1e-5)
        << projection << ", " << column;
    }
  }
}

TEST_F(ProjectSeries, SurfacesOfTheirOwnMaterials)
{
  // Beside each other along x.
  const std::string titanium = this->Box("titanium.vtp", { -20, -1, -20 }, { 0, 1, 20 });
  const std::string water = this->Box("water.stl", { 2, -10, -20 }, { 20, 10, 20 });
  const std::string surfaces = "project --surface 'Ti90Al6V4@4.43=" + titanium +
    "' --surface 'Water, Liquid=" + water + "'" + Parallel;
  ASSERT_EQ(this->Run(surfaces + " -o " + this->Stack), 0) << this->Errors;
  EXPECT_THAT(this->Errors, testing::StartsWith("mammoray: warning: 25 % of the shadow falls on"));
  const IntensityVolume image = ReadIntensityFile(this->Stack);
  const double throughTitanium = -std::log(image.Voxels[5 * 50 + 10]);
  const double throughWater = -std::log(image.Voxels[5 * 50 + 35]);
  EXPECT_EQ(image.Voxels[5 * 50 + 25], 1); // between them
  // NIST's mass attenuation at 20 keV, cm2/g: Ti 15.85, Al 3.441, V 17.68; fractions by mass of
  // 90, 6 and 4 atoms.
  const double mass = 90 * 47.867 + 6 * 26.982 + 4 * 50.942;
  const double perGram = (90 * 47.867 * 15.85 + 6 * 26.982 * 3.441 + 4 * 50.942 * 17.68) / mass;
  EXPECT_NEAR(throughTitanium, 0.2 * 4.43 * perGram, 0.03 * throughTitanium);
  EXPECT_NEAR(throughWater, 2 * 0.8096, 0.01 * throughWater);

  this->ExpectRefused(surfaces + " --mesh " + titanium + " -o " + this->Stack, "found both");
  this->ExpectRefused("project -o " + this->Stack, "found neither");
  const std::string output = " --overwrite -o " + this->Stack;
  this->ExpectRefused("project --surface butter=" + titanium + output, "butter");
  this->ExpectRefused("project --surface " + titanium + output, "MATERIAL=FILE");
  this->ExpectRefused("project --surface Ti@x=" + titanium + output, "density");
}

TEST_F(ProjectSeries, EmptyAndCutPicturesAreEvents)
{
  const std::string around = " --kev 20 --source 0 -600 0 --detector-origin -24.5 60 24.5 "
                             "--column-direction 1 0 0 --row-direction 0 0 -1 --columns 50 --rows "
                             "50 --pixel-spacing 1 --overwrite -o " +
    this->Stack;
  const auto told = [&](const Vector3& low, const Vector3& high, const std::string& options = "")
  {
    const std::string box = this->Box("box.stl", low, high);
    EXPECT_EQ(this->Run("project --surface Al=" + box + options + around), 0) << this->Errors;
    return this->Errors;
  };
  using testing::HasSubstr;
  EXPECT_EQ(told({ -10, -10, -10 }, { 10, 10, 10 }), "");
  EXPECT_THAT(told({ -10, 70, -10 }, { 10, 90, 10 }), HasSubstr("lies behind the detector"));
  EXPECT_THAT(told({ -10, -900, -10 }, { 10, -800, 10 }), HasSubstr("lies behind the source"));
  EXPECT_THAT(told({ 100, -10, -10 }, { 120, 10, 10 }), HasSubstr("the picture is empty"));
  EXPECT_THAT(told({ 15, -10, -10 }, { 35, 10, 10 }), HasSubstr("% of the shadow falls on the"));
  EXPECT_THAT(told({ 0.011, -0.01, 0.011 }, { 0.031, 0.01, 0.031 }),
    HasSubstr("0.02 mm wide: a file in metres? (--unit)"));
  EXPECT_EQ(told({ -0.01, -0.01, -0.01 }, { 0.01, 0.01, 0.01 }, " --unit m"), "");
  // 20 mm of aluminium, 2.70 g/cm3 of 3.441 cm2/g (NIST), at the middle.
  const IntensityVolume image = ReadIntensityFile(this->Stack);
  EXPECT_NEAR(-std::log(image.Voxels[25 * 50 + 25]), 2 * 2.70 * 3.441, 0.02 * 18.6);
  EXPECT_EQ(this->Run("project --surface Al=box.stl --unit yard" + around), 2);
  // As a mesh with a table, too, unless something of it is fixed as the chest wall of a breast is.
  const std::string cutBox = this->Box("box.stl", { 15, -10, -10 }, { 35, 10, 10 });
  for (const char* const fixed : { "false", "true" })
  {
    const std::string table = this->Folder.Write("table.json",
      R"({ "name": "t", "materials": [ { "name": "air", "labels": [0] }, { "name": "fat",
        "labels": [1], "attenuation": "adipose", "fixed": )" +
        std::string(fixed) + " } ] }");
    EXPECT_EQ(this->Run("project --mesh " + cutBox + " --materials " + table + around), 0);
    EXPECT_EQ(this->Errors.find("% of the shadow falls on the") == std::string::npos,
      std::string(fixed) == "true")
      << this->Errors;
  }
  // Turned about an axis beside it, the part is seen, cut, not seen, and cut.
  EXPECT_THAT(told({ -10, -10, -10 }, { 10, 10, 10 }, " --turn 4 --axis-point 30 0 0"),
    testing::AllOf(HasSubstr("warning: projection 1: "),
      HasSubstr("1 of 4 projections show nothing of the object")));
  // A part behind the source, and a file in metres, beside one that is seen.
  const std::string water = this->Box("water.vtp", { 5, -10, -10 }, { 15, 10, 10 });
  const std::string cut = " --surface H2O@1=" + water;
  EXPECT_EQ(told({ -10, -900, -10 }, { 10, -800, 10 }, cut),
    "mammoray: warning: nothing is seen of part 1 (Al): the part lies behind the source\n");
  EXPECT_THAT(told({ 0.011, -0.01, 0.011 }, { 0.031, 0.01, 0.031 }, cut),
    testing::AllOf(testing::StartsWith("mammoray: warning: part 1 (Al)'s shadow"),
      HasSubstr("0.02 mm wide: a file in metres? (--unit)\n")));
}

TEST_F(ProjectSeries, TomosynthesisMovesWhatIsHighMost)
{
  // Thin plates whose edges are at gantry x = 0, at heights of 10 and 40 mm over the receptor.
  const std::string options = " --orientation LAS --anchor 0 0 0 --thickness 46 --kev 20 "
                              "--columns 2 --rows 400 --pixel-spacing 0.5 --tomosynthesis 5 "
                              "--span 40 --overwrite -o " +
    this->Stack;
  // The receptor's plane is half of the thickness and 2 mm under the anchor.
  const auto edgesOf = [&](double height)
  {
    const double z = height - 25;
    const std::string plate = this->Box("plate.vtp", { 0, -200, z - 0.01 }, { 300, 200, z + 0.01 });
    EXPECT_EQ(this->Run("project --surface Pb=" + plate + options), 0) << this->Errors;
    const IntensityVolume stack = ReadIntensityFile(this->Stack);
    std::vector<double> edges;
    for (int projection = 0; projection < 5; ++projection)
    {
      int covered = 0;
      for (int row = 0; row < 400; ++row)
      {
        covered +=
          stack.Voxels[static_cast<std::size_t>((projection * 400 + row) * 2)] < 0.9 ? 1 : 0;
      }
      edges.push_back(0.5 * covered);
    }
    return edges;
  };
  const nlohmann::json::json_pointer angle("/projections/4/angleDeg");
  for (const double height : { 10.0, 40.0 })
  {
    const std::vector<double> edges = edgesOf(height);
    const nlohmann::json series = nlohmann::json::parse(ReadFile(this->Folder.File("stack.json")));
    EXPECT_EQ(series.at(angle), 20);
    for (int projection = 0; projection < 5; ++projection)
    {
      // A source at 650 (sin a, cos a) throws the edge by height tan a' the other way.
      const double turn = (projection - 2) * 10 * std::numbers::pi / 180;
      const double shift = height * 650 * std::sin(turn) / (650 * std::cos(turn) - height);
      EXPECT_NEAR(std::abs(edges[projection] - edges[2]), std::abs(shift), 0.5 + 1e-6)
        << height << ", " << projection;
    }
    EXPECT_LT((edges[0] - edges[2]) * (edges[4] - edges[2]), 0);
  }
}

TEST_F(ProjectSeries, TomosynthesisIsADicomObjectThatKnowsWhereItsSourcesStood)
{
  // The edge of a thin plate at gantry x = 0, 40 mm over the receptor.
  const std::string plate = this->Box("plate.vtp", { 0, -200, 14.99 }, { 300, 200, 15.01 });
  const std::string object = this->Folder.File("sweep.dcm");
  const std::string inputs = "project --surface Pb=" + plate +
    " --orientation LAS --anchor 0 0 0 --thickness 46 --kev 20 --columns 2 --rows 400 "
    "--pixel-spacing 0.5 ";
  for (const auto& [side, hung] : { std::pair{ "left", -1.0 }, { "right", 1.0 } })
  {
    ASSERT_EQ(this->Run(inputs + "--tomosynthesis 5 --span 40 --pivot-height 30 --side " + side +
                " --for-processing --overwrite -o " + object),
      0)
      << this->Errors;
    test::ExpectValidDicom(object);
    EXPECT_FALSE(std::filesystem::exists(this->Folder.File("sweep.json")));
    const std::vector<Mammogram> projections = ReadProjections(object);
    ASSERT_EQ(projections.size(), 5u);
    EXPECT_EQ(MiddleProjection(projections), 2u);
    EXPECT_EQ(projections[0].View, "CC");
    EXPECT_EQ(projections[0].PeakKilovoltage, 20);
    for (int number = 0; number < 5; ++number)
    {
      const Mammogram& projection = projections[static_cast<std::size_t>(number)];
      const std::array<double, 2>& foot = *projection.SourceFootPixel;
      const double height = *projection.SourceToDetectorMm;
      // On an arc of 620 mm about the pivot, right-handed about gantry y in the mesh's frame, whose
      // LAS is left-handed: positive angles lead to the patient's left.
      const double turn = (number - 2) * 10 * std::numbers::pi / 180;
      EXPECT_NEAR(height, 30 + 620 * std::cos(turn), 1e-3);
      // x leads to the left: against the rows of a left breast, with those of a right one.
      const auto xOf = [&](double row) { return hung * (row - 199.5) * 0.5; };
      EXPECT_NEAR(xOf(foot[1]), 620 * std::sin(turn), 1e-3);
      EXPECT_NEAR(*projection.SourceToPatientMm, height - 2, 1e-3);
      // The object itself tells where the edge's shadow falls.
      const double shadow = xOf(foot[1]) * (1 - height / (height - 40));
      for (int row = 0; row < 400; ++row)
      {
        const bool covered = projection.Pixels[static_cast<std::size_t>(2 * row)] < 25000;
        if (std::abs(xOf(row) - shadow) > 0.5)
        {
          EXPECT_EQ(covered, xOf(row) > shadow) << side << " " << number << " " << row;
        }
      }
    }
  }
  this->ExpectRefused(inputs + "--tomosynthesis 5 -o " + this->Folder.File("other.dcm"),
    "--side left or right");
  this->ExpectRefused(inputs + "--tomosynthesis 5 --side left --flat-fields 2 -o " +
      this->Folder.File("other.dcm"),
    "--flat-fields");
  this->ExpectRefused(inputs + "--turn 5 --side left -o " + this->Folder.File("other.dcm"),
    "stack (.tif .mha .nrrd)");
  this->ExpectRefused(inputs + "--tomosynthesis 5 --source 0 0 600 --side left -o " +
      this->Folder.File("other.dcm"),
    "explicit positions");
}

TEST_F(ProjectSeries, FlatFieldsAndNoiseAreEachOnesOwn)
{
  const std::string box = this->Box("box.vtp", { -10, -5, -20 }, { 10, 5, 20 });
  ASSERT_EQ(this->Run("project --surface 'Water, Liquid=" + box + "'" + Parallel +
              " --photons 1000 --turn 2 --span 360 --axis 0 0 1 --axis-point 0 0 0 --flat-fields "
              "20 -o " +
              this->Folder.File("scan.mha")),
    0)
    << this->Errors;
  const IntensityVolume scan = ReadIntensityFile(this->Folder.File("scan.mha"));
  const IntensityVolume flat = ReadIntensityFile(this->Folder.File("scan_flat.mha"));
  ASSERT_EQ(flat.Size, (std::array<int, 3>{ 50, 10, 20 }));
  double sum = 0;
  double squares = 0;
  for (const float value : flat.Voxels)
  {
    sum += value;
    squares += (value - 1) * (value - 1);
  }
  const double count = 10000;
  // Four standard deviations of the mean of 10,000 pixels and of their variance.
  EXPECT_NEAR(sum / count, 1, 4 * std::sqrt(0.001 / count));
  EXPECT_NEAR(squares / count, 0.001, 4 * 0.001 * std::sqrt(2 / count));
  // No two pictures have the same noise.
  for (int pixel = 0; pixel < 50; ++pixel)
  {
    if (flat.Voxels[pixel] != flat.Voxels[500 + pixel])
    {
      break;
    }
    EXPECT_LT(pixel, 20);
  }
  EXPECT_NE(scan.Voxels, flat.Voxels);
}

TEST_F(ProjectSeries, DetectorsOfLayersAndTables)
{
  const std::string box = this->Box("box.vtp", { -10, -5, -20 }, { 10, 5, 20 });
  const auto through = [&](const std::string& response)
  {
    EXPECT_EQ(this->Run("project --surface 'Water, Liquid=" + box +
                "' --beam-direction 0 1 0 --column-direction 1 0 0 --row-direction 0 0 -1 "
                "--detector-origin 0 60 0 --columns 1 --rows 1 --overwrite -o " +
                this->Stack + response),
      0)
      << this->Errors;
    return ReadIntensityFile(this->Stack).Voxels.at(0);
  };
  // A thick layer detects all, a thin one the softer photons rather; a table says so itself.
  EXPECT_NEAR(through(" --set detector.scintillator=CsI@4.51:20"), through(""), 1e-6);
  EXPECT_LT(through(" --set detector.scintillator=CsI@4.51:0.01"), 0.99 * through(""));
  this->Folder.Write("energy.csv", "1, 1\n100, 100\n");
  EXPECT_NEAR(through(" --set detector.response-table=" + this->Folder.File("energy.csv")),
    through(""), 1e-6);
  this->Folder.Write("one.csv", "20, 1\n");
  EXPECT_NEAR(through(" --set detector.response-table=" + this->Folder.File("one.csv")),
    through(" --set detector.response=counting"), 1e-6);
  this->ExpectRefused("project --surface 'Water, Liquid=" + box +
      "' --set detector.scintillator=CsI:1 --set detector.response-table=" +
      this->Folder.File("one.csv") + " --overwrite -o " + this->Stack,
    "found both");
}

TEST_F(ProjectSeries, DualEnergyLeavesTheIodine)
{
  // 40 mm of fat beside 40 mm of gland, beside gland with iodine.
  SurfaceMesh slabs;
  shapes::AddBox(slabs, { -30, -20, -20 }, { -10, 20, 20 }, 1);
  shapes::AddBox(slabs, { -9, -20, -20 }, { 9, 20, 20 }, 2);
  shapes::AddBox(slabs, { 10, -20, -20 }, { 30, 20, 20 }, 3);
  WriteMesh(ToPolyData(slabs, { "air", "fat", "gland", "enhanced" }),
    this->Folder.File("slabs.vtp"));
  this->Folder.Write("table.json", R"({"materials": [{"name": "air", "labels": [0]},
    {"name": "fat", "labels": [1], "attenuation": "adipose", "density_g_per_cm3": 0.92},
    {"name": "gland", "labels": [2], "attenuation": "glandular", "density_g_per_cm3": 1.04},
    {"name": "enhanced", "labels": [3], "attenuation": "glandular", "density_g_per_cm3": 1.04,
     "iodine_mg_per_ml": 0.5}]})");
  const std::string inputs = "project --mesh " + this->Folder.File("slabs.vtp") + " --materials " +
    this->Folder.File("table.json") +
    " --beam-direction 0 1 0 --column-direction 1 0 0 --row-direction 0 0 -1 --detector-origin -20 "
    "60 "
    "0 --columns 3 --rows 1 --pixel-spacing 20 --overwrite --cancel fat gland --cancel-thickness "
    "40";
  ASSERT_EQ(this->Run(inputs +
              " --tube W --kvp 28 --filter Rh:0.05 --high kvp=42 filter=Cu:0.3 "
              "--set iodine.enhanced=2 -o " +
              this->Stack),
    0)
    << this->Errors;
  EXPECT_EQ(this->Errors, "");
  EXPECT_THAT(this->Output, testing::HasSubstr("fat and gland of 40 mm look the same"));
  const std::vector<float> recombined = ReadIntensityFile(this->Stack).Voxels;
  const auto logOf = [&](const char* name)
  {
    std::vector<float> values = ReadIntensityFile(this->Folder.File(name)).Voxels;
    for (float& value : values)
    {
      value = -std::log(value);
    }
    return values;
  };
  const std::vector<float> low = logOf("stack_low.mha");
  const std::vector<float> high = logOf("stack_high.mha");
  EXPECT_NEAR(recombined[0], recombined[1], 1e-5);
  EXPECT_GT(low[1] - low[0], 0.5);
  EXPECT_GT(high[1] - high[0], 0.05);
  // 40 mm of 2 mg/ml; tables' 0.5 is replaced.
  EXPECT_GT(recombined[2] - recombined[1], 0.05);

  this->ExpectRefused(inputs + " -o " + this->Stack, "found none");
  this->ExpectRefused(inputs + " --high kev=35 kvp=40 -o " + this->Stack, "found several");
  this->ExpectRefused(inputs + " --high kvp=40 -o " + this->Stack, "--tube");
  this->ExpectRefused(inputs + " --high kev=35 --set iodine.enhanced=-1 -o " + this->Stack,
    "0 to 500");
  this->ExpectRefused(inputs + " --high kev=35 -o " + this->Folder.File("a.png"), "one picture");
  this->ExpectRefused(inputs + " --high kev=35 --turn 3 -o " + this->Stack, "one picture");
}

TEST_F(ProjectSeries, RefusesWhatDoesNotGoTogether)
{
  const std::string box = this->Box("box.vtp", { -10, -5, -20 }, { 10, 5, 20 });
  const std::string inputs = "project --surface 'Water, Liquid=" + box + "' -o " + this->Stack;
  this->ExpectRefused(inputs + " --turn 4 --tomosynthesis 3", "found both");
  this->ExpectRefused(inputs + " --span 20", "found neither");
  this->ExpectRefused(inputs + " --turn 4 --axis w", "expected x, y, z or three numbers");
  this->ExpectRefused(inputs + " --turn 4 --axis 0 0 0", "without length");
  this->ExpectRefused(inputs + " --tomosynthesis 4 --axis z", "--pivot-height");
  this->ExpectRefused(inputs + " --tomosynthesis 4 --beam-direction 0 0 -1", "parallel");
  this->ExpectRefused("project --surface 'Water, Liquid=" + box + "' --turn 2 -o " +
      this->Folder.File("stack.png"),
    "expected .tif, .mha or .nrrd");
  EXPECT_FALSE(std::filesystem::exists(this->Stack));
  EXPECT_FALSE(std::filesystem::exists(this->Folder.File("stack.json")));
}
