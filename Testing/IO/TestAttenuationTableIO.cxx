// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/Private/AttenuationTableIO.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using mammoray::test::RefusalOf;
using namespace mammoray;
using test::TemporaryFolder;

namespace
{
std::string TableRefusal(const std::string& path)
{
  return RefusalOf([&] { ReadAttenuationTable(path); });
}
}

TEST(AttenuationTableIO, ColumnsAreFoundByNameAndTurnedIntoKeVAndMillimetres)
{
  TemporaryFolder folder;
  const AttenuationTable table = ReadAttenuationTable(folder.Write("fat.csv",
    "# fat, nominal density 0.92 g/cm3\nmu_total_per_cm,other,energy_eV\n2,9,1e4\n1,9,2e4\n"));
  EXPECT_EQ(table.Name, "fat");
  EXPECT_EQ(table.NominalDensityGPerCm3, 0.92);
  EXPECT_THAT(table.EnergiesKeV, testing::ElementsAre(10, 20));
  EXPECT_THAT(table.MuPerMm, testing::ElementsAre(0.2, 0.1));
}

TEST(AttenuationTableIO, LinesEndAsTheyDoOnAnySystem)
{
  TemporaryFolder folder;
  for (const std::string end : { "\n", "\r\n", "\r" })
  {
    const AttenuationTable table = ReadAttenuationTable(folder.Write("a.csv",
      "# nominal density 0.92 g/cm3" + end + end + "energy_eV,mu_total_per_cm" + end + "1e4,2" +
        end + "2e4,1"));
    EXPECT_THAT(table.EnergiesKeV, testing::ElementsAre(10, 20));
    folder.Write("a.csv",
      "# nominal density 1 g/cm3" + end + "energy_eV,mu_total_per_cm" + end + "1e4,oops" + end);
    EXPECT_THAT(TableRefusal(folder.File("a.csv")), testing::HasSubstr("line 3"));
  }
}

TEST(AttenuationTableIO, DamagedFilesAreRefusedByLine)
{
  TemporaryFolder folder;
  folder.Write("a.csv", "# nominal density 1 g/cm3\nenergy_eV,mu_total_per_cm\n1e4,oops\n");
  EXPECT_THAT(TableRefusal(folder.File("a.csv")), testing::HasSubstr("line 3"));
  folder.Write("a.csv", "energy_eV,mu_total_per_cm\n1e4,1\n");
  EXPECT_THAT(TableRefusal(folder.File("a.csv")), testing::HasSubstr("nominal density"));
  folder.Write("a.csv", "# nominal density 1 g/cm3\nenergy,mu\n1e4,1\n");
  EXPECT_THAT(TableRefusal(folder.File("a.csv")), testing::HasSubstr("energy_eV"));
  EXPECT_THAT(TableRefusal(folder.File("absent.csv")), testing::HasSubstr("cannot be opened"));
}
