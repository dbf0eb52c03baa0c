// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Biomechanics/Private/LoadPath.h"
#include "mammoray/Foundation/Error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace
{
using namespace mammoray;

/// Plates along z about the origin.
PlatePair At(double gapMm)
{
  PlatePair plates;
  plates.Support.Edge = { 0, 0, -0.5 * gapMm };
  plates.Paddle.Edge = { 0, 0, 0.5 * gapMm };
  plates.Paddle.Normal = { 0, 0, -1 };
  return plates;
}

/// Solves or fails as it is told, and keeps record.
class ToldSolver : public LoadStepSolver
{
public:
  /// Whether it converges from the gap before to that of the step.
  std::function<bool(double before, const LoadStep& step)> Converges = [](double, const LoadStep&)
  { return true; };
  /// Penetration at the stiffness of the options, mm; inverse to the stiffness.
  double PenetrationMm = 0.01;
  std::vector<LoadStep> Steps;
  std::vector<double> Arrivals;

  std::vector<double> Begin(const std::vector<double>& x, const PlatePair&,
    const LoadStep&) override
  {
    return x;
  }
  EquilibriumReport Solve(std::vector<double>&, const std::vector<double>&,
    const PlatePair& lastPlates, const LoadStep& step, const ProgressCallback& progress) override
  {
    ReportProgress(progress, 0, "told");
    this->Steps.push_back(step);
    EquilibriumReport report;
    report.NewtonSteps = 5;
    report.Converged = this->Converges(GapMm(lastPlates), step);
    report.Reason = report.Converged ? "" : "as told";
    report.LargestPenetrationMm =
      this->PenetrationMm * CompressionOptions().ContactStiffness / step.ContactStiffness;
    return report;
  }
  void Arrived(const std::vector<double>&, const PlatePair& plates) override
  {
    this->Arrivals.push_back(GapMm(plates));
  }
  int Untangle(std::vector<double>&, const LoadStep&, const ProgressCallback&) override
  {
    return 7;
  }
};

/// From 100 mm to 60 mm in steps of 10 mm.
LoadPath ColdPath(LoadStepSolver& solver, const CompressionOptions& options)
{
  return { solver, options, At(60), LoadPathStart::Cold({ 1, 2, 3 }, At(100), At(60), options, 1) };
}

/// The state of hard contact at 60 mm.
CompressionState StateAtSixty(const CompressionOptions& options)
{
  CompressionState state;
  state.Positions = { 1, 2, 3 };
  state.Plates = At(60);
  state.ContactStiffness = options.ContactStiffness;
  return state;
}

TEST(LoadPath, ClosesInEqualStepsThenHardensThenPolishes)
{
  const CompressionOptions options;
  ToldSolver solver;
  LoadPath path = ColdPath(solver, options);
  path.Complete();
  ASSERT_EQ(solver.Steps.size(), 6u);
  for (int step = 0; step < 4; ++step)
  {
    EXPECT_NEAR(GapMm(solver.Steps[step].Plates), 90 - 10 * step, 1e-12);
    EXPECT_DOUBLE_EQ(solver.Steps[step].ContactStiffness, 0.1 * options.ContactStiffness);
  }
  EXPECT_EQ(solver.Arrivals.size(), 3u);
  EXPECT_DOUBLE_EQ(solver.Steps[4].ContactStiffness, options.ContactStiffness);
  EXPECT_GT(solver.Steps[4].Tolerance, options.RelativeTolerance);
  EXPECT_EQ(solver.Steps[5].Tolerance, options.RelativeTolerance);
  EXPECT_EQ(path.State().LoadSteps, 4);
  EXPECT_EQ(path.State().NewtonSteps, 30);
  EXPECT_EQ(path.State().ContactStiffness, options.ContactStiffness);
  EXPECT_EQ(path.State().Plates, At(60));
}

TEST(LoadPath, ClosesOnlyForAPrediction)
{
  const CompressionOptions options;
  ToldSolver solver;
  LoadPath path = ColdPath(solver, options);
  path.Close();
  EXPECT_EQ(solver.Steps.size(), 4u);
  EXPECT_DOUBLE_EQ(path.State().ContactStiffness, 0.1 * options.ContactStiffness);
}

TEST(LoadPath, HalvesStepsThatFail)
{
  const CompressionOptions options;
  ToldSolver solver;
  solver.Converges = [](double before, const LoadStep& step)
  { return before - GapMm(step.Plates) < 3; };
  LoadPath path = ColdPath(solver, options);
  path.Complete();
  // 10 and 5 mm fail; 2.5 mm do not.
  EXPECT_EQ(path.State().LoadSteps, 16);
}

TEST(LoadPath, GivesUpWithTheLastGap)
{
  const CompressionOptions options;
  ToldSolver solver;
  solver.Converges = [](double, const LoadStep& step) { return GapMm(step.Plates) >= 70.1; };
  LoadPath path = ColdPath(solver, options);
  try
  {
    path.Complete();
    FAIL() << "60 mm were reached";
  }
  catch (const CompressionError& error)
  {
    // To two of the smallest steps, 5e-3 of 40 mm.
    EXPECT_GE(error.LastGapMm(), 70.1);
    EXPECT_LE(error.LastGapMm(), 70.5);
    EXPECT_EQ(error.Reason(), "as told");
  }
}

TEST(LoadPath, StiffensContactUntilThePenetrationIsWithinItsLimit)
{
  const CompressionOptions options;
  ToldSolver solver;
  solver.PenetrationMm = 0.15; // the limit is 0.06 mm
  LoadPath path = ColdPath(solver, options);
  path.Complete();
  EXPECT_DOUBLE_EQ(path.State().ContactStiffness, 4 * options.ContactStiffness);
  EXPECT_LE(path.State().LargestPenetrationMm, PenetrationLimitMm(At(60)));
  EXPECT_EQ(solver.Steps.back().Tolerance, options.RelativeTolerance);
  ToldSolver hopeless;
  hopeless.PenetrationMm = 100;
  LoadPath other = ColdPath(hopeless, options);
  EXPECT_THROW(other.Complete(), CompressionError);
}

TEST(LoadPath, HardensInSmallerStepsWhereContactResists)
{
  const CompressionOptions options;
  ToldSolver solver;
  double last = 0;
  solver.Converges = [&](double, const LoadStep& step)
  {
    const bool good = last == 0 || step.ContactStiffness < 2 * last;
    last = good ? step.ContactStiffness : last;
    return good;
  };
  LoadPath path = ColdPath(solver, options);
  path.Complete();
  EXPECT_EQ(path.State().ContactStiffness, options.ContactStiffness);
  // 10 and its root fail; the root of that, 1.78, needs four steps, and is given more time.
  int patient = 0;
  for (const LoadStep& step : solver.Steps)
  {
    patient += step.MaximumNewtonSteps == 2 * options.MaximumNewtonSteps;
  }
  EXPECT_GE(patient, 4);
  EXPECT_LE(patient, 5); // roundoff may leave a last bit to go
}

TEST(LoadPath, GoesAShortWayAtOnceAndALongOneInSteps)
{
  const CompressionOptions options;
  ToldSolver solver;
  const CompressionState state = StateAtSixty(options);
  LoadPath near(solver, options, At(58), LoadPathStart::Warm(state, At(58), options));
  near.Complete();
  ASSERT_EQ(solver.Steps.size(), 2u);
  EXPECT_DOUBLE_EQ(solver.Steps[0].ContactStiffness, options.ContactStiffness);
  solver.Steps.clear();
  // Either plate goes 10 mm: two steps of 6 mm at most, with soft contact.
  LoadPath far(solver, options, At(40), LoadPathStart::Warm(state, At(40), options));
  far.Complete();
  EXPECT_EQ(far.State().LoadSteps, 2);
  EXPECT_DOUBLE_EQ(solver.Steps[0].ContactStiffness, 0.1 * options.ContactStiffness);
}

TEST(LoadPath, AWarmStartThatStrugglesGivesUpSoon)
{
  const CompressionOptions options;
  ToldSolver solver;
  solver.Converges = [](double, const LoadStep&) { return false; };
  LoadPath path(solver, options, At(58),
    LoadPathStart::Warm(StateAtSixty(options), At(58), options));
  EXPECT_THROW(path.Complete(), CompressionError);
  // Soft contact, then steps down to a tenth.
  EXPECT_LE(solver.Steps.size(), 6u);
}

TEST(LoadPath, ArrivesFromAPredictionOrGoesTheWay)
{
  const CompressionOptions options;
  ToldSolver solver;
  LoadPath path = ColdPath(solver, options);
  path.ArriveFrom({ 4, 5, 6 });
  path.Complete();
  EXPECT_EQ(path.State().LoadSteps, 1);
  EXPECT_EQ(path.State().Positions, (std::vector<double>{ 4, 5, 6 }));
  EXPECT_EQ(solver.Steps.size(), 3u);
  EXPECT_EQ(path.State().NewtonSteps, 7 + 15);
  solver.Converges = [](double before, const LoadStep& step)
  { return before - GapMm(step.Plates) < 11; };
  LoadPath other = ColdPath(solver, options);
  other.ArriveFrom({ 4, 5, 6 });
  other.Complete();
  EXPECT_EQ(other.State().LoadSteps, 4);
  EXPECT_EQ(other.State().Positions, (std::vector<double>{ 1, 2, 3 }));
}

TEST(LoadPath, StopsWhenAsked)
{
  const CompressionOptions options;
  ToldSolver solver;
  LoadPath path(solver, options, At(60),
    LoadPathStart::Cold({ 1, 2, 3 }, At(100), At(60), options, 1),
    [](double fraction, const char*) { return fraction < 0.4; });
  EXPECT_THROW(path.Complete(), Interrupted);
  EXPECT_EQ(solver.Steps.size(), 2u);
}
}
