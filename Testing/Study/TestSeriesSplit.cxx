// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/Private/HeaderRules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

namespace
{
using namespace mammoray;

/// `phases` volumes of `count` axial slices, 2 mm apart, of one series; shuffled.
std::vector<DicomHeader> ShuffledSlices(int count, int phases,
  const std::function<void(DicomHeader&, int slice, int phase)>& change)
{
  std::vector<DicomHeader> slices;
  for (int phase = 0; phase < phases; ++phase)
  {
    for (int slice = 0; slice < count; ++slice)
    {
      DicomHeader header;
      header.Path = std::to_string(phase) + "/" + std::to_string(slice);
      header.SeriesInstanceUid = "1.2.3";
      header.ImageType = { "ORIGINAL", "PRIMARY" };
      header.Rows = header.Columns = 64;
      header.RowSpacingMm = header.ColumnSpacingMm = 4;
      header.Position = Vector3{ -128, -128, 2.0 * slice };
      change(header, slice, phase);
      slices.push_back(header);
    }
  }
  std::mt19937 generator(4);
  std::shuffle(slices.begin(), slices.end(), generator);
  return slices;
}

const auto AsMade = [](DicomHeader&, int, int) {};

TEST(SeriesSplit, OneVolumeIsInTheOrderOfItsGrid)
{
  const auto volumes = SplitIntoVolumes(ShuffledSlices(20, 1, AsMade));
  ASSERT_EQ(volumes.size(), 1u);
  const StudySeries& series = volumes.front();
  ASSERT_TRUE(series.Grid);
  EXPECT_EQ(series.Grid->Size, (std::array<int, 3>{ 64, 64, 20 }));
  EXPECT_DOUBLE_EQ(series.Grid->Spacing[2], 2);
  EXPECT_DOUBLE_EQ(series.SliceSpacingMm, 2);
  ASSERT_EQ(series.Files.size(), 20u);
  for (int slice = 0; slice < 20; ++slice)
  {
    EXPECT_EQ(series.Files[static_cast<std::size_t>(slice)], "0/" + std::to_string(slice));
  }
}

TEST(SeriesSplit, PhasesAreToldApartByWhatTellsThem)
{
  using Change = std::function<void(DicomHeader&, int, int)>;
  const Change keys[] = {
    [](DicomHeader& h, int, int phase) { h.TemporalPosition = phase + 1; },
    [](DicomHeader& h, int, int phase) { h.AcquisitionNumber = phase + 9; },
    [](DicomHeader& h, int, int phase) { h.TriggerTimeMs = 60000.0 * phase; },
    [](DicomHeader& h, int, int phase) { h.AcquisitionTime = "10150" + std::to_string(phase); },
    [](DicomHeader& h, int, int phase) { h.ContentTime = "10150" + std::to_string(phase); },
    // By nothing but their numbers.
    [](DicomHeader& h, int slice, int phase) { h.InstanceNumber = 100 * phase + slice; },
    // A time of each slice's own tells no phases, the acquisition does.
    [](DicomHeader& h, int slice, int phase)
    {
      h.AcquisitionNumber = phase;
      h.ContentTime = std::to_string(100000 + 1000 * phase + slice);
    },
  };
  for (std::size_t key = 0; key < std::size(keys); ++key)
  {
    const auto volumes = SplitIntoVolumes(ShuffledSlices(15, 3, keys[key]));
    ASSERT_EQ(volumes.size(), 3u) << key;
    for (int phase = 0; phase < 3; ++phase)
    {
      const StudySeries& series = volumes[static_cast<std::size_t>(phase)];
      EXPECT_EQ(series.Phase, phase + 1) << key;
      EXPECT_EQ(series.Phases, 3) << key;
      ASSERT_TRUE(series.Grid) << key;
      ASSERT_EQ(series.Files.size(), 15u) << key;
      EXPECT_EQ(series.Files.front(), std::to_string(phase) + "/0") << key;
      EXPECT_EQ(series.Files.back(), std::to_string(phase) + "/14") << key;
    }
  }
}

TEST(SeriesSplit, KindsEchoesAndSeriesAreApart)
{
  const auto kinds = SplitIntoVolumes(ShuffledSlices(15, 2,
    [](DicomHeader& h, int, int phase) { h.ImageType.push_back(phase == 0 ? "W" : "F"); }));
  EXPECT_EQ(kinds.size(), 2u);
  const auto echoes = SplitIntoVolumes(
    ShuffledSlices(15, 2, [](DicomHeader& h, int, int phase) { h.EchoTimeMs = 2.4 + phase; }));
  EXPECT_EQ(echoes.size(), 2u);
  EXPECT_EQ(echoes.front().Phases, 1);
  const auto series = SplitIntoVolumes(ShuffledSlices(15, 2,
    [](DicomHeader& h, int, int phase) { h.SeriesInstanceUid += std::to_string(phase); }));
  EXPECT_EQ(series.size(), 2u);
  // What is the same but for rounding stays together.
  const auto rounded = SplitIntoVolumes(ShuffledSlices(15, 1,
    [](DicomHeader& h, int slice, int)
    {
      h.EchoTimeMs = 2.4 + 1e-5 * slice;
      h.AlongRow = { 1, 1e-6 * slice, 0 };
    }));
  EXPECT_EQ(rounded.size(), 1u);
}

TEST(SeriesSplit, LocalizersAndGapsHaveNoGrid)
{
  const auto planes = SplitIntoVolumes(ShuffledSlices(20, 1,
    [](DicomHeader& h, int slice, int) {
      h.AlongRow = slice % 2 == 0 ? Vector3{ 1, 0, 0 } : Vector3{ 0, 0, 1 };
    }));
  ASSERT_EQ(planes.size(), 1u);
  EXPECT_THAT(planes.front().LeftOut, testing::HasSubstr("several directions"));
  const auto gap = SplitIntoVolumes(ShuffledSlices(20, 1,
    [](DicomHeader& h, int slice, int) { (*h.Position)[2] += slice > 9 ? 2 : 0; }));
  ASSERT_EQ(gap.size(), 1u);
  EXPECT_FALSE(gap.front().Grid);
  EXPECT_EQ(gap.front().WhyNoGrid,
    "missing slices (1, the first after slice 10; 20 slices, 2.11 mm apart on average)");
  EXPECT_EQ(gap.front().Files.size(), 20u);
  // Two slices once more.
  std::vector<DicomHeader> doubled = ShuffledSlices(20, 1, AsMade);
  doubled.push_back(doubled[4]);
  doubled.push_back(doubled[9]);
  EXPECT_THAT(SplitIntoVolumes(doubled).front().WhyNoGrid,
    testing::StartsWith("doubled slices (2 of 22 lie where another one does: duplicates"));
  const auto uneven = SplitIntoVolumes(ShuffledSlices(20, 1,
    [](DicomHeader& h, int slice, int) { (*h.Position)[2] += slice == 9 ? 0.7 : 0; }));
  EXPECT_EQ(uneven.front().WhyNoGrid, "slices at uneven distances (1.30 to 2.70 mm)");
  const auto nowhere =
    SplitIntoVolumes(ShuffledSlices(20, 1, [](DicomHeader& h, int, int) { h.Position.reset(); }));
  ASSERT_EQ(nowhere.size(), 1u);
  EXPECT_FALSE(nowhere.front().Grid);
}
}
