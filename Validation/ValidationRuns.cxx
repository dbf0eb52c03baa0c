// SPDX-License-Identifier: Apache-2.0
#include "ValidationRuns.h"

#include "GlandOverlap.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/Sha256.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Study/RegistrationCase.h"

#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>

namespace mammoray
{
namespace
{
using nlohmann::json;

/// The experiments; each phantom is meshed when it is first needed.
class TwinBench
{
public:
  TwinBench(const TwinPlan& plan, ValidationFile& file, const ProgressCallback& progress)
    : Plan(plan)
    , File(file)
    , Progress(progress)
  {
  }

  /// Runs searches of one problem that the file does not hold yet.
  void RunMissing(const Phantom& phantom, TwinKind kind, int number,
    const std::vector<TwinSearch>& searches)
  {
    std::optional<TwinProblem> problem;
    int equilibria = 1;
    for (const TwinSearch search : searches)
    {
      const json key{ { "phantom", phantom.Name }, { "kind", NameOf(kind) },
        { "search", NameOf(search) }, { "number", number } };
      if (const json* done = this->File.Find("twins", key))
      {
        equilibria = std::max(done->at("equilibria").get<int>(), 1);
        continue;
      }
      const std::string stage =
        phantom.Name + " " + NameOf(kind) + " " + std::to_string(number) + ": " + NameOf(search);
      const ProgressCallback progress = [&](double fraction, const char*)
      { return !this->Progress || this->Progress(fraction, stage.c_str()); };
      TwinExperiment& experiment = this->ExperimentOn(phantom);
      json run;
      try
      {
        if (!problem)
        {
          problem = experiment.Draw(kind, number, progress);
        }
        run = experiment.Run(*problem, search, equilibria, progress);
      }
      catch (const ConvergenceError& error)
      {
        run = FailedTwin(phantom.Name, kind, search, number, error.what());
      }
      catch (const InputError& error)
      {
        if (!IsWrongPair(kind))
        {
          throw;
        }
        run = FailedTwin(phantom.Name, kind, search, number, error.what());
      }
      equilibria = std::max(run.at("equilibria").get<int>(), 1);
      this->File.Add("twins", std::move(run));
    }
  }

private:
  /// The next phantom's breast for TwinKind::OtherBreast; nothing if it is not needed or there is
  /// only one.
  std::optional<LabelVolume> OtherBreast(const Phantom& phantom, const MaterialTable& table) const
  {
    const std::vector<Phantom>& all = this->Plan.Phantoms;
    const std::vector<TwinKind>& kinds = this->Plan.Kinds;
    if (all.size() < 2 ||
      std::find(kinds.begin(), kinds.end(), TwinKind::OtherBreast) == kinds.end())
    {
      return std::nullopt;
    }
    const auto own = std::find_if(all.begin(), all.end(),
      [&](const Phantom& each) { return each.Name == phantom.Name; });
    return ReadMaterials((own + 1 == all.end() ? all.front() : *(own + 1)).Labels, table);
  }

  TwinExperiment& ExperimentOn(const Phantom& phantom)
  {
    std::unique_ptr<TwinExperiment>& experiment = this->Experiments[phantom.Name];
    if (!experiment)
    {
      const MaterialTable table = FindMaterialTable(this->Plan.Materials);
      const std::optional<LabelVolume> other = this->OtherBreast(phantom, table);
      experiment =
        std::make_unique<TwinExperiment>(phantom.Name, ReadMaterials(phantom.Labels, table), table,
          AnatomicalAxes::FromCode(this->Plan.Orientation), this->Plan.Options, this->Progress,
          other ? &*other : nullptr);
    }
    return *experiment;
  }

  const TwinPlan& Plan;
  ValidationFile& File;
  const ProgressCallback& Progress;
  std::map<std::string, std::unique_ptr<TwinExperiment>> Experiments;
};

json ToJson(const ErrorSummary& summary)
{
  return { { "count", summary.Count }, { "median", summary.Median }, { "mean", summary.Mean },
    { "largest", summary.Largest } };
}

json MeasureLandmarks(const LandmarkCase& input, const ProgressCallback& progress)
{
  const std::vector<Landmark> landmarks = ReadLandmarks(input.Landmarks);
  const RegistrationCaseResult result = RunRegistrationCase(input.Case, progress);
  ReportProgress(progress, 1, "registered");
  const RegisteredView& view = result.Views.front();
  const ViewResult& registered = view.Registration;
  const Assessment& trust = registered.Trust;
  json run{ { "name", input.Name }, { "rows", json::array() }, { "glandDice", nullptr },
    { "glandDiceAtRest", nullptr }, { "trust", NameOf(trust.Level) }, { "reasons", trust.Reasons },
    { "expectedMedianMm", nullptr }, { "iterations", registered.Iterations.size() },
    { "equilibria", registered.Evaluations }, { "seconds", registered.Seconds } };
  if (registered.Expected)
  {
    run["expectedMedianMm"] = registered.Expected->MedianMm;
  }
  const auto grid = UncompressedGrid(result, view);
  for (const LandmarkErrors& errors :
    EvaluateLandmarks(landmarks, input.Truth, grid, registered.Placed, view.View.Unit))
  {
    run["rows"].push_back(
      { { "method", errors.Method }, { "in3dMm", ToJson(Summarise(errors.Imaged.InSpaceMm)) },
        { "onReceptorMm", ToJson(Summarise(errors.Imaged.OnReceptorMm)) } });
  }
  if (!input.CompressedLabels.Path.empty())
  {
    const GlandOverlap overlap = MeasureGland(input, result, grid);
    run["glandDice"] = overlap.Registered;
    run["glandDiceAtRest"] = overlap.AtRest;
  }
  return run;
}

json MeasureMammogram(const MammogramCase& input, const ProgressCallback& progress)
{
  json run{ { "name", input.Name }, { "failure", "" } };
  try
  {
    const RegistrationCaseResult result = RunRegistrationCase(input.Case, progress);
    ReportProgress(progress, 1, "registered");
    const ViewResult& registered = result.Views.front().Registration;
    const Assessment& trust = registered.Trust;
    run.update({ { "meanOutlineDistanceMm", registered.After.MeanOutlineDistanceMm },
      { "largestOutlineDistanceMm", registered.After.LargestOutlineDistanceMm },
      { "correlation", registered.After.Correlation },
      { "tissueCorrelation", registered.After.TissueCorrelation },
      { "seconds", registered.Seconds }, { "trust", NameOf(trust.Level) },
      { "reasons", trust.Reasons } });
  }
  catch (const ConvergenceError& error)
  {
    run["failure"] = error.what();
  }
  catch (const InputError& error)
  {
    run["failure"] = error.what();
  }
  return run;
}
}

nlohmann::json SettingsOf(const TwinPlan& plan)
{
  json phantoms;
  for (const Phantom& phantom : plan.Phantoms)
  {
    phantoms[phantom.Name] = { { "sha256", Sha256OfFile(phantom.Labels.Path) },
      { "spacingMm", phantom.Labels.SpacingMm } };
  }
  const TwinOptions& options = plan.Options;
  return { { "phantoms", phantoms }, { "materials", plan.Materials },
    { "orientation", plan.Orientation }, { "seed", options.Seed },
    { "modelFineness", options.ModelFineness }, { "targetFineness", options.TargetFineness },
    { "modelAnatomyMm", options.ModelAnatomyMm }, { "targetAnatomyMm", options.TargetAnatomyMm },
    { "noise", options.Noise }, { "picture", NameOf(options.Picture) } };
}

void RunTwins(const TwinPlan& plan, ValidationFile& file, const ProgressCallback& progress)
{
  TwinBench bench(plan, file, progress);
  for (int number = 0; number < plan.Count; ++number)
  {
    for (const TwinKind kind : plan.Kinds)
    {
      for (const Phantom& phantom : plan.Phantoms)
      {
        // A single phantom has no other breast: this is no pair, not a refused one.
        if (kind != TwinKind::OtherBreast || plan.Phantoms.size() > 1)
        {
          bench.RunMissing(phantom, kind, number, { TwinSearch::Register });
        }
      }
    }
  }
}

void CompareSearches(const TwinPlan& plan, ValidationFile& file, const ProgressCallback& progress)
{
  TwinBench bench(plan, file, progress);
  for (int number = 0; number < plan.Count; ++number)
  {
    for (const Phantom& phantom : plan.Phantoms)
    {
      bench.RunMissing(phantom, TwinKind::Plain, number,
        { TwinSearch::Exact, TwinSearch::CentralDifferences, TwinSearch::Annealing });
    }
  }
}

void RunLandmarks(const std::vector<LandmarkCase>& cases, ValidationFile& file,
  const ProgressCallback& progress)
{
  for (const LandmarkCase& each : cases)
  {
    if (!file.Find("landmarks", { { "name", each.Name } }))
    {
      file.Add("landmarks", MeasureLandmarks(each, PartOf(progress, 0, 1, each.Name)));
    }
  }
}

void RunMammograms(const std::vector<MammogramCase>& cases, ValidationFile& file,
  const ProgressCallback& progress)
{
  for (const MammogramCase& each : cases)
  {
    if (!file.Find("mammograms", { { "name", each.Name } }))
    {
      file.Add("mammograms", MeasureMammogram(each, PartOf(progress, 0, 1, each.Name)));
    }
  }
}

void RunStudies(const std::vector<PlannedStudy>& studies, const std::string& keepIn,
  ValidationFile& file, const ProgressCallback& progress)
{
  for (const PlannedStudy& study : studies)
  {
    const std::uint32_t seed = study.Options.Seed;
    if (!file.Find("studies", { { "phantom", study.Phantom }, { "seed", seed } }))
    {
      const std::string name = study.Phantom + " " + std::to_string(seed);
      file.Add("studies", RunStudy(study, keepIn, PartOf(progress, 0, 1, name)));
    }
  }
}
}
