// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Evidence/EvidenceFile.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/ValidRange.h"
#include "mammoray/IO/Sha256.h"

#include <nlohmann/json.hpp>

#include <fstream>
#include <limits>

namespace mammoray
{
namespace
{
nlohmann::json ToJson(const TwinRun& run)
{
  // What is not a number becomes null.
  return { { "phantom", run.Phantom }, { "kind", run.Kind }, { "search", run.Search },
    { "number", run.Number }, { "redrawn", run.Redrawn }, { "modelCells", run.ModelCells },
    { "targetCells", run.TargetCells }, { "parameters", run.Names }, { "truth", run.Truth },
    { "start", run.Start }, { "found", run.Found }, { "sigma", run.Sigma },
    { "medianErrorMm", run.MedianErrorMm }, { "largestErrorMm", run.LargestErrorMm },
    { "coordinatesWithin", run.CoordinatesWithin }, { "meanOutlineDistanceMm", run.MeanOutlineMm },
    { "largestOutlineDistanceMm", run.LargestOutlineMm }, { "correlation", run.Correlation },
    { "tissueCorrelation", run.TissueCorrelation }, { "trust", run.Trust },
    { "reasons", run.Reasons }, { "iterations", run.Iterations }, { "equilibria", run.Equilibria },
    { "seconds", run.Seconds }, { "iterationSeconds", run.IterationSeconds },
    { "iterationCosts", run.IterationCosts }, { "converged", run.Converged },
    { "stopReason", run.StopReason } };
}

/// Tables are printed: letters only.
std::string Text(const nlohmann::json& value)
{
  return EscapeControls(value.get<std::string>());
}

std::vector<std::string> Texts(const nlohmann::json& values)
{
  std::vector<std::string> texts;
  for (const nlohmann::json& value : values)
  {
    texts.push_back(Text(value));
  }
  return texts;
}

/// Files before 2026-11-27 hold none.
std::vector<std::string> ReasonsFrom(const nlohmann::json& json)
{
  return Texts(json.value("reasons", nlohmann::json::array()));
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
  run.Phantom = Text(json.at("phantom"));
  run.Kind = Text(json.at("kind"));
  run.Search = Text(json.at("search"));
  run.Number = json.at("number").get<int>();
  run.Redrawn = json.at("redrawn").get<int>();
  run.ModelCells = json.at("modelCells").get<std::size_t>();
  run.TargetCells = json.at("targetCells").get<std::size_t>();
  run.Names = Texts(json.at("parameters"));
  run.Truth = Numbers(json.at("truth"));
  run.Start = Numbers(json.at("start"));
  run.Found = Numbers(json.at("found"));
  run.Sigma = Numbers(json.at("sigma"));
  run.MedianErrorMm = Number(json.at("medianErrorMm"));
  run.LargestErrorMm = Number(json.at("largestErrorMm"));
  run.CoordinatesWithin = Number(json.at("coordinatesWithin"));
  run.MeanOutlineMm = Number(json.at("meanOutlineDistanceMm"));
  run.LargestOutlineMm = Number(json.at("largestOutlineDistanceMm"));
  run.Correlation = Number(json.at("correlation"));
  run.TissueCorrelation = Number(json.at("tissueCorrelation"));
  run.Trust = Text(json.at("trust"));
  run.Reasons = ReasonsFrom(json);
  run.Iterations = json.at("iterations").get<int>();
  run.Equilibria = json.at("equilibria").get<int>();
  run.Seconds = Number(json.at("seconds"));
  run.IterationSeconds = Numbers(json.at("iterationSeconds"));
  run.IterationCosts = Numbers(json.at("iterationCosts"));
  run.Converged = json.at("converged").get<bool>();
  run.StopReason = Text(json.at("stopReason"));
  return run;
}

/// Tables go through these lists together.
void CheckCounts(const TwinRun& run, const std::string& path)
{
  const auto check =
    [&path](const char* name, std::size_t found, const char* other, std::size_t expected)
  {
    if (found != expected)
    {
      throw InputError(path + ": expected in '" + name + "' of a twin as many values as in '" +
        other + "', " + std::to_string(expected) + ", found " + std::to_string(found));
    }
  };
  check("truth", run.Truth.size(), "parameters", run.Names.size());
  check("start", run.Start.size(), "parameters", run.Names.size());
  check("found", run.Found.size(), "parameters", run.Names.size());
  check("sigma", run.Sigma.size(), "parameters", run.Names.size());
  check("iterationSeconds", run.IterationSeconds.size(), "iterationCosts",
    run.IterationCosts.size());
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
  for (const LandmarkSummary& row : found.Rows)
  {
    rows.push_back({ { "method", row.Method }, { "in3dMm", ToJson(row.InSpace) },
      { "onReceptorMm", ToJson(row.OnReceptor) } });
  }
  return { { "name", found.Name }, { "rows", rows }, { "glandDice", found.GlandDice },
    { "glandDiceAtRest", found.GlandDiceAtRest }, { "trust", found.Trust },
    { "expectedMedianMm", found.ExpectedMedianMm }, { "reasons", found.Reasons },
    { "iterations", found.Iterations }, { "equilibria", found.Equilibria },
    { "seconds", found.Seconds } };
}

LandmarkEvidence LandmarkEvidenceFrom(const nlohmann::json& json)
{
  LandmarkEvidence found;
  found.Name = Text(json.at("name"));
  for (const nlohmann::json& row : json.at("rows"))
  {
    found.Rows.push_back({ Text(row.at("method")), SummaryFrom(row.at("in3dMm")),
      SummaryFrom(row.at("onReceptorMm")) });
  }
  found.GlandDice = Number(json.at("glandDice"));
  found.GlandDiceAtRest = Number(json.at("glandDiceAtRest"));
  found.Trust = Text(json.at("trust"));
  found.ExpectedMedianMm = Number(json.at("expectedMedianMm"));
  found.Reasons = ReasonsFrom(json);
  found.Iterations = json.at("iterations").get<int>();
  found.Equilibria = json.at("equilibria").get<int>();
  found.Seconds = Number(json.at("seconds"));
  return found;
}

nlohmann::json ToJson(const MammogramEvidence& found)
{
  return { { "name", found.Name }, { "meanOutlineDistanceMm", found.MeanOutlineMm },
    { "largestOutlineDistanceMm", found.LargestOutlineMm }, { "correlation", found.Correlation },
    { "tissueCorrelation", found.TissueCorrelation }, { "trust", found.Trust },
    { "reasons", found.Reasons }, { "seconds", found.Seconds }, { "failure", found.Failure } };
}

nlohmann::json ToJson(const PointErrors& errors)
{
  return { { "in3dMm", errors.InSpaceMm }, { "onReceptorMm", errors.OnReceptorMm },
    { "alongBeamMm", errors.AlongBeamMm } };
}

PointErrors PointErrorsFrom(const nlohmann::json& json)
{
  return { Numbers(json.at("in3dMm")), Numbers(json.at("onReceptorMm")),
    Numbers(json.at("alongBeamMm")) };
}

nlohmann::json ToJson(const std::vector<StudyViewErrors>& found)
{
  nlohmann::json views = nlohmann::json::array();
  for (const StudyViewErrors& view : found)
  {
    views.push_back({ { "view", view.View }, { "imaged", ToJson(view.Imaged) },
      { "behind", ToJson(view.Behind) }, { "coordinatesWithin", view.CoordinatesWithin },
      { "modelErrorNeeded", view.ModelErrorNeeded },
      { "meanOutlineDistanceMm", view.MeanOutlineMm }, { "correlation", view.Correlation },
      { "tissueCorrelation", view.TissueCorrelation },
      { "expectedMedianMm", view.ExpectedMedianMm }, { "expected95Mm", view.Expected95Mm },
      { "trust", view.Trust }, { "reasons", view.Reasons } });
  }
  return views;
}

std::vector<StudyViewErrors> ViewErrorsFrom(const nlohmann::json& views)
{
  std::vector<StudyViewErrors> found;
  for (const nlohmann::json& view : views)
  {
    found.push_back({ Text(view.at("view")), PointErrorsFrom(view.at("imaged")),
      PointErrorsFrom(view.at("behind")), Number(view.at("coordinatesWithin")),
      Numbers(view.at("modelErrorNeeded")), Number(view.at("meanOutlineDistanceMm")),
      Number(view.at("correlation")), Number(view.at("tissueCorrelation")),
      Number(view.at("expectedMedianMm")), Number(view.at("expected95Mm")), Text(view.at("trust")),
      Texts(view.at("reasons")) });
  }
  return found;
}

nlohmann::json ToJson(const StudyRun& run)
{
  return { { "phantom", run.Phantom }, { "seed", run.Seed },
    { "laterality", std::string(1, run.Laterality) }, { "views", ToJson(run.Views) },
    { "ccAlone", ToJson(run.CcAlone) }, { "projections", ToJson(run.Swept) },
    { "oneViewMm", run.Together.OneViewMm }, { "bothViewsMm", run.Together.BothViewsMm },
    { "seconds", run.Seconds }, { "failure", run.Failure } };
}

StudyRun StudyRunFrom(const nlohmann::json& json)
{
  StudyRun run;
  run.Phantom = Text(json.at("phantom"));
  run.Seed = json.at("seed").get<std::uint32_t>();
  run.Laterality = Text(json.at("laterality")) == "R" ? 'R' : 'L';
  run.Views = ViewErrorsFrom(json.at("views"));
  run.CcAlone = ViewErrorsFrom(json.at("ccAlone"));
  run.Swept = ViewErrorsFrom(json.at("projections"));
  run.Together = { Numbers(json.at("oneViewMm")), Numbers(json.at("bothViewsMm")) };
  run.Seconds = Number(json.at("seconds"));
  run.Failure = Text(json.at("failure"));
  return run;
}

MammogramEvidence MammogramEvidenceFrom(const nlohmann::json& json)
{
  return { Text(json.at("name")), Number(json.at("meanOutlineDistanceMm")),
    Number(json.at("largestOutlineDistanceMm")), Number(json.at("correlation")),
    Number(json.at("tissueCorrelation")), Text(json.at("trust")), ReasonsFrom(json),
    Number(json.at("seconds")), Text(json.at("failure")) };
}
}

std::string EvidenceSettings(const EvidenceOptions& options)
{
  nlohmann::json phantoms;
  for (const EvidencePhantom& phantom : options.Phantoms)
  {
    phantoms[phantom.Name] = { { "sha256", Sha256OfFile(phantom.Labels.Path) },
      { "spacingMm", phantom.Labels.SpacingMm } };
  }
  const TwinOptions& twin = options.Twin;
  return nlohmann::json{
    { "phantoms", phantoms }, { "materials", options.Materials },
    { "orientation", options.Orientation }, { "seed", twin.Seed },
    { "modelFineness", twin.ModelFineness }, { "targetFineness", twin.TargetFineness },
    { "modelAnatomyMm", twin.ModelAnatomyMm }, { "targetAnatomyMm", twin.TargetAnatomyMm },
    { "noise", twin.Noise }, { "picture", NameOf(twin.Picture) },
    { "pixelSizesMm", twin.Registration.PixelSizesMm },
    { "comparison", static_cast<int>(twin.Registration.Comparison) },
    { "windowMm", twin.Registration.WindowMm },
    { "projections", options.Studies.empty() ? 0 : options.Studies.front().Options.Projections }
  }.dump();
}

std::string EvidenceJson(const RegistrationEvidence& evidence, const std::string& settings)
{
  nlohmann::json json{ { "settings", nlohmann::json::parse(settings) },
    { "version", MAMMORAY_VERSION }, { "twins", nlohmann::json::array() },
    { "landmarks", nlohmann::json::array() }, { "mammograms", nlohmann::json::array() } };
  for (const TwinRun& run : evidence.Twins)
  {
    json["twins"].push_back(ToJson(run));
  }
  for (const LandmarkEvidence& landmarks : evidence.Landmarks)
  {
    json["landmarks"].push_back(ToJson(landmarks));
  }
  for (const MammogramEvidence& mammogram : evidence.Mammograms)
  {
    json["mammograms"].push_back(ToJson(mammogram));
  }
  json["studies"] = nlohmann::json::array();
  for (const StudyRun& study : evidence.Studies)
  {
    json["studies"].push_back(ToJson(study));
  }
  return json.dump(1) + "\n";
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
    const nlohmann::json json = nlohmann::json::parse(file, JsonNestingLimit{ path });
    if (json.at("settings") != nlohmann::json::parse(settings))
    {
      throw InputError(path + ": expected evidence gathered with the same settings, " + settings +
        ", found " + json.at("settings").dump());
    }
    for (const nlohmann::json& run : json.at("twins"))
    {
      evidence.Twins.push_back(TwinRunFrom(run));
      CheckCounts(evidence.Twins.back(), path);
    }
    for (const nlohmann::json& landmarks : json.value("landmarks", nlohmann::json::array()))
    {
      evidence.Landmarks.push_back(LandmarkEvidenceFrom(landmarks));
    }
    for (const nlohmann::json& mammogram : json.at("mammograms"))
    {
      evidence.Mammograms.push_back(MammogramEvidenceFrom(mammogram));
    }
    for (const nlohmann::json& study : json.value("studies", nlohmann::json::array()))
    {
      evidence.Studies.push_back(StudyRunFrom(study));
    }
  }
  catch (const nlohmann::json::exception& error)
  {
    throw InputError(path + ": expected what 'mammoray evidence' writes: " + error.what());
  }
  return evidence;
}
}
