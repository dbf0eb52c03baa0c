// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/Private/GantryGrid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace
{
using namespace mammoray;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr PixelGrid FilmGrid{ 10, 20, 0.1, 0.2 };

/// How far the breast touches the sides where its chest wall is at one of them.
std::array<double, 4> TouchedAt(Side side)
{
  std::array<double, 4> touched{ 0, 0, 0, 0 };
  touched[static_cast<std::size_t>(side)] = 3;
  return touched;
}

Mammogram Header(const std::string& view, char laterality, const std::string& row,
  const std::string& column)
{
  Mammogram mammogram;
  mammogram.View = view;
  mammogram.Laterality = laterality;
  mammogram.RowDirection = row;
  mammogram.ColumnDirection = column;
  return mammogram;
}

RegistrationTarget Placed(const Mammogram& mammogram, Side side)
{
  RegistrationTarget target;
  target.Grid.Columns = FilmGrid.Columns;
  target.Grid.Rows = FilmGrid.Rows;
  PlaceInGantry(mammogram, FilmGrid, TouchedAt(side), target);
  return target;
}

TEST(AlongX, IsTheCosineWithGantryX)
{
  // Gantry x is cos r * left - sin r * head.
  const double half = std::sqrt(0.5);
  EXPECT_DOUBLE_EQ(AlongX("L", 0), 1);
  EXPECT_DOUBLE_EQ(AlongX("R", 0), -1);
  EXPECT_NEAR(AlongX("H", 90), -1, 1e-15);
  EXPECT_NEAR(AlongX("F", 90), 1, 1e-15);
  EXPECT_NEAR(AlongX("L", 180), -1, 1e-15);
  EXPECT_NEAR(AlongX("F", 45), half, 1e-15);
  EXPECT_NEAR(AlongX("FL", 45), 2 * half, 1e-15); // both are along it
  EXPECT_NEAR(AlongX("FR", 45), 0, 1e-15);
  EXPECT_EQ(AlongX("A", 30), 0);
  EXPECT_EQ(AlongX("", 30), 0);
}

TEST(PlaceInGantry, FollowsTheHeader)
{
  // A left CC view, hung: chest wall at the left, lateral (patient's left) up, so columns of pixels
  // run to the right: against x.
  const RegistrationTarget left = Placed(Header("CC", 'L', "A", "R"), Side::Left);
  EXPECT_THAT(left.Warnings, IsEmpty());
  EXPECT_THAT(left.Grid.ColumnStep, ElementsAre(0, 0.1));
  EXPECT_THAT(left.Grid.RowStep, ElementsAre(-0.2, 0));
  // The chest-wall edge of the first column is y = 0, the middle row x = 0.
  EXPECT_THAT(left.Grid.Origin, ElementsAre(testing::DoubleNear(1.9, 1e-12), 0.05));
  // A right one: chest wall at the right, lateral up is the patient's right, columns go left.
  const RegistrationTarget right = Placed(Header("CC", 'R', "P", "L"), Side::Right);
  EXPECT_THAT(right.Warnings, IsEmpty());
  EXPECT_THAT(right.Grid.ColumnStep, ElementsAre(0, -0.1));
  EXPECT_THAT(right.Grid.RowStep, ElementsAre(0.2, 0));
  EXPECT_NEAR(right.Grid.Origin[1], 0.95, 1e-12); // ten columns
}

TEST(PlaceInGantry, EveryCornerLiesWhereItsSideSays)
{
  // All eight ways to hang a picture: the chest wall's edge lies on y = 0 and the picture is
  // centred on x = 0, in front of it.
  for (const std::string along : { "L", "R" })
  {
    for (const Side side : { Side::Left, Side::Right, Side::Top, Side::Bottom })
    {
      const bool upright = side == Side::Left || side == Side::Right;
      const std::string inward = side == Side::Left || side == Side::Top ? "A" : "P";
      const Mammogram mammogram =
        upright ? Header("CC", 'L', inward, along) : Header("CC", 'L', along, inward);
      const RegistrationTarget target = Placed(mammogram, side);
      EXPECT_THAT(target.Warnings, IsEmpty());
      double least[2] = { 1e9, 1e9 };
      double most[2] = { -1e9, -1e9 };
      for (const double column : { -0.5, 9.5 })
      {
        for (const double row : { -0.5, 19.5 })
        {
          const ReceptorPoint corner = target.Grid.PositionOf(column, row);
          for (std::size_t axis = 0; axis < 2; ++axis)
          {
            least[axis] = std::min(least[axis], corner[axis]);
            most[axis] = std::max(most[axis], corner[axis]);
          }
        }
      }
      EXPECT_NEAR(least[1], 0, 1e-12);
      EXPECT_NEAR(most[1], upright ? 1.0 : 4.0, 1e-12);
      EXPECT_NEAR(least[0], -most[0], 1e-12);
      EXPECT_NEAR(most[0], upright ? 2.0 : 0.5, 1e-12);
      const double x = upright ? target.Grid.RowStep[0] : target.Grid.ColumnStep[0];
      EXPECT_EQ(x > 0, along == "L");
    }
  }
}

TEST(PlaceInGantry, AssumesWhatIsHungAndSaysSo)
{
  // The header says nothing: the chest wall is where the breast touches most, the breast the one
  // that hangs so, seen from above.
  const RegistrationTarget bare = Placed(Header("CC", '?', "", ""), Side::Right);
  EXPECT_THAT(bare.Warnings,
    ElementsAre(HasSubstr("taken to be at the right edge"), HasSubstr("taken as the right one"),
      HasSubstr("the lateral side is taken to be up")));
  const RegistrationTarget said = Placed(Header("CC", 'R', "P", "L"), Side::Right);
  EXPECT_EQ(bare.Grid.Origin, said.Grid.Origin);
  EXPECT_EQ(bare.Grid.ColumnStep, said.Grid.ColumnStep);
  EXPECT_EQ(bare.Grid.RowStep, said.Grid.RowStep);
  // Obliquely: the head is up, as when the header says so.
  const RegistrationTarget oblique = Placed(Header("MLO", 'L', "A", ""), Side::Left);
  EXPECT_THAT(oblique.Warnings, ElementsAre(HasSubstr("the head is taken to be up")));
  const RegistrationTarget known = Placed(Header("MLO", 'L', "A", "F"), Side::Left);
  EXPECT_THAT(known.Warnings, IsEmpty());
  EXPECT_EQ(oblique.Grid.RowStep, known.Grid.RowStep);
  // A view that is none of ours.
  EXPECT_THAT(Placed(Header("AT", 'L', "A", "R"), Side::Left).Warnings,
    ElementsAre(HasSubstr("view 'AT' is not one of")));
}

TEST(PlaceInGantry, FollowsTheHeaderAgainstThePictureAndSaysSo)
{
  const RegistrationTarget target = Placed(Header("CC", 'L', "A", "R"), Side::Right);
  EXPECT_THAT(target.Disagreements,
    ElementsAre(HasSubstr("puts the chest wall at the left edge of the picture, but the breast "
                          "touches the right edge most")));
  EXPECT_THAT(target.Grid.ColumnStep, ElementsAre(0, 0.1));
}

TEST(PlaceInGantry, AnswersTheRollOfTheView)
{
  const auto rollOf = [](const Mammogram& mammogram)
  {
    RegistrationTarget target;
    return PlaceInGantry(mammogram, FilmGrid, TouchedAt(Side::Left), target);
  };
  EXPECT_EQ(rollOf(Header("CC", 'L', "A", "R")), 0);
  const double oblique = rollOf(Header("MLO", 'L', "A", "F"));
  EXPECT_DOUBLE_EQ(std::abs(oblique), 45);
  EXPECT_DOUBLE_EQ(rollOf(Header("MLO", 'R', "P", "F")), -oblique);
}
}
