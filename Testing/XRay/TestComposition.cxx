// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MaterialTableIO.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/XRay/Composition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <xraylib.h>

#include <memory>

namespace
{
using mammoray::test::RefusalOf;
using namespace mammoray;

AttenuationTable Composition(const std::string& text)
{
  AttenuationTable table;
  EXPECT_TRUE(FindComposition(text, table)) << text;
  return table;
}

/// 1/cm at 15, 17.5, 20, 25 and 30 keV.
void ExpectPerCm(const std::string& text, double density, const std::vector<double>& expected,
  double tolerance)
{
  const AttenuationTable table = Composition(text);
  const double energies[5] = { 15, 17.5, 20, 25, 30 };
  for (std::size_t index = 0; index < 5; ++index)
  {
    EXPECT_NEAR(10 * table.MuAt(energies[index], density), expected[index],
      tolerance * expected[index])
      << text << " at " << energies[index] << " keV";
  }
}

void ExpectRefused(const std::string& name, const std::string& text)
{
  EXPECT_THAT(RefusalOf([&] { FindAttenuationTable(name); }), testing::HasSubstr(text));
}
}

TEST(Composition, WaterAndBreastTissuesMatchPublishedConstants)
{
  // Water to the three digits of the source. The ash of Hammerstein's tissues (Radiology 130, 1979)
  // is not broken down; phosphorus to calcium moves gland by 6 % at 15 keV, sulphur lies between.
  ExpectPerCm("H2O", 1, { 1.673, 1.117, 0.810, 0.509, 0.376 }, 2e-3);
  ExpectPerCm("H:0.112 C:0.619 N:0.017 O:0.251 S:0.001", 0.93,
    { 0.968, 0.675, 0.512, 0.352, 0.280 }, 0.015);
  ExpectPerCm("H:0.102 C:0.184 N:0.032 O:0.677 S:0.005", 1.04,
    { 1.620, 1.089, 0.793, 0.505, 0.376 }, 0.025);
}

TEST(Composition, WhatIndustryXRaysMatchesNistUpTo500KeV)
{
  // Total attenuation with coherent scattering, cm2/g (Hubbell and Seltzer, NISTIR 5632), to 2 %.
  const double energies[] = { 60, 100, 200, 500 };
  const std::pair<const char*, std::array<double, 4>> expected[] = {
    { "H2O", { 0.2059, 0.1707, 0.1370, 0.09687 } },
    { "Al", { 0.2778, 0.1704, 0.1223, 0.08445 } },
    { "Fe", { 1.205, 0.3717, 0.1460, 0.08414 } },
    { "Pb", { 5.021, 5.549, 0.9985, 0.1614 } },
  };
  for (const auto& [text, values] : expected)
  {
    for (std::size_t index = 0; index < 4; ++index)
    {
      EXPECT_NEAR(10 * Composition(text).MuAt(energies[index], 1), values[index],
        0.02 * values[index])
        << text << " at " << energies[index] << " keV";
    }
  }
}

TEST(Composition, KEdgesAreWhereXraylibHasThem)
{
  // 1e-4 beside the edge, less than a bin of any spectrum: 1e-4 relative, as a power law between
  // energies 2.3 % apart misses that much.
  for (const int element : { 53, 56, 64, 74, 82 })
  {
    const std::unique_ptr<char, decltype(&xrlFree)> symbol(AtomicNumberToSymbol(element, nullptr),
      xrlFree);
    const AttenuationTable table = Composition(symbol.get());
    const double edge = EdgeEnergy(element, K_SHELL, nullptr);
    double sides[2] = {};
    for (const double energy : { edge * (1 - 1e-2), edge * (1 - 1e-3), edge * (1 - 3e-4),
           edge * (1 + 3e-4), edge * (1 + 1e-3), edge * (1 + 1e-2), 300.0, 450.0, 500.0 })
    {
      const double expected = 0.1 * CS_Total(element, energy, nullptr);
      EXPECT_NEAR(table.MuAt(energy, 1) / expected, 1, 1e-4)
        << symbol.get() << " at " << energy << " keV";
    }
    sides[0] = table.MuAt(edge * (1 - 3e-4), 1);
    sides[1] = table.MuAt(edge * (1 + 3e-4), 1);
    EXPECT_GT(sides[1], 3 * sides[0]) << symbol.get();
    // The jump lies between neighbouring energies of the table: no value is between the two sides.
    for (int step = -300; step <= 300; ++step)
    {
      const double mu = table.MuAt(edge * (1 + 1e-6 * step), 1);
      EXPECT_TRUE(mu < 1.01 * sides[0] || mu > 0.99 * sides[1])
        << symbol.get() << " at " << 1e-6 * step << " of its edge";
    }
  }
}

TEST(Composition, ShippedTablesAgree)
{
  // The shipped tables are PENELOPE's, xraylib's cross sections another evaluation: 2 % for what
  // tissues are made of. Photoelectric cross sections of heavier elements differ more, by 4.5 % for
  // selenium on both sides of its edge.
  struct Pair
  {
    const char* Table;
    const char* Composition;
    double Tolerance;
  };
  const Pair pairs[] = { { "adipose", "Adipose Tissue (ICRP)", 0.02 },
    { "polystyrene", "C8H8", 0.02 }, { "calcium_oxalate", "CaC2O4", 0.02 },
    { "muscle", "Muscle, Skeletal", 0.02 }, { "selenium", "Se", 0.05 } };
  for (const auto& [name, text, tolerance] : pairs)
  {
    const AttenuationTable shipped = FindAttenuationTable(name);
    const AttenuationTable table = Composition(text);
    const double density = shipped.NominalDensityGPerCm3;
    for (double energy = 10; energy <= 50; energy += 0.5)
    {
      if (std::string(name) == "selenium" && std::abs(energy - 12.66) < 0.5)
      {
        continue; // tabulated 0.1 keV apart across its edge
      }
      const double expected = shipped.MuAt(energy, density);
      EXPECT_NEAR(table.MuAt(energy, density), expected, tolerance * expected)
        << text << " at " << energy << " keV";
    }
  }
}

TEST(Composition, SpellingsOfOneMaterialAgree)
{
  // Fractions of water to four digits; 1e-4 relative.
  const AttenuationTable formula = Composition("H2O");
  const AttenuationTable fractions = Composition("H:0.1119 O:0.8881");
  const AttenuationTable named = Composition("Water, Liquid");
  const AttenuationTable nested = Composition("H2O:1");
  for (const double energy : { 1.0, 17.3, 20.0, 200.0 })
  {
    const double expected = formula.MuAt(energy, 1);
    EXPECT_NEAR(fractions.MuAt(energy, 1), expected, 1e-3 * expected);
    EXPECT_NEAR(named.MuAt(energy, 1), expected, 1e-3 * expected);
    EXPECT_NEAR(nested.MuAt(energy, 1), expected, 1e-12 * expected);
  }
  EXPECT_NEAR(Composition("Al").NominalDensityGPerCm3, 2.7, 0.01);
}

TEST(Composition, OnlyElementsCompoundsAndTablesHaveADensity)
{
  for (const auto& [name, density] : { std::pair{ "Al", 2.70 }, std::pair{ "Ti", 4.54 },
         std::pair{ "Water, Liquid", 1.0 }, std::pair{ "adipose", 0.92 } })
  {
    EXPECT_NEAR(FindAttenuationTable(name).DensityOf(0), density, 5e-3) << name;
    EXPECT_EQ(FindAttenuationTable(name).DensityOf(1.5), 1.5);
  }
  for (const char* name : { "H2O", "H:0.112 O:0.888", "Al:1", "Al2O3" })
  {
    EXPECT_THAT(RefusalOf([&] { FindAttenuationTable(name).DensityOf(0); }),
      testing::HasSubstr("expected a density in g/cm3"));
    EXPECT_EQ(FindAttenuationTable(name).DensityOf(1.5), 1.5);
  }
  EXPECT_THAT(RefusalOf([] { FindAttenuationTable("Al").DensityOf(2699); }),
    testing::HasSubstr("found 2699 (in kg/m3?)"));
  std::string text = "SiO2@2.2";
  EXPECT_EQ(TakeDensity(text, "test"), 2.2);
  EXPECT_EQ(text, "SiO2");
  EXPECT_EQ(TakeDensity(text, "test"), 0);
  for (const char* bad : { "Al@", "Al@0", "Al@-1", "Al@nan", "Al@2699", "@1" })
  {
    text = bad;
    EXPECT_THROW(TakeDensity(text, "test"), InputError) << bad;
  }
}

TEST(Composition, EdgesAreSharp)
{
  // Rhodium's K edge at 23.22 keV: the coefficient jumps by a factor of about 6.
  const AttenuationTable rhodium = Composition("Rh");
  const double below = rhodium.MuAt(23.21, rhodium.NominalDensityGPerCm3);
  const double above = rhodium.MuAt(23.23, rhodium.NominalDensityGPerCm3);
  EXPECT_GT(above, 5 * below);
  EXPECT_LT(above, 7 * below);
}

TEST(Composition, UnknownNamesAreRefusedWithNearOnes)
{
  ExpectRefused("adipos", "did you mean adipose");
  ExpectRefused("Watr, Liquid", "Water, Liquid");
  ExpectRefused("AL", "did you mean Al?");
  ExpectRefused("FE", "did you mean Fe?");
  ExpectRefused("zr", "did you mean Zr");
  ExpectRefused("AL2O3", "Al2O3");
  ExpectRefused("CACO3", "CaCO3");
  ExpectRefused("NACL", "NaCl");
  EXPECT_THAT(RefusalOf([] { FindAttenuationTable("BRASS"); }),
    testing::Not(testing::HasSubstr("BrAsS")));
  EXPECT_THAT(RefusalOf([] { RequireComposition("MG", "--surface"); }),
    testing::HasSubstr("did you mean Mg?"));
  ExpectRefused("xyzzy", "known are adipose, air, blood");
  ExpectRefused("H:0.5 O:0.4", "a sum of 0.9");
  ExpectRefused("H:0.5 Qq:0.5", "'Qq:0.5'");
  ExpectRefused("H:0.5 O:", "'O:'");
  ExpectRefused("H:0.5 H:0.5", "'H' twice");
  ExpectRefused("", "expected an attenuation, found none");
}

TEST(Composition, EverydayNamesAreKnown)
{
  const std::pair<const char*, const char*> same[] = {
    { "PMMA", "Polymethyl Methacralate (Lucite, Perspex)" },
    { "acrylic", "Polymethyl Methacralate (Lucite, Perspex)" },
    { "perspex", "Polymethyl Methacralate (Lucite, Perspex)" },
    { "Polymethyl Methacrylate", "Polymethyl Methacralate (Lucite, Perspex)" },
    { "Water", "Water, Liquid" }, { "liquid water", "Water, Liquid" }, { "Aluminium", "Al" },
    { "aluminum", "Al" }, { "TITANIUM", "Ti" }, { "Tin", "Sn" }, { "Iron", "Fe" },
    { "Caesium Iodide", "Cesium Iodide" }, { "teflon", "Polytetrafluoroethylene (Teflon)" },
    { "Polyethylene Terephthalate, (Mylar)", "Polyethylene Terephthalate (Mylar)" },
    { "Glass, Borosilicate (Pyrex)", "Glass, Pyrex" }, { "lead glass", "Glass, Lead" },
    { "C-552 Air-equivalent Plastic", "C-552 Air-Equivalent Plastic" },
    { "eye lens (icrp)", "Eye Lens (ICRP)" }, { "skin", "Skin (ICRP)" }
  };
  for (const auto& [name, text] : same)
  {
    const AttenuationTable named = Composition(name);
    const AttenuationTable table = Composition(text);
    EXPECT_TRUE(named.HasDensity) << name;
    EXPECT_EQ(named.NominalDensityGPerCm3, table.NominalDensityGPerCm3) << name;
    EXPECT_EQ(named.MuPerMm, table.MuPerMm) << name;
  }
  // NIST's page (NISTIR 5632), mass attenuation at 20 keV, cm2/g, to 2 %, and the densities there.
  const std::tuple<const char*, double, double> page[] = {
    { "Adipose Tissue (ICRU-44)", 0.5677, 0.95 }, { "Breast Tissue (ICRU-44)", 0.6890, 1.02 },
    { "Bone, Cortical (ICRU-44)", 4.001, 1.92 }, { "Polymethyl Methacrylate", 0.5714, 1.19 }
  };
  for (const auto& [name, perGram, density] : page)
  {
    const AttenuationTable table = Composition(name);
    EXPECT_NEAR(table.DensityOf(0), density, 1e-9) << name;
    EXPECT_NEAR(10 * table.MuAt(20, 1), perGram, 0.02 * perGram) << name;
  }
  EXPECT_EQ(Composition("Concrete, Ordinary").DensityOf(0), 2.3);
  // Which bone, which wood?
  AttenuationTable table;
  EXPECT_FALSE(FindComposition("bone", table));
  EXPECT_FALSE(FindComposition("wood", table));
  EXPECT_FALSE(FindComposition("ICRU-44", table));
  ExpectRefused("bone", "Bone, Compact (ICRU)");
  ExpectRefused("Alumnium", "Aluminum");
  EXPECT_THAT(RefusalOf([] { RequireComposition("Rhodum", "filter"); }),
    testing::HasSubstr("did you mean Rhodium"));
}

TEST(Composition, PlasticsAreNoFormulas)
{
  // NIST's compounds: density, and the heaviest element, which an accidental formula would have.
  const std::tuple<const char*, double, int> plastics[] = { { "PP", 0.90, 6 }, { "PS", 1.06, 6 },
    { "PC", 1.20, 8 }, { "PET", 1.40, 8 }, { "PVC", 1.30, 17 }, { "PI", 1.42, 8 } };
  for (const auto& [name, density, heaviest] : plastics)
  {
    const CompositionParts parts = ParseComposition(name, "test");
    EXPECT_NEAR(parts.DensityGPerCm3, density, 0.03) << name;
    EXPECT_EQ(parts.MassFractions.rbegin()->first, heaviest) << name;
  }
  EXPECT_EQ(ParseComposition("Pa", "test").MassFractions.begin()->first, 91);
}

TEST(Composition, FormulasInCapitalsThatMeanAnotherElementAreRefused)
{
  const auto refusal = [](const char* text)
  { return RefusalOf([text] { ParseComposition(text, "test"); }); };
  EXPECT_EQ(refusal("PB"),
    "'PB' is a formula of phosphorus and boron; lead is 'Pb' (as a formula: 'P1B1')");
  const std::pair<const char*, const char*> mistaken[] = { { "NI", "nickel is 'Ni'" },
    { "CU", "copper is 'Cu'" }, { "CO", "cobalt is 'Co'" }, { "SI", "silicon is 'Si'" },
    { "HF", "hafnium is 'Hf'" }, { "SN", "tin is 'Sn'" }, { "CSI", "cesium is 'Cs'" },
    { "SIO2", "'S1I1O2'" }, { "CUSO4", "copper is 'Cu'" }, { "PPS", "'P1P1S1'" },
    { "OO", "twice in a row" }, { "PSU", "a plastic" }, { "PU", "a plastic" },
    { "PB:0.5 C:0.5", "lead is 'Pb'" } };
  for (const auto& [text, expected] : mistaken)
  {
    EXPECT_THAT(refusal(text), testing::HasSubstr(expected)) << text;
  }
  for (const char* clear : { "P1B1", "BP", "BN", "WC", "UO2", "CO2", "K2CO3", "CS2", "HNO3",
         "H3PO4", "KOH", "CaCO3", "NaHCO3", "CH3COOH", "C9H8INO", "P2O5", "PH3", "P", "C1O1" })
  {
    EXPECT_FALSE(ParseComposition(clear, "test").MassFractions.empty()) << clear;
  }
}

TEST(Composition, BracketsWithoutEndAreNoFormula)
{
  AttenuationTable table;
  EXPECT_TRUE(FindComposition(std::string(50, '(') + "H" + std::string(50, ')'), table));
  // xraylib ends the process on it.
  const std::string deep = std::string(200000, '(') + "H" + std::string(200000, ')');
  EXPECT_FALSE(FindComposition(deep, table));
  EXPECT_THROW(FindComposition(deep + ":1", table), InputError);
}

TEST(Composition, MaterialTablesTakeThem)
{
  test::TemporaryFolder folder;
  folder.Write("table.json", R"({"materials": [{"name": "air", "labels": [0]},
    {"name": "cyst", "labels": [1], "attenuation": {"H": 0.1119, "O": 0.8881},
      "density_g_per_cm3": 1},
    {"name": "chalk", "labels": [2], "attenuation": "CaCO3", "density_g_per_cm3": 2.7}]})");
  const MaterialTable table = ReadMaterialTable(folder.File("table.json"));
  const Beam beam = MakeBeam(table, Spectrum::Monochromatic(20), DetectorResponse::PhotonCounting);
  const double cyst[3] = { 0, 10, 0 };
  EXPECT_NEAR(beam.LogAttenuation(cyst), 0.810, 0.002);
  folder.Write("table.json", R"({"materials": [{"name": "air", "labels": [0]},
    {"name": "cyst", "labels": [1], "attenuation": {"H": "much"}}]})");
  EXPECT_THROW(ReadMaterialTable(folder.File("table.json")), InputError);
}
