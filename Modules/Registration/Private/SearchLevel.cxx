// SPDX-License-Identifier: Apache-2.0
#include "Private/SearchLevel.h"

#include "Private/ResidualGroups.h"
#include "Private/SearchCovariance.h"

#include <Eigen/Dense>
#include <ceres/ceres.h>
#include <glog/logging.h>

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace mammoray
{
namespace
{
/// Silences glog, through which Ceres prints what its summary states as well.
class QuietGlog
{
public:
  QuietGlog() { FLAGS_minloglevel = google::GLOG_FATAL; }
  QuietGlog(const QuietGlog&) = delete;
  QuietGlog& operator=(const QuietGlog&) = delete;
  ~QuietGlog() { FLAGS_minloglevel = this->Before; }

private:
  int Before = FLAGS_minloglevel;
};

/**
 * The residuals of one view. Ceres would weigh a block of residuals by one robust loss, but each of
 * ours has its own: they are weighed here, as Ceres' corrector weighs a block of one residual by
 * Huber's loss, and ViewLoss answers with the robust cost of all of them.
 */
class ViewCost : public ceres::CostFunction
{
public:
  ViewCost(const RegistrationEvaluator& evaluator, std::size_t view)
    : Source(evaluator)
    , View(view)
  {
    this->set_num_residuals(static_cast<int>(evaluator.NumberOfResiduals(view)));
    this->mutable_parameter_block_sizes()->push_back(
      static_cast<int>(evaluator.FreeParameters.size()));
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override
  {
    if (!this->Source.Valid)
    {
      return false;
    }
    const std::size_t first = this->Source.First[this->View];
    const std::size_t columns = this->Source.FreeParameters.size();
    for (std::size_t row = 0; row < this->Source.NumberOfResiduals(this->View); ++row)
    {
      const double factor = std::sqrt(this->Source.Weight(first + row));
      residuals[row] = factor * this->Source.Residuals[first + row];
      for (std::size_t u = 0; jacobians && jacobians[0] && u < columns; ++u)
      {
        jacobians[0][row * columns + u] = factor *
          this->Source.Jacobian(static_cast<Eigen::Index>(first + row),
            static_cast<Eigen::Index>(u));
      }
    }
    return true;
  }

private:
  const RegistrationEvaluator& Source;
  std::size_t View;
};

/// Twice the robust cost of a view where its ViewCost was evaluated last.
class ViewLoss : public ceres::LossFunction
{
public:
  ViewLoss(const RegistrationEvaluator& evaluator, std::size_t view)
    : Source(evaluator)
    , View(view)
  {
  }

  void Evaluate(double /*squaredNorm*/, double rho[3]) const override
  {
    rho[0] = 2 * this->Source.CostsOf(this->View).Sum();
    rho[1] = 1; // the residuals are weighed already
    rho[2] = 0;
  }

private:
  const RegistrationEvaluator& Source;
  std::size_t View;
};

/// Keeps the best of the accepted states and stops when asked.
class IterationRecorder : public ceres::IterationCallback
{
public:
  /// `covariance`: of the unknowns over their scales, where it is known.
  IterationRecorder(const RegistrationEvaluator& evaluator, const ResolutionLevel& level,
    SearchState& search, const std::optional<Eigen::MatrixXd>& covariance)
    : Source(evaluator)
    , Searched(level)
    , Search(search)
  {
    if (covariance)
    {
      this->Measure.compute(*covariance);
    }
  }

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override
  {
    if (this->Source.Stopped ||
      this->Source.Failures >= RegistrationEvaluator::LargestNumberOfFailures)
    {
      return ceres::SOLVER_ABORT;
    }
    const bool accepted = summary.iteration == 0 || summary.step_is_successful;
    if (accepted && summary.cost < this->Least)
    {
      this->Least = summary.cost;
      // Ceres has just evaluated the Jacobian at the accepted point, so the evaluator stands there.
      for (std::size_t view = 0; view < this->Search.Views.size(); ++view)
      {
        this->Keep(view);
      }
      this->Search.Observe();
      const RegistrationEvaluator::Bottom bottom = this->Source.PredictedBottom();
      this->Fall = bottom.Fall;
      this->Left = this->Measure.cols() == bottom.Step.size()
        ? 0.5 * bottom.Step.dot(this->Measure.solve(bottom.Step))
        : bottom.Fall;
    }
    return this->Fall < this->Searched.NegligibleFall ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
                                                      : ceres::SOLVER_CONTINUE;
  }

  /// True if the best state is near enough to the minimum: the sum over all parameters may be as
  /// large as if each were off by the permitted amount.
  bool Settled() const
  {
    return this->Left <
      this->Searched.NegligibleFall * static_cast<double>(this->Source.FreeParameters.size());
  }

private:
  void Keep(std::size_t view) const
  {
    const ViewEvaluator& evaluator = *this->Source.Views[view];
    ViewSearch& search = this->Search.Views[view];
    const RegistrationCosts costs = this->Source.CostsOf(view);
    RegistrationIteration row;
    row.Number = static_cast<int>(search.Result.Iterations.size());
    row.Parameters = evaluator.Values;
    row.PixelSizeMm = this->Searched.PixelSizeMm;
    row.Comparison = NameOf(this->Searched.Comparison);
    row.OutlineCost = costs.Outline;
    row.IntensityCost = costs.Intensity;
    row.PriorCost = costs.Prior;
    row.Cost = costs.Sum();
    row.Seconds = SecondsSince(this->Search.Begin);
    search.Result.Iterations.push_back(row);
    search.Result.Values = evaluator.Values;
    search.Current = evaluator.Current;
  }

  const RegistrationEvaluator& Source;
  const ResolutionLevel& Searched;
  SearchState& Search;
  Eigen::LDLT<Eigen::MatrixXd> Measure;
  double Least = std::numeric_limits<double>::infinity();
  /// By how much the best state can be expected to fall: half the square of the way to the bottom
  /// in deviations as the weights alone have them; and in those of the covariance.
  double Fall = std::numeric_limits<double>::infinity();
  double Left = std::numeric_limits<double>::infinity();
};

ceres::Solver::Options SolverOptions()
{
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  // A cost that falls by a thousandth tells nothing more: residuals are in standard deviations.
  options.function_tolerance = 1e-3;
  options.parameter_tolerance = 1e-3;
  options.update_state_every_iteration = true;
  options.initial_trust_region_radius = 1e2;
  options.max_num_consecutive_invalid_steps = 10;
  // After an unsuccessful step, a shorter one is tried. Ceres' line search for bounds would spend
  // an equilibrium on each of many small dents of the cost.
  options.max_num_line_search_step_size_iterations = 0;
  return options;
}

/**
 * Searches with steps up: where tissue snaps round a plate's edge the cost jumps, however short the
 * step, and there the way down begins with a step up. But each of them lengthens the next, so that
 * near the bottom they may swing from one side of it to the other: where its iterations are spent,
 * the last level goes on from the best state by short steps down, at most a third as many.
 */
ceres::Solver::Summary Minimise(const ResolutionLevel& level, RegistrationEvaluator& evaluator,
  const SearchState& search, ceres::Problem& problem, IterationRecorder& recorder)
{
  ceres::Solver::Options options = SolverOptions();
  options.callbacks.push_back(&recorder);
  options.max_num_iterations = level.MaximumIterations;
  options.use_nonmonotonic_steps = true;
  options.max_consecutive_nonmonotonic_steps = 3;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!level.Last || summary.termination_type != ceres::NO_CONVERGENCE)
  {
    return summary;
  }
  const int failures = evaluator.Failures;
  evaluator.ReturnTo(search.CurrentBreasts());
  evaluator.Failures = failures;
  options.max_num_iterations = (level.MaximumIterations + 2) / 3;
  options.use_nonmonotonic_steps = false;
  // Ceres scales by the diagonal of the Hessian: at 1 steps are about half as long.
  options.initial_trust_region_radius = 1;
  ceres::Solve(options, &problem, &summary);
  return summary;
}

void AddResiduals(RegistrationEvaluator& evaluator, ceres::Problem& problem)
{
  for (std::size_t view = 0; view < evaluator.Views.size(); ++view)
  {
    problem.AddResidualBlock(new ViewCost(evaluator, view), new ViewLoss(evaluator, view),
      evaluator.Block.data());
  }
  for (std::size_t u = 0; u < evaluator.FreeParameters.size(); ++u)
  {
    const FreeParameter& parameter = evaluator.FreeParameters[u];
    problem.SetParameterLowerBound(evaluator.Block.data(), static_cast<int>(u),
      parameter.Lower / parameter.Scale);
    problem.SetParameterUpperBound(evaluator.Block.data(), static_cast<int>(u),
      parameter.Upper / parameter.Scale);
  }
}

/// Why a level ended.
struct Ending
{
  LevelEnd End = LevelEnd::Reached;
  bool Converged = false;
  std::string Reason;
};

Ending EndingOf(const RegistrationEvaluator& evaluator, const ceres::Solver::Summary& summary,
  bool settled)
{
  if (evaluator.Stopped)
  {
    return { LevelEnd::Stopped, false, "interrupted; this is the best pose so far" };
  }
  if (evaluator.Failures >= RegistrationEvaluator::LargestNumberOfFailures)
  {
    return { LevelEnd::Failed, false,
      std::to_string(evaluator.Failures) +
        " poses on the way to a better match had no equilibrium; this is the best pose that has "
        "one" };
  }
  const bool failed = summary.termination_type == ceres::FAILURE && !settled;
  return { failed ? LevelEnd::Failed : LevelEnd::Reached,
    settled || summary.termination_type == ceres::CONVERGENCE,
    // Like our own reasons, without a full stop.
    settled ? "the parameters are, as a whole, within half a standard deviation of the best match"
            : summary.message.substr(0, summary.message.find_last_not_of(". ") + 1) };
}

/// Adds what a level took, and why it ended, to the result of a view.
void KeepEnd(const ViewEvaluator& spent, const Ending& ending, ViewResult& result)
{
  result.Evaluations += spent.Evaluations;
  result.Projections += spent.Projections;
  result.MechanicsSeconds += spent.MechanicsSeconds;
  result.ProjectionSeconds += spent.ProjectionSeconds;
  result.JacobianSeconds += spent.JacobianSeconds;
  result.Converged = ending.Converged;
  result.StopReason = ending.Reason;
}
}

LevelEnd SearchLevel(std::vector<std::unique_ptr<ViewEvaluator>> views,
  const ResolutionLevel& level, SearchState& search, const ProgressCallback& progress)
{
  RegistrationEvaluator evaluator(std::move(views), search.FreeParameters, progress);
  ceres::Problem::Options problemOptions;
  problemOptions.evaluation_callback = &evaluator;
  ceres::Problem problem(problemOptions);
  AddResiduals(evaluator, problem);
  std::optional<Eigen::MatrixXd> covariance;
  if (auto groups = level.Reweighed ? CompareGroups(evaluator) : std::nullopt)
  {
    groups->WeighByVariances(evaluator);
    covariance = CovarianceOf(evaluator, *groups);
  }
  IterationRecorder recorder(evaluator, level, search, covariance);
  const QuietGlog quiet;
  const ceres::Solver::Summary summary = Minimise(level, evaluator, search, problem, recorder);
  const Ending ending = EndingOf(evaluator, summary, recorder.Settled());
  if (ending.End == LevelEnd::Reached && level.Last)
  {
    KeepCovariance(evaluator, search);
  }
  for (std::size_t view = 0; view < search.Views.size(); ++view)
  {
    KeepEnd(*evaluator.Views[view], ending, search.Views[view].Result);
  }
  return ending.End;
}
}
