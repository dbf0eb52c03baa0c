// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/RegistrationResult.h"

#include "mammoray/Foundation/Error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace
{
using namespace mammoray;

/// 40 x 60 pixels of 1 mm, the breast below y = 25 mm; its outline is that line.
RegistrationTarget StraightTarget(double slope = 0)
{
  RegistrationTarget target;
  target.Grid.Columns = 40;
  target.Grid.Rows = 60;
  target.Grid.Origin = { -29.5, 0.5 };
  target.Grid.ColumnStep = { 0, 1 };
  target.Grid.RowStep = { 1, 0 };
  std::mt19937 generator(12);
  std::normal_distribution<float> normal(2.0f, 0.4f);
  for (int row = 0; row < 60; ++row)
  {
    for (int column = 0; column < 40; ++column)
    {
      const double beyond = column + 0.5 - 25 - slope * (row - 29.5);
      target.BreastMask.push_back(beyond < 0 ? 1 : 0);
      target.SignedDistanceMm.push_back(static_cast<float>(beyond / std::hypot(1, slope)));
      target.LogAttenuation.push_back(beyond < 0 ? normal(generator) : 0.0f);
    }
  }
  return target;
}

/// Its picture up to scale and offset, and a line at another height, from +x to -x.
SyntheticMammogram PictureOf(const RegistrationTarget& target, double heightMm)
{
  SyntheticMammogram synthetic;
  for (std::size_t pixel = 0; pixel < target.LogAttenuation.size(); ++pixel)
  {
    synthetic.LogAttenuation.push_back(
      target.BreastMask[pixel] ? 0.5f * target.LogAttenuation[pixel] + 3 : 0.0f);
  }
  for (double x = 41; x > -41.5; x -= 2)
  {
    synthetic.Outline.push_back({ x, heightMm });
  }
  return synthetic;
}

TEST(Compare, MeasuresTheOutlinesAndThePictures)
{
  const RegistrationTarget target = StraightTarget();
  const Similarity same = Compare(PictureOf(target, 25), target);
  EXPECT_NEAR(same.MeanOutlineDistanceMm, 0, 1e-6);
  // 1e-6 is added to the deviations of 0.4 and 0.2.
  EXPECT_NEAR(same.Correlation, 1, 1e-5);
  for (const double height : { 22.0, 28.0 })
  {
    const Similarity beside = Compare(PictureOf(target, height), target);
    EXPECT_NEAR(beside.MeanOutlineDistanceMm, 3, 1e-5) << height; // on either side
    EXPECT_NEAR(beside.LargestOutlineDistanceMm, 3, 1e-5) << height;
  }
  SyntheticMammogram inverted = PictureOf(target, 25);
  for (float& value : inverted.LogAttenuation)
  {
    value = value > 0 ? 10 - value : 0;
  }
  EXPECT_NEAR(Compare(inverted, target).Correlation, -1, 1e-5);
}

/// 100 x 100 pixels of 1.5 mm, breast in front of y = 105 mm, as thick as the plates are apart but
/// for a bulge of 20 mm, with lumps of tissue where `lumps` says so.
RegistrationTarget BulgingTarget(double (*lumps)(double x, double y))
{
  RegistrationTarget target;
  target.Grid.Columns = 100;
  target.Grid.Rows = 100;
  target.Grid.Origin = { -74.25, 0.75 };
  target.Grid.ColumnStep = { 0, 1.5 };
  target.Grid.RowStep = { 1.5, 0 };
  for (int row = 0; row < 100; ++row)
  {
    for (int column = 0; column < 100; ++column)
    {
      const double x = -74.25 + 1.5 * row;
      const double y = 0.75 + 1.5 * column;
      const double deep = 105 - y;
      const double bulge =
        deep >= 20 ? 1 : std::sqrt(std::max(0.0, 1 - std::pow(1 - deep / 20, 2)));
      target.BreastMask.push_back(deep > 0 ? 1 : 0);
      target.SignedDistanceMm.push_back(static_cast<float>(-deep));
      target.LogAttenuation.push_back(
        deep > 0 ? static_cast<float>(bulge * (2 + 0.2 * lumps(x, y))) : 0.0F);
    }
  }
  return target;
}

double Lumps(double x, double y)
{
  return std::sin(x / 5) * std::sin(y / 4);
}

double OtherLumps(double x, double y)
{
  return std::cos(x / 4.5) * std::cos(y / 5.5);
}

TEST(Compare, TellsTwoBreastsOfOneShapeByTheirTissue)
{
  const RegistrationTarget target = BulgingTarget(Lumps);
  const auto pictureOf = [](const RegistrationTarget& breast)
  {
    SyntheticMammogram picture;
    for (const float value : breast.LogAttenuation)
    {
      picture.LogAttenuation.push_back(
        value > 0 ? 0.5F * value + 1 : 0.0F); // up to scale and offset
    }
    picture.Outline = { { 75, 105 }, { -75, 105 } };
    return picture;
  };
  const Similarity same = Compare(pictureOf(target), target);
  EXPECT_NEAR(same.TissueCorrelation, 1, 1e-3);
  // Another breast agrees in shape and thickness, and so in all of the picture.
  const Similarity other = Compare(pictureOf(BulgingTarget(OtherLumps)), target);
  EXPECT_GT(other.Correlation, 0.8);
  EXPECT_LT(std::abs(other.TissueCorrelation), 0.1);
  EXPECT_NEAR(other.MeanOutlineDistanceMm, 0, 1e-5);
  // Where next to nothing is compared, it is not known.
  RegistrationTarget covered = target;
  covered.Excluded.assign(target.BreastMask.size(), 1);
  covered.Excluded[0] = 0;
  EXPECT_TRUE(std::isnan(Compare(pictureOf(target), covered).TissueCorrelation));
}

TEST(Compare, WeighsTheOutlineByItsLength)
{
  const RegistrationTarget target = StraightTarget();
  SyntheticMammogram synthetic = PictureOf(target, 25);
  // From x = -7 on the line ends and goes on 4 mm farther out, with ten times as many points.
  synthetic.Outline.clear();
  for (double x = 41; x > -7.5; x -= 2)
  {
    synthetic.Outline.push_back({ x, 25 });
  }
  for (double x = -7; x > -41.01; x -= 0.2)
  {
    synthetic.Outline.push_back({ x, 29 });
  }
  // The outline is seen from x = -27 to 27, 3 mm from the picture's borders, in pieces of up to
  // 0.25 mm; for 4 mm beside the step the line's end is nearest.
  const Similarity agreement = Compare(synthetic, target);
  EXPECT_NEAR(agreement.MeanOutlineDistanceMm, (4 * 2 + 16 * 4) / 54.0, 0.02);
  EXPECT_NEAR(agreement.LargestOutlineDistanceMm, 4, 1e-5);
}

TEST(Compare, LeavesOutTheBodyBesideTheBreast)
{
  const RegistrationTarget target = StraightTarget();
  SyntheticMammogram synthetic = PictureOf(target, 25);
  // The model goes on where the mammogram shows no outline, and has a spike that it does not show.
  synthetic.Outline.insert(synthetic.Outline.begin(), { { 41, 10 }, { 80, 10 }, { 80, 25 } });
  EXPECT_NEAR(Compare(synthetic, target).LargestOutlineDistanceMm, 0, 1e-6);
  // A bulge instead of the outline is a distance.
  for (ReceptorPoint& point : synthetic.Outline)
  {
    point[1] += std::abs(point[0]) < 10 ? 8 : 0;
  }
  EXPECT_NEAR(Compare(synthetic, target).LargestOutlineDistanceMm, 8, 1e-5);
}

TEST(Compare, CountsTheLargestDistanceAlsoInTheStripAtTheChestWall)
{
  constexpr double Slope = 0.3;
  RegistrationTarget target = StraightTarget(Slope);
  target.OutlineFromMm = 20;
  SyntheticMammogram synthetic = PictureOf(target, 25);
  for (ReceptorPoint& point : synthetic.Outline)
  {
    point[1] += Slope * point[0] + (point[0] < -19 ? 8 : 0);
  }
  const Similarity similarity = Compare(synthetic, target);
  EXPECT_LT(similarity.MeanOutlineDistanceMm, 0.1); // pixels of 1 mm along a slant
  EXPECT_NEAR(similarity.LargestOutlineDistanceMm, 8 / std::hypot(1, Slope), 0.5);
}

TEST(Compare, LeavesOutWhatIsNotCompared)
{
  RegistrationTarget target = StraightTarget();
  SyntheticMammogram synthetic = PictureOf(target, 25);
  // A marker: excluded, it does not disturb the correlation.
  target.Excluded.assign(target.BreastMask.size(), 0);
  for (std::size_t pixel = 5; pixel < target.BreastMask.size(); pixel += 7)
  {
    target.Excluded[pixel] = 1;
    target.LogAttenuation[pixel] = 100;
  }
  EXPECT_NEAR(Compare(synthetic, target).Correlation, 1, 1e-5);
  target.Excluded.clear();
  EXPECT_LT(Compare(synthetic, target).Correlation, 0.5);
  // A breast behind where outlines are compared has none.
  target.OutlineFromMm = 30;
  EXPECT_THROW(Compare(synthetic, target), InputError);
  target.OutlineFromMm = 0;
  // One outside the picture is as far as it is; none has no distance.
  for (ReceptorPoint& point : synthetic.Outline)
  {
    point[1] = 45;
  }
  EXPECT_NEAR(Compare(synthetic, target).MeanOutlineDistanceMm, 20, 1e-5);
  synthetic.Outline.clear();
  EXPECT_TRUE(std::isnan(Compare(synthetic, target).MeanOutlineDistanceMm));
  EXPECT_TRUE(std::isnan(Compare(synthetic, target).LargestOutlineDistanceMm));
  // Where the synthetic breast is not, there is nothing to compare.
  synthetic.LogAttenuation.assign(synthetic.LogAttenuation.size(), 0.0f);
  EXPECT_EQ(Compare(synthetic, target).Correlation, 0);
}
}
