// SPDX-License-Identifier: Apache-2.0
#include "Refusals.h"
#include "mammoray/Segmentation/Private/Plausibility.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace
{
using namespace mammoray;
using test::NotRefused;
using test::RefusalOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// What a breast of middling size has: 600 cm3, a sixth of it gland.
SegmentationResult MiddlingBreast()
{
  SegmentationResult result;
  result.Measures.FatCm3 = 400;
  result.Measures.GlandCm3 = 100;
  result.Measures.SkinCm3 = 100;
  result.Measures.GlandFraction = 100.0 / 600;
  result.Measures.DepthMm = 80;
  result.Measures.GlandOverMuscle = 1;
  return result;
}

std::string VerdictOn(SegmentationResult& result, int breasts = 1, bool glandGiven = false)
{
  return RefusalOf([&] { Judge(result, breasts, glandGiven); });
}

TEST(QualityOf, DoubtsABreastWhoseBordersHardlyShow)
{
  const BreastQuality good = QualityOf(BreastSide::Left, { 200, 160, 150, 200 }, true);
  EXPECT_EQ(good.Side, BreastSide::Left);
  EXPECT_DOUBLE_EQ(good.WallSeen, 0.8);
  EXPECT_DOUBLE_EQ(good.WallAgreement, 0.75);
  EXPECT_DOUBLE_EQ(good.SkinSeen, 1);
  EXPECT_EQ(good.Doubt, "");
  EXPECT_EQ(QualityOf(BreastSide::Right, { 200, 60, 150, 100 }, true).Doubt,
    "the right breast is doubtful: the chest wall shows in 0.3 of its columns (expected 0.5), and "
    "the skin stands out from the noise in 0.5 of its columns (expected 0.8)");
  EXPECT_THAT(QualityOf(BreastSide::Both, { 200, 160, 20, 200 }, true).Doubt,
    HasSubstr("the breast is doubtful: two ways to find the chest wall agree in 0.1"));
  EXPECT_THAT(QualityOf(BreastSide::Both, {}, true).Doubt, HasSubstr("in 0 of its columns"));
  EXPECT_THAT(QualityOf(BreastSide::Both, { 200, 160, 150, 200 }, false).Doubt,
    HasSubstr("the breast is doubtful: the image does not tell whether fat is bright"));
  SegmentationResult result = MiddlingBreast();
  result.Quality = { good, QualityOf(BreastSide::Right, { 200, 60, 150, 200 }, true) };
  EXPECT_EQ(VerdictOn(result), NotRefused);
  EXPECT_THAT(result.Warnings, ElementsAre(result.Quality[1].Doubt));
}

TEST(Measure, CountsTheVolumesAndTheLevels)
{
  SegmentationResult result;
  result.Labels.Size = { 10, 1, 1 };
  result.Labels.Spacing = { 10, 5, 20 }; // 1 cm3 a voxel
  result.Labels.Voxels = { 0, 1, 1, 1, 2, 2, 2, 3, 4, 4 };
  static_cast<VolumeGrid&>(result.Corrected) = result.Labels;
  result.Corrected.Voxels = { 0, 1, 1, 1, 0.5f, 0.4f, 0.3f, 0.6f, 0.2f, 0.2f };
  result.MuscleLevel = 0.2;
  Measure(result);
  EXPECT_DOUBLE_EQ(result.Measures.FatCm3, 3);
  EXPECT_DOUBLE_EQ(result.Measures.GlandCm3, 3);
  EXPECT_DOUBLE_EQ(result.Measures.SkinCm3, 1);
  EXPECT_DOUBLE_EQ(result.Measures.ChestWallCm3, 2);
  EXPECT_DOUBLE_EQ(result.Measures.GlandFraction, 3.0 / 7);
  EXPECT_NEAR(result.Measures.GlandOverMuscle, 0.4 / 0.2, 1e-7); // floats
}

TEST(Measure, WithoutGlandOrMuscleHasNoRatio)
{
  SegmentationResult result;
  result.Labels.Size = { 3, 1, 1 };
  result.Labels.Voxels = { 0, 1, 4 };
  result.Corrected.Voxels = { 0, 1, 0.4f };
  result.MuscleLevel = 0.4;
  Measure(result);
  EXPECT_EQ(result.Measures.GlandFraction, 0);
  EXPECT_EQ(result.Measures.GlandOverMuscle, 0);
  result.Labels.Voxels = { 0, 2, 4 };
  result.MuscleLevel = 0;
  Measure(result);
  EXPECT_EQ(result.Measures.GlandOverMuscle, 0);
  EXPECT_EQ(result.Measures.GlandFraction, 1);
  result.Labels.Voxels = { 0, 0, 4 };
  Measure(result);
  EXPECT_EQ(result.Measures.GlandFraction, 0);
}

TEST(Judge, TakesAMiddlingBreastWithoutAWord)
{
  SegmentationResult result = MiddlingBreast();
  EXPECT_EQ(VerdictOn(result), NotRefused);
  EXPECT_THAT(result.Warnings, IsEmpty());
}

TEST(Judge, RefusesWhatNoBreastIs)
{
  SegmentationResult small = MiddlingBreast();
  small.Measures.FatCm3 = 10;
  small.Measures.GlandCm3 = 2;
  small.Measures.SkinCm3 = 2.7;
  EXPECT_THAT(VerdictOn(small), test::Mentions("15 to 5000 cm3", "found 15"));
  small.Measures.SkinCm3 = 3.1;
  EXPECT_EQ(VerdictOn(small), NotRefused);
  // Of each of two.
  small.Measures.FatCm3 = 20;
  EXPECT_THAT(VerdictOn(small, 2), HasSubstr("found 13"));
  SegmentationResult large = MiddlingBreast();
  large.Measures.FatCm3 = 5100;
  EXPECT_THAT(VerdictOn(large), HasSubstr("found 5300"));
  EXPECT_EQ(VerdictOn(large, 2), NotRefused);
  SegmentationResult deep = MiddlingBreast();
  deep.Measures.DepthMm = 301;
  EXPECT_THAT(VerdictOn(deep), test::Mentions("300 mm", "301"));
  SegmentationResult gland = MiddlingBreast();
  gland.Measures.GlandFraction = 0.91;
  EXPECT_THAT(VerdictOn(gland), test::Mentions("gland", "0.9", "0.91"));
  // The caller's own threshold is the caller's own concern.
  EXPECT_EQ(VerdictOn(gland, 1, true), NotRefused);
  EXPECT_THAT(gland.Warnings, IsEmpty());
}

TEST(Judge, WarnsOfWhatFewBreastsAre)
{
  const auto warningsOf = [](const std::function<void(BreastMeasures&)>& change)
  {
    SegmentationResult result = MiddlingBreast();
    change(result.Measures);
    EXPECT_EQ(VerdictOn(result), NotRefused);
    return result.Warnings;
  };
  EXPECT_THAT(warningsOf(
                [](BreastMeasures& m)
                {
                  m.FatCm3 = 40;
                  m.GlandCm3 = 8;
                  m.SkinCm3 = 10;
                }),
    ElementsAre(HasSubstr("a breast of 58 cm3")));
  EXPECT_THAT(warningsOf([](BreastMeasures& m) { m.FatCm3 = 2900; }),
    ElementsAre(HasSubstr("a breast of 3100 cm3")));
  EXPECT_THAT(warningsOf([](BreastMeasures& m) { m.GlandFraction = 0.004; }),
    ElementsAre(HasSubstr("gland is 0.004 of the breast")));
  EXPECT_THAT(warningsOf([](BreastMeasures& m) { m.GlandFraction = 0.61; }),
    ElementsAre(HasSubstr("gland is 0.61 of the breast")));
  EXPECT_THAT(warningsOf([](BreastMeasures& m) { m.SkinCm3 = 300; }),
    ElementsAre(HasSubstr("skin is 0.38 of the breast")));
  EXPECT_THAT(warningsOf([](BreastMeasures& m) { m.GlandOverMuscle = 2.1; }),
    ElementsAre(HasSubstr("gland is 2.1 times as bright as muscle")));
  EXPECT_THAT(warningsOf([](BreastMeasures& m) { m.GlandOverMuscle = 0.4; }),
    ElementsAre(HasSubstr("gland is 0.4 times as bright as muscle")));
  // 0 says that nothing was measured.
  EXPECT_THAT(warningsOf([](BreastMeasures& m) { m.GlandOverMuscle = 0; }), IsEmpty());
}
}
