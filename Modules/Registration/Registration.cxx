// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/Registration.h"

#include "Private/SearchLevel.h"
#include "Private/SearchStart.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>

namespace mammoray
{
namespace
{
/// A level of the search has ended where so much is left of the cost, to the bottom of its
/// quadratic model. Residuals are in standard deviations: parameters that are half of their own
/// from the best cost this much more. The predictor is off by more than two, and what another
/// comparison goes on from need be no nearer.
constexpr double NegligibleFall = 0.125;
constexpr double NegligibleFallOnTheWay = 2;

/// Outlines that are so far apart on average when the coarse resolutions have been searched are not
/// of one breast: right ones are within 3 mm then. The finest, which takes most of the time, is
/// left out.
constexpr double HopelessOutlineMm = 10;

/// The correlation of the tissue can fall by this much by chance.
constexpr double LostTissueCorrelation = 0.02;

/// Fractions of a search's time (150 to 200 s for a study) at which its stages end: choice of the
/// start, coarse resolutions with the predictor, equilibrium of the simulation itself there.
constexpr double StartEnds = 0.1;
constexpr double CoarseEnds = 0.35;
constexpr double AdoptedEnds = 0.45;
/// Typical number of equilibria of a stage per view; a level takes 8 to 25.
constexpr double EquilibriaOfStart = 5;
constexpr double EquilibriaOfLevel = 12;

/**
 * Progress of a stage that takes from `from` to `to` of the whole. It consists of equilibria, each
 * of which reports 0 to 1. Their number is unknown, so the progress approaches `to` asymptotically.
 */
ProgressCallback Counted(const ProgressCallback& progress, double from, double to,
  double expectedEquilibria)
{
  if (!progress)
  {
    return {};
  }
  struct Count
  {
    int Done = 0;
    double Begun = 0;
  };
  // One for all copies of the callback.
  return [=, count = std::make_shared<Count>()](double fraction, const char* stage)
  {
    // Newton's method begins at 0 within an equilibrium, too, which ends with 1.
    count->Done += fraction >= 1 ? 1 : 0;
    count->Begun = fraction >= 1 ? 0 : std::max(count->Begun, fraction);
    const double part = 1 - std::exp(-(count->Done + count->Begun) / expectedEquilibria);
    return progress(from + (to - from) * part, stage);
  };
}

/// How the points of the anatomy move with each parameter that is free or has a prior.
void AddSensitivities(BreastModel& model, const UnitPlacement& placement, ViewResult& result)
{
  std::vector<int> uncertain;
  for (std::size_t index = 0; index < result.Parameters.size(); ++index)
  {
    if (!result.Parameters[index].Fixed || result.Parameters[index].PriorSigma > 0)
    {
      uncertain.push_back(static_cast<int>(index));
    }
  }
  const VectorFields velocities = model.Body().VelocitiesSeenFromUnit(placement, result.Pose,
    result.State, model.AnatomyPoints(), result.Points, uncertain);
  result.Sensitivities.resize(result.Parameters.size());
  for (std::size_t index = 0; index < uncertain.size(); ++index)
  {
    result.Sensitivities[uncertain[index]].assign(velocities[index].begin(),
      velocities[index].end());
  }
}

/// Adds to a result, whose search has ended, what follows from its pose, state and covariance.
void Complete(ViewSearch& view)
{
  BreastModel& model = *view.Model;
  ViewResult& result = view.Result;
  const RegistrationTarget& target = view.Input->Target;
  result.Pose = PoseOf(result.Values);
  result.State = view.Current->State();
  PosedBreast breast(model, model.Body(), view.Placement, result.Pose, result.State);
  result.Placed = breast.Placed();
  result.Points = model.AnatomyPoints().Map(result.State.Positions);
  AddSensitivities(model, view.Placement, result);
  result.Synthetic = Synthesize(breast, target.Grid, ChestWallCentre(target), 1);
  result.After = Compare(result.Synthetic, target);
  for (const ViewProjection& projection : view.Input->Projections)
  {
    const RegistrationTarget& finest = projection.Levels.back();
    result.ProjectionsAfter.push_back(Compare(
      Synthesize(breast.SeenFrom(projection.FocalSpotMm), finest.Grid, ChestWallCentre(finest), 1),
      finest));
  }
  if (result.Synthetic.InconsistentRays > 0)
  {
    result.Warnings.push_back(std::to_string(result.Synthetic.InconsistentRays) +
      " rays of the synthetic mammogram crossed a surface that does not close.");
  }
  result.HeaderThicknessMm = target.HeaderThicknessMm;
  result.Disagreements = target.Disagreements;
  result.Expected = ExpectedErrorOf(model.Anatomy(), result);
  result.Trust = Assess(result);
}

void ForgetCovariance(ViewResult& result)
{
  result.Covariance.clear();
  result.ConsideredCovariance.clear();
  std::fill(result.StandardDeviations.begin(), result.StandardDeviations.end(),
    std::numeric_limits<double>::quiet_NaN());
  result.Misfit = {};
}

/// The steps of Register.
class Search
{
public:
  Search(const RegistrationProblem& problem, const ProgressCallback& progress,
    const SearchObserver& observer)
    : Options(problem.Options)
    , Progress(progress)
    , State(problem, observer)
  {
  }

  void Run()
  {
    for (ViewSearch& view : this->State.Views)
    {
      OpenToLeastHeight(view);
    }
    this->State.CollectFreeParameters();
    const bool chooses =
      !this->State.FreeParameters.empty() && this->State.Views.front().Input->From.empty();
    if (chooses && this->State.Views.front().Model->Predictor() && this->ByPredictor())
    {
      return;
    }
    for (ViewSearch& view : this->State.Views)
    {
      const ProgressCallback progress = this->OfView(view, 0, StartEnds);
      CompressStart(view, progress);
      if (chooses)
      {
        this->Choose(view.Breast(), view, progress);
      }
    }
    this->State.CollectFreeParameters(); // a start may have been opened
    this->Levels(false, 0, this->Options.PixelSizesMm.size(), StartEnds);
  }

  /// The result of Run.
  RegistrationResult Result()
  {
    const double seconds = SecondsSince(this->State.Begin);
    RegistrationResult result;
    for (ViewSearch& view : this->State.Views)
    {
      view.Result.Seconds = seconds;
      Complete(view);
      result.Views.push_back(std::move(view.Result));
    }
    result.FreeParameters = std::move(this->State.FreeParameters);
    result.Covariance = std::move(this->State.Covariance);
    return result;
  }

private:
  /**
   * The starts are chosen, and all resolutions but the finest are searched, with the predictor;
   * then the finest with the simulation itself. False, with the values as they were, where either
   * has no equilibrium on this way.
   */
  bool ByPredictor()
  {
    std::vector<std::vector<double>> starts;
    const std::size_t finest = this->Options.PixelSizesMm.size() - 1;
    try
    {
      for (ViewSearch& view : this->State.Views)
      {
        starts.push_back(view.Result.Values);
        const ProgressCallback progress = this->OfView(view, 0, StartEnds);
        view.Current =
          CompressForStart(view.Breast(true), view.Result.Values, nullptr, view.Result, progress);
        this->Choose(view.Breast(true), view, progress);
      }
      const bool goesOn =
        this->Levels(true, 0, finest, StartEnds, CoarseEnds) && !this->EndsHopeless();
      // An end takes effect once the simulation itself has been where the predictor got to.
      for (ViewSearch& view : this->State.Views)
      {
        const ProgressCallback progress = this->OfView(view, CoarseEnds, AdoptedEnds);
        if (goesOn)
        {
          // A cold start of the simulation itself would double the time of a search.
          ChooseEquilibrium(view.Breast(true), view.Input->Levels.back(),
            this->ComparedBy(this->FirstComparison()), view, progress);
        }
        AdoptPredicted(view, goesOn ? progress : ProgressCallback());
      }
      if (goesOn)
      {
        this->Levels(false, finest, finest + 1, AdoptedEnds);
      }
      return true;
    }
    catch (const ConvergenceError&)
    {
      for (std::size_t view = 0; view < starts.size(); ++view)
      {
        this->State.Views[view].Result.Values = starts[view];
      }
      return false;
    }
  }

  /// True if the outlines are too far apart to continue; then sets StopReason of the results.
  bool EndsHopeless()
  {
    double apart = 0;
    for (ViewSearch& view : this->State.Views)
    {
      apart = std::fmax(apart, this->SimilarityOf(view).MeanOutlineDistanceMm);
    }
    if (!(apart > HopelessOutlineMm))
    {
      return false;
    }
    for (ViewSearch& view : this->State.Views)
    {
      view.Result.Converged = false;
      view.Result.StopReason = "the outlines are still " + NumberText(std::round(apart)) +
        " mm apart after the coarse search, and the fine one was left out";
    }
    return true;
  }

  /**
   * How pictures are compared until they match but for the last millimetres. Gradients match where
   * structures overlap: by them alone two views of patients' studies were 8 and 9 mm off.
   */
  PictureComparison FirstComparison() const
  {
    return this->Options.Comparison == PictureComparison::Local ? PictureComparison::Local
                                                                : PictureComparison::Global;
  }

  /// The options with another comparison.
  RegistrationOptions ComparedBy(PictureComparison comparison) const
  {
    RegistrationOptions options = this->Options;
    options.Comparison = comparison;
    return options;
  }

  /// Similarity of a view at the finest resolution.
  Similarity SimilarityOf(ViewSearch& view) const
  {
    const RegistrationTarget& finest = view.Input->Levels.back();
    return Compare(
      Synthesize(*view.Current, finest.Grid, ChestWallCentre(finest), this->Options.Samples),
      finest);
  }

  /// Progress of one view in a stage that processes views one after the other.
  ProgressCallback OfView(const ViewSearch& view, double from, double to) const
  {
    const std::vector<ViewSearch>& all = this->State.Views;
    const double share = (to - from) / static_cast<double>(all.size());
    const double begin = from + share * static_cast<double>(&view - all.data());
    return Counted(this->Progress, begin, begin + share, EquilibriaOfStart);
  }

  void Choose(const SearchedBreast& breast, ViewSearch& view, const ProgressCallback& progress)
  {
    ChooseStart(breast, view.Input->Levels.front(), this->ComparedBy(this->FirstComparison()), view,
      progress);
  }

  /// Evaluators where the search stands, with the prior of a shared parameter counted once.
  std::vector<std::unique_ptr<ViewEvaluator>> Evaluators(bool predicted, std::size_t level,
    PictureComparison comparison, const ProgressCallback& progress) const
  {
    const RegistrationOptions options = this->ComparedBy(comparison);
    std::vector<std::unique_ptr<ViewEvaluator>> evaluators;
    for (std::size_t number = 0; number < this->State.Views.size(); ++number)
    {
      const ViewSearch& view = this->State.Views[number];
      std::vector<ComparedProjection> projections{ { &view.Input->Levels[level], std::nullopt } };
      for (const ViewProjection& projection : view.Input->Projections)
      {
        projections.push_back({ &projection.Levels[level], projection.FocalSpotMm });
      }
      std::vector<RegistrationParameter> parameters = view.Result.Parameters;
      for (int index = 0; index < ParameterCount; ++index)
      {
        if (IsShared(index) && number > 0)
        {
          parameters[index].PriorSigma = 0;
        }
      }
      evaluators.push_back(std::make_unique<ViewEvaluator>(view.Breast(predicted),
        RegistrationResiduals(std::move(projections), std::move(parameters), options),
        view.Result.Values, view.Current, progress));
    }
    return evaluators;
  }

  /// Searches resolutions from `first` to before `last`; false when stopped by the user.
  bool Levels(bool predicted, std::size_t first, std::size_t last, double from, double to = 1)
  {
    const bool refines = this->Options.Comparison != this->FirstComparison();
    const std::size_t searches =
      last - first + (refines && last == this->Options.PixelSizesMm.size() ? 1 : 0);
    const ProgressCallback progress = Counted(this->Progress, from, to,
      EquilibriaOfLevel * static_cast<double>(searches * this->State.Views.size()));
    for (std::size_t number = first; number < last && !this->State.FreeParameters.empty(); ++number)
    {
      const double pixelSizeMm = this->Options.PixelSizesMm[number];
      const bool finest = pixelSizeMm == this->Options.PixelSizesMm.back();
      const bool refined = finest && refines;
      LevelEnd end =
        SearchLevel(this->Evaluators(predicted, number, this->FirstComparison(), progress),
          { pixelSizeMm, this->FirstComparison(),
            predicted || refined ? NegligibleFallOnTheWay : NegligibleFall,
            this->Options.MaximumIterations, finest && !refined },
          this->State, progress);
      if (end == LevelEnd::Reached && refined)
      {
        end = this->Refine(progress);
      }
      if (end != LevelEnd::Reached)
      {
        return end != LevelEnd::Stopped;
      }
    }
    return true;
  }

  /**
   * From where the first comparison has led, by the one that is wanted; back, and to the first
   * one's end, where that has no equilibrium or tissue looks less alike then. Edges of tissue that
   * the model has elsewhere than the breast mislead gradients more: what they find is taken where
   * tissue can tell that it is no worse.
   */
  LevelEnd Refine(const ProgressCallback& progress)
  {
    const double pixelSizeMm = this->Options.PixelSizesMm.back();
    const auto search = [&](PictureComparison comparison)
    {
      return SearchLevel(
        this->Evaluators(false, this->Options.PixelSizesMm.size() - 1, comparison, progress),
        { pixelSizeMm, comparison, NegligibleFall, this->Options.MaximumIterations, true,
          comparison != this->FirstComparison() },
        this->State, progress);
    };
    const double before = this->TissueCorrelation();
    if (std::isnan(before))
    {
      return search(this->FirstComparison());
    }
    std::vector<std::pair<std::vector<double>, std::shared_ptr<PosedBreast>>> places;
    for (const ViewSearch& view : this->State.Views)
    {
      places.emplace_back(view.Result.Values, view.Current);
    }
    const LevelEnd end = search(this->Options.Comparison);
    if (end == LevelEnd::Stopped ||
      (end == LevelEnd::Reached && this->TissueCorrelation() >= before - LostTissueCorrelation))
    {
      return end;
    }
    this->State.Covariance.clear();
    for (std::size_t number = 0; number < places.size(); ++number)
    {
      ViewSearch& view = this->State.Views[number];
      std::tie(view.Result.Values, view.Current) = places[number];
      ForgetCovariance(view.Result);
    }
    return search(this->FirstComparison());
  }

  /// Mean over the views; NaN if it is unknown for one of them.
  double TissueCorrelation()
  {
    double sum = 0;
    for (ViewSearch& view : this->State.Views)
    {
      sum += this->SimilarityOf(view).TissueCorrelation;
    }
    return sum / static_cast<double>(this->State.Views.size());
  }

  const RegistrationOptions& Options;
  const ProgressCallback& Progress;
  SearchState State;
};
}

RegistrationResult Register(const RegistrationProblem& problem, const ProgressCallback& progress,
  const SearchObserver& observer)
{
  problem.Validate();
  Search search(problem, progress, observer);
  search.Run();
  return search.Result();
}
}
