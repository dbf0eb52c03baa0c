// SPDX-License-Identifier: Apache-2.0
#include "Registration.h"

#include "Error.h"
#include "TargetImage.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

namespace mammoray
{
namespace
{
/// Poses without an equilibrium, of one resolution, after which a search ends: each costs many
/// times what a good one does, and the best match lies where the breast cannot be compressed to.
constexpr int LargestNumberOfFailures = 5;
/// Of the cost in an iteration. Residuals are in standard deviations: parameters that are half of
/// their own from the best cost this much more.
constexpr double NegligibleFall = 0.125;

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point begin)
{
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Half the sums of squares of residuals as Ceres' robust loss counts them.
struct TermCosts
{
  double Outline = 0;
  double Intensity = 0;
  double Prior = 0;

  double Sum() const { return this->Outline + this->Intensity + this->Prior; }
};

TermCosts CostsOf(const RegistrationResiduals& compared, const RegistrationOptions& options,
  const std::vector<double>& residuals)
{
  TermCosts costs;
  const double width = options.RobustWidth;
  const std::size_t outline = compared.NumberOfOutlineResiduals();
  const std::size_t pictures = outline + compared.NumberOfIntensityResiduals();
  for (std::size_t index = 0; index < residuals.size(); ++index)
  {
    const double r = std::abs(residuals[index]);
    const double robust = r <= width ? 0.5 * r * r : width * r - 0.5 * width * width;
    if (index < outline)
    {
      costs.Outline += robust;
    }
    else if (index < pictures)
    {
      costs.Intensity += robust;
    }
    else
    {
      costs.Prior += 0.5 * r * r;
    }
  }
  return costs;
}

/// The residuals of a level for Ceres, with the equilibrium they belong to.
class Evaluator : public ceres::EvaluationCallback
{
public:
  Evaluator(const RegistrationModel& model, const RegistrationTarget& target,
    const RegistrationOptions& options, const std::vector<int>& freeParameters,
    const std::vector<double>& start, const CompressionState& startState,
    const ProgressCallback& progress)
    : Compared(model, target, options)
    , Free(freeParameters)
    , Values(start)
    , State(startState)
    , Model(model)
    , Options(options)
    , Progress(progress)
  {
    for (const int parameter : this->Free)
    {
      this->Unknowns.push_back(start[parameter] / options.Parameters[parameter].Scale);
    }
  }

  void PrepareForEvaluation(bool evaluateJacobians, bool /*newPoint*/) override
  {
    if (!this->Evaluated || this->Unknowns != this->EvaluatedAt)
    {
      this->EvaluatedAt = this->Unknowns;
      this->Evaluated = true;
      this->HasJacobian = false;
      this->Valid = this->EvaluateResiduals();
    }
    if (evaluateJacobians && this->Valid && !this->HasJacobian)
    {
      this->EvaluateJacobian();
      this->HasJacobian = true;
    }
  }

  /// The next evaluation starts at this state and is not refused.
  void ReturnTo(const CompressionState& state)
  {
    this->State = state;
    this->LongestTravelMm = std::numeric_limits<double>::infinity();
    this->Failures = 0;
  }

  TermCosts Costs() const { return CostsOf(this->Compared, this->Options, this->Residuals); }

  const RegistrationResiduals Compared;
  const std::vector<int> Free;
  /// Ceres' parameter block: the free values over their scales.
  std::vector<double> Unknowns;
  /// Values of all parameters at the evaluated point.
  std::vector<double> Values;
  /// Equilibrium at the evaluated point, and where the next one starts.
  CompressionState State;
  std::vector<double> Residuals;
  /// Column f is d residuals / d Unknowns[f].
  std::vector<std::vector<double>> Jacobian;
  bool Valid = false;
  bool Stopped = false;
  /// Poses without an equilibrium that were tried.
  int Failures = 0;
  int Evaluations = 0;
  int Projections = 0;
  double MechanicsSeconds = 0;
  double ProjectionSeconds = 0;
  double JacobianSeconds = 0;

private:
  bool EvaluateResiduals()
  {
    for (std::size_t f = 0; f < this->Free.size(); ++f)
    {
      this->Values[this->Free[f]] =
        this->Unknowns[f] * this->Options.Parameters[this->Free[f]].Scale;
    }
    const PlatePair plates = PlatesAt(this->Model, PoseOf(this->Values));
    const double travelMm = TravelMm(PlateMotion(SlidTowards(this->State.Plates, plates), plates));
    if (travelMm > this->LongestTravelMm || this->Failures >= LargestNumberOfFailures)
    {
      return false; // costs nothing, and Ceres shortens its step or gives up
    }
    const auto begin = Clock::now();
    try
    {
      this->State = CompressAt(this->Model, this->Values, &this->State, this->Progress);
      ++this->Evaluations;
      this->MechanicsSeconds += SecondsSince(begin);
      this->LongestTravelMm = std::max(this->LongestTravelMm, 2 * travelMm);
      ReportProgress(this->Progress, 0, "project");
    }
    catch (const Interrupted&)
    {
      this->Stopped = true;
      // Stale residuals: Ceres must not take the stop for a failure; the recorder ends the search.
      return !this->Residuals.empty();
    }
    catch (const ConvergenceError&)
    {
      ++this->Failures;
      ++this->Evaluations;
      this->MechanicsSeconds += SecondsSince(begin);
      this->LongestTravelMm = travelMm > 0 ? 0.5 * travelMm : this->LongestTravelMm;
      return false; // no equilibrium there: Ceres shortens its step
    }
    const auto projecting = Clock::now();
    this->Residuals = this->Compared.Evaluate(this->Values, this->State);
    this->ProjectionSeconds += SecondsSince(projecting);
    ++this->Projections;
    return true;
  }

  void EvaluateJacobian()
  {
    this->Jacobian.assign(this->Free.size(),
      std::vector<double>(this->Compared.NumberOfResiduals(), 0.0));
    if (this->Stopped)
    {
      return; // zeros; see EvaluateResiduals
    }
    const auto begin = Clock::now();
    RegistrationResiduals::Jacobian jacobian =
      this->Compared.Differentiate(this->Values, this->State, this->Free);
    for (std::size_t f = 0; f < this->Free.size(); ++f)
    {
      this->Jacobian[f] = std::move(jacobian.Columns[this->Free[f]]);
      for (double& entry : this->Jacobian[f])
      {
        entry *= this->Options.Parameters[this->Free[f]].Scale;
      }
    }
    this->JacobianSeconds += SecondsSince(begin);
  }

  const RegistrationModel& Model;
  const RegistrationOptions& Options;
  const ProgressCallback& Progress;
  /// A longer way of the plates from State is refused unseen: half of what failed last, twice of
  /// what succeeded. The first is a step that a phantom's compression still follows.
  double LongestTravelMm = 20;
  std::vector<double> EvaluatedAt;
  bool Evaluated = false;
  bool HasJacobian = false;
};

/// One residual of an Evaluator, so that Ceres can weigh each by its robust loss.
class ResidualCost : public ceres::CostFunction
{
public:
  ResidualCost(const Evaluator& evaluator, std::size_t index)
    : Source(evaluator)
    , Index(index)
  {
    this->set_num_residuals(1);
    this->mutable_parameter_block_sizes()->push_back(static_cast<int>(evaluator.Free.size()));
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
      for (std::size_t f = 0; f < this->Source.Free.size(); ++f)
      {
        jacobians[0][f] = this->Source.Jacobian[f][this->Index];
      }
    }
    return true;
  }

private:
  const Evaluator& Source;
  std::size_t Index;
};

/// Keeps the accepted states, tells of progress and stops when asked.
class IterationRecorder : public ceres::IterationCallback
{
public:
  IterationRecorder(const Evaluator& evaluator, RegistrationResult& result, double pixelSizeMm,
    Clock::time_point begin)
    : Source(evaluator)
    , Result(result)
    , PixelSizeMm(pixelSizeMm)
    , Begin(begin)
  {
  }

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override
  {
    if (this->Source.Stopped || this->Source.Failures >= LargestNumberOfFailures)
    {
      return ceres::SOLVER_ABORT;
    }
    if (summary.iteration == 0 || summary.step_is_successful)
    {
      // Ceres has just evaluated the Jacobian at the accepted point, so the evaluator stands there.
      const TermCosts costs = this->Source.Costs();
      RegistrationIteration row;
      row.Number = static_cast<int>(this->Result.Iterations.size());
      row.Parameters = this->Source.Values;
      row.PixelSizeMm = this->PixelSizeMm;
      row.OutlineCost = costs.Outline;
      row.IntensityCost = costs.Intensity;
      row.PriorCost = costs.Prior;
      row.Cost = costs.Sum();
      row.Seconds = SecondsSince(this->Begin);
      this->Settled = summary.iteration > 0 && summary.cost_change < NegligibleFall;
      this->Result.Iterations.push_back(row);
      this->Result.Values = this->Source.Values;
      this->Result.State = this->Source.State;
    }
    return this->Settled ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

private:
  const Evaluator& Source;
  RegistrationResult& Result;
  double PixelSizeMm;
  Clock::time_point Begin;
  bool Settled = false;
};

void ValidateModel(const RegistrationModel& model, const RegistrationOptions& options)
{
  if (!model.Simulation || !model.Surface || !model.SurfaceEmbedding || !model.Projector ||
    !model.XRays)
  {
    throw InputError("registration: expected a simulation, a surface with its embedding, a "
                     "projector and a beam, found one missing");
  }
  if (options.Parameters.size() != ParameterCount)
  {
    throw InputError("registration: expected " + std::to_string(ParameterCount) +
      " parameters, found " + std::to_string(options.Parameters.size()));
  }
  for (const RegistrationParameter& parameter : options.Parameters)
  {
    if (!(parameter.Lower <= parameter.Start && parameter.Start <= parameter.Upper) ||
      !(parameter.Scale > 0))
    {
      throw InputError("registration: parameter " + parameter.Name +
        ": expected lower <= start <= "
        "upper and a positive scale, found " +
        std::to_string(parameter.Lower) + ", " + std::to_string(parameter.Start) + ", " +
        std::to_string(parameter.Upper) + ", " + std::to_string(parameter.Scale));
    }
  }
  if (!options.Parameters[StiffnessParameter].Fixed && model.ScaledMaterials.empty())
  {
    throw InputError("registration: expected a material whose stiffness is to be found, such as "
                     "gland, found none");
  }
  for (const int index : model.ScaledMaterials)
  {
    if (index < 0 || static_cast<std::size_t>(index) >= model.Elastic.size())
    {
      throw InputError("registration: expected a material of the " +
        std::to_string(model.Elastic.size()) + " known to scale, found number " +
        std::to_string(index));
    }
  }
  if (!options.From.empty())
  {
    if (options.From.size() != ParameterCount)
    {
      throw InputError("registration: expected " + std::to_string(ParameterCount) +
        " values to begin at, found " + std::to_string(options.From.size()));
    }
    for (int index = 0; index < ParameterCount; ++index)
    {
      const RegistrationParameter& parameter = options.Parameters[index];
      if (!parameter.Fixed &&
        !(parameter.Lower <= options.From[index] && options.From[index] <= parameter.Upper))
      {
        throw InputError("registration: parameter " + parameter.Name +
          ": expected a beginning from " + std::to_string(parameter.Lower) + " to " +
          std::to_string(parameter.Upper) + ", found " + std::to_string(options.From[index]));
      }
    }
  }
  if (options.PixelSizesMm.empty() || options.Samples < 1 || options.OutlineDirections < 10)
  {
    throw InputError("registration: expected at least one pixel size, one sample and ten outline "
                     "directions");
  }
}

/// CompressAt before the search, counted and timed; cold where it fails from `start`.
CompressionState CompressForStart(const RegistrationModel& model, const std::vector<double>& values,
  const CompressionState* start, RegistrationResult& result, const ProgressCallback& progress)
{
  ++result.Evaluations;
  const auto begin = Clock::now();
  try
  {
    CompressionState state = CompressAt(model, values, start, progress);
    result.MechanicsSeconds += SecondsSince(begin);
    return state;
  }
  catch (const ConvergenceError&)
  {
    result.MechanicsSeconds += SecondsSince(begin);
    if (!start || !result.Warnings.empty())
    {
      throw;
    }
  }
  return CompressForStart(model, values, nullptr, result, progress);
}

/// Extent of the body at rest along the beam's axis, mm.
double UncompressedHeight(const RegistrationModel& model, const BreastPose& pose)
{
  const Vector3 axis = PlaceUnit(model.Axes, model.Anchor, model.Unit, pose).Z;
  const std::vector<double>& points = model.Simulation->RestPositions();
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (std::size_t index = 0; index < points.size(); index += 3)
  {
    const double height = Dot({ points[index], points[index + 1], points[index + 2] }, axis);
    low = std::min(low, height);
    high = std::max(high, height);
  }
  return high - low;
}

/**
 * The equilibrium at the start. A breast is compressed to about half its height; a start below that
 * belongs to another breast and costs minutes to fail, so thickness is opened and bounded there,
 * with a warning, and again where even that has no equilibrium.
 */
CompressionState CompressStart(const RegistrationModel& model, RegistrationResult& result,
  const ProgressCallback& progress)
{
  RegistrationParameter& thickness = result.Parameters[ThicknessParameter];
  double& value = result.Values[ThicknessParameter];
  const double height = UncompressedHeight(model, PoseOf(result.Values));
  const auto open = [&](double thicknessMm)
  {
    char sentence[240];
    std::snprintf(sentence, sizeof sentence,
      "The breast of the volume is %.0f mm high; it is not compressed to the %.1f mm the search "
      "should start from, but "
      "to no less than %.1f mm.",
      height, value, thicknessMm);
    result.Warnings.push_back(sentence);
    value = thicknessMm;
    thickness.Start = thicknessMm;
    thickness.Lower = thicknessMm;
    thickness.Upper = std::max(thickness.Upper, 1.5 * thicknessMm);
  };
  const double least = 0.5 * height;
  if (!thickness.Fixed && value < least)
  {
    open(least);
  }
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
      if (thickness.Fixed || attempt == attempts || !(opened > value))
      {
        throw;
      }
      open(opened);
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

/// The target in pixels of about `pixelSizeMm`.
RegistrationTarget CoarsenTo(const RegistrationTarget& target, double pixelSizeMm)
{
  const double pixel = std::hypot(target.ColumnStep[0], target.ColumnStep[1]);
  return Coarsen(target, std::max(1, static_cast<int>(std::lround(pixelSizeMm / pixel))));
}

/**
 * Moves values to where the outlines meet, with their equilibrium `state`. Lateral first, which the
 * plates do not feel; without an equilibrium on the way to the chest wall it is kept alone.
 */
void MoveToOutline(const RegistrationModel& model, const RegistrationTarget& target,
  RegistrationResult& result, std::vector<double>& values, CompressionState& state,
  const ProgressCallback& progress)
{
  std::vector<double> aligned = values;
  AlignStart(model, target, state, result.Parameters, aligned);
  for (const int parameter : { LateralParameter, AnteriorParameter })
  {
    std::vector<double> shifted = values;
    shifted[parameter] = aligned[parameter];
    try
    {
      state = CompressForStart(model, shifted, &state, result, progress);
      values = shifted;
    }
    catch (const ConvergenceError&)
    {
      break;
    }
  }
}

/**
 * Of the start and others with the roll beside it, each moved to where the outlines meet, the one
 * whose picture matches best: a picture changes little with the roll and has more than one valley.
 */
void ChooseStart(const RegistrationModel& model, const RegistrationTarget& target,
  const RegistrationOptions& options, RegistrationResult& result, const ProgressCallback& progress)
{
  const RegistrationResiduals compared(model, target, options);
  const std::vector<double> from = result.Values;
  const CompressionState fromState = result.State;
  double best = std::numeric_limits<double>::infinity();
  std::vector<double> offsets{ 0 };
  // A start that had to be opened is another breast's: every equilibrium costs much there.
  if (!result.Parameters[RollParameter].Fixed && result.Warnings.empty())
  {
    offsets.insert(offsets.end(), options.RollOffsetsDeg.begin(), options.RollOffsetsDeg.end());
  }
  for (const double offset : offsets)
  {
    const RegistrationParameter& roll = result.Parameters[RollParameter];
    std::vector<double> values = from;
    values[RollParameter] += offset;
    if (values[RollParameter] < roll.Lower || values[RollParameter] > roll.Upper)
    {
      continue;
    }
    try
    {
      CompressionState state = fromState;
      if (offset != 0)
      {
        state = CompressForStart(model, values, &fromState, result, progress);
      }
      MoveToOutline(model, target, result, values, state, progress);
      const double cost = CostsOf(compared, options, compared.Evaluate(values, state)).Sum();
      ++result.Projections;
      if (cost < best)
      {
        best = cost;
        result.Values = values;
        result.State = state;
      }
    }
    catch (const ConvergenceError&)
    {
      // No equilibrium there: one of the others.
    }
  }
}

/// Standard deviations and covariance of the free parameters at the evaluator's solution.
void KeepCovariance(ceres::Problem& problem, Evaluator& evaluator, RegistrationResult& result)
{
  evaluator.ReturnTo(result.State);
  ceres::Covariance covariance{ ceres::Covariance::Options() };
  const std::vector<const double*> blocks{ evaluator.Unknowns.data() };
  if (!covariance.Compute(blocks, &problem))
  {
    return;
  }
  const std::size_t n = evaluator.Free.size();
  std::vector<double> matrix(n * n);
  covariance.GetCovarianceBlock(evaluator.Unknowns.data(), evaluator.Unknowns.data(),
    matrix.data());
  result.Covariance.assign(std::size_t{ ParameterCount } * ParameterCount, 0.0);
  for (std::size_t f = 0; f < n; ++f)
  {
    const int row = evaluator.Free[f];
    for (std::size_t g = 0; g < n; ++g)
    {
      const int column = evaluator.Free[g];
      result.Covariance[row * ParameterCount + column] =
        matrix[f * n + g] * result.Parameters[row].Scale * result.Parameters[column].Scale;
    }
    result.StandardDeviations[row] = std::sqrt(result.Covariance[row * (ParameterCount + 1)]);
  }
}

/// Searches at one resolution; false where that ends the search.
bool SearchLevel(const RegistrationModel& model, const RegistrationTarget& coarse,
  const RegistrationOptions& options, double pixelSizeMm, const std::vector<int>& freeParameters,
  Clock::time_point begin, RegistrationResult& result, const ProgressCallback& progress)
{
  Evaluator evaluator(model, coarse, options, freeParameters, result.Values, result.State,
    progress);
  ceres::Problem::Options problemOptions;
  problemOptions.evaluation_callback = &evaluator;
  ceres::Problem problem(problemOptions);
  const std::size_t robustCount =
    evaluator.Compared.NumberOfOutlineResiduals() + evaluator.Compared.NumberOfIntensityResiduals();
  for (std::size_t index = 0; index < evaluator.Compared.NumberOfResiduals(); ++index)
  {
    problem.AddResidualBlock(new ResidualCost(evaluator, index),
      index < robustCount ? new ceres::HuberLoss(options.RobustWidth) : nullptr,
      evaluator.Unknowns.data());
  }
  for (std::size_t f = 0; f < freeParameters.size(); ++f)
  {
    const RegistrationParameter& parameter = result.Parameters[freeParameters[f]];
    problem.SetParameterLowerBound(evaluator.Unknowns.data(), static_cast<int>(f),
      parameter.Lower / parameter.Scale);
    problem.SetParameterUpperBound(evaluator.Unknowns.data(), static_cast<int>(f),
      parameter.Upper / parameter.Scale);
  }
  ceres::Solver::Options solverOptions;
  solverOptions.max_num_iterations = options.MaximumIterations;
  solverOptions.linear_solver_type = ceres::DENSE_QR;
  solverOptions.logging_type = ceres::SILENT;
  // A cost that falls by a thousandth tells nothing more: residuals are in standard deviations.
  solverOptions.function_tolerance = 1e-3;
  solverOptions.parameter_tolerance = 1e-3;
  solverOptions.update_state_every_iteration = true;
  solverOptions.initial_trust_region_radius = 1e2;
  solverOptions.max_num_consecutive_invalid_steps = 10;
  IterationRecorder recorder(evaluator, result, pixelSizeMm, begin);
  solverOptions.callbacks.push_back(&recorder);
  ceres::Solver::Summary summary;
  ceres::Solve(solverOptions, &problem, &summary);
  result.Evaluations += evaluator.Evaluations;
  result.Projections += evaluator.Projections;
  result.MechanicsSeconds += evaluator.MechanicsSeconds;
  result.ProjectionSeconds += evaluator.ProjectionSeconds;
  result.JacobianSeconds += evaluator.JacobianSeconds;
  result.Converged = false;
  if (evaluator.Stopped)
  {
    result.StopReason = "interrupted; this is the best pose so far";
    return false;
  }
  if (evaluator.Failures >= LargestNumberOfFailures)
  {
    result.StopReason = std::to_string(evaluator.Failures) +
      " poses on the way to a better match had no equilibrium; this is the best pose that has one";
    return false;
  }
  result.Converged = summary.IsSolutionUsable() &&
    (summary.termination_type == ceres::CONVERGENCE ||
      summary.termination_type == ceres::USER_SUCCESS);
  // Like our own reasons, without a full stop.
  result.StopReason = summary.termination_type == ceres::USER_SUCCESS
    ? "the cost falls by less than half a standard deviation of the parameters makes"
    : summary.message.substr(0, summary.message.find_last_not_of(". ") + 1);
  if (summary.termination_type == ceres::FAILURE)
  {
    return false;
  }
  if (pixelSizeMm == options.PixelSizesMm.back())
  {
    KeepCovariance(problem, evaluator, result);
  }
  return true;
}
}

RegistrationResult Register(const RegistrationModel& model, const RegistrationTarget& target,
  const RegistrationOptions& options, const ProgressCallback& progress)
{
  ValidateModel(model, options);
  ValidateTarget(target);
  const auto begin = Clock::now();
  RegistrationResult result;
  result.Parameters = options.Parameters;
  std::vector<int> freeParameters;
  for (int index = 0; index < ParameterCount; ++index)
  {
    result.Values.push_back(options.Parameters[index].Start);
    if (!options.Parameters[index].Fixed)
    {
      freeParameters.push_back(index);
    }
  }
  if (!options.From.empty())
  {
    result.Values = options.From;
  }
  result.StandardDeviations.assign(ParameterCount, std::numeric_limits<double>::quiet_NaN());

  result.State = CompressStart(model, result, progress);
  const RegistrationTarget finest = CoarsenTo(target, options.PixelSizesMm.back());
  result.Before = Compare(
    Synthesize(model, PoseOf(result.Values), result.State, finest, options.Samples), finest);
  RegistrationOptions search = options;
  search.Parameters = result.Parameters;
  result.StopReason = "nothing to optimise: every parameter is fixed";
  result.Converged = freeParameters.empty();
  if (!freeParameters.empty() && options.From.empty())
  {
    ChooseStart(model, CoarsenTo(target, options.PixelSizesMm.front()), search, result, progress);
  }

  const ProgressCallback searchProgress = [&](double, const char* stage)
  {
    const auto iterations = static_cast<double>(result.Iterations.size());
    // A typical number.
    const double expected = 6.0 * static_cast<double>(options.PixelSizesMm.size());
    return !progress || progress(iterations / (iterations + expected), stage);
  };
  for (const double pixelSizeMm : options.PixelSizesMm)
  {
    if (freeParameters.empty() ||
      !SearchLevel(model, CoarsenTo(target, pixelSizeMm), search, pixelSizeMm, freeParameters,
        begin, result, searchProgress))
    {
      break;
    }
  }
  result.Pose = PoseOf(result.Values);
  result.Stiffness = result.Values[StiffnessParameter];
  result.After =
    Compare(Synthesize(model, result.Pose, result.State, finest, options.Samples), finest);
  result.Seconds = SecondsSince(begin);
  return result;
}
}
