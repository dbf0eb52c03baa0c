// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/Registration.h"

#include "Private/SearchLevel.h"
#include "Private/ValidateRegistration.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
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

/// Of the tissue's correlation so much is lost by chance.
constexpr double LostTissueCorrelation = 0.02;

/// Where stages of a search end, as parts of its time: the start chosen, coarse resolutions
/// searched by the predictor, the simulation itself where that got to. Of a study's 150 to 200 s.
constexpr double StartEnds = 0.1;
constexpr double CoarseEnds = 0.35;
constexpr double AdoptedEnds = 0.45;
/// Equilibria that a stage takes for each mammogram, by experience: a level 8 to 25.
constexpr double EquilibriaOfStart = 5;
constexpr double EquilibriaOfLevel = 12;

/**
 * Of a stage that takes from `from` to `to` of the whole, in equilibria that each tell of
 * themselves from 0 to 1: how many it needs is not known, so that it draws near its end, never
 * back.
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
void AddSensitivities(BreastModel& model, const UnitPlacement& placement,
  RegistrationResult& result)
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
    result.Sensitivities[uncertain[index]].assign(
      velocities[index].begin(), velocities[index].end());
  }
}

/// Adds to a result, whose search has ended, what follows from its pose, state and covariance.
void Complete(const JointMammogram& mammogram, RegistrationResult& result)
{
  BreastModel& model = *mammogram.Model;
  const RegistrationTarget& target = *mammogram.Target;
  EvaluatedState breast(model, model.Body(), mammogram.Placement, result.Pose, result.State);
  result.Placed = breast.Placed();
  result.Points = model.AnatomyPoints().Map(result.State.Positions);
  AddSensitivities(model, mammogram.Placement, result);
  result.Synthetic = Synthesize(breast, target.Grid, ChestWallCentre(target), 1);
  result.After = Compare(result.Synthetic, target);
  for (const ProjectionTarget& other : mammogram.Others)
  {
    const RegistrationTarget& picture = *other.Target;
    result.ProjectionsAfter.push_back(Compare(
      Synthesize(breast.SeenFrom(other.FocalSpotMm), picture.Grid, ChestWallCentre(picture), 1),
      picture));
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

void ForgetCovariance(RegistrationResult& result)
{
  result.Covariance.clear();
  result.ConsideredCovariance.clear();
  std::fill(result.StandardDeviations.begin(), result.StandardDeviations.end(),
    std::numeric_limits<double>::quiet_NaN());
  result.Misfit = {};
}

/// The steps of RegisterTogether.
class Search
{
public:
  Search(const std::vector<JointMammogram>& mammograms, const RegistrationOptions& options,
    const ProgressCallback& progress, const SearchObserver& observer)
    : Options(options)
    , Progress(progress)
  {
    this->Joint.Observer = observer;
    for (const JointMammogram& mammogram : mammograms)
    {
      this->Joint.Mammograms.push_back(StartOf(mammogram));
    }
  }

  void Run()
  {
    for (MammogramSearch& mammogram : this->Joint.Mammograms)
    {
      OpenToLeastHeight(mammogram);
    }
    this->Joint.CollectUnknowns();
    const bool chooses =
      !this->Joint.Unknowns.empty() && this->Joint.Mammograms.front().Given->From.empty();
    if (chooses && this->HasPredictors() && this->ByPredictor())
    {
      return;
    }
    for (MammogramSearch& mammogram : this->Joint.Mammograms)
    {
      const ProgressCallback progress = this->OfMammogram(mammogram, 0, StartEnds);
      CompressStart(mammogram, progress);
      this->KeepBefore(mammogram);
      if (chooses)
      {
        this->Choose(mammogram.Breast(), mammogram, progress);
      }
    }
    this->Joint.CollectUnknowns(); // a start may have been opened
    this->Levels(this->Bodies(), 0, this->Options.PixelSizesMm.size(), StartEnds);
  }

  /// What Run has found, with how well its end agrees.
  JointRegistrationResult Result()
  {
    JointRegistrationResult joint;
    for (const SearchUnknown& unknown : this->Joint.Unknowns)
    {
      joint.Unknowns.push_back(
        { unknown.Parameter, unknown.Mammograms.front(), unknown.Mammograms.size() > 1 });
    }
    joint.Covariance = std::move(this->Joint.Covariance);
    for (MammogramSearch& mammogram : this->Joint.Mammograms)
    {
      RegistrationResult& result = mammogram.Result;
      result.Pose = PoseOf(result.Values);
      result.State = mammogram.Here->State();
      result.Seconds = SecondsSince(this->Joint.Begin);
      Complete(*mammogram.Given, result);
      joint.Mammograms.push_back(std::move(result));
    }
    return joint;
  }

private:
  bool HasPredictors() const
  {
    return std::all_of(this->Joint.Mammograms.begin(), this->Joint.Mammograms.end(),
      [](const MammogramSearch& mammogram) { return mammogram.PredictedBreast().Body != nullptr; });
  }

  std::vector<SearchedBreast> Bodies() const
  {
    std::vector<SearchedBreast> bodies;
    for (const MammogramSearch& mammogram : this->Joint.Mammograms)
    {
      bodies.push_back(mammogram.Breast());
    }
    return bodies;
  }

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
      std::vector<SearchedBreast> predictors;
      for (MammogramSearch& mammogram : this->Joint.Mammograms)
      {
        starts.push_back(mammogram.Result.Values);
        predictors.push_back(mammogram.PredictedBreast());
        const ProgressCallback progress = this->OfMammogram(mammogram, 0, StartEnds);
        mammogram.Here = CompressForStart(predictors.back(), mammogram.Result.Values, nullptr,
          mammogram.Result, progress);
        this->KeepBefore(mammogram);
        this->Choose(predictors.back(), mammogram, progress);
      }
      const bool goesOn =
        this->Levels(predictors, 0, finest, StartEnds, CoarseEnds) && !this->EndsHopeless();
      // An end takes effect once the simulation itself has been where the predictor got to.
      for (std::size_t number = 0; number < predictors.size(); ++number)
      {
        MammogramSearch& mammogram = this->Joint.Mammograms[number];
        const ProgressCallback progress = this->OfMammogram(mammogram, CoarseEnds, AdoptedEnds);
        if (goesOn)
        {
          // A cold start of the simulation itself would double the time of a search.
          ChooseEquilibrium(predictors[number],
            CoarsenTo(*mammogram.Given->Target, this->Options.PixelSizesMm.back()),
            this->Bounded(mammogram, this->FirstComparison()), mammogram, progress);
        }
        AdoptPredicted(mammogram, goesOn ? progress : ProgressCallback());
      }
      if (goesOn)
      {
        this->Levels(this->Bodies(), finest, finest + 1, AdoptedEnds);
      }
      return true;
    }
    catch (const ConvergenceError&)
    {
      for (std::size_t mammogram = 0; mammogram < starts.size(); ++mammogram)
      {
        this->Joint.Mammograms[mammogram].Result.Values = starts[mammogram];
      }
      return false;
    }
  }

  /// Whether outlines are too far apart to be searched on; says so in the results, then.
  bool EndsHopeless()
  {
    double apart = 0;
    for (MammogramSearch& mammogram : this->Joint.Mammograms)
    {
      apart = std::fmax(apart, this->AgreementOf(mammogram).MeanOutlineDistanceMm);
    }
    if (!(apart > HopelessOutlineMm))
    {
      return false;
    }
    for (MammogramSearch& mammogram : this->Joint.Mammograms)
    {
      mammogram.Result.Converged = false;
      mammogram.Result.StopReason = "the outlines are still " + NumberText(std::round(apart)) +
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

  /// What the options say, with the bounds of a mammogram's result.
  RegistrationOptions Bounded(const MammogramSearch& mammogram, PictureComparison comparison) const
  {
    RegistrationOptions bounded = this->Options;
    bounded.Parameters = mammogram.Result.Parameters;
    bounded.Comparison = comparison;
    return bounded;
  }

  /// At the finest resolution.
  Agreement AgreementOf(MammogramSearch& mammogram) const
  {
    const RegistrationTarget finest =
      CoarsenTo(*mammogram.Given->Target, this->Options.PixelSizesMm.back());
    return Compare(
      Synthesize(*mammogram.Here, finest.Grid, ChestWallCentre(finest), this->Options.Samples),
      finest);
  }

  void KeepBefore(MammogramSearch& mammogram) const
  {
    mammogram.Result.Before = this->AgreementOf(mammogram);
  }

  /// Of one mammogram's share in a stage that takes them one by one.
  ProgressCallback OfMammogram(const MammogramSearch& mammogram, double from, double to) const
  {
    const std::vector<MammogramSearch>& all = this->Joint.Mammograms;
    const double share = (to - from) / static_cast<double>(all.size());
    const double begin = from + share * static_cast<double>(&mammogram - all.data());
    return Counted(this->Progress, begin, begin + share, EquilibriaOfStart);
  }

  void Choose(const SearchedBreast& breast, MammogramSearch& mammogram,
    const ProgressCallback& progress)
  {
    ChooseStart(breast, CoarsenTo(*mammogram.Given->Target, this->Options.PixelSizesMm.front()),
      this->Bounded(mammogram, this->FirstComparison()), mammogram, progress);
  }

  /// Where the search stands, with the prior of a shared parameter counted once.
  std::vector<SearchedMammogram> Searched(const std::vector<SearchedBreast>& breasts,
    double pixelSizeMm, PictureComparison comparison) const
  {
    std::vector<SearchedMammogram> searched;
    for (std::size_t number = 0; number < this->Joint.Mammograms.size(); ++number)
    {
      const MammogramSearch& mammogram = this->Joint.Mammograms[number];
      searched.push_back({ breasts[number], CoarsenTo(*mammogram.Given->Target, pixelSizeMm),
        this->Bounded(mammogram, comparison), mammogram.Result.Values, mammogram.Here, {} });
      for (const ProjectionTarget& other : mammogram.Given->Others)
      {
        searched.back().Others.push_back(
          { CoarsenTo(*other.Target, pixelSizeMm), other.FocalSpotMm });
      }
      for (int index = 0; index < ParameterCount; ++index)
      {
        if (IsShared(index) && number > 0)
        {
          searched.back().Options.Parameters[index].PriorSigma = 0;
        }
      }
    }
    return searched;
  }

  /// Searches resolutions from `first` to before `last`; false when stopped by the user.
  bool Levels(const std::vector<SearchedBreast>& breasts, std::size_t first, std::size_t last,
    double from, double to = 1)
  {
    const bool refines = this->Options.Comparison != this->FirstComparison();
    const std::size_t searches =
      last - first + (refines && last == this->Options.PixelSizesMm.size() ? 1 : 0);
    const ProgressCallback progress = Counted(this->Progress, from, to,
      EquilibriaOfLevel * static_cast<double>(searches * breasts.size()));
    const bool predicted = breasts.front().Body == breasts.front().Model->Predictor();
    for (std::size_t number = first; number < last && !this->Joint.Unknowns.empty(); ++number)
    {
      const double pixelSizeMm = this->Options.PixelSizesMm[number];
      const bool finest = pixelSizeMm == this->Options.PixelSizesMm.back();
      const bool refined = finest && refines;
      LevelEnd end = SearchLevel(this->Searched(breasts, pixelSizeMm, this->FirstComparison()),
        { pixelSizeMm, this->FirstComparison(),
          predicted || refined ? NegligibleFallOnTheWay : NegligibleFall,
          this->Options.MaximumIterations, finest && !refined },
        this->Joint, progress);
      if (end == LevelEnd::Reached && refined)
      {
        end = this->Refine(breasts, progress);
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
  LevelEnd Refine(const std::vector<SearchedBreast>& breasts, const ProgressCallback& progress)
  {
    const double pixelSizeMm = this->Options.PixelSizesMm.back();
    const auto search = [&](PictureComparison comparison)
    {
      return SearchLevel(this->Searched(breasts, pixelSizeMm, comparison),
        { pixelSizeMm, comparison, NegligibleFall, this->Options.MaximumIterations, true,
          comparison != this->FirstComparison() },
        this->Joint, progress);
    };
    const double before = this->TissueCorrelation();
    if (std::isnan(before))
    {
      return search(this->FirstComparison());
    }
    std::vector<std::pair<std::vector<double>, std::shared_ptr<EvaluatedState>>> places;
    for (const MammogramSearch& mammogram : this->Joint.Mammograms)
    {
      places.emplace_back(mammogram.Result.Values, mammogram.Here);
    }
    const LevelEnd end = search(this->Options.Comparison);
    if (end == LevelEnd::Stopped ||
      (end == LevelEnd::Reached && this->TissueCorrelation() >= before - LostTissueCorrelation))
    {
      return end;
    }
    this->Joint.Covariance.clear();
    for (std::size_t number = 0; number < places.size(); ++number)
    {
      MammogramSearch& mammogram = this->Joint.Mammograms[number];
      std::tie(mammogram.Result.Values, mammogram.Here) = places[number];
      ForgetCovariance(mammogram.Result);
    }
    return search(this->FirstComparison());
  }

  /// Of all mammograms on average; NaN where one of them does not tell.
  double TissueCorrelation()
  {
    double sum = 0;
    for (MammogramSearch& mammogram : this->Joint.Mammograms)
    {
      sum += this->AgreementOf(mammogram).TissueCorrelation;
    }
    return sum / static_cast<double>(this->Joint.Mammograms.size());
  }

  const RegistrationOptions& Options;
  const ProgressCallback& Progress;
  JointSearch Joint;
};
}

bool IsShared(int parameter)
{
  return parameter == StiffnessParameter;
}

JointRegistrationResult RegisterTogether(const std::vector<JointMammogram>& mammograms,
  const RegistrationOptions& options, const ProgressCallback& progress,
  const SearchObserver& observer)
{
  ValidateMammograms(mammograms, options);
  Search search(mammograms, options, progress, observer);
  search.Run();
  return search.Result();
}

RegistrationResult Register(BreastModel& model, const UnitPlacement& placement,
  const RegistrationTarget& target, const RegistrationOptions& options,
  const ProgressCallback& progress)
{
  const JointMammogram mammogram{ &model, placement, &target, options.Parameters, options.From,
    {} };
  return std::move(RegisterTogether({ mammogram }, options, progress).Mammograms.front());
}
}
