// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Study/StudyAnswers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace
{
using namespace mammoray;
using test::RefusalOf;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

/// Three points in CC, pixels of 0.2 mm, the last behind the receptor's edge; one view more.
StudyTruth SmallTruth()
{
  StudyTruth truth;
  truth.MriPoints = { { 0, 0, 0 }, { 1, 0, 0 }, { 2, 0, 0 } };
  TrueView view;
  view.View = "CC";
  view.Receptor = { { 0, 10 }, { 20, 10 }, { 0, -2 } };
  view.Pixels = { { 50, 100 }, { 50, 200 }, { -10, 100 } };
  view.Gantry = { { 0, 9, 20 }, { 18, 9, 20 }, { 0, -2, 20 } };
  truth.Views = { view, view };
  truth.Views[1].View = "MLO";
  return truth;
}

TEST(StudyAnswers, AreScoredInMillimetres)
{
  const std::vector<StudyAnswer> answers{ { "CC", 1, { 53, 204 }, Vector3{ 18, 9, 22.5 } },
    { "CC", 2, { -10, 95 }, Vector3{ 0, -2, 20 } } };
  const std::vector<AnswerScore> scores = ScoreAnswers(SmallTruth(), answers);
  ASSERT_EQ(scores.size(), 1u);
  EXPECT_EQ(scores[0].View, "CC");
  EXPECT_THAT(scores[0].Imaged.OnReceptorMm, ElementsAre(testing::DoubleNear(1, 1e-12)));
  EXPECT_THAT(scores[0].Imaged.InSpaceMm, ElementsAre(2.5));
  EXPECT_THAT(scores[0].Behind.OnReceptorMm, ElementsAre(testing::DoubleNear(1, 1e-12)));
  EXPECT_EQ(scores[0].Missing, 1u);
}

TEST(StudyAnswers, WithoutDepthHaveNoErrorInSpace)
{
  const std::vector<StudyAnswer> answers{ { "MLO", 0, { 50, 100 }, {} },
    { "MLO", 1, { 50, 200 }, Vector3{ 18, 9, 20 } } };
  const std::vector<AnswerScore> scores = ScoreAnswers(SmallTruth(), answers);
  ASSERT_EQ(scores.size(), 1u);
  EXPECT_EQ(scores[0].View, "MLO");
  EXPECT_THAT(scores[0].Imaged.OnReceptorMm, ElementsAre(0, 0));
  EXPECT_THAT(scores[0].Imaged.InSpaceMm, testing::IsEmpty());
}

TEST(StudyAnswers, AreReadWithAndWithoutDepth)
{
  const TemporaryFolder folder;
  const std::vector<StudyAnswer> read = ReadStudyAnswers(folder.Write("answers.csv",
    "view,point,column,row,x,y,z\nCC,7,1.500,-2.250,3.000,4.000,-5.125\n"));
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].View, "CC");
  EXPECT_EQ(read[0].Point, 7u);
  EXPECT_EQ(read[0].Pixel, (std::array<double, 2>{ 1.5, -2.25 }));
  EXPECT_EQ(read[0].Gantry, (Vector3{ 3, 4, -5.125 }));
  // Three lines of somebody's spreadsheet.
  const std::vector<StudyAnswer> flat = ReadStudyAnswers(
    folder.Write("three.csv", "view,point,column,row\r\nCC,0,51,100\r\nMLO,0,1,2\r\n"));
  ASSERT_EQ(flat.size(), 2u);
  EXPECT_FALSE(flat[0].Gantry);
  EXPECT_NEAR(ScoreAnswers(SmallTruth(), flat)[0].Imaged.OnReceptorMm.front(), 0.2, 1e-12);
}

TEST(StudyAnswers, RefuseWhatIsNoAnswer)
{
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& rows)
  {
    return RefusalOf(
      [&] { ReadStudyAnswers(folder.Write("answers.csv", "view,point,column,row\n" + rows)); });
  };
  EXPECT_THAT(refused("ML,0,1,2\n"), HasSubstr("line 2: expected the view CC or MLO, found 'ML,0"));
  EXPECT_THAT(refused("CC,-1,1,2\n"), HasSubstr("expected a point's number"));
  EXPECT_THAT(refused("CC,0.5,1,2\n"), HasSubstr("expected a point's number"));
  EXPECT_THAT(refused("CC,0,1,2\nCC,0,3,4\n"), HasSubstr("line 3: expected each point once"));
  EXPECT_THAT(refused("CC,0,nan,2\n"), HasSubstr("expected a number in column 3"));
  EXPECT_THAT(refused("CC,0,1\n"), HasSubstr("expected 4 values (view,point,column,row)"));
  EXPECT_THAT(RefusalOf([&] { ReadStudyAnswers(folder.Write("answers.csv", "point,x\n")); }),
    HasSubstr("line 1: expected view,point,column,row or view,point,column,row,x,y,z"));
  EXPECT_THAT(RefusalOf([] { ScoreAnswers(SmallTruth(), {}); }), HasSubstr("found none"));
  EXPECT_THAT(RefusalOf(
                [] {
                  ScoreAnswers(SmallTruth(), { { "CC", 3, { 0, 0 }, {} } });
                }),
    HasSubstr("expected the study's 3 points in its views, found point 3 in CC"));
}
}
