// SPDX-License-Identifier: Apache-2.0
#include "Private/VarianceComponents.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace
{
using namespace mammoray;

std::mt19937 Generator(2718);

/// Residuals that remain of values with noise, apart by more than they are alike over.
ResidualGroup White(Eigen::Index count, double sigma, const Eigen::MatrixXd& jacobian)
{
  std::normal_distribution<double> normal(0, sigma);
  ResidualGroup group;
  group.Residuals = Eigen::VectorXd::NullaryExpr(count, [&]() { return normal(Generator); });
  group.Jacobian = jacobian;
  for (Eigen::Index index = 0; index < count; ++index)
  {
    group.Places.push_back({ 200.0 * static_cast<double>(index), 0 });
  }
  group.Extent = 200;
  return group;
}

TEST(VarianceComponents, OfOneGroupIsTheSampleVariance)
{
  // A mean of n values: sigma^2 = sum / (n - 1), the mean's variance sigma^2 / n.
  const Eigen::Index count = 12;
  ResidualGroup group = White(count, 3, Eigen::MatrixXd::Ones(count, 1));
  group.Residuals.array() -= group.Residuals.mean();
  const VarianceComponents found = EstimateVariances({ group }, Eigen::MatrixXd::Zero(1, 1));
  const double expected = group.Residuals.squaredNorm() / (count - 1);
  ASSERT_TRUE(found.Determined);
  EXPECT_NEAR(found.Sigmas[0] * found.Sigmas[0], expected, 1e-9 * expected);
  EXPECT_NEAR(found.Covariance(0, 0), expected / count, 1e-9 * expected);
  EXPECT_EQ(found.Correlated[0], 200);
}

TEST(VarianceComponents, TellsTwoKindsApartWithoutBias)
{
  // Few residuals and as many unknowns as make the naive estimate wrong by a third; the mean over
  // 400 fits is good to 2 to 5 %.
  const Eigen::Index counts[2] = { 12, 40 };
  const double sigmas[2] = { 2.0, 0.3 };
  double sums[2] = { 0, 0 };
  double coveredSum = 0;
  constexpr int Fits = 400;
  std::normal_distribution<double> normal(0, 1);
  for (int fit = 0; fit < Fits; ++fit)
  {
    std::vector<ResidualGroup> groups;
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(4, 4);
    Eigen::VectorXd pull = Eigen::VectorXd::Zero(4);
    for (int kind = 0; kind < 2; ++kind)
    {
      const Eigen::MatrixXd jacobian =
        Eigen::MatrixXd::NullaryExpr(counts[kind], 4, [&]() { return normal(Generator); });
      groups.push_back(White(counts[kind], sigmas[kind], jacobian));
      const double weight = 1 / (sigmas[kind] * sigmas[kind]);
      information += weight * jacobian.transpose() * jacobian;
      pull += weight * jacobian.transpose() * groups.back().Residuals;
    }
    const Eigen::VectorXd error = information.ldlt().solve(pull); // of a fit with the true weights
    for (ResidualGroup& group : groups)
    {
      group.Residuals -= group.Jacobian * error;
    }
    const VarianceComponents found = EstimateVariances(groups, Eigen::MatrixXd::Zero(4, 4));
    ASSERT_TRUE(found.Determined);
    for (int kind = 0; kind < 2; ++kind)
    {
      sums[kind] += found.Sigmas[kind] * found.Sigmas[kind] / Fits;
    }
    coveredSum += std::abs(error[0]) < 2 * std::sqrt(found.Covariance(0, 0)) ? 1.0 / Fits : 0;
  }
  EXPECT_NEAR(sums[0], 4.0, 0.4);
  EXPECT_NEAR(sums[1], 0.09, 0.005);
  // 95.4 %, a little less for weights that are themselves estimated; one deviation of 400 is 1 %.
  EXPECT_NEAR(coveredSum, 0.945, 0.03);
}

TEST(WeightedEstimate, ScattersAsItsCovarianceSaysWhateverItsWeights)
{
  // Weights that have the two kinds' variances the wrong way round, and a prior whose value is as
  // far off as it says: 4000 fits tell a variance to 2.2 % (one deviation).
  const Eigen::Index counts[2] = { 20, 30 };
  const double sigmas[2] = { 1.0, 0.2 };
  const std::vector<double> weights{ 4.0, 1.0 };
  const Eigen::MatrixXd precision = Eigen::Vector3d(0, 0, 25).asDiagonal();
  std::normal_distribution<double> normal(0, 1);
  std::vector<ResidualGroup> groups;
  VarianceComponents variances;
  for (int kind = 0; kind < 2; ++kind)
  {
    const Eigen::MatrixXd jacobian =
      Eigen::MatrixXd::NullaryExpr(counts[kind], 3, [&]() { return normal(Generator); });
    groups.push_back(White(counts[kind], sigmas[kind], jacobian));
    variances.Sigmas.push_back(sigmas[kind]);
    variances.Correlated.push_back(groups.back().Extent);
  }
  const WeightedEstimate estimate(groups, weights, variances, precision);
  Eigen::MatrixXd found = Eigen::MatrixXd::Zero(3, 3);
  constexpr int Fits = 4000;
  for (int fit = 0; fit < Fits; ++fit)
  {
    Eigen::VectorXd pull = precision * Eigen::Vector3d(0, 0, 0.2 * normal(Generator));
    for (int kind = 0; kind < 2; ++kind)
    {
      const Eigen::VectorXd errors = Eigen::VectorXd::NullaryExpr(counts[kind],
        [&]() { return sigmas[kind] * normal(Generator); });
      pull += weights[kind] * groups[kind].Jacobian.transpose() * errors;
    }
    const Eigen::VectorXd error = estimate.Inverse * pull;
    found += error * error.transpose() / Fits;
  }
  for (int i = 0; i < 3; ++i)
  {
    EXPECT_NEAR(found(i, i), estimate.Covariance(i, i), 0.1 * estimate.Covariance(i, i)) << i;
  }
  // With the weights of the variances it is what they tell, and that is the least.
  const WeightedEstimate best(groups, { 1.0, 25.0 }, variances, precision);
  EXPECT_TRUE(best.Covariance.isApprox(best.Inverse, 1e-12));
  EXPECT_LT(best.Covariance(0, 0), 0.5 * estimate.Covariance(0, 0));
}

TEST(VarianceComponents, CountAPriorAsInformation)
{
  const Eigen::Index count = 30;
  ResidualGroup group = White(count, 1, Eigen::MatrixXd::Zero(count, 1));
  // Nothing is told of the unknown but by the prior.
  const VarianceComponents found =
    EstimateVariances({ group }, Eigen::MatrixXd::Constant(1, 1, 0.25));
  ASSERT_TRUE(found.Determined);
  EXPECT_NEAR(found.Covariance(0, 0), 4, 1e-12);
  EXPECT_NEAR(found.Sigmas[0], std::sqrt(group.Residuals.squaredNorm() / count), 1e-9);
  EXPECT_FALSE(EstimateVariances({ group }, Eigen::MatrixXd::Zero(1, 1)).Determined);
}

TEST(VarianceComponents, TellNoMoreThanTheLeastScatterLets)
{
  ResidualGroup group = White(12, 0.01, Eigen::MatrixXd::Ones(12, 1));
  group.LeastCovariance = 200 * 0.09; // as of residuals of 0.3
  const VarianceComponents found = EstimateVariances({ group }, Eigen::MatrixXd::Zero(1, 1));
  EXPECT_LT(found.Sigmas[0], 0.02); // what they are is told
  EXPECT_NEAR(found.Covariance(0, 0), 0.09 / 12, 1e-12);
}

TEST(VarianceComponents, FindOverWhatALineIsAlike)
{
  // An autoregressive line: correlation rho^lag, integral scale step (1 + rho) / (1 - rho).
  const double rho = 0.8;
  const double step = 1.5;
  std::normal_distribution<double> normal(0, 1);
  ResidualGroup group;
  group.Residuals.resize(2000);
  group.Extent = step;
  double value = 0;
  for (Eigen::Index index = 0; index < group.Residuals.size(); ++index)
  {
    value = rho * value + std::sqrt(1 - rho * rho) * normal(Generator);
    group.Residuals[index] = value;
    group.Places.push_back({ step * static_cast<double>(index), 0 });
  }
  // The correlation below 0.1 is left out, a tenth of the scale; as much is chance.
  EXPECT_NEAR(IntegralScale(group), step * (1 + rho) / (1 - rho), 0.25 * step * 9);
}

TEST(VarianceComponents, FindOverWhatAPictureIsAlike)
{
  // White noise smoothed over a disc of radius R: the autocorrelation's integral is the disc's
  // area.
  const int size = 60;
  const int radius = 4;
  std::normal_distribution<double> normal(0, 1);
  std::vector<double> noise(static_cast<std::size_t>(size + 2 * radius) * (size + 2 * radius));
  for (double& value : noise)
  {
    value = normal(Generator);
  }
  ResidualGroup group;
  group.Dimension = 2;
  group.Residuals.resize(Eigen::Index{ size } * size);
  for (int row = 0; row < size; ++row)
  {
    for (int column = 0; column < size; ++column)
    {
      double sum = 0;
      for (int i = -radius; i <= radius; ++i)
      {
        for (int j = -radius; j <= radius; ++j)
        {
          sum += i * i + j * j <= radius * radius
            ? noise[static_cast<std::size_t>(row + radius + i) * (size + 2 * radius) + column +
                radius + j]
            : 0;
        }
      }
      group.Residuals[Eigen::Index{ row } * size + column] = sum;
      group.Places.push_back({ static_cast<double>(column), static_cast<double>(row) });
    }
  }
  // 49 pixels; 60 discs fit into the picture.
  EXPECT_NEAR(IntegralScale(group), 49, 15);
}

TEST(SmoothCovariance, IsTheSumOverAllPairs)
{
  // Places on the cells' lattice, each twice: 60 mm an eighth apart, so that none are merged with
  // others.
  std::normal_distribution<double> normal(0, 1);
  const double alike = 60;
  std::vector<std::array<double, 2>> places;
  for (int column = 0; column < 9; ++column)
  {
    for (int row = 0; row < 7; ++row)
    {
      const std::array<double, 2> place{ column * alike / 8, row * alike / 8 };
      places.insert(places.end(), { place, place });
    }
  }
  const auto count = static_cast<Eigen::Index>(places.size());
  const Eigen::MatrixXd scores =
    Eigen::MatrixXd::NullaryExpr(count, 3, [&]() { return normal(Generator); });
  Eigen::MatrixXd correlation(count, count);
  for (std::size_t i = 0; i < places.size(); ++i)
  {
    for (std::size_t j = 0; j < places.size(); ++j)
    {
      correlation(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
        std::exp(-std::hypot(places[i][0] - places[j][0], places[i][1] - places[j][1]) / alike);
    }
  }
  const Eigen::MatrixXd expected = scores.transpose() * correlation * scores;
  const Eigen::MatrixXd found = SmoothCovariance(places, scores, alike);
  EXPECT_LT((found - expected).norm(), 1e-12 * expected.norm());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(found).eigenvalues().minCoeff(), 0);
}

TEST(SmoothCovariance, OfPlacesWithinACellIsThatOfTheirSum)
{
  std::uniform_real_distribution<double> within(-0.05, 0.05);
  std::vector<std::array<double, 2>> places(50);
  for (std::array<double, 2>& place : places)
  {
    place = { within(Generator), within(Generator) };
  }
  const Eigen::MatrixXd scores = Eigen::MatrixXd::Random(50, 2);
  const Eigen::VectorXd sum = scores.colwise().sum().transpose();
  EXPECT_LT((SmoothCovariance(places, scores, 1.0) - sum * sum.transpose()).norm(), 1e-12);
}
}
