// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ScatterData.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace
{
using namespace mammoray;

/// One ring, two energies and gaps.
constexpr const char* SmallTable = R"(# made by a test
composition,H2O
density_g_per_cm3,1
energies_keV,20,30
thicknesses_mm,40
gaps_mm,0,10
radii_mm,0,50
angles_deg,0,45,90
multiple,0.25,0.5
shares,0.2,0.1
shares,0.25,0.125
shares,0.5,0.25
shares,0.0625,0.5
)";

TEST(ScatterData, ATableIsReadAndInterpolated)
{
  const test::TemporaryFolder folder;
  const ScatterKernels back = ReadScatterKernels(folder.Write("table.csv", SmallTable));
  EXPECT_EQ(back.Composition, "H2O");
  EXPECT_EQ(back.DensityGPerCm3, 1);
  EXPECT_THAT(back.EnergiesKeV, testing::ElementsAre(20, 30));
  EXPECT_THAT(back.ThicknessesMm, testing::ElementsAre(40));
  EXPECT_THAT(back.GapsMm, testing::ElementsAre(0, 10));
  EXPECT_THAT(back.RadiiMm, testing::ElementsAre(0, 50));
  EXPECT_THAT(back.AnglesDeg, testing::ElementsAre(0, 45, 90));
  EXPECT_THAT(back.Multiple, testing::ElementsAre(0.25F, 0.5F));
  EXPECT_THAT(back.Shares,
    testing::ElementsAre(0.2F, 0.1F, 0.25F, 0.125F, 0.5F, 0.25F, 0.0625F, 0.5F));
  // Between energies and gaps linearly, as at the ends beyond.
  EXPECT_NEAR(back.At(25, 0, 5)[0], 0.25 * (0.2 + 0.25 + 0.5 + 0.0625), 1e-7);
  EXPECT_NEAR(back.At(90, 0, 90)[1], 0.5, 1e-7);
  EXPECT_NEAR(back.MultipleAt(25, 0), 0.375, 1e-6);
}

TEST(ScatterData, DamagedTablesAreRefusedWithTheirPlace)
{
  const test::TemporaryFolder folder;
  const std::string sound = SmallTable;
  const auto refusal = [&](const std::string& from, const std::string& to)
  {
    std::string text = sound;
    text.replace(text.find(from), from.size(), to);
    const std::string damaged = folder.Write("damaged.csv", text);
    try
    {
      ReadScatterKernels(damaged);
    }
    catch (const InputError& error)
    {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  EXPECT_THAT(refusal("gaps_mm", "holes_mm"), testing::HasSubstr("line 6: expected the name"));
  EXPECT_THAT(refusal("0,45,90", "0,90,45"), testing::HasSubstr("expected ascending angles"));
  EXPECT_THAT(refusal("0.25,0.5", "0.25,1.5"), testing::HasSubstr("shares of multiple"));
  EXPECT_THAT(refusal("shares,0.2", "shares,-0.2"), testing::HasSubstr("not negative"));
  EXPECT_THAT(refusal("shares,0.2", "shares,x"), testing::HasSubstr("line 10: expected numbers"));
  EXPECT_THAT(refusal("density_g_per_cm3,1", "# none"), testing::HasSubstr("one density"));
  EXPECT_THAT(refusal("shares,0.2,0.1\n", ""), testing::HasSubstr("expected 8 shares"));
  EXPECT_EQ(refusal("made by", "changed by"), "taken");
}
}
