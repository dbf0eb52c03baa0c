// SPDX-License-Identifier: Apache-2.0
#include "Refusals.h"
#include "SurfaceMeasures.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/MaterialTableIO.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/IO/ShippedExamples.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

namespace
{
using mammoray::test::RefusalOf;
using namespace mammoray;

template <typename Function>
void ExpectRefused(const Function& function, const std::string& text)
{
  EXPECT_THAT(RefusalOf([&] { function(); }), testing::HasSubstr(text));
}

TEST(ShippedData, SpectraHaveTheMeanEnergyTheyState)
{
  // The files' own comments, printed with one or three digits; the last interval is left out there
  // too.
  EXPECT_NEAR(FindSpectrum("W28kVp_Rh50um_Be1mm").MeanEnergyKeV(), 19.0, 0.05);
  EXPECT_NEAR(FindSpectrum("W30kVp_Rh50um_Be1mm").MeanEnergyKeV(), 19.3, 0.05);
  EXPECT_NEAR(FindSpectrum("W28kVp_Rh50um_Be1mm_Al2mm_MTF").MeanEnergyKeV(), 20.955, 0.02);
}

TEST(ShippedData, TablesGiveTheirValuesInMillimetres)
{
  // From the README of the tables' source, 1/cm at 20 keV.
  EXPECT_NEAR(FindAttenuationTable("adipose").MuAt(20, 0.92), 0.051255, 1e-6);
  EXPECT_NEAR(FindAttenuationTable("glandular").MuAt(20, 1.06), 0.078581, 1e-6);
  EXPECT_NEAR(FindAttenuationTable("glandular").MuAt(20, 0.53), 0.5 * 0.078581, 1e-6);
}

TEST(ShippedData, BeamOfTheShippedTable)
{
  const MaterialTable table = ReadMaterialTable(DataDirectory() + "/materials/victre.json");
  const Beam beam = MakeBeam(table, Spectrum::Monochromatic(20), DetectorResponse::PhotonCounting);
  std::vector<double> lengths(table.Materials.size(), 0.0);
  lengths[static_cast<std::size_t>(table.IndexOf("fat"))] = 30;
  lengths[static_cast<std::size_t>(table.IndexOf("gland"))] = 10;
  EXPECT_NEAR(beam.LogAttenuation(lengths.data()), 30 * 0.051255 + 10 * 0.078581 * 1.035 / 1.06,
    1e-4); // the six digits of the source
}

TEST(ShippedData, BreastSegNetsLabelsHaveTheirTissuesAndImplantsNone)
{
  const MaterialTable table = FindMaterialTable("breastsegnet");
  // Gland, vessel, muscle, bone, lesion, lymph node, heart, liver, implant; 10: fat from elsewhere.
  const std::vector<std::string> tissues = { "air", "gland", "gland", "chest-wall", "chest-wall",
    "gland", "gland", "chest-wall", "chest-wall", "", "fat" };
  LabelVolume labels;
  labels.Size = { 2, 1, 1 }; // the second voxel is fat: air alone is refused
  for (std::uint16_t label = 0; label < tissues.size(); ++label)
  {
    labels.Voxels = { label, 10 };
    if (tissues[label].empty())
    {
      ExpectRefused([&] { table.ToMaterials(labels, "labels"); }, std::to_string(label));
      continue;
    }
    EXPECT_EQ(table.ToMaterials(labels, "labels").Voxels.front(), table.IndexOf(tissues[label]))
      << label;
  }
  EXPECT_TRUE(table.Fixed()[static_cast<std::size_t>(table.IndexOf("chest-wall"))]);
}

TEST(ShippedData, ShippedTablesAreFoundByName)
{
  const Spectrum spectrum = Spectrum::Monochromatic(20);
  for (const auto& entry : std::filesystem::directory_iterator(DataDirectory() + "/materials"))
  {
    const std::string name = entry.path().stem().string();
    const MaterialTable table = FindMaterialTable(name);
    EXPECT_EQ(table.Name, FindMaterialTable(entry.path().string()).Name);
    // Every attenuation is known, and between fat's and skin's at 20 keV, 1/mm.
    const Beam beam = MakeBeam(table, spectrum, DetectorResponse::PhotonCounting);
    for (std::size_t material = 1; material < table.Materials.size(); ++material)
    {
      std::vector<double> lengths(table.Materials.size(), 0.0);
      lengths[material] = 1;
      EXPECT_GT(beam.LogAttenuation(lengths.data()), 0.05) << name << ", " << material;
      EXPECT_LT(beam.LogAttenuation(lengths.data()), 0.1) << name << ", " << material;
    }
  }
  EXPECT_EQ(FindMaterialTable("victre").MaterialOfLabel.at(88), 2);
}

TEST(ShippedData, UnknownNamesListTheKnown)
{
  ExpectRefused([] { FindMaterialTable("victor"); },
    "material table victor: no such file, and no material table of that name; did you mean "
    "victre?");
  ExpectRefused([] { FindMaterialTable("/nowhere.json"); }, "no such file");
  ExpectRefused([] { FindAttenuationTable("unobtainium"); }, "adipose, air, blood");
  ExpectRefused([] { FindSpectrum("W99"); }, "W28kVp_Rh50um_Be1mm");
  MaterialTable table;
  table.Materials = { { "air" }, { .Name = "cyst", .Attenuation = "wader" } };
  ExpectRefused([&]
    { MakeBeam(table, Spectrum::Monochromatic(20), DetectorResponse::PhotonCounting); },
    "material 'cyst': unknown attenuation 'wader'");
}

TEST(ShippedData, ExampleBreastIsThePublishedSizeAndKeepsTheTissues)
{
  const ExampleScene scene = MakeExampleScene("breast");
  EXPECT_EQ(scene.Surface.NumberOfTriangles(), 5185458u);
  EXPECT_EQ(scene.Detector.Columns, 1080);
  EXPECT_EQ(scene.Detector.Rows, 1080);
  scene.Surface.Validate("breast");
  EXPECT_TRUE(test::IsClosed(scene.Surface));

  const LabelVolume voxels = scene.Materials.ToMaterials(
    ReadLabelFile(DataDirectory() + "/victre-phantom-1/labels.nrrd"), "labels");
  const auto counts = voxels.CountLabels();
  const auto volumes = test::MaterialVolumes(scene.Surface);
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

TEST(ShippedData, UnknownExamplesGetNearOnes)
{
  EXPECT_THAT(RefusalOf([&] { MakeExampleScene("boxs"); }),
    testing::HasSubstr("did you mean boxes?"));
}
}
