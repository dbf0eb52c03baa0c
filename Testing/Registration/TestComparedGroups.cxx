// SPDX-License-Identifier: Apache-2.0
#include "RegistrationTwin.h"
#include "mammoray/Registration/Private/ComparedGroups.h"
#include "mammoray/Registration/Private/SearchCovariance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

using namespace mammoray;
using namespace mammoray::test;

TEST(ComparedGroups, TellTheSameVariancesWhateverTheyAreWeighedBy)
{
  std::string reason;
  if (ListDevices(&reason).empty())
  {
    GTEST_SKIP() << reason;
  }
  Twin twin(4, 8, 20.0, false);
  Twin other(5, 10, 30.0, false);
  const RegistrationTarget target = CoarsenTo(MakeTarget(other, Truth()), 3.0);
  RegistrationOptions options;
  options.Parameters = DefaultParameters(Truth());
  const std::vector<double> values = ValuesOf(Truth());
  const SearchedBreast breast{ &twin.Model, &twin.Model.Body(), twin.Placement };
  const std::vector<SearchUnknown> unknowns{ { RollParameter, { 0 }, -90, 90, 5 },
    { LateralParameter, { 0 }, -50, 50, 2 } };
  const ProgressCallback progress;
  std::vector<SearchedMammogram> mammograms{ { breast, target, options, values,
    breast.At(values, twin.At(Truth()).State()) } };
  RegistrationEvaluator evaluator(std::move(mammograms), unknowns, progress);
  const auto before = CompareGroups(evaluator);
  ASSERT_TRUE(before);
  ASSERT_EQ(before->Groups.size(), 2u);
  EXPECT_EQ(before->Priors.rows(), 2);
  const std::vector<double> residuals = evaluator.Residuals;
  const std::vector<double> column = evaluator.Jacobian[1];

  ComparedGroups weighedGroups = *before;
  weighedGroups.WeighByVariances(evaluator);
  const std::vector<double>& factors = weighedGroups.Factors;
  ASSERT_EQ(factors.size(), 2u);
  const auto after = CompareGroups(evaluator);
  ASSERT_TRUE(after);
  for (std::size_t group = 0; group < 2; ++group)
  {
    EXPECT_DOUBLE_EQ(after->Factors[group], factors[group]);
    EXPECT_NEAR(after->Variances.Sigmas[group], before->Variances.Sigmas[group],
      1e-9 * before->Variances.Sigmas[group]);
    const double change = factors[group] / before->Factors[group];
    EXPECT_GT(std::abs(change - 1), 1e-2) << "tells nothing otherwise";
    const auto first = static_cast<std::size_t>(before->First[group]);
    EXPECT_NEAR(evaluator.Residuals[first], change * residuals[first],
      1e-12 * std::abs(evaluator.Residuals[first]));
    EXPECT_NEAR(evaluator.Jacobian[1][first], change * column[first],
      1e-12 * std::abs(evaluator.Jacobian[1][first]));
  }
  // Weighed by variances, the covariance is that of the weights and what parameters absorb.
  const Eigen::MatrixXd covariance = CovarianceOf(evaluator, weighedGroups);
  ASSERT_EQ(covariance.rows(), 2);
  for (Eigen::Index unknown = 0; unknown < 2; ++unknown)
  {
    EXPECT_GT(covariance(unknown, unknown), after->Variances.Covariance(unknown, unknown));
  }

  // What was scaled is what is found when it is computed again.
  const std::vector<double> weighed = evaluator.Residuals;
  const std::vector<double> weighedColumn = evaluator.Jacobian[1];
  const std::vector<double> block = evaluator.Block;
  evaluator.Block[1] += 0.1;
  evaluator.PrepareForEvaluation(true, true);
  EXPECT_NE(evaluator.Residuals, weighed);
  // 1 mm beside: at the bottom that is predicted there is little left to fall.
  evaluator.Block[1] += 0.4;
  evaluator.PrepareForEvaluation(true, true);
  const RegistrationEvaluator::Bottom bottom = evaluator.PredictedBottom();
  EXPECT_GT(bottom.Fall, 1);
  evaluator.Block[0] += bottom.Step[0];
  evaluator.Block[1] += bottom.Step[1];
  evaluator.PrepareForEvaluation(true, true);
  EXPECT_LT(evaluator.PredictedBottom().Fall, 0.2 * bottom.Fall);
  evaluator.Block = block;
  evaluator.ReturnTo({ breast.At(values, twin.At(Truth()).State()) });
  evaluator.PrepareForEvaluation(true, true);
  ASSERT_EQ(evaluator.Residuals.size(), weighed.size());
  for (std::size_t index = 0; index < weighed.size(); ++index)
  {
    // The state without load is solved to 1e-6 of the forces; residuals are in deviations.
    EXPECT_NEAR(evaluator.Residuals[index], weighed[index], 1e-3);
    EXPECT_NEAR(evaluator.Jacobian[1][index], weighedColumn[index],
      1e-2 * (1 + std::abs(weighedColumn[index])));
  }
}

TEST(ComparedGroups, ACovarianceWithoutTheUnitsEdgesIsToldOf)
{
  std::string reason;
  if (ListDevices(&reason).empty())
  {
    GTEST_SKIP() << reason;
  }
  Twin twin(4, 8, 20.0, false);
  const RegistrationTarget target = CoarsenTo(MakeTarget(twin, Truth()), 3.0);
  SearchedBreast breast{ &twin.Model, &twin.Model.Body(), twin.Placement };
  breast.Placement.Unit.EdgeRadiusMm = SearchedEdgeRadiusMm;
  RegistrationOptions options;
  options.Parameters = DefaultParameters(Truth());
  const std::vector<double> values = ValuesOf(Truth());
  // Stopped: there is no equilibrium beside this one.
  bool goesOn = true;
  const ProgressCallback progress = [&](double, const char*) { return goesOn; };
  JointSearch search;
  search.Mammograms.resize(1);
  MammogramSearch& mammogram = search.Mammograms.front();
  mammogram.Result.Parameters = options.Parameters;
  mammogram.Result.Values = values;
  mammogram.Result.StandardDeviations.resize(ParameterCount);
  mammogram.Here = breast.At(values, breast.Body->Compress(breast.Placement, Truth(), nullptr));
  search.Unknowns = { { ThicknessParameter, { 0 }, 20, 80, 3 } };
  RegistrationEvaluator evaluator({ { breast, target, options, values, mammogram.Here } },
    search.Unknowns, progress);
  KeepCovariance(evaluator, search);
  EXPECT_THAT(mammogram.Result.Warnings, testing::IsEmpty());
  const double counted = mammogram.Result.StandardDeviations[ThicknessParameter];
  goesOn = false;
  KeepCovariance(evaluator, search);
  EXPECT_THAT(mammogram.Result.Warnings, testing::ElementsAre(testing::HasSubstr("sharper edges")));
  EXPECT_LT(mammogram.Result.StandardDeviations[ThicknessParameter], counted);
}
