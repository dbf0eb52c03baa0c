// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Evidence/RegistrationEvidence.h"

#include "mammoray/Case/RegistrationCaseWriter.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Report/RegistrationReport.h"

#include "vtkUnstructuredGrid.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <fstream>
#include <limits>
#include <map>

namespace mammoray
{
namespace
{
/// A run converges when the median error of its points is below this, mm.
constexpr double ConvergedMm = 3;

/// One line of text.
__attribute__((format(printf, 1, 2))) std::string Line(const char* format, ...)
{
  char text[1000];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

double Median(std::vector<double> values)
{
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : Summarise(values).Median;
}

double Largest(const std::vector<double>& values)
{
  return values.empty() ? std::numeric_limits<double>::quiet_NaN()
                        : *std::max_element(values.begin(), values.end());
}

const TwinRun* Find(const std::vector<TwinRun>& runs, const std::string& phantom,
  const std::string& kind, const std::string& search, int number)
{
  for (const TwinRun& run : runs)
  {
    if (run.Phantom == phantom && run.Kind == kind && run.Search == search && run.Number == number)
    {
      return &run;
    }
  }
  return nullptr;
}

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
          this->RunMissing(phantom, kind, number, { TwinSearch::Register });
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
            Find(this->Evidence.Twins, phantom.Name, NameOf(kind), NameOf(search), number))
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
      budget = std::max(run.Equilibria, 1);
      this->Evidence.Twins.push_back(run);
      this->Keep();
    }
  }

  TwinExperiment& ExperimentOn(const EvidencePhantom& phantom)
  {
    std::unique_ptr<TwinExperiment>& experiment = this->Experiments[phantom.Name];
    if (!experiment)
    {
      const MaterialTable table = FindMaterialTable(this->Options.Materials);
      experiment =
        std::make_unique<TwinExperiment>(phantom.Name, ReadMaterials(phantom.Labels, table), table,
          AnatomicalAxes::FromCode(this->Options.Orientation), this->Options.Twin, this->Progress);
    }
    return *experiment;
  }

  const EvidenceOptions& Options;
  RegistrationEvidence& Evidence;
  const std::function<void()>& Keep;
  const ProgressCallback& Progress;
  std::map<std::string, std::unique_ptr<TwinExperiment>> Experiments;
};

nlohmann::json ToJson(const TwinRun& run)
{
  // What is not a number becomes null.
  return { { "phantom", run.Phantom }, { "kind", run.Kind }, { "search", run.Search },
    { "number", run.Number }, { "redrawn", run.Redrawn }, { "modelCells", run.ModelCells },
    { "targetCells", run.TargetCells }, { "parameters", run.Names }, { "truth", run.Truth },
    { "start", run.Start }, { "found", run.Found }, { "sigma", run.Sigma },
    { "medianErrorMm", run.MedianErrorMm }, { "largestErrorMm", run.LargestErrorMm },
    { "meanOutlineDistanceMm", run.MeanOutlineMm }, { "correlation", run.Correlation },
    { "iterations", run.Iterations }, { "equilibria", run.Equilibria }, { "seconds", run.Seconds },
    { "iterationSeconds", run.IterationSeconds }, { "iterationCosts", run.IterationCosts },
    { "converged", run.Converged }, { "stopReason", run.StopReason } };
}

double Number(const nlohmann::json& value)
{
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

std::vector<double> Numbers(const nlohmann::json& values)
{
  std::vector<double> numbers;
  for (const nlohmann::json& value : values)
  {
    numbers.push_back(Number(value));
  }
  return numbers;
}

TwinRun TwinRunFrom(const nlohmann::json& json)
{
  TwinRun run;
  run.Phantom = json.at("phantom").get<std::string>();
  run.Kind = json.at("kind").get<std::string>();
  run.Search = json.at("search").get<std::string>();
  run.Number = json.at("number").get<int>();
  run.Redrawn = json.at("redrawn").get<int>();
  run.ModelCells = json.at("modelCells").get<std::size_t>();
  run.TargetCells = json.at("targetCells").get<std::size_t>();
  run.Names = json.at("parameters").get<std::vector<std::string>>();
  run.Truth = Numbers(json.at("truth"));
  run.Start = Numbers(json.at("start"));
  run.Found = Numbers(json.at("found"));
  run.Sigma = Numbers(json.at("sigma"));
  run.MedianErrorMm = Number(json.at("medianErrorMm"));
  run.LargestErrorMm = Number(json.at("largestErrorMm"));
  run.MeanOutlineMm = Number(json.at("meanOutlineDistanceMm"));
  run.Correlation = Number(json.at("correlation"));
  run.Iterations = json.at("iterations").get<int>();
  run.Equilibria = json.at("equilibria").get<int>();
  run.Seconds = Number(json.at("seconds"));
  run.IterationSeconds = Numbers(json.at("iterationSeconds"));
  run.IterationCosts = Numbers(json.at("iterationCosts"));
  run.Converged = json.at("converged").get<bool>();
  run.StopReason = json.at("stopReason").get<std::string>();
  return run;
}

nlohmann::json ToJson(const ErrorSummary& summary)
{
  return { { "count", summary.Count }, { "median", summary.Median }, { "mean", summary.Mean },
    { "largest", summary.Largest } };
}

ErrorSummary SummaryFrom(const nlohmann::json& json)
{
  return { json.at("count").get<int>(), Number(json.at("median")), Number(json.at("mean")),
    Number(json.at("largest")) };
}

nlohmann::json ToJson(const LandmarkEvidence& found)
{
  nlohmann::json rows;
  for (const LandmarkEvidence::Row& row : found.Rows)
  {
    rows.push_back({ { "method", row.Method }, { "in3dMm", ToJson(row.InSpace) },
      { "onReceptorMm", ToJson(row.OnReceptor) } });
  }
  return { { "rows", rows }, { "glandDice", found.GlandDice },
    { "glandDiceAtRest", found.GlandDiceAtRest }, { "iterations", found.Iterations },
    { "equilibria", found.Equilibria }, { "seconds", found.Seconds } };
}

LandmarkEvidence LandmarkEvidenceFrom(const nlohmann::json& json)
{
  LandmarkEvidence found;
  for (const nlohmann::json& row : json.at("rows"))
  {
    found.Rows.push_back({ row.at("method").get<std::string>(), SummaryFrom(row.at("in3dMm")),
      SummaryFrom(row.at("onReceptorMm")) });
  }
  found.GlandDice = Number(json.at("glandDice"));
  found.GlandDiceAtRest = Number(json.at("glandDiceAtRest"));
  found.Iterations = json.at("iterations").get<int>();
  found.Equilibria = json.at("equilibria").get<int>();
  found.Seconds = Number(json.at("seconds"));
  return found;
}

nlohmann::json ToJson(const MammogramEvidence& found)
{
  return { { "name", found.Name }, { "meanOutlineDistanceMm", found.MeanOutlineMm },
    { "largestOutlineDistanceMm", found.LargestOutlineMm }, { "correlation", found.Correlation },
    { "trust", found.Trust }, { "seconds", found.Seconds }, { "failure", found.Failure } };
}

MammogramEvidence MammogramEvidenceFrom(const nlohmann::json& json)
{
  return { json.at("name").get<std::string>(), Number(json.at("meanOutlineDistanceMm")),
    Number(json.at("largestOutlineDistanceMm")), Number(json.at("correlation")),
    json.at("trust").get<std::string>(), Number(json.at("seconds")),
    json.at("failure").get<std::string>() };
}

/// Counts the gland of a breast in cubes of the gantry frame.
class GlandCubes
{
public:
  static constexpr double EdgeMm = 0.8;

  void Add(const Vector3& gantry, double mm3)
  {
    std::array<int, 3> cube{};
    for (int axis = 0; axis < 3; ++axis)
    {
      cube[axis] = static_cast<int>(std::floor(gantry[axis] / EdgeMm));
    }
    this->Mm3[cube] += mm3;
  }

  /// Dice's coefficient of the cubes that are gland by at least half.
  static double Dice(const GlandCubes& a, const GlandCubes& b)
  {
    const double least = 0.5 * EdgeMm * EdgeMm * EdgeMm;
    std::size_t both = 0;
    std::size_t sum = 0;
    for (const auto& [cube, mm3] : a.Mm3)
    {
      const auto other = b.Mm3.find(cube);
      const bool inB = other != b.Mm3.end() && other->second >= least;
      both += mm3 >= least && inB ? 1 : 0;
      sum += mm3 >= least ? 1 : 0;
    }
    for (const auto& [cube, mm3] : b.Mm3)
    {
      sum += mm3 >= least ? 1 : 0;
    }
    return 2.0 * static_cast<double>(both) / static_cast<double>(sum);
  }

private:
  std::map<std::array<int, 3>, double> Mm3;
};

std::vector<Vector3> GlandVoxels(const LabelVolume& materials, const MaterialTable& table)
{
  const std::vector<int> gland = table.Glandular();
  std::vector<Vector3> points;
  for (int k = 0; k < materials.Size[2]; ++k)
  {
    for (int j = 0; j < materials.Size[1]; ++j)
    {
      for (int i = 0; i < materials.Size[0]; ++i)
      {
        const int material = materials.Voxels[materials.Index(i, j, k)];
        if (std::find(gland.begin(), gland.end(), material) != gland.end())
        {
          points.push_back(materials.PointAt(i, j, k));
        }
      }
    }
  }
  return points;
}

/// Where the gland is, among what the truth's volume shows.
void MeasureGland(const EvidenceLandmarks& input, const RegistrationCaseResult& result,
  vtkUnstructuredGrid* uncompressed, LandmarkEvidence& found)
{
  LabelVolume compressed = ReadMaterials(input.CompressedLabels, result.Materials);
  if (input.CompressedOrigin)
  {
    compressed.Origin = *input.CompressedOrigin;
  }
  GlandCubes truth;
  for (const Vector3& point : GlandVoxels(compressed, result.Materials))
  {
    truth.Add(input.Truth.Placed.ToGantry(point), compressed.VoxelVolume());
  }
  LabelSource source = input.Case.Labels;
  source.SpacingMm = 0; // every voxel
  const LabelVolume rest = ReadMaterials(source, result.Materials);
  const std::vector<Vector3> points = GlandVoxels(rest, result.Materials);
  const std::vector<Vector3> moved = Displace(points, uncompressed);
  GlandCubes registered;
  GlandCubes still;
  const auto shown = [&](const Vector3& truthPoint)
  {
    const Vector3 index = compressed.ContinuousIndex(truthPoint);
    return index[0] >= -0.5 && index[0] < compressed.Size[0] - 0.5 && index[1] >= -0.5 &&
      index[1] < compressed.Size[1] - 0.5 && index[2] >= -0.5 &&
      index[2] < compressed.Size[2] - 0.5;
  };
  const auto add = [&](GlandCubes& cubes, const Vector3& gantry)
  {
    if (shown(input.Truth.Placed.Point(gantry)))
    {
      cubes.Add(gantry, rest.VoxelVolume());
    }
  };
  for (std::size_t index = 0; index < points.size(); ++index)
  {
    add(registered, result.Views.front().Placed.ToGantry(moved[index]));
    add(still, input.Truth.Placed.ToGantry(points[index]));
  }
  found.GlandDice = GlandCubes::Dice(registered, truth);
  found.GlandDiceAtRest = GlandCubes::Dice(still, truth);
}

LandmarkEvidence MeasureLandmarks(const EvidenceLandmarks& input, const ProgressCallback& progress)
{
  const std::vector<Landmark> landmarks = ReadLandmarks(input.Landmarks);
  const RegistrationCaseResult result = RunRegistrationCase(input.Case, progress);
  ReportProgress(progress, 1, "registered");
  LandmarkEvidence found;
  const RegisteredView& view = result.Views.front();
  found.Iterations = static_cast<int>(view.Registration.Iterations.size());
  found.Equilibria = view.Registration.Evaluations;
  found.Seconds = view.Registration.Seconds;
  const auto grid = UncompressedGrid(result, view);
  for (const LandmarkErrors& errors :
    EvaluateLandmarks(landmarks, input.Truth, grid, view.Placed, view.Unit.SourceToDetectorMm))
  {
    std::vector<double> space;
    std::vector<double> receptor;
    for (std::size_t index = 0; index < landmarks.size(); ++index)
    {
      if (landmarks[index].Imaged)
      {
        space.push_back(errors.InSpace[index]);
        receptor.push_back(errors.OnReceptor[index]);
      }
    }
    found.Rows.push_back({ errors.Method, Summarise(space), Summarise(receptor) });
  }
  found.GlandDice = std::numeric_limits<double>::quiet_NaN();
  found.GlandDiceAtRest = found.GlandDice;
  if (!input.CompressedLabels.Path.empty())
  {
    MeasureGland(input, result, grid, found);
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
    const RegistrationResult& registered = result.Views.front().Registration;
    found.MeanOutlineMm = registered.After.MeanOutlineDistanceMm;
    found.LargestOutlineMm = registered.After.LargestOutlineDistanceMm;
    found.Correlation = registered.After.Correlation;
    found.Seconds = registered.Seconds;
    const Trust trust = Assess(registered).Level;
    found.Trust = trust == Trust::Good ? "good" : trust == Trust::Doubtful ? "doubtful" : "none";
  }
  catch (const ConvergenceError& error)
  {
    found.Failure = error.what();
  }
  return found;
}

/// Of some runs.
struct TwinSummary
{
  int Count = 0;
  int Converged = 0;
  std::size_t ModelCells = 0;
  std::vector<double> Errors;
  std::vector<double> Iterations;
  std::vector<double> Equilibria;
  std::vector<double> Seconds;
  /// By parameter: errors, and how many are within two of their standard deviations.
  std::map<std::string, std::vector<double>> ParameterErrors;
  std::map<std::string, int> Within;
  int WithinAll = 0;
  int ParametersAll = 0;

  void Add(const TwinRun& run)
  {
    ++this->Count;
    this->Converged += run.MedianErrorMm < ConvergedMm ? 1 : 0;
    if (!std::isfinite(run.MedianErrorMm))
    {
      return;
    }
    this->ModelCells = run.ModelCells;
    this->Errors.push_back(run.MedianErrorMm);
    this->Iterations.push_back(run.Iterations);
    this->Equilibria.push_back(run.Equilibria);
    this->Seconds.push_back(run.Seconds);
    for (std::size_t index = 0; index < run.Names.size(); ++index)
    {
      if (std::isfinite(run.Sigma[index]))
      {
        const double error = std::abs(run.Found[index] - run.Truth[index]);
        const int within = error <= 2 * run.Sigma[index] ? 1 : 0;
        this->ParameterErrors[run.Names[index]].push_back(error);
        this->Within[run.Names[index]] += within;
        this->WithinAll += within;
        ++this->ParametersAll;
      }
    }
  }
};

int Percent(double part, double whole)
{
  return whole > 0 ? static_cast<int>(std::lround(100 * part / whole)) : 0;
}

/// By kind, then by phantom, the last of which is "all".
using TwinSummaries = std::map<std::string, std::map<std::string, TwinSummary>>;

constexpr const char* AllPhantoms = "all";
constexpr TwinKind AllKinds[] = { TwinKind::Plain, TwinKind::WrongMaterial, TwinKind::WrongStart,
  TwinKind::EveryParameter };

std::string RunTable(const TwinSummaries& summaries)
{
  std::string text = "| twins | phantom | cells | runs | 3D error: median (largest), mm | below 3 "
                     "mm | iterations, median "
                     "(most) | equilibria | time, s | true values within 2 sigma |\n"
                     "|---|---|---|---|---|---|---|---|---|---|\n";
  const auto row = [&](const std::string& kind, const std::string& phantom, const TwinSummary& of)
  {
    text +=
      Line("| %s | %s | %s | %d | %.2f (%.2f) | %d %% | %.0f (%.0f) | %.0f | %.0f | %d %% |\n",
        kind.c_str(), phantom.c_str(),
        phantom == AllPhantoms ? "" : Line("%zu", of.ModelCells).c_str(), of.Count,
        Median(of.Errors), Largest(of.Errors), Percent(of.Converged, of.Count),
        Median(of.Iterations), Largest(of.Iterations), Median(of.Equilibria), Median(of.Seconds),
        Percent(of.WithinAll, of.ParametersAll));
  };
  for (const TwinKind kind : AllKinds)
  {
    const auto found = summaries.find(NameOf(kind));
    if (found == summaries.end())
    {
      continue;
    }
    for (const auto& [phantom, summary] : found->second)
    {
      if (phantom != AllPhantoms)
      {
        row(found->first, phantom, summary);
      }
    }
    row(found->first, AllPhantoms, found->second.at(AllPhantoms));
  }
  return text + "\n";
}

std::string ParameterTable(const TwinSummaries& summaries)
{
  std::string text = "| error: median (largest); true value within 2 sigma |";
  std::string rule = "|---|";
  for (const TwinKind kind : AllKinds)
  {
    if (summaries.count(NameOf(kind)) != 0)
    {
      text += std::string(" ") + NameOf(kind) + " |";
      rule += "---|";
    }
  }
  text += "\n" + rule + "\n";
  for (const RegistrationParameter& parameter : DefaultParameters({}))
  {
    std::string row;
    bool any = false;
    for (const TwinKind kind : AllKinds)
    {
      if (summaries.count(NameOf(kind)) == 0)
      {
        continue;
      }
      const TwinSummary& summary = summaries.at(NameOf(kind)).at(AllPhantoms);
      const auto errors = summary.ParameterErrors.find(parameter.Name);
      const bool found = errors != summary.ParameterErrors.end();
      any = any || found;
      row += found
        ? Line(" %.2f (%.2f); %d %% |", Median(errors->second), Largest(errors->second),
            Percent(summary.Within.at(parameter.Name), static_cast<double>(errors->second.size())))
        : " - |";
    }
    if (any)
    {
      text += "| " + parameter.Name + (parameter.Unit.empty() ? "" : ", " + parameter.Unit) + " |" +
        row + "\n";
    }
  }
  return text + "\n";
}

std::string TwinTables(const std::vector<TwinRun>& runs)
{
  TwinSummaries summaries;
  for (const TwinRun& run : runs)
  {
    if (run.Search == NameOf(TwinSearch::Register))
    {
      summaries[run.Kind][run.Phantom].Add(run);
      summaries[run.Kind][AllPhantoms].Add(run);
    }
  }
  return summaries.empty() ? "" : RunTable(summaries) + ParameterTable(summaries);
}

/// Time after `from` until the cost is as low as `cost`; NaN where it never is.
double SecondsTo(const TwinRun& run, double cost, double from)
{
  for (std::size_t index = 0; index < run.IterationCosts.size(); ++index)
  {
    if (run.IterationCosts[index] <= cost)
    {
      return run.IterationSeconds[index] - from;
    }
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::string SearchTable(const std::vector<TwinRun>& runs)
{
  std::string text =
    "| search | phantom, twin | equilibria | time, s | cost | time to the exact search's cost, s "
    "(without the start) | 3D error, mm |\n|---|---|---|---|---|---|---|\n";
  bool any = false;
  std::vector<double> ratios;
  for (const TwinRun& exact : runs)
  {
    if (exact.Search != NameOf(TwinSearch::Exact) || exact.IterationCosts.empty())
    {
      continue;
    }
    // As low: what the search itself takes for nothing.
    const double reached = exact.IterationCosts.back() + 0.125;
    // All searches have the same start.
    const double begin = exact.IterationSeconds.front();
    const double ownSeconds = SecondsTo(exact, reached, begin);
    for (const TwinSearch search :
      { TwinSearch::Exact, TwinSearch::CentralDifferences, TwinSearch::Annealing })
    {
      if (const TwinRun* run = Find(runs, exact.Phantom, exact.Kind, NameOf(search), exact.Number))
      {
        const double seconds = SecondsTo(*run, reached, begin);
        text += Line("| %s | %s, %d | %d | %.1f | %.2f | %s | %.2f |\n", NameOf(search),
          run->Phantom.c_str(), run->Number, run->Equilibria, run->Seconds,
          run->IterationCosts.empty() ? std::numeric_limits<double>::quiet_NaN()
                                      : run->IterationCosts.back(),
          std::isfinite(seconds) ? Line("%.1f", seconds).c_str() : "never", run->MedianErrorMm);
        if (search == TwinSearch::CentralDifferences && std::isfinite(seconds) && ownSeconds > 0)
        {
          ratios.push_back(seconds / ownSeconds);
        }
        any = true;
      }
    }
  }
  if (!ratios.empty())
  {
    text += Line("\nExact derivatives get there %.1f times as fast as differences (median).\n",
      Median(ratios));
  }
  return any ? text + "\n" : "";
}

std::string LandmarkTable(const LandmarkEvidence& found)
{
  std::string text = "| imaged landmarks: median (largest) error, mm | in 3D | on the receptor |\n"
                     "|---|---|---|\n";
  for (const LandmarkEvidence::Row& row : found.Rows)
  {
    text += Line("| %s | %.2f (%.2f) | %.2f (%.2f) |\n", row.Method.c_str(), row.InSpace.Median,
      row.InSpace.Largest, row.OnReceptor.Median, row.OnReceptor.Largest);
  }
  if (std::isfinite(found.GlandDice))
  {
    text +=
      Line("\nGland overlap (Dice) %.2f, at rest %.2f. ", found.GlandDice, found.GlandDiceAtRest);
  }
  return text +
    Line("%d iterations, %d equilibria, %.0f s.\n\n", found.Iterations, found.Equilibria,
      found.Seconds);
}

std::string MammogramTable(const std::vector<MammogramEvidence>& found)
{
  std::string text =
    "| real mammogram | outline: mean (largest), mm | correlation | trust that the "
    "report claims | time, s |\n|---|---|---|---|---|\n";
  for (const MammogramEvidence& row : found)
  {
    text += row.Failure.empty()
      ? Line("| %s | %.2f (%.2f) | %.2f | %s | %.0f |\n", row.Name.c_str(), row.MeanOutlineMm,
          row.LargestOutlineMm, row.Correlation, row.Trust.c_str(), row.Seconds)
      : Line("| %s | - | - | no result: %s | - |\n", row.Name.c_str(), row.Failure.c_str());
  }
  return text + "\n";
}

void WriteText(const std::string& text, const std::string& path)
{
  std::ofstream file(path);
  file << text;
  file.close();
  if (!file)
  {
    throw InputError(path + ": cannot be written");
  }
}
}

void GatherEvidence(const EvidenceOptions& options, RegistrationEvidence& evidence,
  const std::function<void()>& keep, const ProgressCallback& progress)
{
  if (options.Landmarks && !evidence.Landmarks)
  {
    evidence.Landmarks = MeasureLandmarks(*options.Landmarks, progress);
    keep();
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
}

void WriteEvidence(const RegistrationEvidence& evidence, const std::string& settings,
  const std::string& path)
{
  nlohmann::json json{ { "settings", nlohmann::json::parse(settings) },
    { "version", MAMMORAY_VERSION }, { "twins", nlohmann::json::array() },
    { "mammograms", nlohmann::json::array() } };
  for (const TwinRun& run : evidence.Twins)
  {
    json["twins"].push_back(ToJson(run));
  }
  if (evidence.Landmarks)
  {
    json["landmarks"] = ToJson(*evidence.Landmarks);
  }
  for (const MammogramEvidence& mammogram : evidence.Mammograms)
  {
    json["mammograms"].push_back(ToJson(mammogram));
  }
  WriteText(json.dump(1) + "\n", path);
}

RegistrationEvidence ReadEvidence(const std::string& path, const std::string& settings)
{
  std::ifstream file(path);
  if (!file)
  {
    throw InputError(path + ": no such file");
  }
  RegistrationEvidence evidence;
  try
  {
    const nlohmann::json json = nlohmann::json::parse(file);
    if (json.at("settings") != nlohmann::json::parse(settings))
    {
      throw InputError(path + ": expected evidence gathered with the same settings, " + settings +
        ", found " + json.at("settings").dump());
    }
    for (const nlohmann::json& run : json.at("twins"))
    {
      evidence.Twins.push_back(TwinRunFrom(run));
    }
    if (json.contains("landmarks"))
    {
      evidence.Landmarks = LandmarkEvidenceFrom(json.at("landmarks"));
    }
    for (const nlohmann::json& mammogram : json.at("mammograms"))
    {
      evidence.Mammograms.push_back(MammogramEvidenceFrom(mammogram));
    }
  }
  catch (const nlohmann::json::exception& error)
  {
    throw InputError(path + ": expected what 'mammoray evidence' writes: " + error.what());
  }
  return evidence;
}

void WriteTwinTable(const std::vector<TwinRun>& runs, const std::string& path)
{
  std::string text = "phantom,kind,search,number,median_error_mm,largest_error_mm,outline_mm,"
                     "correlation,iterations,equilibria,seconds,converged";
  for (const RegistrationParameter& parameter : DefaultParameters({}))
  {
    for (const char* what : { "truth", "start", "found", "sigma" })
    {
      text += "," + parameter.Name + "_" + what;
    }
  }
  text += "\n";
  for (const TwinRun& run : runs)
  {
    text += run.Phantom + "," + run.Kind + "," + run.Search +
      Line(",%d,%.4f,%.4f,%.4f,%.4f,%d,%d,%.2f,%d", run.Number, run.MedianErrorMm,
        run.LargestErrorMm, run.MeanOutlineMm, run.Correlation, run.Iterations, run.Equilibria,
        run.Seconds, run.Converged ? 1 : 0);
    for (std::size_t index = 0; index < run.Names.size(); ++index)
    {
      text += Line(",%.5f,%.5f,%.5f,%.5f", run.Truth[index], run.Start[index], run.Found[index],
        run.Sigma[index]);
    }
    text += "\n";
  }
  WriteText(text, path);
}

std::string FormatEvidence(const RegistrationEvidence& evidence)
{
  std::string text;
  if (evidence.Landmarks)
  {
    text += LandmarkTable(*evidence.Landmarks);
  }
  text += TwinTables(evidence.Twins) + SearchTable(evidence.Twins);
  if (!evidence.Mammograms.empty())
  {
    text += MammogramTable(evidence.Mammograms);
  }
  return text;
}
}
