// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/Registration.h"

#include "Private/RegistrationEvaluator.h"
#include "Private/ValidateRegistration.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Registration/TargetImage.h"

#include <Eigen/Dense>
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <numeric>

namespace mammoray
{
namespace
{
/// Of the cost, to the bottom of its quadratic model. Residuals are in standard deviations:
/// parameters that are half of their own from the best cost this much more. The cheap simulation is
/// off by more than two.
constexpr double NegligibleFall = 0.125;
constexpr double NegligibleFallOfScout = 2;

/// One residual of an evaluator, so that Ceres can weigh each by its robust loss.
class ResidualCost : public ceres::CostFunction
{
public:
  ResidualCost(const RegistrationEvaluator& evaluator, std::size_t index)
    : Source(evaluator)
    , Index(index)
  {
    this->set_num_residuals(1);
    this->mutable_parameter_block_sizes()->push_back(static_cast<int>(evaluator.Unknowns.size()));
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override
  {
    if (!this->Source.Valid)
    {
      return false;
    }
    residuals[0] = this->Source.Residuals[this->Index];
    if (jacobians && jacobians[0])
    {
      for (std::size_t u = 0; u < this->Source.Unknowns.size(); ++u)
      {
        jacobians[0][u] = this->Source.Jacobian[u][this->Index];
      }
    }
    return true;
  }

private:
  const RegistrationEvaluator& Source;
  std::size_t Index;
};

/// Keeps the accepted states, tells of progress and stops when asked.
class IterationRecorder : public ceres::IterationCallback
{
public:
  IterationRecorder(const RegistrationEvaluator& evaluator,
    std::vector<RegistrationResult>& results, double pixelSizeMm, double negligibleFall,
    Clock::time_point begin)
    : Source(evaluator)
    , Results(results)
    , PixelSizeMm(pixelSizeMm)
    , LeastFall(negligibleFall)
    , Begin(begin)
  {
  }

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override
  {
    if (this->Source.Stopped ||
      this->Source.Failures >= RegistrationEvaluator::LargestNumberOfFailures)
    {
      return ceres::SOLVER_ABORT;
    }
    if (summary.iteration == 0 || summary.step_is_successful)
    {
      // Ceres has just evaluated the Jacobian at the accepted point, so the evaluator stands there.
      for (std::size_t view = 0; view < this->Results.size(); ++view)
      {
        this->Keep(*this->Source.Views[view], this->Results[view]);
      }
      this->Settled = this->Source.PredictedFall() < this->LeastFall;
    }
    return this->Settled ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

private:
  void Keep(const ViewEvaluator& view, RegistrationResult& result) const
  {
    const RegistrationCosts costs = view.Costs();
    RegistrationIteration row;
    row.Number = static_cast<int>(result.Iterations.size());
    row.Parameters = view.View.Values;
    row.PixelSizeMm = this->PixelSizeMm;
    row.OutlineCost = costs.Outline;
    row.IntensityCost = costs.Intensity;
    row.PriorCost = costs.Prior;
    row.Cost = costs.Sum();
    row.Seconds = SecondsSince(this->Begin);
    result.Iterations.push_back(row);
    result.Values = view.View.Values;
    result.State = view.View.State;
  }

  const RegistrationEvaluator& Source;
  std::vector<RegistrationResult>& Results;
  double PixelSizeMm;
  double LeastFall;
  Clock::time_point Begin;
  bool Settled = false;
};

/// CompressAt before the search, counted and timed.
CompressionState CompressForStart(const RegistrationModel& model, const std::vector<double>& values,
  const CompressionState* near, RegistrationResult& result, const ProgressCallback& progress)
{
  if (near && TravelFrom(*near, model, values) > LongestWarmTravelMm)
  {
    near = nullptr;
  }
  ++result.Evaluations;
  const auto begin = Clock::now();
  try
  {
    CompressionState state = CompressAt(model, values, near, progress);
    result.MechanicsSeconds += SecondsSince(begin);
    return state;
  }
  catch (const ConvergenceError&)
  {
    result.MechanicsSeconds += SecondsSince(begin);
    throw;
  }
}

/// Extent of the breast at rest along the beam's axis, mm: of what is clearly in front of the chest
/// wall, which may be taller.
double UncompressedHeight(const RegistrationModel& model, const BreastPose& pose)
{
  const Vector3 axis = PlaceUnit(model.Axes, model.Anchor, model.Unit, pose).Z;
  const std::vector<double>& points = model.Simulation->RestPositions();
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (std::size_t index = 0; index < points.size(); index += 3)
  {
    const Vector3 point{ points[index], points[index + 1], points[index + 2] };
    constexpr double clearlyMm = 5;
    if (Dot(point - model.Anchor, model.Axes.Anterior) > clearlyMm)
    {
      const double height = Dot(point, axis);
      low = std::min(low, height);
      high = std::max(high, height);
    }
  }
  return high - low;
}

/// Thickness that is too small for the breast: opened and bounded, with a warning.
void OpenTo(double thicknessMm, double heightMm, RegistrationResult& result)
{
  RegistrationParameter& thickness = result.Parameters[ThicknessParameter];
  double& value = result.Values[ThicknessParameter];
  char sentence[240];
  std::snprintf(sentence, sizeof sentence,
    "The breast of the volume is %.0f mm high; it is not compressed to the %.1f mm the search "
    "should start from, but to no less than %.1f mm.",
    heightMm, value, thicknessMm);
  result.Warnings.push_back(sentence);
  value = thicknessMm;
  thickness.Start = thicknessMm;
  thickness.Lower = thicknessMm;
  thickness.Upper = std::max(thickness.Upper, 1.5 * thicknessMm);
}

/// A breast is compressed to about half its height; a start below that belongs to another breast
/// and costs minutes to fail.
void OpenToHalfHeight(const RegistrationModel& model, RegistrationResult& result)
{
  const double height = UncompressedHeight(model, PoseOf(result.Values));
  if (!result.Parameters[ThicknessParameter].Fixed &&
    result.Values[ThicknessParameter] < 0.5 * height)
  {
    OpenTo(0.5 * height, height, result);
  }
}

/// The equilibrium at the result's values, opened where there is none.
CompressionState CompressStart(const RegistrationModel& model, RegistrationResult& result,
  const ProgressCallback& progress)
{
  constexpr int attempts = 3;
  for (int attempt = 1;; ++attempt)
  {
    try
    {
      return CompressForStart(model, result.Values, nullptr, result, progress);
    }
    catch (const CompressionError& error)
    {
      const double opened = 1.1 * error.LastGapMm();
      if (result.Parameters[ThicknessParameter].Fixed || attempt == attempts ||
        !(opened > result.Values[ThicknessParameter]))
      {
        throw;
      }
      OpenTo(opened, UncompressedHeight(model, PoseOf(result.Values)), result);
    }
  }
}

/**
 * Shifts the unit so that the start's silhouette has its middle and its tip where the mammogram's
 * outline has them: cheap, and it spares the optimiser the long way from a wrong position.
 */
void AlignStart(const RegistrationModel& model, const RegistrationTarget& target,
  const CompressionState& state, const std::vector<RegistrationParameter>& parameters,
  std::vector<double>& values)
{
  const auto directions = HalfCircleDirections(180);
  const ReceptorPoint centre = ChestWallCentre(target);
  const BreastPose pose = PoseOf(values);
  const std::vector<double> radii =
    SilhouetteRadii(ProjectToReceptor(model.SurfaceEmbedding->Map(state.Positions),
                      PlaceUnit(model.Axes, model.Anchor, model.Unit, pose), model.Unit),
      OuterEdges(*model.Surface), centre, directions);
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  double tip = 0;
  for (std::size_t index = 0; index < directions.size(); ++index)
  {
    low = std::min(low, centre[0] + radii[index] * directions[index][0]);
    high = std::max(high, centre[0] + radii[index] * directions[index][0]);
    tip = std::max(tip, centre[1] + radii[index] * directions[index][1]);
  }
  double targetTip = 0;
  for (int row = 0; row < target.Rows; ++row)
  {
    for (int column = 0; column < target.Columns; ++column)
    {
      if (target.BreastMask[static_cast<std::size_t>(row) * target.Columns + column])
      {
        targetTip = std::max(targetTip, PixelPosition(target, column, row)[1]);
      }
    }
  }
  const double sid = model.Unit.SourceToDetectorMm;
  const double magnification = sid / (sid - model.Unit.SupportHeightMm - 0.5 * pose.ThicknessMm);
  const auto shift = [&](int index, double by)
  {
    const RegistrationParameter& parameter = parameters[index];
    if (!parameter.Fixed)
    {
      values[index] = std::clamp(values[index] + by, parameter.Lower, parameter.Upper);
    }
  };
  shift(LateralParameter, (0.5 * (low + high) - centre[0]) / magnification);
  shift(AnteriorParameter, (tip - targetTip) / magnification);
}

/// The values and equilibrium of one beginning of the search.
struct Beginning
{
  std::vector<double> Values;
  CompressionState State;
};

/**
 * Moves a beginning to `aligned`, where the outlines meet; without an equilibrium there only
 * sideways, which the plates do not feel.
 */
void MoveTo(const RegistrationModel& model, const std::vector<double>& aligned,
  Beginning& beginning, RegistrationResult& result, const ProgressCallback& progress)
{
  std::vector<double> sideways = beginning.Values;
  sideways[LateralParameter] = aligned[LateralParameter];
  for (const std::vector<double>& values : { aligned, sideways })
  {
    try
    {
      beginning.State = CompressForStart(model, values, &beginning.State, result, progress);
      beginning.Values = values;
      return;
    }
    catch (const ConvergenceError&)
    {
      // The next, or none.
    }
  }
}

/**
 * Of the start and others with the roll beside it, the one whose picture matches best where the
 * outlines meet: a picture changes little with the roll and has more than one valley. To compare
 * them, the compressed breast is moved to its outline as it is; only the best is compressed again
 * there.
 */
void ChooseStart(const RegistrationModel& model, const RegistrationTarget& target,
  const RegistrationOptions& options, RegistrationResult& result, const ProgressCallback& progress)
{
  const RegistrationResiduals compared(model, target, options);
  const std::vector<double> from = result.Values;
  double least = std::numeric_limits<double>::infinity();
  Beginning best;
  std::vector<double> aligned;
  std::vector<double> offsets{ 0 };
  // A start that had to be opened is another breast's: every equilibrium costs much there.
  if (!result.Parameters[RollParameter].Fixed && result.Warnings.empty())
  {
    offsets.insert(offsets.end(), options.RollOffsetsDeg.begin(), options.RollOffsetsDeg.end());
  }
  for (const double offset : offsets)
  {
    const RegistrationParameter& roll = result.Parameters[RollParameter];
    Beginning beginning{ from, result.State };
    beginning.Values[RollParameter] += offset;
    if (beginning.Values[RollParameter] < roll.Lower ||
      beginning.Values[RollParameter] > roll.Upper)
    {
      continue;
    }
    try
    {
      if (offset != 0)
      {
        beginning.State =
          CompressForStart(model, beginning.Values, &result.State, result, progress);
      }
    }
    catch (const ConvergenceError&)
    {
      continue; // no equilibrium there: one of the others
    }
    std::vector<double> values = beginning.Values;
    AlignStart(model, target, beginning.State, result.Parameters, values);
    const double cost = compared.Costs(compared.Evaluate(values, beginning.State)).Sum();
    ++result.Projections;
    if (cost < least)
    {
      least = cost;
      best = std::move(beginning);
      aligned = std::move(values);
    }
  }
  MoveTo(model, aligned, best, result, progress);
  result.Values = best.Values;
  result.State = best.State;
}

/// The views that have a parameter of one: all of them a shared one.
std::vector<std::size_t> ViewsOf(int parameter, std::size_t view, std::size_t count)
{
  if (!IsShared(parameter))
  {
    return { view };
  }
  std::vector<std::size_t> views(count);
  std::iota(views.begin(), views.end(), std::size_t{ 0 });
  return views;
}

/// Parameters that are held, but not known: those with a prior, a shared one once.
std::vector<SearchUnknown> Considered(const std::vector<RegistrationResult>& results)
{
  std::vector<SearchUnknown> considered;
  for (std::size_t view = 0; view < results.size(); ++view)
  {
    for (int index = 0; index < ParameterCount; ++index)
    {
      const RegistrationParameter& parameter = results[view].Parameters[index];
      if (parameter.Fixed && parameter.PriorSigma > 0 && (view == 0 || !IsShared(index)))
      {
        considered.push_back(
          { index, ViewsOf(index, view, results.size()), 0, 0, parameter.PriorSigma });
      }
    }
  }
  return considered;
}

/// d residuals / d parameters in units of their scales, at the evaluator's point.
Eigen::MatrixXd ColumnsOf(RegistrationEvaluator& evaluator,
  const std::vector<SearchUnknown>& parameters)
{
  Eigen::MatrixXd columns =
    Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(evaluator.Residuals.size()),
      static_cast<Eigen::Index>(parameters.size()));
  std::size_t first = 0;
  for (std::size_t view = 0; view < evaluator.Views.size(); ++view)
  {
    std::vector<int> wanted;
    std::vector<Eigen::Index> places;
    for (std::size_t index = 0; index < parameters.size(); ++index)
    {
      const std::vector<std::size_t>& views = parameters[index].Views;
      if (std::find(views.begin(), views.end(), view) != views.end())
      {
        wanted.push_back(parameters[index].Parameter);
        places.push_back(static_cast<Eigen::Index>(index));
      }
    }
    const RegistrationResiduals::Jacobian jacobian = evaluator.Views[view]->Differentiate(wanted);
    for (std::size_t index = 0; index < wanted.size(); ++index)
    {
      const std::vector<double>& column = jacobian.Columns[wanted[index]];
      columns.col(places[index])
        .segment(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(column.size())) =
        parameters[static_cast<std::size_t>(places[index])].Scale *
        Eigen::Map<const Eigen::VectorXd>(column.data(), static_cast<Eigen::Index>(column.size()));
    }
    first += evaluator.Views[view]->Residuals.size();
  }
  return columns;
}

/**
 * The covariance of free parameters and of those that are held, but are only known up to their
 * priors, into the results of the views: an error c of the latter moves the minimum by S c, S =
 * -(J^T W J)^-1 J^T W J_c (consider covariance, Schmidt 1966; Tapley, Schutz and Born 2004, section
 * 6.2). Needs the joint covariance.
 */
void KeepConsidered(RegistrationEvaluator& evaluator, JointRegistrationResult& joint)
{
  std::vector<SearchUnknown> all = evaluator.Unknowns;
  const auto count = static_cast<Eigen::Index>(all.size());
  const std::vector<SearchUnknown> considered = Considered(joint.Views);
  const auto held = static_cast<Eigen::Index>(considered.size());
  all.insert(all.end(), considered.begin(), considered.end());

  const std::vector<double> weights = evaluator.Weights();
  Eigen::MatrixXd jacobian(static_cast<Eigen::Index>(weights.size()), count);
  for (Eigen::Index u = 0; u < count; ++u)
  {
    jacobian.col(u) = Eigen::Map<const Eigen::VectorXd>(
      evaluator.Jacobian[static_cast<std::size_t>(u)].data(), jacobian.rows());
  }
  const Eigen::MatrixXd weighted = jacobian.transpose() *
    Eigen::Map<const Eigen::VectorXd>(weights.data(), jacobian.rows()).asDiagonal();
  // In units of the unknowns' scales and of the priors.
  const Eigen::MatrixXd shift =
    -(weighted * jacobian).ldlt().solve(weighted * ColumnsOf(evaluator, considered));
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(count + held, count + held);
  for (Eigen::Index i = 0; i < count; ++i)
  {
    for (Eigen::Index j = 0; j < count; ++j)
    {
      covariance(i, j) = joint.Covariance[static_cast<std::size_t>(i * count + j)] /
        (all[static_cast<std::size_t>(i)].Scale * all[static_cast<std::size_t>(j)].Scale);
    }
  }
  covariance.topLeftCorner(count, count) += shift * shift.transpose();
  covariance.topRightCorner(count, held) = shift;
  covariance.bottomLeftCorner(held, count) = shift.transpose();
  for (std::size_t view = 0; view < joint.Views.size(); ++view)
  {
    std::vector<double>& kept = joint.Views[view].ConsideredCovariance;
    kept.assign(std::size_t{ ParameterCount } * ParameterCount, 0.0);
    const auto has = [view](const SearchUnknown& parameter)
    {
      return std::find(parameter.Views.begin(), parameter.Views.end(), view) !=
        parameter.Views.end();
    };
    for (std::size_t i = 0; i < all.size(); ++i)
    {
      for (std::size_t j = 0; has(all[i]) && j < all.size(); ++j)
      {
        if (has(all[j]))
        {
          kept[all[i].Parameter * ParameterCount + all[j].Parameter] = all[i].Scale * all[j].Scale *
            covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
        }
      }
    }
  }
}

/// Covariance of the unknowns at the evaluator's solution, and its part in each view's result.
void KeepCovariance(ceres::Problem& problem, RegistrationEvaluator& evaluator,
  JointRegistrationResult& joint)
{
  std::vector<CompressionState> states;
  for (const RegistrationResult& result : joint.Views)
  {
    states.push_back(result.State);
  }
  evaluator.ReturnTo(states);
  ceres::Covariance covariance{ ceres::Covariance::Options() };
  const std::vector<const double*> blocks{ evaluator.Block.data() };
  if (!covariance.Compute(blocks, &problem))
  {
    return;
  }
  const std::size_t n = evaluator.Unknowns.size();
  joint.Covariance.resize(n * n);
  covariance.GetCovarianceBlock(evaluator.Block.data(), evaluator.Block.data(),
    joint.Covariance.data());
  for (RegistrationResult& result : joint.Views)
  {
    result.Covariance.assign(std::size_t{ ParameterCount } * ParameterCount, 0.0);
  }
  for (std::size_t i = 0; i < n; ++i)
  {
    const SearchUnknown& row = evaluator.Unknowns[i];
    for (std::size_t j = 0; j < n; ++j)
    {
      const SearchUnknown& column = evaluator.Unknowns[j];
      double& entry = joint.Covariance[i * n + j];
      entry *= row.Scale * column.Scale;
      for (const std::size_t view : row.Views)
      {
        if (std::find(column.Views.begin(), column.Views.end(), view) != column.Views.end())
        {
          joint.Views[view].Covariance[row.Parameter * ParameterCount + column.Parameter] = entry;
        }
      }
    }
    for (const std::size_t view : row.Views)
    {
      joint.Views[view].StandardDeviations[row.Parameter] =
        std::sqrt(joint.Covariance[i * (n + 1)]);
    }
  }
  KeepConsidered(evaluator, joint);
}

enum class LevelEnd
{
  Reached,
  /// The next level has nothing to go on from.
  Failed,
  /// By the user.
  Stopped
};

/// What a level of the search compares, and when it ends.
struct Level
{
  double PixelSizeMm = 0;
  double NegligibleFall = 0;
  int MaximumIterations = 0;
  bool Finest = false;
};

ceres::Solver::Options SolverOptions(const Level& level)
{
  ceres::Solver::Options options;
  options.max_num_iterations = level.MaximumIterations;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  // A cost that falls by a thousandth tells nothing more: residuals are in standard deviations.
  options.function_tolerance = 1e-3;
  options.parameter_tolerance = 1e-3;
  options.update_state_every_iteration = true;
  options.initial_trust_region_radius = 1e2;
  options.max_num_consecutive_invalid_steps = 10;
  // Of a step that does not help a shorter one is tried: Ceres' own search along it, meant for
  // bounds, spends an equilibrium on each of many dents of the cost.
  options.max_num_line_search_step_size_iterations = 0;
  return options;
}

void AddResiduals(RegistrationEvaluator& evaluator, ceres::Problem& problem)
{
  const double width = evaluator.Views.front()->View.Options.RobustWidth;
  for (std::size_t index = 0; index < evaluator.Robust.size(); ++index)
  {
    problem.AddResidualBlock(new ResidualCost(evaluator, index),
      evaluator.Robust[index] ? new ceres::HuberLoss(width) : nullptr, evaluator.Block.data());
  }
  for (std::size_t u = 0; u < evaluator.Unknowns.size(); ++u)
  {
    const SearchUnknown& unknown = evaluator.Unknowns[u];
    problem.SetParameterLowerBound(evaluator.Block.data(), static_cast<int>(u),
      unknown.Lower / unknown.Scale);
    problem.SetParameterUpperBound(evaluator.Block.data(), static_cast<int>(u),
      unknown.Upper / unknown.Scale);
  }
}

/// Adds what a level took, and why it ended, to the results.
LevelEnd KeepEnd(const RegistrationEvaluator& evaluator, const ceres::Solver::Summary& summary,
  std::vector<RegistrationResult>& results)
{
  LevelEnd end = summary.termination_type == ceres::FAILURE ? LevelEnd::Failed : LevelEnd::Reached;
  bool converged = summary.IsSolutionUsable() &&
    (summary.termination_type == ceres::CONVERGENCE ||
      summary.termination_type == ceres::USER_SUCCESS);
  // Like our own reasons, without a full stop.
  std::string reason = summary.termination_type == ceres::USER_SUCCESS
    ? "the parameters are within half a standard deviation of the best match"
    : summary.message.substr(0, summary.message.find_last_not_of(". ") + 1);
  if (evaluator.Stopped)
  {
    end = LevelEnd::Stopped;
    converged = false;
    reason = "interrupted; this is the best pose so far";
  }
  else if (evaluator.Failures >= RegistrationEvaluator::LargestNumberOfFailures)
  {
    end = LevelEnd::Failed;
    converged = false;
    reason = std::to_string(evaluator.Failures) +
      " poses on the way to a better match had no equilibrium; this is the best pose that has one";
  }
  for (std::size_t view = 0; view < results.size(); ++view)
  {
    const ViewEvaluator& spent = *evaluator.Views[view];
    RegistrationResult& result = results[view];
    result.Evaluations += spent.Evaluations;
    result.Projections += spent.Projections;
    result.MechanicsSeconds += spent.MechanicsSeconds;
    result.ProjectionSeconds += spent.ProjectionSeconds;
    result.JacobianSeconds += spent.JacobianSeconds;
    result.Converged = converged;
    result.StopReason = reason;
  }
  return end;
}

/// Searches at one resolution.
LevelEnd SearchLevel(const std::vector<EvaluatedView>& views,
  const std::vector<SearchUnknown>& unknowns, const Level& level, Clock::time_point begin,
  JointRegistrationResult& joint, const ProgressCallback& progress)
{
  RegistrationEvaluator evaluator(views, unknowns, progress);
  ceres::Problem::Options problemOptions;
  problemOptions.evaluation_callback = &evaluator;
  ceres::Problem problem(problemOptions);
  AddResiduals(evaluator, problem);
  ceres::Solver::Options solverOptions = SolverOptions(level);
  IterationRecorder recorder(evaluator, joint.Views, level.PixelSizeMm, level.NegligibleFall,
    begin);
  solverOptions.callbacks.push_back(&recorder);
  ceres::Solver::Summary summary;
  ceres::Solve(solverOptions, &problem, &summary);
  const LevelEnd end = KeepEnd(evaluator, summary, joint.Views);
  if (end == LevelEnd::Reached && level.Finest)
  {
    KeepCovariance(problem, evaluator, joint);
  }
  return end;
}

/// The steps of RegisterTogether.
class Search
{
public:
  Search(const std::vector<RegistrationView>& views, const RegistrationOptions& options,
    JointRegistrationResult& joint, const ProgressCallback& progress)
    : Views(views)
    , Options(options)
    , Joint(joint)
    , Progress(progress)
  {
    for (const RegistrationView& view : views)
    {
      this->Models.push_back(*view.Model);
    }
  }

  void Run()
  {
    for (std::size_t view = 0; view < this->Views.size(); ++view)
    {
      OpenToHalfHeight(this->Models[view], this->Joint.Views[view]);
    }
    this->CollectUnknowns();
    const bool chooses = !this->Unknowns.empty() && this->Views.front().From.empty();
    if (chooses && this->HasScout() && this->ByScout())
    {
      return;
    }
    for (std::size_t view = 0; view < this->Views.size(); ++view)
    {
      RegistrationResult& result = this->Joint.Views[view];
      result.State = CompressStart(this->Models[view], result, this->Progress);
      this->KeepBefore(this->Models[view], view);
      if (chooses)
      {
        this->Choose(this->Models[view], view);
      }
    }
    this->CollectUnknowns(); // a start may have been opened
    this->Levels(this->Models, 0, this->Options.PixelSizesMm.size());
  }

private:
  bool HasScout() const
  {
    return std::all_of(this->Models.begin(), this->Models.end(),
      [](const RegistrationModel& model) { return model.Scout != nullptr; });
  }

  /// What is free, view by view; a shared parameter once, with the bounds of the first view.
  void CollectUnknowns()
  {
    this->Unknowns.clear();
    this->Joint.Unknowns.clear();
    for (std::size_t view = 0; view < this->Views.size(); ++view)
    {
      for (int index = 0; index < ParameterCount; ++index)
      {
        const RegistrationParameter& parameter = this->Joint.Views[view].Parameters[index];
        if (parameter.Fixed || (IsShared(index) && view > 0))
        {
          continue;
        }
        SearchUnknown unknown{ index, ViewsOf(index, view, this->Views.size()), parameter.Lower,
          parameter.Upper, parameter.Scale };
        this->Joint.Unknowns.push_back({ index, view, unknown.Views.size() > 1 });
        this->Unknowns.push_back(std::move(unknown));
      }
    }
  }

  /**
   * The starts are chosen, and all resolutions but the finest are searched, with the cheap
   * simulation; then the finest with the real one. False, with the values as they were, where
   * either has no equilibrium on this way.
   */
  bool ByScout()
  {
    std::vector<RegistrationModel> scouts = this->Models;
    std::vector<std::vector<double>> starts;
    const std::size_t finest = this->Options.PixelSizesMm.size() - 1;
    try
    {
      for (std::size_t view = 0; view < scouts.size(); ++view)
      {
        RegistrationResult& result = this->Joint.Views[view];
        starts.push_back(result.Values);
        scouts[view].Simulation = this->Models[view].Scout;
        scouts[view].SurfaceEmbedding = this->Models[view].ScoutEmbedding;
        result.State =
          CompressForStart(scouts[view], result.Values, nullptr, result, this->Progress);
        this->KeepBefore(scouts[view], view);
        this->Choose(scouts[view], view);
      }
      const bool goesOn = this->Levels(scouts, 0, finest);
      // A stop takes effect once the real simulation has been where the cheap one got to.
      for (std::size_t view = 0; view < scouts.size(); ++view)
      {
        RegistrationResult& result = this->Joint.Views[view];
        result.State = CompressForStart(this->Models[view], result.Values, nullptr, result,
          goesOn ? this->Progress : ProgressCallback());
      }
      if (goesOn)
      {
        this->Levels(this->Models, finest, finest + 1);
      }
      return true;
    }
    catch (const ConvergenceError&)
    {
      for (std::size_t view = 0; view < starts.size(); ++view)
      {
        this->Joint.Views[view].Values = starts[view];
      }
      return false;
    }
  }

  /// What the options say, with the bounds of a view's result.
  RegistrationOptions Bounded(std::size_t view) const
  {
    RegistrationOptions bounded = this->Options;
    bounded.Parameters = this->Joint.Views[view].Parameters;
    return bounded;
  }

  void KeepBefore(const RegistrationModel& model, std::size_t view)
  {
    RegistrationResult& result = this->Joint.Views[view];
    const RegistrationTarget finest =
      CoarsenTo(*this->Views[view].Target, this->Options.PixelSizesMm.back());
    result.Before =
      Compare(Synthesize(model, PoseOf(result.Values), result.State, finest, this->Options.Samples),
        finest);
  }

  void Choose(const RegistrationModel& model, std::size_t view)
  {
    ChooseStart(model, CoarsenTo(*this->Views[view].Target, this->Options.PixelSizesMm.front()),
      this->Bounded(view), this->Joint.Views[view], this->Progress);
  }

  /// Where the search stands, with the prior of a shared parameter counted once.
  std::vector<EvaluatedView> Evaluated(const std::vector<RegistrationModel>& models,
    double pixelSizeMm) const
  {
    std::vector<EvaluatedView> evaluated;
    for (std::size_t view = 0; view < this->Views.size(); ++view)
    {
      const RegistrationResult& result = this->Joint.Views[view];
      evaluated.push_back({ &models[view], CoarsenTo(*this->Views[view].Target, pixelSizeMm),
        this->Bounded(view), result.Values, result.State });
      for (int index = 0; index < ParameterCount; ++index)
      {
        if (IsShared(index) && view > 0)
        {
          evaluated.back().Options.Parameters[index].PriorSigma = 0;
        }
      }
    }
    return evaluated;
  }

  /// Searches resolutions from `first` to before `last`; false when stopped by the user.
  bool Levels(const std::vector<RegistrationModel>& models, std::size_t first, std::size_t last)
  {
    const ProgressCallback progress = [this](double, const char* stage)
    {
      const auto iterations = static_cast<double>(this->Joint.Views.front().Iterations.size());
      // A typical number.
      const double expected = 6.0 * static_cast<double>(this->Options.PixelSizesMm.size());
      return !this->Progress || this->Progress(iterations / (iterations + expected), stage);
    };
    const bool scouts = models.front().Simulation == this->Models.front().Scout;
    for (std::size_t number = first; number < last && !this->Unknowns.empty(); ++number)
    {
      const double pixelSizeMm = this->Options.PixelSizesMm[number];
      const Level level{ pixelSizeMm, scouts ? NegligibleFallOfScout : NegligibleFall,
        this->Options.MaximumIterations, pixelSizeMm == this->Options.PixelSizesMm.back() };
      const LevelEnd end = SearchLevel(this->Evaluated(models, pixelSizeMm), this->Unknowns, level,
        this->Begin, this->Joint, progress);
      if (end != LevelEnd::Reached)
      {
        return end != LevelEnd::Stopped;
      }
    }
    return true;
  }

  const std::vector<RegistrationView>& Views;
  const RegistrationOptions& Options;
  JointRegistrationResult& Joint;
  const ProgressCallback& Progress;
  std::vector<RegistrationModel> Models;
  std::vector<SearchUnknown> Unknowns;
  Clock::time_point Begin = Clock::now();
};

/// What the search of a view begins with.
RegistrationResult StartOf(const RegistrationView& view)
{
  RegistrationResult result;
  result.Parameters = view.Parameters;
  result.Values = view.From;
  for (const RegistrationParameter& parameter : view.Parameters)
  {
    if (view.From.empty())
    {
      result.Values.push_back(parameter.Start);
    }
  }
  result.StandardDeviations.assign(ParameterCount, std::numeric_limits<double>::quiet_NaN());
  // Holds unless there is something to search.
  result.StopReason = "nothing to optimise: every parameter is fixed";
  result.Converged = true;
  return result;
}
}

bool IsShared(int parameter)
{
  return parameter == StiffnessParameter;
}

JointRegistrationResult RegisterTogether(const std::vector<RegistrationView>& views,
  const RegistrationOptions& options, const ProgressCallback& progress)
{
  ValidateViews(views, options);
  const auto begin = Clock::now();
  JointRegistrationResult joint;
  for (const RegistrationView& view : views)
  {
    joint.Views.push_back(StartOf(view));
  }
  Search(views, options, joint, progress).Run();
  for (std::size_t view = 0; view < views.size(); ++view)
  {
    RegistrationResult& result = joint.Views[view];
    const RegistrationTarget finest = CoarsenTo(*views[view].Target, options.PixelSizesMm.back());
    result.Pose = PoseOf(result.Values);
    result.Stiffness = result.Values[StiffnessParameter];
    result.After = Compare(
      Synthesize(*views[view].Model, result.Pose, result.State, finest, options.Samples), finest);
  }
  for (RegistrationResult& result : joint.Views)
  {
    result.Seconds = SecondsSince(begin);
  }
  return joint;
}

RegistrationResult Register(const RegistrationModel& model, const RegistrationTarget& target,
  const RegistrationOptions& options, const ProgressCallback& progress)
{
  const RegistrationView view{ &model, &target, options.Parameters, options.From };
  return std::move(RegisterTogether({ view }, options, progress).Views.front());
}
}
