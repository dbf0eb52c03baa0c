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
ScatterKernels SmallTable()
{
  ScatterKernels kernels;
  kernels.Composition = "H2O";
  kernels.DensityGPerCm3 = 1;
  kernels.EnergiesKeV = { 20, 30 };
  kernels.ThicknessesMm = { 40 };
  kernels.GapsMm = { 0, 10 };
  kernels.RadiiMm = { 0, 50 };
  kernels.AnglesDeg = { 0, 45, 90 };
  kernels.Shares = { 0.2F, 0.1F, 0.25F, 0.125F, 0.5F, 0.25F, 0.0625F, 0.5F };
  kernels.Multiple = { 0.25F, 0.5F };
  return kernels;
}

TEST(ScatterData, ATableComesBackAsItWasWritten)
{
  const test::TemporaryFolder folder;
  const std::string path = folder.File("table.csv");
  WriteScatterKernels(SmallTable(), "made by a test", path);
  const ScatterKernels back = ReadScatterKernels(path);
  const ScatterKernels kernels = SmallTable();
  EXPECT_EQ(back.Composition, kernels.Composition);
  EXPECT_EQ(back.EnergiesKeV, kernels.EnergiesKeV);
  EXPECT_EQ(back.AnglesDeg, kernels.AnglesDeg);
  EXPECT_EQ(back.Multiple, kernels.Multiple);
  ASSERT_EQ(back.Shares.size(), kernels.Shares.size());
  for (std::size_t place = 0; place < back.Shares.size(); ++place)
  {
    EXPECT_NEAR(back.Shares[place], kernels.Shares[place], 5e-3 * kernels.Shares[place]);
  }
  // Between energies and gaps linearly, as at the ends beyond.
  EXPECT_NEAR(back.At(25, 0, 5)[0], 0.25 * (0.2 + 0.25 + 0.5 + 0.0625), 2e-3);
  EXPECT_NEAR(back.At(90, 0, 90)[1], 0.5, 1e-3);
  EXPECT_NEAR(back.MultipleAt(25, 0), 0.375, 1e-6);
}

TEST(ScatterData, DamagedTablesAreRefusedWithTheirPlace)
{
  const test::TemporaryFolder folder;
  const std::string path = folder.File("table.csv");
  WriteScatterKernels(SmallTable(), "made by a test", path);
  const std::string sound = test::ReadFile(path);
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
