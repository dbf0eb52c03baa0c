// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/Private/SpectrumIO.h"
#include "mammoray/IO/ShippedData.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
