// SPDX-License-Identifier: Apache-2.0
// With friction at the plates an equilibrium depends on the way to it, which tells where it came
// from.
#include "RegistrationTwin.h"
#include "mammoray/Registration/Private/ViewEvaluator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

using namespace mammoray;
using namespace mammoray::test;

namespace
{
double LargestDifference(const CompressionState& a, const CompressionState& b)
{
  double largest = 0;
  for (std::size_t c = 0; c < a.Positions.size(); ++c)
  {
    largest = std::max(largest, std::abs(a.Positions[c] - b.Positions[c]));
  }
  return largest;
}

BreastPose Closed(double byMm)
{
  BreastPose pose = Truth();
  pose.ThicknessMm -= byMm;
  return pose;
}
}

TEST(ViewEvaluator, TakesEveryStepFromTheAcceptedState)
{
  std::string reason;
  if (ListDevices(&reason).empty())
  {
    GTEST_SKIP() << reason;
  }
  CompressionOptions rubbing;
  rubbing.Friction = 0.5;
  Twin twin(4, 8, 20.0, false, rubbing);
  const SearchedBreast breast{ &twin.Model, &twin.Model.Body(), twin.Placement };
  const CompressionState start = twin.Model.Body().Compress(twin.Placement, Truth(), nullptr);
  const CompressionState far = twin.Model.Body().Compress(twin.Placement, Closed(5), &start);
  const CompressionState near = twin.Model.Body().Compress(twin.Placement, Closed(0.5), &start);
  const CompressionState back = twin.Model.Body().Compress(twin.Placement, Closed(0.5), &far);
  ASSERT_GT(LargestDifference(near, back), 0.05);

  const RegistrationTarget target = MakeTarget(twin, Truth());
  const RegistrationResiduals compared(target, DefaultParameters(Truth()), {});
  const std::vector<double> values = ValuesOf(Truth());
  const ProgressCallback progress;
  ViewEvaluator evaluator(breast, compared, values, breast.At(values, start), progress);
  using Answer = ViewEvaluator::Answer;
  evaluator.Values = ValuesOf(Closed(5));
  ASSERT_EQ(evaluator.Compress(), Answer::Found);
  // That step was refused; a shorter one does not begin where it ended.
  evaluator.Values = ValuesOf(Closed(0.5));
  ASSERT_EQ(evaluator.Compress(), Answer::Found);
  // Newton's method ends within 1e-6 of the forces.
  EXPECT_LT(LargestDifference(evaluator.Current->State(), near), 1e-3);
  // Once a step is taken the next one begins there.
  evaluator.Values = ValuesOf(Closed(5));
  ASSERT_EQ(evaluator.Compress(), Answer::Found);
  evaluator.Accept();
  evaluator.Values = ValuesOf(Closed(0.5));
  ASSERT_EQ(evaluator.Compress(), Answer::Found);
  EXPECT_LT(LargestDifference(evaluator.Current->State(), back), 1e-3);
}

TEST(ViewEvaluator, TellsTheResidualsOfOtherEdgesAndStaysWhereItIs)
{
  std::string reason;
  if (ListDevices(&reason).empty())
  {
    GTEST_SKIP() << reason;
  }
  Twin twin(4, 8, 20.0, false);
  const SearchedBreast breast{ &twin.Model, &twin.Model.Body(), twin.Placement };
  const RegistrationTarget target = MakeTarget(twin, Truth());
  const RegistrationResiduals compared(target, DefaultParameters(Truth()), {});
  const std::vector<double> values = ValuesOf(Truth());
  ProgressCallback progress;
  ViewEvaluator evaluator(breast, compared, values,
    breast.At(values, twin.Model.Body().Compress(twin.Placement, Truth(), nullptr)), progress);
  std::vector<double> residuals;
  evaluator.AppendResiduals(residuals);
  const std::shared_ptr<PosedBreast> here = evaluator.Current;
  const auto farthest = [&](const std::vector<double>& others)
  {
    double largest = 0;
    for (std::size_t index = 0; index < others.size(); ++index)
    {
      largest = std::max(largest, std::abs(others[index] - residuals[index]));
    }
    return largest;
  };
  const double radiusMm = twin.Placement.Unit.EdgeRadiusMm;
  const std::vector<double> same = evaluator.WithEdges(radiusMm);
  const std::vector<double> rounder = evaluator.WithEdges(radiusMm + 5);
  ASSERT_EQ(same.size(), residuals.size());
  ASSERT_EQ(rounder.size(), residuals.size());
  // Newton's method ends within 1e-6 of the forces; residuals are in standard deviations.
  EXPECT_LT(farthest(same), 1e-2);
  EXPECT_GT(farthest(rounder), 0.1);
  EXPECT_EQ(evaluator.Current, here);
  EXPECT_EQ(evaluator.Evaluations, 2);
  progress = [](double, const char*) { return false; };
  EXPECT_TRUE(evaluator.WithEdges(radiusMm + 5).empty());
}
