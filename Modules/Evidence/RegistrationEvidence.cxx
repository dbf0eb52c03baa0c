// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Evidence/RegistrationEvidence.h"

#include "Private/GlandOverlap.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Registration/RegistrationResult.h"
#include "mammoray/Study/RegistrationCaseWriter.h"

#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <limits>
#include <map>

namespace mammoray
{
namespace
{
/// A search that found nothing counts as one that did not converge.
TwinRun FailedRun(const std::string& phantom, const char* kind, const char* search, int number,
  const std::string& reason)
{
  TwinRun run;
  run.Phantom = phantom;
  run.Kind = kind;
  run.Search = search;
  run.Number = number;
  run.MedianErrorMm = std::numeric_limits<double>::quiet_NaN();
  run.LargestErrorMm = run.MedianErrorMm;
  run.CoordinatesWithin = run.MedianErrorMm;
  run.TissueCorrelation = run.MedianErrorMm;
  run.Trust = NameOf(Trust::None);
  run.StopReason = reason;
  return run;
}

/// The experiments, each phantom's meshes made when it is first wanted.
class TwinBench
{
public:
  TwinBench(const EvidenceOptions& options, RegistrationEvidence& evidence,
    const std::function<void()>& keep, const ProgressCallback& progress)
    : Options(options)
    , Evidence(evidence)
    , Keep(keep)
    , Progress(progress)
  {
  }

  void Register()
  {
    for (int number = 0; number < this->Options.Twins; ++number)
    {
      for (const TwinKind kind : this->Options.Kinds)
      {
        for (const EvidencePhantom& phantom : this->Options.Phantoms)
        {
          // One phantom has no other beside it: no pair, and none that was refused.
          if (kind != TwinKind::OtherBreast || this->Options.Phantoms.size() > 1)
          {
            this->RunMissing(phantom, kind, number, { TwinSearch::Register });
          }
        }
      }
    }
  }

  void CompareSearches()
  {
    for (int number = 0; number < this->Options.SearchTwins; ++number)
    {
      for (const EvidencePhantom& phantom : this->Options.Phantoms)
      {
        this->RunMissing(phantom, TwinKind::Plain, number,
          { TwinSearch::Exact, TwinSearch::CentralDifferences, TwinSearch::Annealing });
      }
    }
  }

private:
  /// Searches of one problem; annealing gets as many equilibria as the search before it took.
  void RunMissing(const EvidencePhantom& phantom, TwinKind kind, int number,
    const std::vector<TwinSearch>& searches)
  {
    std::optional<TwinProblem> problem;
    int budget = 1;
    for (const TwinSearch search : searches)
    {
      if (const TwinRun* done =
            this->Evidence.Find(phantom.Name, NameOf(kind), NameOf(search), number))
      {
        budget = std::max(done->Equilibria, 1);
        continue;
      }
      const std::string stage =
        phantom.Name + " " + NameOf(kind) + " " + std::to_string(number) + ": " + NameOf(search);
      const ProgressCallback progress = [&](double fraction, const char*)
      { return !this->Progress || this->Progress(fraction, stage.c_str()); };
      TwinExperiment& experiment = this->ExperimentOn(phantom);
      TwinRun run;
      try
      {
        if (!problem)
        {
          problem = experiment.Draw(kind, number, progress);
        }
        run = experiment.Run(*problem, search, budget, progress);
      }
      catch (const ConvergenceError& error)
      {
        run = FailedRun(phantom.Name, NameOf(kind), NameOf(search), number, error.what());
      }
      catch (const InputError& error)
      {
        if (!IsWrongPair(kind))
        {
          throw;
        }
        run = FailedRun(phantom.Name, NameOf(kind), NameOf(search), number, error.what());
      }
      budget = std::max(run.Equilibria, 1);
      this->Evidence.Twins.push_back(run);
      this->Keep();
    }
  }

  /// The next phantom's, for TwinKind::OtherBreast; nothing where there is but one or it is not
  /// asked for.
  std::optional<LabelVolume> BreastBeside(const EvidencePhantom& phantom,
    const MaterialTable& table) const
  {
    const std::vector<EvidencePhantom>& all = this->Options.Phantoms;
    const std::vector<TwinKind>& kinds = this->Options.Kinds;
    if (all.size() < 2 ||
      std::find(kinds.begin(), kinds.end(), TwinKind::OtherBreast) == kinds.end())
    {
      return std::nullopt;
    }
    const auto here = std::find_if(all.begin(), all.end(),
      [&](const EvidencePhantom& each) { return each.Name == phantom.Name; });
    return ReadMaterials((here + 1 == all.end() ? all.front() : *(here + 1)).Labels, table);
  }

  TwinExperiment& ExperimentOn(const EvidencePhantom& phantom)
  {
    std::unique_ptr<TwinExperiment>& experiment = this->Experiments[phantom.Name];
    if (!experiment)
    {
      const MaterialTable table = FindMaterialTable(this->Options.Materials);
      const std::optional<LabelVolume> other = this->BreastBeside(phantom, table);
      experiment =
        std::make_unique<TwinExperiment>(phantom.Name, ReadMaterials(phantom.Labels, table), table,
          AnatomicalAxes::FromCode(this->Options.Orientation), this->Options.Twin, this->Progress,
          other ? &*other : nullptr);
    }
    return *experiment;
  }

  const EvidenceOptions& Options;
  RegistrationEvidence& Evidence;
  const std::function<void()>& Keep;
  const ProgressCallback& Progress;
  std::map<std::string, std::unique_ptr<TwinExperiment>> Experiments;
};

LandmarkEvidence MeasureLandmarks(const EvidenceLandmarks& input, const ProgressCallback& progress)
{
  const std::vector<Landmark> landmarks = ReadLandmarks(input.Landmarks);
  const RegistrationCaseResult result = RunRegistrationCase(input.Case, progress);
  ReportProgress(progress, 1, "registered");
  LandmarkEvidence found;
  found.Name = input.Name;
  const RegisteredView& view = result.Views.front();
  const Assessment& trust = view.Registration.Trust;
  found.Trust = NameOf(trust.Level);
  found.Reasons = trust.Reasons;
  found.ExpectedMedianMm = view.Registration.Expected ? view.Registration.Expected->MedianMm
                                                      : std::numeric_limits<double>::quiet_NaN();
  found.Iterations = static_cast<int>(view.Registration.Iterations.size());
  found.Equilibria = view.Registration.Evaluations;
  found.Seconds = view.Registration.Seconds;
  const auto grid = UncompressedGrid(result, view);
  for (const LandmarkErrors& errors :
    EvaluateLandmarks(landmarks, input.Truth, grid, view.Registration.Placed, view.View.Unit))
  {
    found.Rows.push_back(SummariseImaged(errors, landmarks));
  }
  found.GlandDice = std::numeric_limits<double>::quiet_NaN();
  found.GlandDiceAtRest = found.GlandDice;
  if (!input.CompressedLabels.Path.empty())
  {
    const GlandOverlap overlap = MeasureGland(input, result, grid);
    found.GlandDice = overlap.Registered;
    found.GlandDiceAtRest = overlap.AtRest;
  }
  return found;
}

MammogramEvidence MeasureMammogram(const EvidenceMammogram& input, const ProgressCallback& progress)
{
  MammogramEvidence found;
  found.Name = input.Name;
  try
  {
    const RegistrationCaseResult result = RunRegistrationCase(input.Case, progress);
    ReportProgress(progress, 1, "registered");
    const ViewResult& registered = result.Views.front().Registration;
    found.MeanOutlineMm = registered.After.MeanOutlineDistanceMm;
    found.LargestOutlineMm = registered.After.LargestOutlineDistanceMm;
    found.Correlation = registered.After.Correlation;
    found.TissueCorrelation = registered.After.TissueCorrelation;
    found.Seconds = registered.Seconds;
    const Assessment& trust = registered.Trust;
    found.Trust = NameOf(trust.Level);
    found.Reasons = trust.Reasons;
  }
  catch (const ConvergenceError& error)
  {
    found.Failure = error.what();
  }
  catch (const InputError& error)
  {
    found.Failure = error.what();
  }
  return found;
}

}

const TwinRun* RegistrationEvidence::Find(const std::string& phantom, const std::string& kind,
  const std::string& search, int number) const
{
  const auto found = std::find_if(this->Twins.begin(), this->Twins.end(),
    [&](const TwinRun& run)
    {
      return run.Phantom == phantom && run.Kind == kind && run.Search == search &&
        run.Number == number;
    });
  return found == this->Twins.end() ? nullptr : &*found;
}

void GatherEvidence(const EvidenceOptions& options, RegistrationEvidence& evidence,
  const std::function<void()>& keep, const ProgressCallback& progress)
{
  for (const EvidenceLandmarks& landmarks : options.Landmarks)
  {
    if (std::none_of(evidence.Landmarks.begin(), evidence.Landmarks.end(),
          [&](const LandmarkEvidence& done) { return done.Name == landmarks.Name; }))
    {
      evidence.Landmarks.push_back(MeasureLandmarks(landmarks, progress));
      keep();
    }
  }
  TwinBench bench(options, evidence, keep, progress);
  bench.CompareSearches();
  bench.Register();
  for (const EvidenceMammogram& mammogram : options.Mammograms)
  {
    if (std::none_of(evidence.Mammograms.begin(), evidence.Mammograms.end(),
          [&](const MammogramEvidence& done) { return done.Name == mammogram.Name; }))
    {
      evidence.Mammograms.push_back(MeasureMammogram(mammogram, progress));
      keep();
    }
  }
  for (const EvidenceStudy& study : options.Studies)
  {
    if (std::none_of(evidence.Studies.begin(), evidence.Studies.end(),
          [&](const StudyRun& done)
          { return done.Phantom == study.Phantom && done.Seed == study.Options.Seed; }))
    {
      const std::string name = study.Phantom + " " + std::to_string(study.Options.Seed);
      evidence.Studies.push_back(
        RunStudy(study, options.KeepStudiesIn, PartOf(progress, 0, 1, name)));
      keep();
    }
  }
}
}
