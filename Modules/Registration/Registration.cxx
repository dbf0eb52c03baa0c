// SPDX-License-Identifier: Apache-2.0
#include "Registration.h"

#include "Error.h"
#include "Private/ValidateRegistration.h"
#include "TargetImage.h"

#include <Eigen/Dense>
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
/// Of the cost, to the bottom of its quadratic model. Residuals are in standard deviations:
/// parameters that are half of their own from the best cost this much more. The cheap simulation is
/// off by more than two.
constexpr double NegligibleFall = 0.125;
constexpr double NegligibleFallOfScout = 2;

/// Beyond this way of the plates a cold start costs less than going there from another state, mm.
constexpr double LongestWarmTravelMm = 8;

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point begin)
{
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// How far the plates are from those of a state, mm.
double TravelFrom(const CompressionState& state, const RegistrationModel& model,
  const std::vector<double>& values)
{
  const PlatePair plates = PlatesAt(model, PoseOf(values));
  return TravelMm(PlateMotion(SlidTowards(state.Plates, plates), plates));
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
    this->StateIsAt = this->Unknowns;
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
    }
  }

  /// Back to an equilibrium, that of the unknowns as they are now.
  void ReturnTo(const CompressionState& state)
  {
    this->State = state;
    this->StateIsAt = this->Unknowns;
    this->Failures = 0;
  }

  RegistrationCosts Costs() const { return this->Compared.Costs(this->Residuals); }

  /**
   * How far the cost falls from the evaluated point to the bottom of its Gauss-Newton model,
   * g^T H^-1 g / 2, residuals weighted as by the robust loss. Parameters that are at a bound and
   * would go beyond it stay.
   */
  double PredictedFall() const
  {
    const auto count = static_cast<Eigen::Index>(this->Free.size());
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(count);
    const std::size_t robust = this->Residuals.size() - this->Compared.NumberOfPriors();
    Eigen::VectorXd row(count);
    for (std::size_t index = 0; index < this->Residuals.size(); ++index)
    {
      const double r = this->Residuals[index];
      const double weight = index < robust && std::abs(r) > this->Options.RobustWidth
        ? this->Options.RobustWidth / std::abs(r)
        : 1.0;
      for (Eigen::Index f = 0; f < count; ++f)
      {
        row[f] = this->Jacobian[static_cast<std::size_t>(f)][index];
      }
      hessian += weight * row * row.transpose();
      gradient += weight * r * row;
    }
    for (Eigen::Index f = 0; f < count; ++f)
    {
      if (this->IsStoppedByBound(static_cast<std::size_t>(f), gradient[f]))
      {
        gradient[f] = 0;
        hessian.row(f).setZero();
        hessian.col(f).setZero();
        hessian(f, f) = 1;
      }
    }
    return 0.5 * gradient.dot(hessian.ldlt().solve(gradient));
  }

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
  bool IsStoppedByBound(std::size_t free, double slope) const
  {
    const RegistrationParameter& parameter = this->Options.Parameters[this->Free[free]];
    const double value = this->Unknowns[free] * parameter.Scale;
    const double near = 1e-6 * parameter.Scale;
    return (slope > 0 && value < parameter.Lower + near) ||
      (slope < 0 && value > parameter.Upper - near);
  }

  bool EvaluateResiduals()
  {
    for (std::size_t f = 0; f < this->Free.size(); ++f)
    {
      this->Values[this->Free[f]] =
        this->Unknowns[f] * this->Options.Parameters[this->Free[f]].Scale;
    }
    return (this->Unknowns == this->StateIsAt || this->Compress()) && this->Compare();
  }

  /// Whether there is an equilibrium at Values, which State then is.
  bool Compress()
  {
    const double travelMm = TravelFrom(this->State, this->Model, this->Values);
    if (travelMm > this->LongestTravelMm || this->Failures >= LargestNumberOfFailures)
    {
      return false; // costs nothing, and Ceres shortens its step or gives up
    }
    const auto begin = Clock::now();
    try
    {
      this->State = CompressAt(this->Model, this->Values,
        travelMm > LongestWarmTravelMm ? nullptr : &this->State, this->Progress);
      this->StateIsAt = this->Unknowns;
      ++this->Evaluations;
      this->MechanicsSeconds += SecondsSince(begin);
      this->LongestTravelMm = std::max(this->LongestTravelMm, 2 * travelMm);
      return true;
    }
    catch (const Interrupted&)
    {
      return this->Stop();
    }
    catch (const ConvergenceError&)
    {
      ++this->Failures;
      ++this->Evaluations;
      this->MechanicsSeconds += SecondsSince(begin);
      this->LongestTravelMm = travelMm > 0 ? 0.5 * travelMm : this->LongestTravelMm;
      return false; // no equilibrium there: Ceres shortens its step
    }
  }

  /// The answer to Ceres: with stale residuals it must not take the stop for a failure; the
  /// recorder ends the search.
  bool Stop()
  {
    this->Stopped = true;
    return !this->Residuals.empty();
  }

  bool Compare()
  {
    if (this->Stopped || (this->Progress && !this->Progress(0, "project")))
    {
      return this->Stop();
    }
    const auto begin = Clock::now();
    this->Residuals = this->Compared.Evaluate(this->Values, this->State);
    this->ProjectionSeconds += SecondsSince(begin);
    ++this->Projections;
    return true;
  }

  void EvaluateJacobian()
  {
    this->Jacobian.assign(this->Free.size(),
      std::vector<double>(this->Compared.NumberOfResiduals(), 0.0));
    this->HasJacobian = true;
    if (this->Stopped)
    {
      return; // zeros; see Stop
    }
    const auto begin = Clock::now();
    if (this->Options.Derivatives == RegistrationDerivatives::CentralDifferences)
    {
      this->Valid = this->DifferentiateByDifferences();
      this->JacobianSeconds += SecondsSince(begin);
      return;
    }
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

public:
  /// Residuals beside the evaluated point for Ceres' differences, which are relative to their
  /// argument: offsets[0][f] is 1 at the point, and 1 more one scale of parameter f beside it.
  bool operator()(const double* const* offsets, double* residuals) const
  {
    std::vector<double> beside = this->Values;
    bool moved = false;
    for (std::size_t f = 0; f < this->Free.size(); ++f)
    {
      moved = moved || offsets[0][f] != 1;
      beside[this->Free[f]] += (offsets[0][f] - 1) * this->Options.Parameters[this->Free[f]].Scale;
    }
    std::vector<double> found = this->Residuals;
    if (moved)
    {
      try
      {
        const CompressionState state =
          CompressAt(this->Model, beside, &this->State, this->Progress);
        found = this->Compared.Evaluate(beside, state);
      }
      catch (const ConvergenceError&)
      {
        return false;
      }
    }
    std::copy(found.begin(), found.end(), residuals);
    return true;
  }

private:
  /// False where a point beside this one has no equilibrium.
  bool DifferentiateByDifferences()
  {
    ceres::NumericDiffOptions steps;
    steps.relative_step_size = this->Options.DifferenceStep;
    ceres::DynamicNumericDiffCostFunction<Evaluator, ceres::CENTRAL> differences(this,
      ceres::DO_NOT_TAKE_OWNERSHIP, steps);
    const auto unknowns = static_cast<int>(this->Free.size());
    const std::size_t count = this->Residuals.size();
    differences.AddParameterBlock(unknowns);
    differences.SetNumResiduals(static_cast<int>(count));
    const std::vector<double> here(this->Free.size(), 1.0);
    const double* const block = here.data();
    std::vector<double> residuals(count);
    std::vector<double> matrix(count * this->Free.size());
    double* rows = matrix.data();
    try
    {
      if (!differences.Evaluate(&block, residuals.data(), &rows))
      {
        return false;
      }
    }
    catch (const Interrupted&)
    {
      return this->Stop();
    }
    this->Evaluations += 2 * unknowns;
    this->Projections += 2 * unknowns;
    for (std::size_t index = 0; index < count; ++index)
    {
      for (std::size_t f = 0; f < this->Free.size(); ++f)
      {
        this->Jacobian[f][index] = matrix[index * this->Free.size() + f];
      }
    }
    return true;
  }

  const RegistrationModel& Model;
  const RegistrationOptions& Options;
  const ProgressCallback& Progress;
  /// A longer way of the plates from State is refused unseen: half of what failed last, twice of
  /// what succeeded. The first is a step that a phantom's compression still follows.
  double LongestTravelMm = 20;
  /// The unknowns whose equilibrium State is.
  std::vector<double> StateIsAt;
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
    double negligibleFall, Clock::time_point begin)
    : Source(evaluator)
    , Result(result)
    , PixelSizeMm(pixelSizeMm)
    , LeastFall(negligibleFall)
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
      const RegistrationCosts costs = this->Source.Costs();
      RegistrationIteration row;
      row.Number = static_cast<int>(this->Result.Iterations.size());
      row.Parameters = this->Source.Values;
      row.PixelSizeMm = this->PixelSizeMm;
      row.OutlineCost = costs.Outline;
      row.IntensityCost = costs.Intensity;
      row.PriorCost = costs.Prior;
      row.Cost = costs.Sum();
      row.Seconds = SecondsSince(this->Begin);
      this->Settled = this->Source.PredictedFall() < this->LeastFall;
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

enum class LevelEnd
{
  Reached,
  /// The next level has nothing to go on from.
  Failed,
  /// By the user.
  Stopped
};

/// Searches at one resolution.
LevelEnd SearchLevel(const RegistrationModel& model, const RegistrationTarget& coarse,
  const RegistrationOptions& options, double pixelSizeMm, double negligibleFall,
  const std::vector<int>& freeParameters, Clock::time_point begin, RegistrationResult& result,
  const ProgressCallback& progress)
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
  // Of a step that does not help a shorter one is tried: Ceres' own search along it, meant for
  // bounds, spends an equilibrium on each of many dents of the cost.
  solverOptions.max_num_line_search_step_size_iterations = 0;
  IterationRecorder recorder(evaluator, result, pixelSizeMm, negligibleFall, begin);
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
    return LevelEnd::Stopped;
  }
  if (evaluator.Failures >= LargestNumberOfFailures)
  {
    result.StopReason = std::to_string(evaluator.Failures) +
      " poses on the way to a better match had no equilibrium; this is the best pose that has one";
    return LevelEnd::Failed;
  }
  result.Converged = summary.IsSolutionUsable() &&
    (summary.termination_type == ceres::CONVERGENCE ||
      summary.termination_type == ceres::USER_SUCCESS);
  // Like our own reasons, without a full stop.
  result.StopReason = summary.termination_type == ceres::USER_SUCCESS
    ? "the parameters are within half a standard deviation of the best match"
    : summary.message.substr(0, summary.message.find_last_not_of(". ") + 1);
  if (summary.termination_type == ceres::FAILURE)
  {
    return LevelEnd::Failed;
  }
  if (pixelSizeMm == options.PixelSizesMm.back())
  {
    KeepCovariance(problem, evaluator, result);
  }
  return LevelEnd::Reached;
}

/// The steps of Register.
class Search
{
public:
  Search(const RegistrationModel& model, const RegistrationTarget& target,
    const RegistrationOptions& options, RegistrationResult& result,
    const ProgressCallback& progress)
    : Model(model)
    , Target(target)
    , Options(options)
    , Result(result)
    , Progress(progress)
  {
    for (int index = 0; index < ParameterCount; ++index)
    {
      if (!options.Parameters[index].Fixed)
      {
        this->Free.push_back(index);
      }
    }
  }

  void Run()
  {
    OpenToHalfHeight(this->Model, this->Result);
    const bool chooses = !this->Free.empty() && this->Options.From.empty();
    if (chooses && this->Model.Scout && this->ByScout())
    {
      return;
    }
    this->Result.State = CompressStart(this->Model, this->Result, this->Progress);
    this->KeepBefore(this->Model);
    if (chooses)
    {
      this->Choose(this->Model);
    }
    this->Levels(this->Model, 0, this->Options.PixelSizesMm.size());
  }

private:
  /**
   * The start is chosen, and all resolutions but the finest are searched, with the cheap
   * simulation; then the finest with the real one. False, with the values as they were, where
   * either has no equilibrium on this way.
   */
  bool ByScout()
  {
    RegistrationModel scout = this->Model;
    scout.Simulation = this->Model.Scout;
    scout.SurfaceEmbedding = this->Model.ScoutEmbedding;
    const std::vector<double> start = this->Result.Values;
    const std::size_t finest = this->Options.PixelSizesMm.size() - 1;
    try
    {
      this->Result.State = CompressForStart(scout, start, nullptr, this->Result, this->Progress);
      this->KeepBefore(scout);
      this->Choose(scout);
      const bool goesOn = this->Levels(scout, 0, finest);
      // A stop takes effect once the real simulation has been where the cheap one got to.
      this->Result.State = CompressForStart(this->Model, this->Result.Values, nullptr, this->Result,
        goesOn ? this->Progress : ProgressCallback());
      if (goesOn)
      {
        this->Levels(this->Model, finest, finest + 1);
      }
      return true;
    }
    catch (const ConvergenceError&)
    {
      this->Result.Values = start;
      return false;
    }
  }

  /// What the options say, with the bounds of the result.
  RegistrationOptions Bounded() const
  {
    RegistrationOptions bounded = this->Options;
    bounded.Parameters = this->Result.Parameters;
    return bounded;
  }

  void KeepBefore(const RegistrationModel& model)
  {
    const RegistrationTarget finest = CoarsenTo(this->Target, this->Options.PixelSizesMm.back());
    this->Result.Before = Compare(Synthesize(model, PoseOf(this->Result.Values), this->Result.State,
                                    finest, this->Options.Samples),
      finest);
  }

  void Choose(const RegistrationModel& model)
  {
    ChooseStart(model, CoarsenTo(this->Target, this->Options.PixelSizesMm.front()), this->Bounded(),
      this->Result, this->Progress);
  }

  /// Searches resolutions from `first` to before `last`; false when stopped by the user.
  bool Levels(const RegistrationModel& model, std::size_t first, std::size_t last)
  {
    const ProgressCallback progress = [this](double, const char* stage)
    {
      const auto iterations = static_cast<double>(this->Result.Iterations.size());
      // A typical number.
      const double expected = 6.0 * static_cast<double>(this->Options.PixelSizesMm.size());
      return !this->Progress || this->Progress(iterations / (iterations + expected), stage);
    };
    const RegistrationOptions bounded = this->Bounded();
    for (std::size_t level = first; level < last && !this->Free.empty(); ++level)
    {
      const double pixelSizeMm = this->Options.PixelSizesMm[level];
      const LevelEnd end = SearchLevel(model, CoarsenTo(this->Target, pixelSizeMm), bounded,
        pixelSizeMm, model.Simulation == this->Model.Scout ? NegligibleFallOfScout : NegligibleFall,
        this->Free, this->Begin, this->Result, progress);
      if (end != LevelEnd::Reached)
      {
        return end != LevelEnd::Stopped;
      }
    }
    return true;
  }

  const RegistrationModel& Model;
  const RegistrationTarget& Target;
  const RegistrationOptions& Options;
  RegistrationResult& Result;
  const ProgressCallback& Progress;
  std::vector<int> Free;
  Clock::time_point Begin = Clock::now();
};
}

RegistrationResult Register(const RegistrationModel& model, const RegistrationTarget& target,
  const RegistrationOptions& options, const ProgressCallback& progress)
{
  ValidateRegistration(model, options);
  ValidateTarget(target);
  const auto begin = Clock::now();
  RegistrationResult result;
  result.Parameters = options.Parameters;
  for (const RegistrationParameter& parameter : options.Parameters)
  {
    result.Values.push_back(parameter.Start);
  }
  if (!options.From.empty())
  {
    result.Values = options.From;
  }
  result.StandardDeviations.assign(ParameterCount, std::numeric_limits<double>::quiet_NaN());
  // Holds unless there is something to search.
  result.StopReason = "nothing to optimise: every parameter is fixed";
  result.Converged = true;
  Search(model, target, options, result, progress).Run();
  const RegistrationTarget finest = CoarsenTo(target, options.PixelSizesMm.back());
  result.Pose = PoseOf(result.Values);
  result.Stiffness = result.Values[StiffnessParameter];
  result.After =
    Compare(Synthesize(model, result.Pose, result.State, finest, options.Samples), finest);
  result.Seconds = SecondsSince(begin);
  return result;
}
}
