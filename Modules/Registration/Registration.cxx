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
#include <numbers>
#include <optional>

namespace mammoray
{
namespace
{
constexpr int ParameterCount = 5;

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point begin)
{
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

BreastPose PoseOf(const std::vector<double>& values)
{
  BreastPose pose;
  pose.ThicknessMm = values[0];
  pose.RollDeg = values[1];
  pose.ShiftLateralMm = values[2];
  pose.ShiftAnteriorMm = values[3];
  pose.ShiftVerticalMm = values[4];
  return pose;
}

VolumeFromGantry Place(const RegistrationModel& model, const BreastPose& pose)
{
  return PlaceUnit(model.Axes, model.Anchor, model.Unit, pose);
}

PlatePair PlatesAt(const RegistrationModel& model, const BreastPose& pose)
{
  return PlatesOf(Place(model, pose), model.Unit, pose.ThicknessMm);
}

/// Silhouette of moved surface points, and what it needs of the surface.
class SilhouetteFinder
{
public:
  explicit SilhouetteFinder(const SurfaceMesh& surface)
    : Edges(OuterEdges(surface))
  {
  }

  std::vector<double> Radii(const RegistrationModel& model, const VolumeFromGantry& placed,
    const std::vector<double>& points, const ReceptorPoint& centre,
    const std::vector<ReceptorPoint>& directions) const
  {
    return SilhouetteRadii(
      ProjectToReceptor(points, placed, model.Unit), this->Edges, centre, directions);
  }

private:
  std::vector<std::array<std::uint32_t, 2>> Edges;
};

/// The mean and standard deviation over the listed pixels taken away and divided by.
std::vector<double> ZScores(
  const std::vector<float>& image, const std::vector<std::size_t>& pixels)
{
  double sum = 0;
  double squares = 0;
  for (const std::size_t pixel : pixels)
  {
    sum += image[pixel];
    squares += static_cast<double>(image[pixel]) * image[pixel];
  }
  const double mean = sum / pixels.size();
  // 1e-6 keeps an empty picture (all air) from dividing by zero; real pictures deviate by about 0.3.
  const double deviation = std::sqrt(std::max(squares / pixels.size() - mean * mean, 0.0)) + 1e-6;
  std::vector<double> scores(pixels.size());
  for (std::size_t index = 0; index < pixels.size(); ++index)
  {
    scores[index] = (image[pixels[index]] - mean) / deviation;
  }
  return scores;
}

/**
 * Residuals and their Jacobian at one resolution. The mechanics' derivative is exact (implicit function theorem), the
 * projection's is a central difference along it: points x +- h dx/dp seen from the unit at p +- h.
 */
class Evaluator : public ceres::EvaluationCallback
{
public:
  Evaluator(const RegistrationModel& model, const RegistrationTarget& target,
    const RegistrationOptions& options, const SilhouetteFinder& silhouette,
    const std::vector<int>& freeParameters, const std::vector<double>& start,
    const CompressionState& startState, const ProgressCallback& progress)
    : Model(model)
    , Target(target)
    , Options(options)
    , Silhouette(silhouette)
    , Free(freeParameters)
    , Values(start)
    , State(startState)
    , Progress(progress)
  {
    this->ChooseOutlineSamples();
    this->ChoosePixels();
    for (const int parameter : this->Free)
    {
      this->Unknowns.push_back(start[parameter] / options.Parameters[parameter].Scale);
    }
  }

  std::size_t NumberOfResiduals() const
  {
    return this->Directions.size() + this->Pixels.size() + this->Free.size();
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
      this->Valid = this->EvaluateJacobian();
      this->HasJacobian = this->Valid;
    }
  }

  struct Costs
  {
    double Outline = 0;
    double Intensity = 0;
    double Prior = 0;
  };
  Costs TermCosts() const
  {
    Costs costs;
    const double width = this->Options.RobustWidth;
    for (std::size_t index = 0; index < this->Residuals.size(); ++index)
    {
      const double r = std::abs(this->Residuals[index]);
      const double robust = r <= width ? 0.5 * r * r : width * r - 0.5 * width * width;
      if (index < this->Directions.size())
      {
        costs.Outline += robust;
      }
      else if (index < this->Directions.size() + this->Pixels.size())
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

  const RegistrationModel& Model;
  const RegistrationTarget& Target;
  const RegistrationOptions& Options;
  const SilhouetteFinder& Silhouette;
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
  int Evaluations = 0;
  int Projections = 0;
  double MechanicsSeconds = 0;
  double ProjectionSeconds = 0;
  /// Directions that hit an outline inside the image.
  std::vector<ReceptorPoint> Directions;
  ReceptorPoint Centre{ 0, 0 };

private:
  void ChooseOutlineSamples()
  {
    this->Centre = ChestWallCentre(this->Target);
    const double pixel = std::hypot(this->Target.ColumnStep[0], this->Target.ColumnStep[1]);
    const double diagonal =
      std::hypot(this->Target.ColumnStep[0], this->Target.ColumnStep[1]) * this->Target.Columns +
      std::hypot(this->Target.RowStep[0], this->Target.RowStep[1]) * this->Target.Rows;
    double length = 0;
    std::optional<ReceptorPoint> previous;
    for (const ReceptorPoint& direction : HalfCircleDirections(this->Options.OutlineDirections))
    {
      // The farthest place inside the breast along the direction, where the image still shows both sides of it. The
      // image may begin a little in front of the chest wall.
      double radius = 0;
      bool entered = false;
      for (double r = 0; r <= diagonal; r += 0.5 * pixel)
      {
        const ReceptorPoint point{ this->Centre[0] + r * direction[0],
          this->Centre[1] + r * direction[1] };
        const bool contained = Contains(this->Target, point, 0);
        if (entered && !contained)
        {
          break;
        }
        entered = entered || contained;
        if (SignedDistanceAt(this->Target, point) < 0)
        {
          radius = r;
        }
      }
      const ReceptorPoint end{ this->Centre[0] + radius * direction[0],
        this->Centre[1] + radius * direction[1] };
      if (radius > 0 && Contains(this->Target, end, 2.0 + pixel))
      {
        this->Directions.push_back(direction);
        if (previous)
        {
          length += std::hypot(end[0] - (*previous)[0], end[1] - (*previous)[1]);
        }
        previous = end;
      }
    }
    if (this->Directions.size() < 5)
    {
      throw InputError("mammogram: the breast's outline lies outside the image in all but " +
        std::to_string(this->Directions.size()) + " of " +
        std::to_string(this->Options.OutlineDirections) + " directions");
    }
    const double spacing = length / this->Directions.size();
    this->OutlineWeight = std::sqrt(std::min(1.0, spacing / this->Options.CorrelationLengthMm)) /
      this->Options.OutlineSigmaMm;
  }

  void ChoosePixels()
  {
    for (std::size_t pixel = 0; pixel < this->Target.BreastMask.size(); ++pixel)
    {
      if (this->Target.BreastMask[pixel] != 0 &&
        this->Target.SignedDistanceMm[pixel] < -this->Options.IntensityMarginMm)
      {
        this->Pixels.push_back(pixel);
      }
    }
    if (this->Pixels.size() < 10)
    {
      throw InputError("mammogram: only " + std::to_string(this->Pixels.size()) +
        " pixels of the compared size lie inside the breast, expected at least 10");
    }
    this->TargetScores = ZScores(this->Target.LogAttenuation, this->Pixels);
    const double area = std::abs(this->Target.ColumnStep[0] * this->Target.RowStep[1] -
      this->Target.ColumnStep[1] * this->Target.RowStep[0]);
    const double alike = this->Options.CorrelationLengthMm * this->Options.CorrelationLengthMm;
    this->IntensityWeight = std::sqrt(std::min(1.0, area / alike)) / this->Options.IntensitySigma;
  }

  /// Outline and intensity residuals of moved surface points.
  void Compare(const BreastPose& pose, const std::vector<double>& points, double* residuals)
  {
    const VolumeFromGantry placed = Place(this->Model, pose);
    const std::vector<double> radii =
      this->Silhouette.Radii(this->Model, placed, points, this->Centre, this->Directions);
    for (std::size_t index = 0; index < radii.size(); ++index)
    {
      const ReceptorPoint end{ this->Centre[0] + radii[index] * this->Directions[index][0],
        this->Centre[1] + radii[index] * this->Directions[index][1] };
      *residuals++ = this->OutlineWeight * SignedDistanceAt(this->Target, end);
    }
    const auto begin = Clock::now();
    this->Model.Projector->UpdatePoints(points);
    const PathLengthImage lengths = this->Model.Projector->Project(
      SourceOf(placed, this->Model.Unit), DetectorOf(placed, this->Target, this->Options.Samples));
    this->ProjectionSeconds += SecondsSince(begin);
    ++this->Projections;
    const std::vector<double> scores =
      ZScores(this->Model.XRays->LogAttenuation(lengths), this->Pixels);
    for (std::size_t index = 0; index < scores.size(); ++index)
    {
      *residuals++ = this->IntensityWeight * (scores[index] - this->TargetScores[index]);
    }
  }

  void ReportStage(const char* stage)
  {
    try
    {
      ReportProgress(this->Progress, 0, stage);
    }
    catch (const Interrupted&)
    {
      this->Stopped = true;
      throw;
    }
  }

  bool EvaluateResiduals()
  {
    for (std::size_t f = 0; f < this->Free.size(); ++f)
    {
      this->Values[this->Free[f]] =
        this->Unknowns[f] * this->Options.Parameters[this->Free[f]].Scale;
    }
    const BreastPose pose = PoseOf(this->Values);
    const PlatePair plates = PlatesAt(this->Model, pose);
    const double travelMm = TravelMm(PlateMotion(this->State.Plates, plates));
    if (travelMm > this->LongestTravelMm)
    {
      return false; // costs nothing, and Ceres shortens its step
    }
    const auto begin = Clock::now();
    try
    {
      this->ReportStage("compress");
      this->State = this->Model.Simulation->Compress(plates, &this->State, this->Progress);
      ++this->Evaluations;
      this->LongestTravelMm = std::max(this->LongestTravelMm, 2 * travelMm);
      this->MechanicsSeconds += SecondsSince(begin);
      this->ReportStage("project");
    }
    catch (const Interrupted&)
    {
      this->Stopped = true;
      // Stale residuals: Ceres must not take the stop for a failure; the recorder ends the search.
      return this->Residuals.size() == this->NumberOfResiduals();
    }
    catch (const ConvergenceError&)
    {
      ++this->Evaluations;
      this->MechanicsSeconds += SecondsSince(begin);
      this->LongestTravelMm = 0.5 * travelMm;
      return false; // no equilibrium there: Ceres shortens its step
    }
    this->Residuals.assign(this->NumberOfResiduals(), 0.0);
    this->Points = this->Model.SurfaceEmbedding->Map(this->State.Positions);
    this->Compare(pose, this->Points, this->Residuals.data());
    for (std::size_t f = 0; f < this->Free.size(); ++f)
    {
      const RegistrationParameter& parameter = this->Options.Parameters[this->Free[f]];
      this->Residuals[this->NumberOfResiduals() - this->Free.size() + f] = parameter.PriorSigma > 0
        ? (this->Values[this->Free[f]] - parameter.Start) / parameter.PriorSigma
        : 0.0;
    }
    return true;
  }

  bool EvaluateJacobian()
  {
    const std::vector<PlatePairVelocity> all =
      PlateVelocities(this->Model, PoseOf(this->Values));
    std::vector<PlatePairVelocity> wanted;
    for (const int parameter : this->Free)
    {
      wanted.push_back(all[parameter]);
    }
    const auto begin = Clock::now();
    const auto nodeVelocities = this->Model.Simulation->Sensitivities(this->State, wanted);
    this->MechanicsSeconds += SecondsSince(begin);
    this->Jacobian.assign(this->Free.size(), std::vector<double>(this->NumberOfResiduals(), 0.0));
    std::vector<double> moved(this->Points.size());
    std::vector<double> sides[2];
    for (std::size_t f = 0; f < this->Free.size(); ++f)
    {
      try
      {
        this->ReportStage("differentiate");
      }
      catch (const Interrupted&)
      {
        return true; // the columns left are zero; see EvaluateResiduals
      }
      const RegistrationParameter& parameter = this->Options.Parameters[this->Free[f]];
      const std::vector<double> velocities =
        this->Model.SurfaceEmbedding->Map(nodeVelocities[f]);
      const double step = 0.1 * parameter.Scale;
      for (int side = 0; side < 2; ++side)
      {
        const double signedStep = side == 0 ? -step : step;
        std::vector<double> values = this->Values;
        values[this->Free[f]] += signedStep;
        for (std::size_t index = 0; index < moved.size(); ++index)
        {
          moved[index] = this->Points[index] + signedStep * velocities[index];
        }
        sides[side].assign(this->NumberOfResiduals(), 0.0);
        this->Compare(PoseOf(values), moved, sides[side].data());
      }
      std::vector<double>& column = this->Jacobian[f];
      const std::size_t compared = this->NumberOfResiduals() - this->Free.size();
      for (std::size_t index = 0; index < compared; ++index)
      {
        column[index] =
          (sides[1][index] - sides[0][index]) / (2 * step) * parameter.Scale;
      }
      column[compared + f] =
        parameter.PriorSigma > 0 ? parameter.Scale / parameter.PriorSigma : 0.0;
    }
    return true;
  }

  const ProgressCallback& Progress;
  std::vector<std::size_t> Pixels;
  std::vector<double> TargetScores;
  double OutlineWeight = 1;
  double IntensityWeight = 1;
  /// A longer way of the plates from State is refused unseen: half of what failed last, twice of what
  /// succeeded. The first is a step that a phantom's compression still follows.
  double LongestTravelMm = 20;
  std::vector<double> Points;
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
    if (this->Source.Stopped)
    {
      return ceres::SOLVER_ABORT;
    }
    if (summary.iteration == 0 || summary.step_is_successful)
    {
      // Ceres has just evaluated the Jacobian at the accepted point, so the evaluator stands there.
      const Evaluator::Costs costs = this->Source.TermCosts();
      RegistrationIteration row;
      row.Number = static_cast<int>(this->Result.Iterations.size());
      row.Parameters = this->Source.Values;
      row.PixelSizeMm = this->PixelSizeMm;
      row.OutlineCost = costs.Outline;
      row.IntensityCost = costs.Intensity;
      row.PriorCost = costs.Prior;
      row.Cost = costs.Outline + costs.Intensity + costs.Prior;
      row.Seconds = SecondsSince(this->Begin);
      this->Result.Iterations.push_back(row);
      this->Result.Values = this->Source.Values;
      this->Result.State = this->Source.State;
    }
    return ceres::SOLVER_CONTINUE;
  }

private:
  const Evaluator& Source;
  RegistrationResult& Result;
  double PixelSizeMm;
  Clock::time_point Begin;
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
      throw InputError("registration: parameter " + parameter.Name + ": expected lower <= start <= "
        "upper and a positive scale, found " + std::to_string(parameter.Lower) + ", " +
        std::to_string(parameter.Start) + ", " + std::to_string(parameter.Upper) + ", " +
        std::to_string(parameter.Scale));
    }
  }
  if (options.PixelSizesMm.empty() || options.Samples < 1 || options.OutlineDirections < 10)
  {
    throw InputError("registration: expected at least one pixel size, one sample and ten outline "
                     "directions");
  }
}

/// Extent of the body at rest along the beam's axis, mm.
double UncompressedHeight(const RegistrationModel& model, const BreastPose& pose)
{
  const Vector3 axis = Place(model, pose).Z;
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
 * The equilibrium at the start. A breast is compressed to about half its height; a start below that belongs to another breast
 * and costs minutes to fail, so thickness is opened and bounded there, with a warning, and again where even that has no
 * equilibrium.
 */
CompressionState CompressStart(
  const RegistrationModel& model, RegistrationResult& result, const ProgressCallback& progress)
{
  RegistrationParameter& thickness = result.Parameters[0];
  const double height = UncompressedHeight(model, PoseOf(result.Values));
  const auto open = [&](double thicknessMm)
  {
    char sentence[240];
    std::snprintf(sentence, sizeof sentence,
      "The breast of the volume is %.0f mm high; it is not compressed to the %.1f mm the search should start from, but "
      "to no less than %.1f mm.",
      height, result.Values[0], thicknessMm);
    result.Warnings.push_back(sentence);
    result.Values[0] = thicknessMm;
    thickness.Start = thicknessMm;
    thickness.Lower = thicknessMm;
    thickness.Upper = std::max(thickness.Upper, 1.5 * thicknessMm);
  };
  const double least = 0.5 * height;
  if (!thickness.Fixed && result.Values[0] < least)
  {
    open(least);
  }
  constexpr int attempts = 3;
  for (int attempt = 1;; ++attempt)
  {
    try
    {
      ++result.Evaluations;
      return model.Simulation->Compress(
        PlatesAt(model, PoseOf(result.Values)), nullptr, progress);
    }
    catch (const CompressionError& error)
    {
      const double opened = 1.1 * error.LastGapMm();
      if (thickness.Fixed || attempt == attempts || !(opened > result.Values[0]))
      {
        throw;
      }
      open(opened);
    }
  }
}

/**
 * Shifts the unit so that the start's silhouette has its middle and its tip where the mammogram's outline has them:
 * cheap, and it spares the optimiser the long way from a wrong position.
 */
void AlignStart(const RegistrationModel& model, const SilhouetteFinder& silhouette,
  const RegistrationTarget& target, const CompressionState& state,
  const std::vector<RegistrationParameter>& parameters, std::vector<double>& values)
{
  const auto directions = HalfCircleDirections(180);
  const ReceptorPoint centre = ChestWallCentre(target);
  const BreastPose pose = PoseOf(values);
  const std::vector<double> radii = silhouette.Radii(model, Place(model, pose),
    model.SurfaceEmbedding->Map(state.Positions), centre, directions);
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
  const double magnification =
    sid / (sid - model.Unit.SupportHeightMm - 0.5 * pose.ThicknessMm);
  const auto shift = [&](int index, double by)
  {
    const RegistrationParameter& parameter = parameters[index];
    if (!parameter.Fixed)
    {
      values[index] = std::clamp(values[index] + by, parameter.Lower, parameter.Upper);
    }
  };
  shift(2, (0.5 * (low + high) - centre[0]) / magnification);
  shift(3, (tip - targetTip) / magnification);
}
}

std::vector<RegistrationParameter> DefaultParameters(const BreastPose& start)
{
  return {
    { .Name = "thickness",
      .Unit = "mm",
      .Start = start.ThicknessMm,
      .Lower = 0.5 * start.ThicknessMm,
      .Upper = 1.5 * start.ThicknessMm,
      .Scale = 5.0,
      .PriorSigma = 5.0 },
    { .Name = "roll",
      .Unit = "deg",
      .Start = start.RollDeg,
      .Lower = start.RollDeg - 30,
      .Upper = start.RollDeg + 30,
      .Scale = 5.0 },
    { .Name = "lateral",
      .Unit = "mm",
      .Start = start.ShiftLateralMm,
      .Lower = start.ShiftLateralMm - 50,
      .Upper = start.ShiftLateralMm + 50,
      .Scale = 5.0 },
    { .Name = "anterior",
      .Unit = "mm",
      .Start = start.ShiftAnteriorMm,
      // The plates cannot stand behind the front of the chest wall.
      .Lower = std::min(0.0, start.ShiftAnteriorMm),
      .Upper = start.ShiftAnteriorMm + 50,
      .Scale = 5.0 },
    { .Name = "vertical",
      .Unit = "mm",
      .Start = start.ShiftVerticalMm,
      .Lower = start.ShiftVerticalMm - 30,
      .Upper = start.ShiftVerticalMm + 30,
      .Scale = 5.0,
      .Fixed = true },
  };
}

std::vector<PlatePairVelocity> PlateVelocities(
  const RegistrationModel& model, const BreastPose& pose)
{
  const VolumeFromGantry placed = Place(model, pose);
  const PlatePair plates = PlatesOf(placed, model.Unit, pose.ThicknessMm);
  const auto both = [](const Vector3& linear)
  { return PlatePairVelocity{ { linear, {} }, { linear, {} } }; };

  PlatePairVelocity thickness;
  thickness.Support.Linear = -0.5 * placed.Z;
  thickness.Paddle.Linear = 0.5 * placed.Z;
  // With omega = Z x X per radian: omega x X = -Z and omega x Z = X, as PlaceUnit turns them.
  const Vector3 omega = (std::numbers::pi / 180.0) * Cross(placed.Z, placed.X);
  // The shifts turn with the unit; only the anchor stays.
  const auto turning = [&](const Plate& plate)
  { return PlateVelocity{ Cross(omega, plate.Edge - model.Anchor), omega }; };
  const PlatePairVelocity roll{ turning(plates.Support), turning(plates.Paddle) };
  return { thickness, roll, both(placed.X), both(placed.Y), both(placed.Z) };
}

XRaySource SourceOf(const VolumeFromGantry& placed, const MammographyUnit& unit)
{
  XRaySource source;
  source.Position = placed.Point({ 0, 0, unit.SourceToDetectorMm });
  return source;
}

XRayDetector DetectorOf(
  const VolumeFromGantry& placed, const RegistrationTarget& grid, int samples)
{
  XRayDetector detector;
  detector.Origin = placed.Point({ grid.Origin[0], grid.Origin[1], 0 });
  detector.ColumnStep = placed.Direction({ grid.ColumnStep[0], grid.ColumnStep[1], 0 });
  detector.RowStep = placed.Direction({ grid.RowStep[0], grid.RowStep[1], 0 });
  detector.Columns = grid.Columns;
  detector.Rows = grid.Rows;
  detector.Samples = samples;
  return detector;
}

SyntheticMammogram Synthesize(const RegistrationModel& model, const BreastPose& pose,
  const CompressionState& state, const RegistrationTarget& grid, int samples)
{
  SyntheticMammogram synthetic;
  const VolumeFromGantry placed = Place(model, pose);
  const std::vector<double> points = model.SurfaceEmbedding->Map(state.Positions);
  model.Projector->UpdatePoints(points);
  const PathLengthImage lengths = model.Projector->Project(
    SourceOf(placed, model.Unit), DetectorOf(placed, grid, samples));
  synthetic.LogAttenuation = model.XRays->LogAttenuation(lengths);
  synthetic.InconsistentRays = lengths.NumberOfInconsistentRays();

  const ReceptorPoint centre = ChestWallCentre(grid);
  const auto directions = HalfCircleDirections(360);
  const std::vector<double> radii =
    SilhouetteFinder(*model.Surface).Radii(model, placed, points, centre, directions);
  for (std::size_t index = 0; index < directions.size(); ++index)
  {
    if (radii[index] > 0)
    {
      synthetic.Outline.push_back({ centre[0] + radii[index] * directions[index][0],
        centre[1] + radii[index] * directions[index][1] });
    }
  }
  return synthetic;
}

Agreement Compare(const SyntheticMammogram& synthetic, const RegistrationTarget& target)
{
  Agreement agreement;
  double distances = 0;
  double length = 0;
  // Weighted by arc length, so that dense directions near the centre do not count more.
  for (std::size_t index = 0; index + 1 < synthetic.Outline.size(); ++index)
  {
    const ReceptorPoint& a = synthetic.Outline[index];
    const ReceptorPoint& b = synthetic.Outline[index + 1];
    const ReceptorPoint middle{ 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]) };
    if (!Contains(target, middle, 0))
    {
      continue;
    }
    const double arc = std::hypot(b[0] - a[0], b[1] - a[1]);
    const double distance = std::abs(SignedDistanceAt(target, middle));
    distances += arc * distance;
    length += arc;
    agreement.LargestOutlineDistanceMm = std::max(agreement.LargestOutlineDistanceMm, distance);
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  agreement.MeanOutlineDistanceMm = length > 0 ? distances / length : nan;
  if (!(length > 0))
  {
    agreement.LargestOutlineDistanceMm = nan;
  }

  std::vector<std::size_t> pixels;
  for (std::size_t pixel = 0; pixel < target.BreastMask.size(); ++pixel)
  {
    if (target.BreastMask[pixel] != 0 && synthetic.LogAttenuation[pixel] > 0)
    {
      pixels.push_back(pixel);
    }
  }
  if (!pixels.empty())
  {
    const std::vector<double> a = ZScores(synthetic.LogAttenuation, pixels);
    const std::vector<double> b = ZScores(target.LogAttenuation, pixels);
    for (std::size_t index = 0; index < pixels.size(); ++index)
    {
      agreement.Correlation += a[index] * b[index] / pixels.size();
    }
  }
  return agreement;
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
  result.StandardDeviations.assign(
    ParameterCount, std::numeric_limits<double>::quiet_NaN());

  const double pixel = std::hypot(target.ColumnStep[0], target.ColumnStep[1]);
  const auto coarsened = [&](double pixelSizeMm)
  { return Coarsen(target, std::max(1, static_cast<int>(std::lround(pixelSizeMm / pixel)))); };
  const SilhouetteFinder silhouette(*model.Surface);

  // The start: a cold compression, then the unit moved to where the outlines roughly meet.
  result.State = CompressStart(model, result, progress);
  result.MechanicsSeconds = SecondsSince(begin);
  const RegistrationTarget finest = coarsened(options.PixelSizesMm.back());
  result.Before = Compare(
    Synthesize(model, PoseOf(result.Values), result.State, finest, options.Samples), finest);
  result.StopReason = "nothing to optimise: every parameter is fixed";
  result.Converged = freeParameters.empty();
  if (!freeParameters.empty())
  {
    std::vector<double> aligned = result.Values;
    AlignStart(model, silhouette, finest, result.State, result.Parameters, aligned);
    try
    {
      result.State =
        model.Simulation->Compress(PlatesAt(model, PoseOf(aligned)), &result.State, progress);
      result.Values = aligned;
      ++result.Evaluations;
    }
    catch (const ConvergenceError&)
    {
      // The unaligned start is as good as any other: it has its equilibrium already.
    }
  }

  RegistrationOptions search = options;
  search.Parameters = result.Parameters;
  int level = 0;
  for (const double pixelSizeMm : options.PixelSizesMm)
  {
    if (freeParameters.empty())
    {
      break;
    }
    const RegistrationTarget coarse = coarsened(pixelSizeMm);
    const ProgressCallback levelProgress = [&](double, const char* stage)
    {
      const double iterations = static_cast<double>(result.Iterations.size());
      const double expected = 6.0 * options.PixelSizesMm.size(); // a typical number
      return !progress || progress(iterations / (iterations + expected), stage);
    };
    Evaluator evaluator(model, coarse, search, silhouette, freeParameters, result.Values,
      result.State, levelProgress);
    ceres::Problem::Options problemOptions;
    problemOptions.evaluation_callback = &evaluator;
    ceres::Problem problem(problemOptions);
    const std::size_t robustCount = evaluator.NumberOfResiduals() - freeParameters.size();
    for (std::size_t index = 0; index < evaluator.NumberOfResiduals(); ++index)
    {
      problem.AddResidualBlock(new ResidualCost(evaluator, index),
        index < robustCount ? new ceres::HuberLoss(options.RobustWidth) : nullptr,
        evaluator.Unknowns.data());
    }
    for (std::size_t f = 0; f < freeParameters.size(); ++f)
    {
      const RegistrationParameter& parameter = result.Parameters[freeParameters[f]];
      problem.SetParameterLowerBound(
        evaluator.Unknowns.data(), static_cast<int>(f), parameter.Lower / parameter.Scale);
      problem.SetParameterUpperBound(
        evaluator.Unknowns.data(), static_cast<int>(f), parameter.Upper / parameter.Scale);
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
    ++level;
    if (evaluator.Stopped)
    {
      result.StopReason = "interrupted; this is the best pose so far";
      result.Converged = false;
      break;
    }
    result.Converged = summary.termination_type == ceres::CONVERGENCE;
    result.StopReason = summary.message;
    if (summary.termination_type == ceres::FAILURE)
    {
      break;
    }
    if (level == static_cast<int>(options.PixelSizesMm.size()))
    {
      ceres::Covariance covariance{ ceres::Covariance::Options() };
      const std::vector<const double*> blocks{ evaluator.Unknowns.data() };
      if (covariance.Compute(blocks, &problem))
      {
        const std::size_t n = freeParameters.size();
        std::vector<double> matrix(n * n);
        covariance.GetCovarianceBlock(
          evaluator.Unknowns.data(), evaluator.Unknowns.data(), matrix.data());
        for (std::size_t f = 0; f < n; ++f)
        {
          result.StandardDeviations[freeParameters[f]] =
            std::sqrt(matrix[f * n + f]) * result.Parameters[freeParameters[f]].Scale;
        }
      }
    }
  }
  result.Pose = PoseOf(result.Values);
  result.After =
    Compare(Synthesize(model, result.Pose, result.State, finest, options.Samples), finest);
  result.Seconds = SecondsSince(begin);
  return result;
}
}
