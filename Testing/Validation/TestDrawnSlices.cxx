// SPDX-License-Identifier: Apache-2.0
// Boxes of labels against drawn boxes that are shifted by known lengths.
#include "DrawnSlices.h"
#include "Files.h"
#include "LabelShapes.h"
#include "Refusals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

using namespace mammoray;

namespace
{
/// Fat from y = -20 to 10 mm with gland from -10 to 0, muscle from 10 to 25; 60 mm wide.
int BoxLabel(const Vector3& point)
{
  const double across = std::max(std::abs(point[0]), std::abs(point[2]));
  if (across > 30 || point[1] < -20 || point[1] > 25)
  {
    return 0;
  }
  return point[1] > 10 ? 4 : across < 10 && point[1] > -10 && point[1] < 0 ? 2 : 1;
}

const LabelVolume& Box()
{
  static const LabelVolume box = test::LabelledCube(80, 1, BoxLabel);
  return box;
}

/// The box with its front 2 mm, its wall 1 mm and its gland 2 mm too far back.
DrawnSlice ShiftedAxial()
{
  DrawnSlice slice;
  slice.PositionMm = 0.25;
  slice.Judged = { -25, 25, -30, 20 };
  slice.Outline = { { { -30, 30 }, { -30, -18 }, { 30, -18 }, { 30, 30 } } };
  slice.ChestWall = { { { -30, 11 }, { 0, 11 }, { 30, 11 } } };
  slice.Gland = { { { -10, -8 }, { 10, -8 }, { 10, 2 }, { -10, 2 } } };
  return slice;
}
}

TEST(DrawnSlices, MeasureAShiftExactly)
{
  DrawnSlice sagittal = ShiftedAxial();
  sagittal.Normal = 0;
  sagittal.Judged = { -30, 20, -25, 25 };
  for (auto* lines : { &sagittal.Outline, &sagittal.ChestWall, &sagittal.Gland })
  {
    for (DrawnPoint& point : lines->front())
    {
      std::swap(point[0], point[1]);
      point[1] *= -1; // from the head on
    }
  }
  for (const std::vector<DrawnSlice>& slices : { std::vector{ ShiftedAxial() },
         std::vector{ sagittal }, std::vector{ sagittal, ShiftedAxial() } })
  {
    const DrawnAgreement agreement = CompareWithDrawn(Box(), slices);
    // Lengths of 30 and 29 mm with 28 in common, and of 10 with 8 in common: samples fit the grid.
    EXPECT_NEAR(agreement.BreastDice, 56.0 / 59, 1e-12);
    EXPECT_NEAR(agreement.GlandDice, 0.8, 1e-12);
    // The nearest border points are up to a quarter of a millimetre beside a drawn one.
    EXPECT_NEAR(agreement.Outline.MeanMm, 2, 0.02);
    EXPECT_NEAR(agreement.Outline.Quantile95Mm, 2, 0.02);
    EXPECT_NEAR(agreement.ChestWall.MeanMm, 1, 0.02);
    EXPECT_NEAR(agreement.ChestWall.Quantile95Mm, 1, 0.05);
  }
}

TEST(DrawnSlices, CompareClosedOutlinesWithoutAChestWall)
{
  DrawnSlice coronal;
  coronal.Normal = 1;
  coronal.PositionMm = -15;
  coronal.Judged = { -38, 38, -38, 38 };
  coronal.Outline = { { { -28, -28 }, { 28, -28 }, { 28, 28 }, { -28, 28 } } };
  const DrawnAgreement agreement = CompareWithDrawn(Box(), { coronal });
  EXPECT_NEAR(agreement.BreastDice, 2.0 * 56 * 56 / (56 * 56 + 60 * 60), 1e-12);
  EXPECT_TRUE(std::isnan(agreement.GlandDice));
  EXPECT_TRUE(std::isnan(agreement.ChestWall.MeanMm));
  // The box's corners are 2.8 mm away.
  EXPECT_NEAR(agreement.Outline.MeanMm, 2, 0.05);
  EXPECT_NEAR(agreement.Outline.Quantile95Mm, 2, 0.05);
}

TEST(DrawnSlices, LeaveUncertainPiecesOut)
{
  DrawnSlice slice = ShiftedAxial();
  slice.ChestWall = { { { -30, 11 }, { 0, 11 }, { 1, 19 }, { 30, 19 } } };
  EXPECT_GT(CompareWithDrawn(Box(), { slice }).ChestWall.MeanMm, 3);
  slice.ChestWallUncertain = { { { 0, 11 }, { 1, 19 }, { 30, 19 } } };
  const DrawnAgreement agreement = CompareWithDrawn(Box(), { slice });
  EXPECT_NEAR(agreement.ChestWall.MeanMm, 1, 0.02);
  EXPECT_NEAR(agreement.ChestWall.Quantile95Mm, 1, 0.05);
}

TEST(DrawnSlices, AMissingBorderIsInfinitelyFar)
{
  const LabelVolume withoutWall = test::LabelledCube(80, 1,
    [](const Vector3& point)
    {
      const int label = BoxLabel(point);
      return label == 4 ? 0 : label;
    });
  const DrawnAgreement agreement = CompareWithDrawn(withoutWall, { ShiftedAxial() });
  EXPECT_TRUE(std::isinf(agreement.ChestWall.MeanMm));
  EXPECT_TRUE(std::isinf(agreement.ChestWall.Quantile95Mm));
  // The back of what there is lies in front of the drawn wall.
  EXPECT_GT(agreement.Outline.MeanMm, 2);
}

TEST(DrawnSlices, ReadWhatTheProjectHolds)
{
  const std::filesystem::path folder =
    std::filesystem::path(test::DataFolder()) / "../Validation/data/uta11-CC-BY-SA-4.0";
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
  {
    if (entry.path().extension() != ".json")
    {
      continue;
    }
    ++files;
    std::array<int, 3> planes{};
    for (const DrawnSlice& slice : ReadDrawnSlices(entry.path().string()))
    {
      ++planes.at(slice.Normal);
    }
    EXPECT_THAT(planes, testing::Each(testing::Ge(2))) << entry.path();
  }
  EXPECT_EQ(files, 8);
}

TEST(DrawnSlices, RefuseWhatIsNoneInOneLine)
{
  const test::TemporaryFolder folder;
  const auto refusal = [&](const std::string& text)
  { return test::RefusalOf([&] { ReadDrawnSlices(folder.Write("a.json", text)); }); };
  EXPECT_THAT(refusal("{"), testing::HasSubstr("a.json: not a file of drawn slices"));
  EXPECT_THAT(
    refusal(R"({"slices": [{"plane": "oblique", "position": 0, "judged": [0, 1, 0, 1]}]})"),
    testing::HasSubstr("found 'oblique'"));
  EXPECT_THAT(refusal(R"({"slices": [{"plane": "axial", "position": 0, "judged": [0, 1, 0, 1]}]})"),
    testing::HasSubstr("expected one outline and one chest wall"));
}
