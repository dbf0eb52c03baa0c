// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/Private/ReportParts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <regex>

using namespace mammoray;
using ::testing::HasSubstr;
using ::testing::Not;

namespace
{
/// Heights of the dots of all curves, in the order of drawing.
std::vector<double> DotHeights(const std::string& svg)
{
  std::vector<double> heights;
  const std::regex dot("<circle cx=\"[^\"]*\" cy=\"([^\"]*)\"");
  for (std::sregex_iterator match(svg.begin(), svg.end(), dot), end; match != end; ++match)
  {
    heights.push_back(std::stod((*match)[1]));
  }
  return heights;
}

RegistrationIteration At(int number, double cost)
{
  RegistrationIteration iteration;
  iteration.Number = number;
  iteration.Cost = cost;
  iteration.OutlineCost = cost;
  iteration.IntensityCost = cost;
  return iteration;
}
}

TEST(ConvergencePlot, IsLinearOverASmallSpan)
{
  // 0 at 268 pixels down and 10, the upper end, at 18.
  const std::vector<double> heights =
    DotHeights(ConvergencePlot({ At(0, 10), At(1, 5), At(2, 2.5) }));
  ASSERT_EQ(heights.size(), 9u);
  EXPECT_NEAR(heights[0], 18, 1e-3);
  EXPECT_NEAR(heights[1], 143, 1e-3);
  EXPECT_NEAR(heights[2], 205.5, 1e-3);
}

TEST(ConvergencePlot, IsLogarithmicOverAWideOne)
{
  // The ordinate reaches from 1 to the decade beyond the largest cost, 10,000.
  const std::vector<double> heights =
    DotHeights(ConvergencePlot({ At(0, 1000), At(1, 100), At(2, 1) }));
  ASSERT_EQ(heights.size(), 9u);
  EXPECT_NEAR(heights[0], 268 - 250 * 0.75, 1e-3);
  EXPECT_NEAR(heights[1], 268 - 250 * 0.5, 1e-3);
  EXPECT_NEAR(heights[2], 268, 1e-3);
}

TEST(ConvergencePlot, LeavesOutWhatIsNoNumber)
{
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  const std::string svg = ConvergencePlot({ At(0, 10), At(1, unknown), At(2, 5) });
  EXPECT_EQ(DotHeights(svg).size(), 6u);
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(ConvergencePlot({}), HasSubstr("No iterations to show"));
}
