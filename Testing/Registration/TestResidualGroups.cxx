// SPDX-License-Identifier: Apache-2.0
#include "RegistrationTwin.h"
#include "mammoray/Registration/Private/ResidualGroups.h"
#include "mammoray/Registration/Private/SearchCovariance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

using namespace mammoray;
using namespace mammoray::test;

TEST(ResidualGroups, TellTheSameVariancesWhateverTheyAreWeighedBy)
{
  std::string reason;
  if (ListDevices(&reason).empty())
  {
    GTEST_SKIP() << reason;
  }
  Twin twin(4, 8, 20.0, false);
  Twin other(5, 10, 30.0, false);
  const RegistrationTarget target = CoarsenTo(MakeTarget(other, Truth()), 3.0);
  const RegistrationOptions options;
  const std::vector<RegistrationParameter> parameters = DefaultParameters(Truth());
  const std::vector<double> values = ValuesOf(Truth());
  const SearchedBreast breast{ &twin.Model, &twin.Model.Body(), twin.Placement };
  const std::vector<FreeParameter> unknowns{ { RollParameter, { 0 }, -90, 90, 5 },
    { LateralParameter, { 0 }, -50, 50, 2 } };
  const ProgressCallback progress;
  std::vector<std::unique_ptr<ViewEvaluator>> views;
  views.push_back(
    std::make_unique<ViewEvaluator>(breast, RegistrationResiduals(target, parameters, options),
      values, breast.At(values, twin.At(Truth()).State()), progress));
  RegistrationEvaluator evaluator(std::move(views), unknowns, progress);
  const auto before = CompareGroups(evaluator);
  ASSERT_TRUE(before);
  ASSERT_EQ(before->Groups.size(), 2u);
  EXPECT_EQ(before->Priors.rows(), 2);
  const std::vector<double> residuals = evaluator.Residuals;
  const Eigen::VectorXd column = evaluator.Jacobian.col(1);

  ResidualGroups weighedGroups = *before;
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
    const Eigen::Index first = before->First[group];
    const auto index = static_cast<std::size_t>(first);
    EXPECT_NEAR(evaluator.Residuals[index], change * residuals[index],
      1e-12 * std::abs(evaluator.Residuals[index]));
    EXPECT_NEAR(evaluator.Jacobian(first, 1), change * column[first],
      1e-12 * std::abs(evaluator.Jacobian(first, 1)));
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
  const Eigen::VectorXd weighedColumn = evaluator.Jacobian.col(1);
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
    const auto row = static_cast<Eigen::Index>(index);
    EXPECT_NEAR(evaluator.Jacobian(row, 1), weighedColumn[row],
      1e-2 * (1 + std::abs(weighedColumn[row])));
  }
}

TEST(ResidualGroups, ACovarianceWithoutTheUnitsEdgesIsToldOf)
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
  const RegistrationOptions options;
  const std::vector<RegistrationParameter> parameters = DefaultParameters(Truth());
  const std::vector<double> values = ValuesOf(Truth());
  // Stopped: there is no equilibrium beside this one.
  bool goesOn = true;
  const ProgressCallback progress = [&](double, const char*) { return goesOn; };
  RegistrationProblem problem = twin.Problem();
  problem.Views.emplace_back().Parameters = parameters;
  SearchState search(problem, {});
  ViewSearch& view = search.Views.front();
  view.Current = breast.At(values, breast.Body->Compress(breast.Placement, Truth(), nullptr));
  search.FreeParameters = { { ThicknessParameter, { 0 }, 20, 80, 3 } };
  std::vector<std::unique_ptr<ViewEvaluator>> views;
  views.push_back(std::make_unique<ViewEvaluator>(breast,
    RegistrationResiduals(target, parameters, options), values, view.Current, progress));
  RegistrationEvaluator evaluator(std::move(views), search.FreeParameters, progress);
  KeepCovariance(evaluator, search);
  EXPECT_THAT(view.Result.Warnings, testing::IsEmpty());
  const double counted = view.Result.StandardDeviations[ThicknessParameter];
  goesOn = false;
  KeepCovariance(evaluator, search);
  EXPECT_THAT(view.Result.Warnings, testing::ElementsAre(testing::HasSubstr("sharper edges")));
  EXPECT_LT(view.Result.StandardDeviations[ThicknessParameter], counted);
}
