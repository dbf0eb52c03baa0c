// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/Private/SpectrumIO.h"
#include "mammoray/IO/ShippedData.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

using mammoray::test::RefusalOf;
using namespace mammoray;
using test::TemporaryFolder;

namespace
{
std::string SpectrumRefusal(const std::string& path)
{
  return RefusalOf([&] { ReadSpectrum(path); });
}
}

TEST(SpectrumIO, EachValueStandsForTheIntervalUpToTheNextEnergy)
{
  TemporaryFolder folder;
  const Spectrum spectrum = ReadSpectrum(
    folder.Write("two.spc", "# comment\n10e3 5 # of 2 keV\n12e3 7\n13e3 -1\n14e3 x\n"));
  EXPECT_EQ(spectrum.Name, "two");
  EXPECT_THAT(spectrum.EnergiesKeV, testing::ElementsAre(10, 12));
  EXPECT_THAT(spectrum.Weights, testing::ElementsAre(10, 7));
}

/// The spectrum of a text, its energies and photons "10:5 12:7", and what was noted.
std::string ReadText(const std::string& text, std::vector<std::string>* said = nullptr)
{
  const TemporaryFolder folder;
  NoteKeeper notes;
  const Spectrum spectrum = ReadSpectrum(folder.Write("s.txt", text));
  std::string read;
  for (std::size_t bin = 0; bin < spectrum.Weights.size(); ++bin)
  {
    read += (read.empty() ? "" : " ") + NumberText(spectrum.EnergiesKeV[bin]) + ':' +
      NumberText(spectrum.Weights[bin]);
  }
  if (said)
  {
    *said = notes.Lines();
  }
  return read;
}

TEST(SpectrumIO, TablesOfOthersAreReadInTheirForms)
{
  const char* const same[] = {
    "Energy [keV] (bin centre), photons\n10,5\n11,7\n12,1\n",
    "\xef\xbb\xbf"
    "E / keV;N;centre\r\n10,0;5,0\r\n11,0;7,0\r\n12,0;1,0\r\n",
    "# energies in keV, centres of bins\n10 5\n11\t7 // the line\n\n 12.0  1e0\n",
    "keV, centre\r10 5\r\r11 7\r12 1\r", // an old Macintosh's, and some spreadsheets'
    "28 kVp W\n50\nE(MeV) at centre\tfluence\n0.010\t5\n0.011\t7\n0.012\t1\n",
    "centre_eV,N\n\"10000\",\"5\"\n\"11000\",\"7\"\n\"12000\",\"1\"\n",
    "\"Energy (keV)\",\"at centre\"\n\"10,0\",\"5,00\"\n\"11,0\",\"7,00\"\n\"12,0\",\"1,00\"\n",
    "keV centre\n12 1\n11 7\n10 5\n", "keV centre\n10,0 5,0\n11,0 7,0\n12,0 1,0\n",
    "from, to [keV], N\n9.5, 10.5, 5\n10.5, 11.5, 7\n11.5, 12.5, 1\n",
    "lower edge (keV), N\n9.5, 5\n10.5, 7\n11.5, 1\n",
    "keV\n9.5 5\n10.5 7\n11.5 1\n12.5\n",                       // the last edge alone
    "# keV, centre\n 10.D0 5.D0\n 11.d+0 0.7D1\n 1.2D+01 1.\n", // Fortran's doubles
  };
  for (const char* const text : same)
  {
    std::vector<std::string> said;
    EXPECT_EQ(ReadText(text, &said), "10:5 11:7 12:1") << text;
    EXPECT_THAT(said, testing::IsEmpty()) << text;
  }
  // Two lines, as xpecgen writes them.
  EXPECT_EQ(ReadText("keV, centre\n9,10,11,12\n0,5,7,1\n"), "9:0 10:5 11:7 12:1");
  // An edge may be 0. Densities count with the width of their bin.
  EXPECT_EQ(ReadText("keV\n0 0\n10 4\n20 2\n40 0\n"), "5:0 15:4 30:2");
  for (const char* const titles : { "centre keV, N per keV", "# centre [keV]  photons per keV",
         "centre (keV), Fluence (1/(mm2 keV))", "centre, per keV" })
  {
    EXPECT_EQ(ReadText(titles + std::string("\n10 4\n20 2\n40 1\n")), "10:40 20:30 40:20");
  }
  EXPECT_EQ(ReadText("keV centre\n59.54 1\n"), "59.54:1");
}

TEST(SpectrumIO, WhatIsInferredIsSaid)
{
  for (const auto& [text, unit, keV] :
    { std::tuple{ "10000 5\n28000 7\n", "eV (up to 28000)", "10:5 28:7" },
      { "10 5\n28 7\n", "keV (up to 28)", "10:5 28:7" },
      { "0.1 5\n0.45 7\n", "MeV (up to 0.45)", "100:5 450:7" } })
  {
    std::vector<std::string> said;
    EXPECT_EQ(ReadText(text, &said), keV);
    ASSERT_EQ(said.size(), 1u);
    EXPECT_THAT(said[0], testing::HasSubstr("s.txt: takes energies as " + std::string(unit)));
    EXPECT_THAT(said[0], testing::HasSubstr("values as photons of bins around their energies"));
  }
  std::vector<std::string> said;
  EXPECT_EQ(ReadText("Energy [keV], Fluence [1/keV/cm2]\n10,4\n20,2\n40,1\n", &said),
    "10:40 20:30 40:20");
  EXPECT_THAT(said, testing::ElementsAre(testing::HasSubstr("takes values as photons per keV")));
}

TEST(SpectrumIO, OtherTablesAreRefusedByLine)
{
  const auto refusal = [](const std::string& text) { return RefusalOf([&] { ReadText(text); }); };
  EXPECT_THAT(refusal("keV\n10 1 2 3\n"), testing::HasSubstr("line 2: expected an energy"));
  EXPECT_THAT(refusal("10 1\n11 x\n"), testing::HasSubstr("line 2: expected an energy"));
  EXPECT_THAT(refusal("10 1\n10 2\n"), testing::HasSubstr("line 2: expected a positive energy"));
  EXPECT_THAT(refusal("10 nan\n11 1\n"), testing::HasSubstr("expected a number of photons"));
  EXPECT_THAT(refusal("1 2 3\n3 4 1\n"), testing::HasSubstr("line 2: expected an energy"));
  EXPECT_THAT(refusal("E (keV), N\n10000, 1\n28000, 2\n"),
    testing::HasSubstr("found energies up to 28000 eV, although the titles name another unit"));
  EXPECT_THAT(refusal("E (MeV)\n1 2\n6 3\n"), testing::HasSubstr("another unit"));
  EXPECT_THAT(refusal("10000000 1\n"), testing::HasSubstr("up to 1e+07 eV"));
  EXPECT_THAT(refusal("\xff\xfe"
                      "1"),
    testing::HasSubstr("found UTF-16"));
  // EGSnrc's line of three numbers, a column for each tube, SpekPy's characteristic radiation.
  EXPECT_THAT(refusal("60 kV\n59, 0.001, 1\n0.010, 5\n"),
    testing::HasSubstr("line 3: expected an energy and a number of photons, or both edges of a bin "
                       "and its photons, found 2 number(s), after 3 in line 2"));
  EXPECT_THAT(refusal("keV,20 kV,21 kV,22 kV\n10,1,2,3\n"), testing::HasSubstr("keep the column"));
  EXPECT_THAT(refusal("keV; total; lines\n10.5;4;0\n11.5;5;0\n"), testing::HasSubstr("keep one"));
  EXPECT_THAT(refusal("energy, photons\n"), testing::HasSubstr("found none"));
  // Decimal, or a thousand?
  EXPECT_THAT(refusal("keV\n\"10,0\",\"1,200\"\n"), testing::HasSubstr("found 4 number(s)"));
  EXPECT_THAT(refusal("0 3\n"), testing::HasSubstr("at least two edges"));
  // A negative value ends nothing here, wherever it stands.
  EXPECT_THAT(refusal("keV,photons\n20,1\n25,-2\n30,3\n"),
    testing::HasSubstr("line 3: expected a number of photons, found -2"));
  EXPECT_THAT(refusal("keV,photons\n15,-1e-9\n20,1\n30,3\n"),
    testing::HasSubstr("line 2: expected a number of photons, found -1e-09"));
  EXPECT_THAT(refusal("keV\n9.5 5\n10.5 7\n11.5 -1\n"), testing::HasSubstr("line 4"));
  EXPECT_THAT(refusal("keV photons\n20.Q0 1\n30.Q0 3\n"),
    testing::HasSubstr("line 2: expected an energy and a number of photons, found '20.Q0 1'"));
  EXPECT_THAT(refusal("0 0\n10\n"), testing::HasSubstr("photons"));
  EXPECT_THAT(refusal("20 1\n15 2\n10\n"), testing::HasSubstr("line 2: expected a positive"));
  // Our own form in another unit.
  const TemporaryFolder folder;
  EXPECT_THAT(SpectrumRefusal(folder.Write("k.spc", "10 1\n28 -1\n")),
    testing::HasSubstr("expected energies in eV, found none above 28"));
}

TEST(SpectrumIO, ResponsesAreLinesOfEnergyAndSignal)
{
  const TemporaryFolder folder;
  const DetectorResponse response =
    ReadDetectorResponse(folder.Write("r.csv", "# keV, signal\n10, 0.5\n30, 1.5 # end\r\n"));
  EXPECT_NEAR(response.Signal(20), 1, 1e-12);
  EXPECT_EQ(response.Signal(5), 0.5);
  EXPECT_EQ(response.Signal(99), 1.5);
  for (const char* damaged :
    { "", "10\n", "10, x\n", "10, 1, 2\n", "10, 1\n9, 1\n", "10, -1\n", "10, nan\n", "-1, 1\n" })
  {
    EXPECT_THROW(ReadDetectorResponse(folder.Write("d.csv", damaged)), InputError) << damaged;
  }
  EXPECT_THROW(ReadDetectorResponse(folder.File("absent.csv")), InputError);
}

TEST(DetectorIO, LineSpreadIsReadOfOneSideOrTheMeanOfBoth)
{
  const TemporaryFolder folder;
  const LineSpread one = ReadLineSpread(folder.Write("l.csv", "mm, value\n0, 2\n0.1, 1\n0.4, 0\n"));
  EXPECT_EQ(one.DistancesMm, (std::vector<double>{ 0, 0.1, 0.4 }));
  EXPECT_EQ(one.Values, (std::vector<double>{ 2, 1, 0 }));
  const LineSpread both = ReadLineSpread(folder.Write("l.csv", "-0.2 1\n0 4\n0.1 3\n0.2 2\n"));
  EXPECT_EQ(both.DistancesMm, (std::vector<double>{ 0, 0.1, 0.2 }));
  EXPECT_EQ(both.Values[0], 4);
  EXPECT_NEAR(both.Values[1], 0.5 * (3 + 2.5), 1e-12);
  EXPECT_EQ(both.Values[2], 1.5);
  for (const char* damaged : { "", "0, 1\n", "0, 1\n0, 1\n", "0, 1\n1, -1\n", "0.1, 1\n0.2, 1\n",
         "0, 0\n1, 0\n", "0, 1, 2\n" })
  {
    EXPECT_THROW(ReadLineSpread(folder.Write("d.csv", damaged)), InputError) << damaged;
  }
  EXPECT_THROW(ReadLineSpread(folder.File("absent.csv")), InputError);
}

TEST(SpectrumIO, DamagedFilesAreRefusedByLine)
{
  TemporaryFolder folder;
  folder.Write("a.spc", "# comment\n10e3 5\n11e3 x\n");
  EXPECT_THAT(SpectrumRefusal(folder.File("a.spc")), testing::HasSubstr("line 3"));
  folder.Write("a.spc", "10e3 5\n9e3 5\n11e3 -1\n");
  EXPECT_THAT(SpectrumRefusal(folder.File("a.spc")), testing::HasSubstr("line 2"));
  folder.Write("a.spc", "10e3 5\n11e3 5\n");
  EXPECT_THAT(SpectrumRefusal(folder.File("a.spc")), testing::HasSubstr("negative"));
}
