// SPDX-License-Identifier: Apache-2.0
#include "mammoray/App/Private/ReducedEquilibria.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
using namespace mammoray;

BreastPose PoseAt(double thicknessMm, double rollDeg)
{
  BreastPose pose;
  pose.ThicknessMm = thicknessMm;
  pose.RollDeg = rollDeg;
  return pose;
}

/// One node whose x, y and z are linear, curved and curved by both, and a linear force.
KnownEquilibrium KnownAt(double t, double r)
{
  KnownEquilibrium known;
  known.Pose = PoseAt(t, r);
  known.State.Positions = { 2 * t - r, t * t, t * r };
  known.PositionRates[0] = { 2, 2 * t, r };
  known.PositionRates[1] = { -1, 0, t };
  known.State.PaddleForceN = 100 - t + r;
  known.ForceRates = { -1, 1 };
  return known;
}

TEST(ReducedEquilibria, IsWhatIsKnownAndItsRatesThere)
{
  ReducedEquilibria equilibria;
  equilibria.Add(KnownAt(50, 0));
  equilibria.Add(KnownAt(54, 1));
  equilibria.Add(KnownAt(52, -2));
  for (const auto& [t, r] : { std::pair{ 50.0, 0.0 }, std::pair{ 54.0, 1.0 }, { 52.0, -2.0 } })
  {
    const KnownEquilibrium known = KnownAt(t, r);
    const auto there = equilibria.At(PoseAt(t, r));
    ASSERT_TRUE(there.has_value());
    EXPECT_EQ(there->Positions, known.State.Positions);
    EXPECT_EQ(there->PaddleForceN, known.State.PaddleForceN);
    EXPECT_EQ(there->From, 1);
    EXPECT_EQ(there->Nearest, 0);
    // Weights of the others fall as the fourth power: of their 100 mm^2 at 1e-3 to 2e-3 of the
    // distance 1e-11 is left.
    constexpr double h = 1e-3;
    const auto thicker = equilibria.At(PoseAt(t + h, r));
    const auto rolled = equilibria.At(PoseAt(t, r + h));
    for (int axis = 0; axis < 3; ++axis)
    {
      EXPECT_NEAR(thicker->Positions[axis],
        known.State.Positions[axis] + h * known.PositionRates[0][axis], 1e-9);
      EXPECT_NEAR(rolled->Positions[axis],
        known.State.Positions[axis] + h * known.PositionRates[1][axis], 1e-9);
    }
  }
}

TEST(ReducedEquilibria, ContinuesLinearOnesExactly)
{
  ReducedEquilibria equilibria;
  equilibria.Add(KnownAt(50, 0));
  equilibria.Add(KnownAt(56, 2));
  const auto between = equilibria.At(PoseAt(53, 1.5));
  ASSERT_TRUE(between.has_value());
  EXPECT_EQ(between->From, 2);
  EXPECT_NEAR(between->Nearest, std::hypot(3, 0.5), 1e-12);
  EXPECT_NEAR(between->Positions[0], 2 * 53 - 1.5, 1e-10);
  EXPECT_NEAR(between->PaddleForceN, 100 - 53 + 1.5, 1e-10);
  // Curved: no farther off than the tangents of the two, 3 and 3 mm away.
  EXPECT_NEAR(between->Positions[1], 53 * 53, 9 + 1e-9);
}

TEST(ReducedEquilibria, SaysNothingOfWhatIsFar)
{
  ReducedEquilibria equilibria;
  EXPECT_TRUE(std::isinf(equilibria.Distance(PoseAt(50, 0))));
  EXPECT_FALSE(equilibria.At(PoseAt(50, 0)).has_value());
  EXPECT_EQ(equilibria.Nearest(PoseAt(50, 0)), nullptr);
  equilibria.Add(KnownAt(50, 0));
  EXPECT_EQ(equilibria.Distance(PoseAt(53, 4)), 5);
  EXPECT_TRUE(equilibria.At(PoseAt(50 + ReducedEquilibria::Reach, 0)).has_value());
  EXPECT_FALSE(equilibria.At(PoseAt(50.1 + ReducedEquilibria::Reach, 0)).has_value());
  // A force never pulls.
  equilibria.Add(KnownAt(106, 0));
  EXPECT_EQ(equilibria.At(PoseAt(108, 0))->PaddleForceN, 0);
  EXPECT_EQ(equilibria.Nearest(PoseAt(90, 0))->Pose.ThicknessMm, 106);
}

TEST(ReducedEquilibria, ForgetsTheOldest)
{
  ReducedEquilibria equilibria;
  for (std::size_t k = 0; k <= ReducedEquilibria::MostKnown; ++k)
  {
    equilibria.Add(KnownAt(30 + static_cast<double>(k), 0));
  }
  EXPECT_EQ(equilibria.Distance(PoseAt(30, 0)), 1);
  // The same again replaces itself.
  equilibria.Add(KnownAt(31, 0));
  EXPECT_EQ(equilibria.Distance(PoseAt(31, 0)), 0);
  EXPECT_EQ(equilibria.Distance(PoseAt(30 + ReducedEquilibria::MostKnown, 0)), 0);
}
}
