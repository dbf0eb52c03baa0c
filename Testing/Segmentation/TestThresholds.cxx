// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Segmentation/Private/Thresholds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace
{
using namespace mammoray;

/// Draws `count` values of each normal distribution (mean, deviation 1) and shuffles them.
std::vector<float> Mixture(const std::vector<double>& means, int count)
{
  std::mt19937 generator(5);
  std::vector<float> values;
  for (const double mean : means)
  {
    std::normal_distribution<double> distribution(mean, 1);
    for (int n = 0; n < count; ++n)
    {
      values.push_back(static_cast<float>(distribution(generator)));
    }
  }
  std::shuffle(values.begin(), values.end(), generator);
  return values;
}

TEST(Quantile, IsTheValueOfThatRank)
{
  std::vector<float> values;
  for (int n = 100; n >= 0; --n)
  {
    values.push_back(static_cast<float>(n));
  }
  EXPECT_EQ(Quantile(values, 0), 0);
  EXPECT_EQ(Quantile(values, 0.25), 25);
  EXPECT_EQ(Quantile(values, 1), 100);
  EXPECT_EQ(Quantile({ 7 }, 0.5), 7);
}

TEST(MiddleOfShortestHalf, IsTheLevelOfTheLargerTissue)
{
  // Seven of one tissue, four of another far away: the shortest run of six is 9 to 10.5.
  EXPECT_DOUBLE_EQ(MiddleOfShortestHalf({ 90, 9.5f, 10, 10.5f, 80, 9.75f, 10.25f, 70, 9, 12, 60 }),
    9.75);
  EXPECT_DOUBLE_EQ(MiddleOfShortestHalf({ 4 }), 4.0);
}

TEST(OtsuThresholds, LieMidwayBetweenEqualClasses)
{
  // Otsu's threshold between equal classes is their middle; a bin of the histogram is 0.06 wide.
  const std::vector<double> two = OtsuThresholds(Mixture({ 10, 20 }, 4000), 2);
  ASSERT_EQ(two.size(), 1u);
  EXPECT_NEAR(two[0], 15, 1.5); // no value lies between 13 and 17
  const std::vector<double> three = OtsuThresholds(Mixture({ 10, 20, 30 }, 4000), 3);
  ASSERT_EQ(three.size(), 2u);
  EXPECT_NEAR(three[0], 15, 1.5);
  EXPECT_NEAR(three[1], 25, 1.5);
}

TEST(OtsuThresholds, OutliersDoNotMoveThem)
{
  std::vector<float> values = Mixture({ 10, 20 }, 4000);
  values.push_back(1e6f);
  values.push_back(-1e6f);
  EXPECT_NEAR(OtsuThresholds(values, 2)[0], 15, 1.5);
}

TEST(OtsuThresholds, OneValueIsEveryThreshold)
{
  EXPECT_EQ(OtsuThresholds(std::vector<float>(50, 3.0f), 3), (std::vector<double>{ 3, 3 }));
}
}
