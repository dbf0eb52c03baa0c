// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MaterialTableIO.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using mammoray::test::NotRefused;
using mammoray::test::RefusalOf;
using namespace mammoray;
using test::TemporaryFolder;

namespace
{
std::string MaterialsRefusal(const std::string& json)
{
  const TemporaryFolder folder;
  const std::string path = folder.Write("table.json", json);
  const std::string message = RefusalOf([&] { ReadMaterialTable(path); });
  EXPECT_THAT(message, testing::AnyOf(NotRefused, testing::StartsWith(path)));
  return message;
}

/// The table with air and one tissue whose keys are given.
std::string WithFat(const std::string& keys)
{
  return R"({"materials": [{"name": "air", "labels": [0]}, {"name": "fat", )" + keys + "}]}";
}
}

TEST(MaterialTableIO, ReadsTheShippedTable)
{
  const MaterialTable table = ReadMaterialTable(test::DataFolder() + "/materials/victre.json");
  EXPECT_EQ(table.Name, "VICTRE phantoms");
  ASSERT_EQ(table.Materials.size(), 5u);
  EXPECT_EQ(table.Materials[0].Name, "air");
  const Material& muscle = table.Materials[4];
  EXPECT_EQ(muscle.Name, "muscle");
  EXPECT_EQ(muscle.Attenuation, "muscle");
  EXPECT_EQ(muscle.DensityGPerCm3, 1.05);
  EXPECT_TRUE(muscle.Fixed);
  EXPECT_EQ(table.Materials[2].YoungsModulusKPa, 15);
  EXPECT_FALSE(table.Materials[2].Fixed);
  EXPECT_EQ(table.MaterialOfLabel.at(33), 3);
  EXPECT_EQ(table.MaterialOfLabel.size(), 12u);
  EXPECT_EQ(table.MaterialOfLabel.at(50), 0); // paddles
}

TEST(MaterialTableIO, AThinMaterialNeedsNoLabels)
{
  const TemporaryFolder folder;
  const MaterialTable table =
    ReadMaterialTable(folder.Write("thin.json", WithFat(R"("attenuation": "skin", "thin": true)")));
  EXPECT_TRUE(table.Materials.at(1).Thin);
  EXPECT_EQ(table.MaterialOfLabel.size(), 1u);
}

TEST(MaterialTableIO, AbsentKeysTakeTheDefaults)
{
  const TemporaryFolder folder;
  const MaterialTable table = ReadMaterialTable(
    folder.Write("plain.json", WithFat(R"("labels": [1, 65535], "attenuation": "adipose")")));
  EXPECT_EQ(table.Name, "plain.json");
  const Material defaults;
  EXPECT_EQ(table.Materials[1].DensityGPerCm3, 0.92); // that of adipose.csv
  EXPECT_EQ(table.Materials[1].YoungsModulusKPa, defaults.YoungsModulusKPa);
  EXPECT_EQ(table.Materials[1].PoissonRatio, defaults.PoissonRatio);
  EXPECT_EQ(table.Materials[1].FungExponent, 0);
  EXPECT_EQ(table.MaterialOfLabel.at(65535), 1);
  const MaterialTable stiffening = ReadMaterialTable(folder.Write("fung.json",
    WithFat(R"("labels": [1], "attenuation": "adipose", "fung_exponent": 2.6)")));
  EXPECT_EQ(stiffening.Materials[1].FungExponent, 2.6);
}

TEST(MaterialTableIO, RefusesWhatIsWrongByKey)
{
  using testing::HasSubstr;
  const std::string good = R"("labels": [1], "attenuation": "adipose")";
  EXPECT_EQ(MaterialsRefusal(WithFat(good)), NotRefused);
  EXPECT_THAT(MaterialsRefusal("{"), HasSubstr("JSON"));
  EXPECT_THAT(MaterialsRefusal("[]"), HasSubstr("expected a JSON object"));
  EXPECT_THAT(MaterialsRefusal("{}"), HasSubstr(": materials: expected"));
  EXPECT_THAT(MaterialsRefusal(R"({"name": 3, "materials": []})"), HasSubstr(": name: expected"));
  EXPECT_THAT(MaterialsRefusal(WithFat(R"("labels": [1])")),
    HasSubstr("materials[1].attenuation: expected"));
  EXPECT_THAT(MaterialsRefusal(WithFat(R"("attenuation": "adipose")")),
    HasSubstr("materials[1].labels: expected"));
  EXPECT_THAT(MaterialsRefusal(WithFat(R"("labels": [0], "attenuation": "a")")),
    HasSubstr("in 'air' already"));
  for (const char* labels : { "[]", "[1.5]", "[-1]", "[65536]", "[\"1\"]", "1", "[1e30]" })
  {
    EXPECT_THAT(
      MaterialsRefusal(WithFat(R"("attenuation": "a", "labels": )" + std::string(labels))),
      HasSubstr("materials[1].labels: expected"))
      << labels;
  }
  EXPECT_THAT(MaterialsRefusal(WithFat(good + R"(, "density_g_per_cm3": 0)")),
    HasSubstr("materials[1].density_g_per_cm3: expected a positive number, found 0"));
  EXPECT_THAT(MaterialsRefusal(WithFat(good + R"(, "youngs_modulus_kpa": "5")")),
    HasSubstr("materials[1].youngs_modulus_kpa: expected"));
  // kg/m3 and Pa, say.
  EXPECT_THAT(MaterialsRefusal(WithFat(good + R"(, "density_g_per_cm3": 920)")),
    HasSubstr("material 'fat': expected a density from 0.5 to 3 g/cm3, found 920 (in kg/m3?); set "
              "\"unusual\""));
  EXPECT_THAT(MaterialsRefusal(WithFat(good + R"(, "youngs_modulus_kpa": 5000)")),
    HasSubstr("expected a Young's modulus from 0.05 to 500 kPa, found 5000 (in Pa?)"));
  // Elements have a density, formulas and fractions have none.
  EXPECT_EQ(MaterialsRefusal(WithFat(R"("labels": [1], "attenuation": "Al")")), NotRefused);
  for (const char* attenuation : { "\"H2O\"", R"({ "H": 0.112, "O": 0.888 })" })
  {
    EXPECT_THAT(
      MaterialsRefusal(WithFat(R"("labels": [1], "attenuation": )" + std::string(attenuation))),
      HasSubstr("expected a density in g/cm3"));
  }
  EXPECT_THAT(MaterialsRefusal(WithFat(good + R"(, "density_g_per_cm3": 2699, "unusual": true)")),
    HasSubstr("(in kg/m3?)"));
  EXPECT_EQ(MaterialsRefusal(WithFat(good + R"(, "density_g_per_cm3": 11.3, "unusual": true)")),
    NotRefused);
  EXPECT_THAT(MaterialsRefusal(WithFat(good + R"(, "poisson_ratio": 0.5)")),
    HasSubstr("below 0.5"));
  EXPECT_THAT(MaterialsRefusal(WithFat(good + R"(, "fung_exponent": -1)")), HasSubstr("from 0"));
  EXPECT_THAT(MaterialsRefusal(WithFat(good + R"(, "fixed": 1)")), HasSubstr("true or false"));
  EXPECT_THAT(MaterialsRefusal(WithFat(good + R"(, "colour": "red")")),
    HasSubstr("unknown key 'colour'"));
  EXPECT_THAT(MaterialsRefusal(WithFat(good + R"(, "labels": [2])")), HasSubstr("expected once"));
  EXPECT_THAT(MaterialsRefusal(R"({"materials": [{"name": "fat", "labels": [0]}, {}]})"),
    HasSubstr("\"air\" for the first"));
  EXPECT_THAT(MaterialsRefusal(R"({"materials": [{"name": "air", "labels": [0]},
    {"name": "air", "labels": [1], "attenuation": "a"}]})"),
    HasSubstr("no other material has"));
  EXPECT_THAT(MaterialsRefusal(R"({"materials": [{"name": "air", "labels": [0], "fixed": true},
    {"name": "fat", "labels": [1], "attenuation": "a"}]})"),
    HasSubstr("unknown key 'fixed'"));
  EXPECT_THROW(ReadMaterialTable("/nowhere/table.json"), InputError);
}

TEST(MaterialTableIO, RefusesDeepNesting)
{
  for (const std::string bracket : { "[", "{\"a\":" })
  {
    std::string json = R"({"materials": )";
    for (int level = 0; level < 300000; ++level)
    {
      json += bracket;
    }
    EXPECT_THAT(MaterialsRefusal(json), testing::HasSubstr("found JSON nested deeper than 16"));
  }
}
