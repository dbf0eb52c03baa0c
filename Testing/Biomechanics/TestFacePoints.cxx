// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Biomechanics/Private/FacePoints.h"

#include <gtest/gtest.h>

#include <array>
#include <numeric>

namespace
{
using namespace mammoray;

TEST(FacePoints, IntegrateTheTriangle)
{
  double weight = 0;
  std::array<double, 3> middle{};
  for (const FacePoint& point : FacePoints())
  {
    weight += point.Weight;
    for (int c = 0; c < 3; ++c)
    {
      middle[c] += point.Weight * point.Lambda[c];
    }
    for (const int nodes : { 3, 6 })
    {
      const std::array<double, 6> shape = FaceShape(point, nodes);
      EXPECT_NEAR(std::accumulate(shape.begin(), shape.end(), 0.0), 1, 1e-14);
    }
  }
  EXPECT_EQ(FacePoints().size(), 64u);
  EXPECT_NEAR(weight, 1, 1e-14);
  for (const double coordinate : middle)
  {
    EXPECT_NEAR(coordinate, 1 / 3.0, 1e-14);
  }
}
}
