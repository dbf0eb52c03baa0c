// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/Registration.h"

#include "Private/SearchLevel.h"
#include "Private/ValidateRegistration.h"
#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <utility>

namespace mammoray
{
namespace
{
/// A level of the search has ended where so much is left of the cost, to the bottom of its
/// quadratic model. Residuals are in standard deviations: parameters that are half of their own
/// from the best cost this much more. The predictor is off by more than two.
constexpr double NegligibleFall = 0.125;
constexpr double NegligibleFallOfPredictor = 2;

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
      CompressStart(mammogram, this->Progress);
      this->KeepBefore(mammogram);
      if (chooses)
      {
        this->Choose(mammogram.Breast(), mammogram);
      }
    }
    this->Joint.CollectUnknowns(); // a start may have been opened
    this->Levels(this->Bodies(), 0, this->Options.PixelSizesMm.size());
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
      result.After = this->AgreementOf(mammogram);
      joint.Mammograms.push_back(std::move(result));
    }
    for (RegistrationResult& result : joint.Mammograms)
    {
      result.Seconds = SecondsSince(this->Joint.Begin);
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
        mammogram.Here = CompressForStart(predictors.back(), mammogram.Result.Values, nullptr,
          mammogram.Result, this->Progress);
        this->KeepBefore(mammogram);
        this->Choose(predictors.back(), mammogram);
      }
      const bool goesOn = this->Levels(predictors, 0, finest);
      // A stop takes effect once the simulation itself has been where the predictor got to.
      for (std::size_t number = 0; number < predictors.size(); ++number)
      {
        MammogramSearch& mammogram = this->Joint.Mammograms[number];
        if (goesOn)
        {
          // A cold start of the simulation itself would double the time of a search.
          ChooseEquilibrium(predictors[number],
            CoarsenTo(*mammogram.Given->Target, this->Options.PixelSizesMm.back()),
            this->Bounded(mammogram), mammogram, this->Progress);
        }
        AdoptPredicted(mammogram, goesOn ? this->Progress : ProgressCallback());
      }
      if (goesOn)
      {
        this->Levels(this->Bodies(), finest, finest + 1);
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

  /// What the options say, with the bounds of a mammogram's result.
  RegistrationOptions Bounded(const MammogramSearch& mammogram) const
  {
    RegistrationOptions bounded = this->Options;
    bounded.Parameters = mammogram.Result.Parameters;
    return bounded;
  }

  /// At the finest resolution.
  Agreement AgreementOf(MammogramSearch& mammogram) const
  {
    const RegistrationTarget finest =
      CoarsenTo(*mammogram.Given->Target, this->Options.PixelSizesMm.back());
    return Compare(Synthesize(*mammogram.Here, finest, this->Options.Samples), finest);
  }

  void KeepBefore(MammogramSearch& mammogram) const
  {
    mammogram.Result.Before = this->AgreementOf(mammogram);
  }

  void Choose(const SearchedBreast& breast, MammogramSearch& mammogram)
  {
    ChooseStart(breast, CoarsenTo(*mammogram.Given->Target, this->Options.PixelSizesMm.front()),
      this->Bounded(mammogram), mammogram, this->Progress);
  }

  /// Where the search stands, with the prior of a shared parameter counted once.
  std::vector<SearchedMammogram> Searched(const std::vector<SearchedBreast>& breasts,
    double pixelSizeMm) const
  {
    std::vector<SearchedMammogram> searched;
    for (std::size_t number = 0; number < this->Joint.Mammograms.size(); ++number)
    {
      const MammogramSearch& mammogram = this->Joint.Mammograms[number];
      searched.push_back({ breasts[number], CoarsenTo(*mammogram.Given->Target, pixelSizeMm),
        this->Bounded(mammogram), mammogram.Result.Values, mammogram.Here });
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
  bool Levels(const std::vector<SearchedBreast>& breasts, std::size_t first, std::size_t last)
  {
    const ProgressCallback progress = [this](double, const char* stage)
    {
      const auto iterations =
        static_cast<double>(this->Joint.Mammograms.front().Result.Iterations.size());
      // A typical number.
      const double expected = 6.0 * static_cast<double>(this->Options.PixelSizesMm.size());
      return !this->Progress || this->Progress(iterations / (iterations + expected), stage);
    };
    const bool predicted = breasts.front().Body == breasts.front().Model->Predictor();
    for (std::size_t number = first; number < last && !this->Joint.Unknowns.empty(); ++number)
    {
      const double pixelSizeMm = this->Options.PixelSizesMm[number];
      const Level level{ pixelSizeMm, predicted ? NegligibleFallOfPredictor : NegligibleFall,
        this->Options.MaximumIterations, pixelSizeMm == this->Options.PixelSizesMm.back() };
      const LevelEnd end =
        SearchLevel(this->Searched(breasts, pixelSizeMm), level, this->Joint, progress);
      if (end != LevelEnd::Reached)
      {
        return end != LevelEnd::Stopped;
      }
    }
    return true;
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
  const JointMammogram mammogram{ &model, placement, &target, options.Parameters, options.From };
  return std::move(RegisterTogether({ mammogram }, options, progress).Mammograms.front());
}
}
