// SPDX-License-Identifier: Apache-2.0
#include "OtherSearches.h"
#include "RegistrationTwin.h"
#include "mammoray/Foundation/Error.h"

#include <gtest/gtest.h>

#include <memory>

using namespace mammoray;
using namespace mammoray::test;

namespace
{
class OtherSearches : public testing::Test
{
protected:
  void SetUp() override
  {
    std::string reason;
    if (ListDevices(&reason).empty())
    {
      GTEST_SKIP() << reason;
    }
    if (!Target)
    {
      Model = std::make_unique<Twin>(6, 12, 20.0);
      Twin other(8, 16, 30.0);
      Target = std::make_unique<RegistrationTarget>(MakeTarget(other, Truth()));
    }
  }
  static void TearDownTestSuite()
  {
    Model.reset();
    Target.reset();
  }

  /// From a place near the truth, at one resolution.
  static RegistrationProblem ProblemNearTruth()
  {
    BreastPose start = Truth();
    start.ThicknessMm += 1.5;
    start.RollDeg -= 3;
    start.LateralMm += 2;
    RegistrationProblem problem = Model->Problem();
    problem.Options.PixelSizesMm = { 3.0 };
    problem.Options.Comparison = PictureComparison::Global;
    View& view = problem.Views.emplace_back();
    view.Target = *Target;
    view.Levels = MakeLevels(view.Target, problem.Options.PixelSizesMm);
    view.Parameters = DefaultParameters(start);
    for (const RegistrationParameter& parameter : view.Parameters)
    {
      view.From.push_back(parameter.Start);
    }
    return problem;
  }

  static inline std::unique_ptr<Twin> Model;
  static inline std::unique_ptr<RegistrationTarget> Target;
};
}

TEST_F(OtherSearches, DifferencesEndWhereExactDerivativesEndAtMoreEquilibria)
{
  const RegistrationProblem problem = ProblemNearTruth();
  const ViewResult exact = Register(problem).Views.front();
  const ViewResult differences = SearchByDifferences(problem);
  EXPECT_TRUE(differences.Converged) << differences.StopReason;
  // Both stop within half a standard deviation of the best.
  for (const int parameter :
    { ThicknessParameter, RollParameter, LateralParameter, AnteriorParameter })
  {
    EXPECT_NEAR(differences.Values[parameter], exact.Values[parameter],
      exact.StandardDeviations[parameter])
      << exact.Parameters[parameter].Name;
  }
  EXPECT_EQ(differences.Iterations.front().Parameters, problem.Views[0].From);
  // The same cost where both begin.
  EXPECT_NEAR(differences.Iterations.front().Cost, exact.Iterations.front().Cost,
    1e-3 * exact.Iterations.front().Cost);
  // Two more for each of four parameters at every accepted point.
  EXPECT_GE(differences.Evaluations, 8 * static_cast<int>(differences.Iterations.size()));
  EXPECT_LE(exact.Evaluations, 10);

  // Stopped among the differences.
  int calls = 0;
  const ViewResult stopped =
    SearchByDifferences(problem, [&](double, const char*) { return ++calls < 200; });
  EXPECT_FALSE(stopped.Converged);
  EXPECT_NE(stopped.StopReason.find("interrupted"), std::string::npos);
}

TEST_F(OtherSearches, AnnealingSpendsItsEquilibriaAndKeepsTheBest)
{
  const RegistrationProblem problem = ProblemNearTruth();
  AnnealingOptions annealing;
  annealing.Equilibria = 6;
  annealing.FirstStep = 0.3;
  const ViewResult result = Anneal(problem, annealing);
  EXPECT_EQ(result.Evaluations, 6);
  EXPECT_EQ(result.Iterations.front().Parameters, problem.Views[0].From);
  ASSERT_GE(result.Iterations.size(), 2u);
  for (std::size_t index = 1; index < result.Iterations.size(); ++index)
  {
    EXPECT_LT(result.Iterations[index].Cost, result.Iterations[index - 1].Cost);
  }
  EXPECT_EQ(result.Values, result.Iterations.back().Parameters);
  EXPECT_EQ(result.Values[StiffnessParameter], 1); // fixed
  for (int index = 0; index < ParameterCount; ++index)
  {
    EXPECT_GE(result.Values[index], problem.Views[0].Parameters[index].Lower);
    EXPECT_LE(result.Values[index], problem.Views[0].Parameters[index].Upper);
  }
  EXPECT_FALSE(result.Converged);

  // The same seed walks the same way; a stop leaves the best so far.
  annealing.Equilibria = 4;
  int calls = 0;
  const auto stopAtThird = [&](double, const char* stage)
  { return std::string(stage) != "anneal" || ++calls < 3; };
  const ViewResult stopped = Anneal(problem, annealing, stopAtThird);
  EXPECT_EQ(stopped.Evaluations, 3);
  EXPECT_NE(stopped.StopReason.find("interrupted"), std::string::npos);
  EXPECT_LE(stopped.Iterations.back().Cost, stopped.Iterations.front().Cost);
  annealing.Equilibria = 0;
  EXPECT_THROW(Anneal(problem, annealing), InputError);
}
